/* People go on to a meeting's next case: meetings.h, meeting_moves.h. */
#include "server/net/meeting_moves.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/net/asleep.h"
#include "server/net/meeting_list.h"
#include "server/net/rooms.h"
#include "server/net/schedule.h"
#include "server/wire/message.h"

/* A wall is nothing else. */
static enum wire_member_role lower(enum wire_member_role a, enum wire_member_role b)
{
    return a == WIRE_MEMBER_ROLE_WALL || a < b ? a : b;
}

/* ---- who may ---------------------------------------------------------------------------------------------------- */

bool net_meeting_role(const struct net *net, const struct meeting *meeting, const struct identity *who,
                      enum wire_member_role *role)
{
    enum wire_member_role most = WIRE_MEMBER_ROLE_OBSERVER, found;
    struct fleet_plan plan;
    *role = WIRE_MEMBER_ROLE_PLANNER;
    if (who->source == IDENTITY_MACHINE)
        return true;
    if (!meeting_allows(meeting, who, role))
        return false;
    for (size_t i = 0; i < meeting->n_cases && most < WIRE_MEMBER_ROLE_PLANNER; i++)
        if (meeting->cases[i]->plan[0] &&
            plan_rights_role(&net->plan_rights, net->fleet, who, meeting->cases[i]->plan, &found) && found > most)
            most = found;
    for (size_t i = 0; !meeting->n_cases && i < fleet_n_plans(net->fleet) && most < WIRE_MEMBER_ROLE_PLANNER; i++)
        if (fleet_plan_at(net->fleet, i, &plan) &&
            plan_rights_role(&net->plan_rights, net->fleet, who, plan.id, &found) && found > most)
            most = found;
    if (!meeting_names(meeting, who)) /* came, and was not asked to prepare it */
        most = lower(most, WIRE_MEMBER_ROLE_REVIEWER);
    *role = lower(*role, most);
    return true;
}

bool net_meeting_case_is_open(const struct net *net, const struct meeting_case *one, const struct identity *who,
                              const char *member)
{
    const struct net_room *room = one->room[0] ? rooms_find(net, one->room) : NULL;
    if (!one->plan[0])
        return false;
    if (plan_rights_check(&net->plan_rights, net->fleet, who, ACCESS_LOOK, one->plan))
        return true;
    return member && room && room_caller_of(room->room, who, member).is_here;
}

bool net_meeting_seat(const struct net *net, const struct meeting *meeting, const struct identity *who,
                      const char *member, enum wire_member_role *role, bool *presents)
{
    bool is_here = false;
    *presents = false;
    for (size_t i = 0; member && i < meeting->n_cases; i++) {
        const struct net_room *room = rooms_find(net, meeting->cases[i]->room);
        const struct room_caller caller =
            room ? room_caller_of(room->room, who, member) : (struct room_caller){ .is_here = false };
        if (!caller.is_here || !caller.is_member || caller.is_guest)
            continue;
        const char *name = strchr(member, ' ');
        struct room_present present;
        is_here = true;
        *role = caller.role;
        for (size_t k = 0; name && room_present_at(room->room, k, &present); k++)
            if (strlen(present.id) == (size_t)(name - member) &&
                strncmp(present.id, member, (size_t)(name - member)) == 0)
                *presents = present.presents;
        if (strcmp(meeting->cases[i]->id, meeting->now) == 0)
            break;
    }
    return is_here;
}

bool meeting_moves_may(const struct net *net, const struct meeting *meeting, const struct meeting_case *to,
                       const struct identity *who, const struct room_present *present, enum wire_member_role *role)
{
    enum wire_member_role most;
    struct meeting_link *link = meeting_link_find((struct meeting *)meeting, present->link);
    *role = present->role;
    if (!to->plan[0])
        return false;
    if (present->role == WIRE_MEMBER_ROLE_WALL || who->source == IDENTITY_MACHINE)
        return true;
    if (meeting_is_barred(meeting, who->user))
        return false;
    if (link && !link->is_ended) {
        *role = lower(lower(link->role, to->cap), present->is_guest ? WIRE_MEMBER_ROLE_REVIEWER : link->role);
        return true;
    }
    if (!who->user[0] || !plan_rights_role(&net->plan_rights, net->fleet, who, to->plan, role))
        return false;
    if (meeting_allows(meeting, who, &most))
        *role = lower(*role, most);
    return true;
}

/* ---- telling ---------------------------------------------------------------------------------------------------- */

static const struct identity *identity_at(void *connection)
{
    const struct visitor *visitor = ws_owner(connection);
    return &visitor->identity;
}

/* The case that is behind the one of now: counted for everybody, named to those to whom it is open. */
static void fill_next(const struct net *net, const struct meeting *meeting, void *connection,
                      const struct room_present *present, struct message_meeting *told)
{
    struct problem problem;
    enum wire_member_role role;
    const struct meeting_case *next = meeting->ended_ms ? NULL : meeting_next(meeting, &problem);
    if (!next)
        return;
    told->n_next = (int64_t)meeting_place(meeting, next) + 1;
    if (!meeting_moves_may(net, meeting, next, identity_at(connection), present, &role))
        return;
    (void)snprintf(told->next_patient, sizeof told->next_patient, "%s", next->patient);
    (void)snprintf(told->next_plan, sizeof told->next_plan, "%.160s", next->label);
}

void meeting_moves_tell(struct net *net, const struct meeting *meeting, const struct meeting_case *here,
                        struct room *room, void *connection)
{
    struct room_present present;
    enum wire_member_role role;
    const struct meeting_case *now = meeting_find(meeting, meeting->now);
    if (!room_present_of(room, connection, &present))
        return;
    struct message_meeting told = { .n = (int64_t)meeting_place(meeting, here) + 1,
                                    .of = (int64_t)meeting->n_cases,
                                    .n_now = now ? (int64_t)meeting_place(meeting, now) + 1 : 0,
                                    .open = true,
                                    .over = meeting->ended_ms != 0 };
    (void)snprintf(told.meeting, sizeof told.meeting, "%s", meeting->id);
    (void)snprintf(told.name, sizeof told.name, "%s", meeting->name);
    (void)snprintf(told.here, sizeof told.here, "%s", here->id);
    if (now)
        told.open = meeting_moves_may(net, meeting, now, identity_at(connection), &present, &role);
    told.waits = present.waits_outside && now && !told.open;
    if (now && told.open)
        (void)snprintf(told.now, sizeof told.now, "%s", now->id);
    told.may_advance =
        !meeting->ended_ms && !present.is_guest &&
        (present.presents || present.role == WIRE_MEMBER_ROLE_PRESENTER || present.role == WIRE_MEMBER_ROLE_PLANNER);
    told.opens = present.presents && here->opens && meetings_opened(net, meeting, here->id);
    fill_next(net, meeting, connection, &present, &told);
    room_tell_meeting(room, connection, &told);
}

static void fill_words(const struct meeting *meeting, const struct meeting_case *to, const char *by,
                       struct message_meeting_case *told)
{
    *told =
        (struct message_meeting_case){ .n = (int64_t)meeting_place(meeting, to) + 1, .of = (int64_t)meeting->n_cases };
    (void)snprintf(told->meeting, sizeof told->meeting, "%s", meeting->id);
    (void)snprintf(told->by, sizeof told->by, "%.160s", by);
}

static void fill_open(const struct meeting_case *to, struct message_meeting_case *told)
{
    told->open = true;
    (void)snprintf(told->to, sizeof told->to, "%s", to->id);
    (void)snprintf(told->room, sizeof told->room, "%s", to->room);
    (void)snprintf(told->patient, sizeof told->patient, "%s", to->patient);
    (void)snprintf(told->plan, sizeof told->plan, "%.160s", to->label);
    (void)snprintf(told->approval, sizeof told->approval, "%s", to->approval);
}

/* presents: in the new room, whoever does it now. */
static void send_along(struct net *net, const struct meeting *meeting, struct room *from, void *connection, bool asks,
                       bool presents, const char *by)
{
    struct room_present present;
    struct problem problem;
    struct message_meeting_case told;
    enum wire_member_role role;
    const struct meeting_case *to = meeting_find(meeting, meeting->now);
    struct net_room *room = to ? rooms_find(net, to->room) : NULL;
    if (!room || room->room == from || !room_present_of(from, connection, &present))
        return;
    fill_words(meeting, to, by, &told);
    if (!meeting_moves_may(net, meeting, to, identity_at(connection), &present, &role)) {
        room_set_waiting(from, connection, true);
        room_tell_case(from, connection, &told);
        return;
    }
    fill_open(to, &told);
    const bool keeps_link =
        present.role == WIRE_MEMBER_ROLE_WALL || meeting_link_find((struct meeting *)meeting, present.link);
    const struct room_seat seat = { .name = present.name,
                                    .user = present.user,
                                    .link = keeps_link ? present.link : "",
                                    .person = present.person,
                                    .color = present.color,
                                    .role = role,
                                    .is_guest = present.is_guest,
                                    .presents = presents };
    told.asks = asks && !present.waits_outside && present.role != WIRE_MEMBER_ROLE_WALL;
    if (!told.asks) {
        meetings_came(net, meeting, present.user);
        told.asks = !room_seat_make(room->room, &seat, clock_now_us(), told.member, told.secret, &problem);
    }
    room_set_waiting(from, connection, false);
    room_tell_case(from, connection, &told);
    schedule_settle(room);
}

void meeting_moves_send(struct net *net, const struct meeting *meeting, struct room *from, void *connection, bool asks,
                        const char *by)
{
    send_along(net, meeting, from, connection, asks, false, by);
}

void net_meeting_tell(struct net *net, const struct meeting *meeting)
{
    for (size_t i = 0; i < meeting->n_cases; i++) {
        struct net_room *room = rooms_find(net, meeting->cases[i]->room);
        struct room_present present;
        for (size_t k = 0; room && room_present_at(room->room, k, &present); k++)
            if (present.connection)
                meeting_moves_tell(net, meeting, meeting->cases[i], room->room, present.connection);
        if (room)
            schedule_settle(room);
    }
}

size_t net_meeting_put_out(struct net *net, const struct meeting *meeting, const char *digits)
{
    size_t n = 0;
    for (size_t i = 0; i < meeting->n_cases; i++) {
        struct net_room *room = rooms_find(net, meeting->cases[i]->room);
        if (!room)
            continue;
        n += room_remove_of_link(room->room, digits, clock_now_us());
        schedule_settle(room);
    }
    return n;
}

/* ---- going ------------------------------------------------------------------------------------------------------ */

struct going {
    struct net *net;
    char meeting[64], to[MEETING_ID], from[64], address[46], name[164], room[64], member[64];
    char made[64]; /* the room that was made for it; "": none */
    struct identity who;
    bool only_prepares;
    net_meeting_done *done;
    void *context;
};

/* True if somebody presents in the room of the case before, and comes along. */
static bool presenter_comes(const struct net *net, const struct meeting *meeting, const struct meeting_case *to,
                            const struct room *before)
{
    struct room_present present;
    enum wire_member_role role;
    for (size_t i = 0; before && room_present_at(before, i, &present); i++)
        if (present.presents && present.connection)
            return meeting_moves_may(net, meeting, to, identity_at(present.connection), &present, &role);
    return false;
}

/* True if somebody presents there now. */
static bool has_presenter(const struct room *room)
{
    struct room_present present;
    for (size_t i = 0; room_present_at(room, i, &present); i++)
        if (present.presents && present.connection)
            return true;
    return false;
}

static void take_people_along(struct net *net, const struct meeting *meeting, const struct going *going,
                              const char *before)
{
    const struct meeting_case *to = meeting_find(meeting, meeting->now);
    const struct net_room *was = rooms_find(net, before);
    const bool keeps_presenter = presenter_comes(net, meeting, to, was ? was->room : NULL);
    for (size_t i = 0; i < meeting->n_cases; i++) {
        struct net_room *room = rooms_find(net, meeting->cases[i]->room);
        struct room_present present;
        const bool is_presented = room && has_presenter(room->room);
        for (size_t k = 0; room && room_present_at(room->room, k, &present); k++) {
            if (room == rooms_find(net, to->room)) {
                room_set_waiting(room->room, present.connection, false);
                continue;
            }
            const bool is_of_now = was == room, has_asked = strcmp(going->room, room_id(room->room)) == 0 &&
                                                            strcmp(going->member, present.id) == 0;
            const bool presents = keeps_presenter ? is_of_now && present.presents : has_asked;
            /* who stayed in the room of an earlier case, or prepares a later one, is asked */
            const bool asks = present.looks_alone || (!is_of_now && is_presented);
            if (present.connection)
                send_along(net, meeting, room->room, present.connection, !has_asked && !presents && asks, presents,
                           going->name);
        }
    }
}

static void end_going(struct going *going, const struct meeting *meeting, const struct problem *problem)
{
    going->done(going->context, meeting, problem);
    free(going);
}

/* It is on disk: so it is. */
static void is_written(void *context, const struct meeting *meeting, const struct problem *problem)
{
    struct going *going = context;
    struct net *net = going->net;
    if (problem) {
        if (going->made[0])
            net_room_delete(net, going->made, "the meeting did not go on to it");
        end_going(going, NULL, problem);
        return;
    }
    const struct meeting *now = net_meeting_find(net, going->meeting); /* with the words of the plan */
    const struct meeting_case *from = meeting_find(now, going->from);
    if (!going->only_prepares) {
        take_people_along(net, now, going, from ? from->room : "");
        net_meeting_tell(net, now);
    }
    end_going(going, meeting, NULL);
}

/* The case to go to. NULL with problem. */
static struct meeting_case *find_target(const struct net *net, const struct meeting *meeting, const struct going *going,
                                        struct problem *problem)
{
    if (meeting->ended_ms) {
        problem_set(problem, PROBLEM_CONFLICT, "", "over", "the meeting is over");
        return NULL;
    }
    if (!going->only_prepares && !meeting_is_at(meeting, going->from, problem))
        return NULL;
    struct meeting_case *to =
        strcmp(going->to, "next") == 0 ? meeting_next(meeting, problem) : meeting_find(meeting, going->to);
    if (!to) {
        if (problem->type == PROBLEM_NONE)
            problem_set(problem, PROBLEM_NOT_FOUND, "/case", "", "the meeting has no case \"%.23s\"", going->to);
        return NULL;
    }
    const size_t n = meeting_place(meeting, to) + 1;
    const struct net_room *room = rooms_find(net, going->room);
    struct room_present present;
    enum wire_member_role role;
    bool may = net_meeting_case_is_open(net, to, &going->who, NULL);
    for (size_t k = 0; !may && room && room_present_at(room->room, k, &present); k++)
        may =
            strcmp(present.id, going->member) == 0 && meeting_moves_may(net, meeting, to, &going->who, &present, &role);
    if (may)
        return to;
    problem_set(problem, PROBLEM_FORBIDDEN, "/case", "closed", "case %zu is not open to you", n);
    return NULL;
}

static void go_on(struct going *going);

static void has_woken(void *context, const char *room_id, const struct problem *problem)
{
    (void)room_id;
    if (problem && problem->type != PROBLEM_NOT_FOUND)
        end_going(context, NULL, problem);
    else
        go_on(context);
}

/* The room of the case is awake, and was made where there was none. False with problem. */
static bool have_room(struct net *net, const struct meeting *meeting, struct meeting_case *to, struct going *going,
                      struct problem *problem)
{
    if (to->room[0] && rooms_find(net, to->room))
        return true;
    if (!net_may_own_more(net, meeting->owner, problem))
        return false;
    struct room *room = net_room_create(net, to->plan, NULL, problem);
    if (!room)
        return false;
    if (meeting->owner[0])
        room_set_owner(room, meeting->owner);
    (void)snprintf(to->room, sizeof to->room, "%s", room_id(room));
    (void)snprintf(going->made, sizeof going->made, "%s", room_id(room));
    return true;
}

/* The plan of the case behind this one is loaded meanwhile, so that it stands there at once. */
static void load_ahead(struct net *net, const struct meeting *meeting, const struct meeting_case *to)
{
    struct problem problem;
    const size_t place = meeting_place(meeting, to) + 1;
    if (place < meeting->n_cases && meeting->cases[place]->plan[0] &&
        !fleet_open(net->fleet, meeting->cases[place]->plan, &problem))
        log_info("the plan of the next case is not loaded ahead");
}

static bool begin_write(struct going *going, struct problem *problem)
{
    struct net *net = going->net;
    const struct meeting *meeting = net_meeting_find(net, going->meeting);
    struct meeting *copy = meeting ? meeting_copy(meeting) : NULL;
    struct meeting_case *to;
    if (!copy)
        return problem_set(problem, PROBLEM_NOT_FOUND, "", "", "there is no meeting \"%.63s\"", going->meeting);
    if (!(to = find_target(net, copy, going, problem)) || !have_room(net, copy, to, going, problem)) {
        meeting_free(copy);
        return false;
    }
    if (!going->only_prepares) {
        meeting_go(copy, to, clock_wall_ms());
        load_ahead(net, copy, to);
    }
    const struct net_meeting_act act = { .who = &going->who,
                                         .address = going->address,
                                         .name = going->name,
                                         .what = going->only_prepares ? "prepared" : "case",
                                         .case_id = to->id };
    return net_meeting_commit(net, copy, &act, is_written, going, problem);
}

/* False with problem: another change is being written. A second press while the first is being written is late. */
static bool is_free(const struct net *net, const char *id, const char *from, bool only_prepares,
                    struct problem *problem)
{
    const char *now;
    if (!meetings_is_busy(net, id, &now, problem))
        return true;
    if (!only_prepares && strcmp(now, from ? from : "") != 0)
        problem_set(problem, PROBLEM_CONFLICT, "/from", "from", "the meeting has moved on meanwhile");
    return false;
}

static void go_on(struct going *going)
{
    struct problem problem = { 0 };
    if (is_free(going->net, going->meeting, going->from, going->only_prepares, &problem) &&
        begin_write(going, &problem))
        return;
    if (going->made[0])
        net_room_delete(going->net, going->made, "the meeting did not go on to it");
    end_going(going, NULL, &problem);
}

bool net_meeting_go(struct net *net, const struct net_meeting_go *go, net_meeting_done *done, void *context,
                    struct problem *problem)
{
    const struct meeting *meeting = net_meeting_find(net, go->meeting);
    problem->type = PROBLEM_NONE;
    if (!meeting)
        return problem_set(problem, PROBLEM_NOT_FOUND, "", "", "there is no meeting \"%.63s\"", go->meeting);
    if (!is_free(net, go->meeting, go->from, go->only_prepares, problem))
        return false;
    struct going *going = mem_new(sizeof *going);
    *going = (struct going){
        .net = net, .who = *go->who, .only_prepares = go->only_prepares, .done = done, .context = context
    };
    mem_put_text(going->meeting, sizeof going->meeting, go->meeting);
    mem_put_text(going->to, sizeof going->to, go->to);
    mem_put_text(going->from, sizeof going->from, go->from);
    mem_put_text(going->address, sizeof going->address, go->address);
    mem_put_text(going->name, sizeof going->name, go->name && go->name[0] ? go->name : go->who->name);
    mem_put_text(going->room, sizeof going->room, go->room);
    mem_put_text(going->member, sizeof going->member, go->member);
    const struct meeting_case *to = find_target(net, meeting, going, problem);
    if (!to) {
        free(going);
        return false;
    }
    mem_put_text(going->to, sizeof going->to, to->id); /* "next" is said once */
    if (to->room[0] && net_room_is_asleep(net, to->room))
        net_room_wake(net, to->room, has_woken, going);
    else
        go_on(going);
    return true;
}

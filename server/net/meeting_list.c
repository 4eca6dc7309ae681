/* The list of meetings: meeting_list.h. */
#include "server/net/meeting_list.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/net/can_write.h"
#include "server/net/keep_change.h"
#include "server/net/schedule.h"
#include "server/wire/random.h"

struct kept_meeting {
    struct meeting *meeting; /* as it counts; NULL: its first write is under way */
    struct meeting *pending; /* as it is being written; NULL: is deleted, or nothing is under way */
    uint64_t ticket;         /* of that write; 0: none */
    net_meeting_done *done;
    void *context;
    bool is_changed; /* what rooms know of it is not on disk */
    int64_t due_us;  /* no such write before */
};

struct place { /* of a room on an agenda */
    char room[64];
    struct meeting *meeting;
    struct meeting_case *one;
};

struct meetings {
    struct kept_meeting **list; /* the oldest first; place for NET_MAX_MEETINGS */
    size_t n;
    struct place *places; /* by room */
    size_t n_places;
    bool is_sorted; /* places are those of the list as it is */
};

static struct meetings *all_of(struct net *net)
{
    if (net->meetings)
        return net->meetings;
    net->meetings = mem_new(sizeof *net->meetings);
    net->meetings->list = mem_array(NET_MAX_MEETINGS, sizeof net->meetings->list[0], 1 << 20, NULL);
    return net->meetings;
}

static struct kept_meeting *find(const struct net *net, const char *id)
{
    for (size_t i = 0; net->meetings && i < net->meetings->n; i++) {
        const struct kept_meeting *kept = net->meetings->list[i];
        const struct meeting *known = kept->meeting ? kept->meeting : kept->pending;
        if (known && strcmp(known->id, id) == 0)
            return net->meetings->list[i];
    }
    return NULL;
}

static void drop(struct meetings *all, struct kept_meeting *kept)
{
    size_t i = 0;
    while (all->list[i] != kept)
        i++;
    all->n--;
    memmove(&all->list[i], &all->list[i + 1], (all->n - i) * sizeof all->list[0]);
    meeting_free(kept->meeting);
    meeting_free(kept->pending);
    free(kept);
    all->is_sorted = false;
}

static struct kept_meeting *append(struct meetings *all)
{
    struct kept_meeting *kept = all->list && all->n < NET_MAX_MEETINGS ? mem_new(sizeof *kept) : NULL;
    if (kept)
        all->list[all->n++] = kept;
    all->is_sorted = false;
    return kept;
}

/* ---- by room ---------------------------------------------------------------------------------------------------- */

static int by_room(const void *a, const void *b)
{
    return strcmp(((const struct place *)a)->room, ((const struct place *)b)->room);
}

static bool sort_places(struct meetings *all)
{
    size_t n = 0;
    if (all->is_sorted)
        return true;
    for (size_t i = 0; i < all->n; i++)
        n += all->list[i]->meeting ? all->list[i]->meeting->n_cases : 0;
    struct place *places = mem_array(n + 1, sizeof *places, 16 << 20, NULL);
    if (!places)
        return false;
    free(all->places);
    all->places = places;
    all->n_places = 0;
    for (size_t i = 0; i < all->n; i++) {
        struct meeting *meeting = all->list[i]->meeting;
        for (size_t k = 0; meeting && k < meeting->n_cases; k++) {
            struct place *place = &places[all->n_places];
            if (!meeting->cases[k]->room[0])
                continue;
            *place = (struct place){ .meeting = meeting, .one = meeting->cases[k] };
            mem_put_text(place->room, sizeof place->room, meeting->cases[k]->room);
            all->n_places++;
        }
    }
    qsort(places, all->n_places, sizeof *places, by_room);
    all->is_sorted = true;
    return true;
}

struct meeting *meetings_of_room(const struct net *net, const char *room, struct meeting_case **one)
{
    struct place key;
    if (!net->meetings || !net->meetings->n || !sort_places(net->meetings))
        return NULL;
    mem_put_text(key.room, sizeof key.room, room);
    const struct place *first = bsearch(&key, net->meetings->places, net->meetings->n_places, sizeof key, by_room);
    const struct place *found = first;
    if (!found)
        return NULL;
    /* a room can be on the agenda of several meetings: the one that runs counts, else any */
    while (found > net->meetings->places && strcmp(found[-1].room, room) == 0)
        found--;
    for (const struct place *at = found;
         at < net->meetings->places + net->meetings->n_places && strcmp(at->room, room) == 0; at++)
        if (meeting_state(at->meeting) == MEETING_RUNNING ||
            (meeting_state(found->meeting) == MEETING_OVER && meeting_state(at->meeting) != MEETING_OVER))
            found = at;
    *one = found->one;
    return found->meeting;
}

bool meetings_ask_in(const struct net *net, const char *room, const struct identity *who)
{
    struct meeting_case *one;
    enum wire_member_role role;
    const struct meeting *meeting = meetings_of_room(net, room, &one);
    return meeting && meeting_allows(meeting, who, &role);
}

/* ---- what rooms know -------------------------------------------------------------------------------------------- */

/* The words of the plan, masked, as its files said them when they were looked at. */
static void look_at_plan(const struct net *net, struct meeting_case *one)
{
    struct fleet_plan plan;
    if (!one->plan[0] || !fleet_plan_find(net->fleet, one->plan, &plan))
        return;
    mem_put_text(one->patient, sizeof one->patient, plan.is_phantom ? "PHANTOM" : plan.patient);
    mem_put_text(one->approval, sizeof one->approval, plan.approval);
    mem_put_text(one->label, sizeof one->label, plan.label && plan.label[0] ? plan.label : plan.name);
}

static const struct net_room *room_awake(const struct net *net, const char *id)
{
    for (size_t i = 0; i < net->n_rooms; i++)
        if (strcmp(room_id(net->rooms[i]->room), id) == 0)
            return net->rooms[i];
    return NULL;
}

static void look_at(const struct net *net, struct meeting *meeting, struct meeting_case *one)
{
    const struct net_room *room = one->room[0] ? room_awake(net, one->room) : NULL;
    const int64_t first_ms = meeting_first_ms(meeting, one);
    if (!room || !first_ms)
        return;
    if (!meeting->ended_ms) /* what is decided later is no decision of the meeting */
        (void)room_decision(room->room, first_ms, one->decision, one->decided_by, &one->decided_ms);
    cJSON *stays = room_stays(room->room);
    while (stays && cJSON_GetArraySize(stays) > MEETING_MAX_STAYS)
        cJSON_DeleteItemFromArray(stays, 0);
    if (!stays)
        return;
    cJSON_Delete(one->stays);
    one->stays = stays;
}

static const struct meeting *look_at_all(const struct net *net, struct meeting *meeting)
{
    for (size_t i = 0; i < meeting->n_cases; i++) {
        look_at_plan(net, meeting->cases[i]);
        look_at(net, meeting, meeting->cases[i]);
    }
    return meeting;
}

void meetings_look_at_room(struct net *net, const char *room)
{
    struct meeting_case *one;
    struct meeting *meeting = meetings_of_room(net, room, &one);
    if (meeting)
        look_at(net, meeting, one);
}

void meetings_touch(struct net *net, const struct meeting *meeting)
{
    struct kept_meeting *kept = find(net, meeting->id);
    if (!kept)
        return;
    kept->is_changed = true;
    schedule_at(net, 0);
}

void meetings_came(struct net *net, const struct meeting *meeting, const char *user)
{
    struct kept_meeting *kept = find(net, meeting->id);
    if (!kept || !kept->meeting || !user[0])
        return;
    const size_t n_before = kept->meeting->n_came;
    meeting_came(kept->meeting, user);
    if (kept->pending)
        meeting_came(kept->pending, user);
    if (kept->meeting->n_came != n_before)
        meetings_touch(net, meeting);
}

void meetings_bar(struct net *net, const struct meeting *meeting, const char *user, const char *link)
{
    struct kept_meeting *kept = find(net, meeting->id);
    if (!kept || !kept->meeting)
        return;
    meeting_bar(kept->meeting, user, link);
    if (kept->pending)
        meeting_bar(kept->pending, user, link);
    meetings_touch(net, meeting);
}

bool meetings_opened(struct net *net, const struct meeting *meeting, const char *case_id)
{
    struct kept_meeting *kept = find(net, meeting->id);
    struct meeting_case *one = kept && kept->meeting ? meeting_find(kept->meeting, case_id) : NULL;
    struct meeting_case *pending = kept && kept->pending ? meeting_find(kept->pending, case_id) : NULL;
    const bool opens = one && one->opens;
    if (one)
        one->opens = false;
    if (opens && pending)
        pending->opens = false;
    return opens;
}

void meetings_room_changed(struct net *net, const char *room)
{
    struct meeting_case *one;
    const struct meeting *meeting = meetings_of_room(net, room, &one);
    if (meeting && meeting_was_entered(meeting, one))
        meetings_touch(net, meeting);
}

/* ---- what others ask -------------------------------------------------------------------------------------------- */

size_t net_n_meetings(const struct net *net)
{
    return net->meetings ? net->meetings->n : 0;
}

const struct meeting *net_meeting_at(const struct net *net, size_t index)
{
    return net->meetings->list[index]->meeting;
}

const struct meeting *net_meeting_find(struct net *net, const char *id)
{
    const struct kept_meeting *kept = find(net, id);
    return kept && kept->meeting ? look_at_all(net, kept->meeting) : NULL;
}

struct meeting *net_meeting_new(struct net *net, const char *owner, struct problem *problem)
{
    const struct meetings *all = all_of(net);
    char letters[8 + 1], id[64];
    size_t n_own = 0;
    for (size_t i = 0; owner[0] && i < all->n; i++)
        n_own += all->list[i]->meeting && strcmp(all->list[i]->meeting->owner, owner) == 0;
    if (!all->list || all->n >= NET_MAX_MEETINGS || n_own >= NET_MAX_MEETINGS_OF_ONE) {
        problem_set(problem, PROBLEM_LIMIT, "", "", "%zu meetings are kept, more are not allowed: delete some",
                    n_own >= NET_MAX_MEETINGS_OF_ONE ? n_own : all->n);
        return NULL;
    }
    do {
        if (!random_letters(letters, 8)) {
            problem_set(problem, PROBLEM_INTERNAL, "", "", "the system gave no random numbers");
            return NULL;
        }
        (void)snprintf(id, sizeof id, "m-%.4s-%s", letters, letters + 4);
    } while (find(net, id));
    return meeting_create(id, owner, clock_wall_ms());
}

/* ---- writing ---------------------------------------------------------------------------------------------------- */

bool meetings_is_busy(const struct net *net, const char *id, const char **now, struct problem *problem)
{
    const struct kept_meeting *kept = find(net, id);
    if (!kept || !kept->ticket)
        return false;
    *now = kept->pending ? kept->pending->now : "";
    problem_set(problem, PROBLEM_BUSY, "", "", "another change of this meeting is being written");
    problem->retry_after_ms = 300;
    return true;
}

static char *audit_text(const struct meeting *meeting, const struct net_meeting_act *act)
{
    cJSON *detail = cJSON_CreateObject();
    cJSON_AddStringToObject(detail, "meeting", meeting->id);
    cJSON_AddStringToObject(detail, "what", act->what);
    if (act->case_id[0])
        cJSON_AddStringToObject(detail, "case", act->case_id);
    const struct meeting_case *of = meeting_find(meeting, act->case_id);
    const struct keep_change_by by = { act->who, act->name ? act->name : act->who->name, act->address };
    return keep_change_row(of ? of->room : "", of ? of->plan : "", "meeting", detail, &by);
}

/* The write of a meeting, or of its end; NULL: no memory. */
static struct store_room *make_write(const struct meeting *meeting, bool deletes, char *audit)
{
    struct store_room *write = mem_new(sizeof *write);
    write->meeting = deletes ? mem_new(sizeof *write->meeting) : meeting_write(meeting);
    if (deletes)
        mem_put_text(write->meeting->id, sizeof write->meeting->id, meeting->id);
    return keep_change_with(write, write->meeting != NULL, audit);
}

/* The change counts. */
static void take_over(struct net *net, struct kept_meeting *kept)
{
    struct meetings *all = net->meetings;
    net_meeting_done *done = kept->done;
    void *context = kept->context;
    kept->ticket = 0;
    all->is_sorted = false;
    if (!kept->pending) {
        drop(all, kept);
        done(context, NULL, NULL);
        return;
    }
    meeting_free(kept->meeting);
    kept->meeting = kept->pending;
    kept->pending = NULL;
    done(context, kept->meeting, NULL);
}

bool net_meeting_commit(struct net *net, struct meeting *changed, const struct net_meeting_act *act,
                        net_meeting_done *done, void *context, struct problem *problem)
{
    struct meetings *all = all_of(net);
    const char *now;
    struct kept_meeting *kept = find(net, changed->id);
    const bool is_new = !kept;
    if (meetings_is_busy(net, changed->id, &now, problem) || !net_can_write(net, problem) ||
        (!kept && !(kept = append(all)))) {
        meeting_free(changed);
        return false;
    }
    char *audit = net->store ? audit_text(changed, act) : NULL;
    struct store_room *write = audit ? make_write(changed, act->deletes, audit) : NULL;
    if (net->store && !keep_change_write(net, write, &kept->ticket, problem)) {
        meeting_free(changed);
        if (is_new)
            drop(all, kept);
        return false;
    }
    kept->done = done;
    kept->context = context;
    kept->pending = changed;
    if (act->deletes) {
        meeting_free(changed);
        kept->pending = NULL;
    }
    if (!net->store)
        take_over(net, kept);
    return true;
}

bool meetings_written(struct net *net, const struct store_answer *answer)
{
    struct problem problem;
    for (size_t i = 0; net->meetings && i < net->meetings->n; i++) {
        struct kept_meeting *kept = net->meetings->list[i];
        const enum keep_change change = keep_change_answer(&kept->ticket, answer, &problem);
        if (change == KEEP_CHANGE_OTHER)
            continue;
        if (change == KEEP_CHANGE_WRITTEN) {
            take_over(net, kept);
            return true;
        }
        net_meeting_done *done = kept->done;
        void *context = kept->context;
        meeting_free(kept->pending);
        kept->pending = NULL;
        if (!kept->meeting)
            drop(net->meetings, kept);
        done(context, NULL, &problem);
        return true;
    }
    return false;
}

void meetings_write_due(struct net *net, bool is_last)
{
    const int64_t now_us = clock_now_us();
    for (size_t i = 0; net->meetings && i < net->meetings->n; i++) {
        struct kept_meeting *kept = net->meetings->list[i];
        if (!kept->is_changed || kept->ticket || !kept->meeting)
            continue;
        if (!is_last && now_us < kept->due_us) {
            schedule_at(net, kept->due_us);
            continue;
        }
        (void)look_at_all(net, kept->meeting);
        struct store_room *write = make_write(kept->meeting, false, NULL);
        kept->due_us = now_us + MEETINGS_PAUSE_MS * INT64_C(1000);
        kept->is_changed = !write || !store_write(net->store, write, 0);
        if (kept->is_changed) { /* tried again */
            store_room_free(write);
            schedule_at(net, kept->due_us);
        }
    }
}

/* ---- the disk, the end ------------------------------------------------------------------------------------------ */

void meetings_add_all(struct net *net, const struct store_answer *opened)
{
    for (size_t i = 0; i < opened->n_meetings; i++) {
        struct meeting *meeting = find(net, opened->meetings[i]->id) ? NULL : meeting_read(opened->meetings[i]);
        struct kept_meeting *kept = meeting ? append(all_of(net)) : NULL;
        if (kept)
            kept->meeting = meeting;
        else
            meeting_free(meeting);
        if (!meeting && !find(net, opened->meetings[i]->id))
            log_error("meeting %s is not readable in the database", opened->meetings[i]->id);
    }
    for (size_t i = 0; opened->is_new && net->meetings && i < net->meetings->n; i++)
        net->meetings->list[i]->is_changed = true; /* what was on disk was lost */
}

void meetings_erase(struct net *net, const char *plan, const char *other)
{
    for (size_t i = 0; net->meetings && i < net->meetings->n; i++) {
        struct kept_meeting *kept = net->meetings->list[i];
        if (kept->meeting && meeting_erase(kept->meeting, plan, other))
            kept->is_changed = true;
        if (kept->pending && meeting_erase(kept->pending, plan, other))
            kept->is_changed = true;
        net->meetings->is_sorted = false;
    }
    schedule_at(net, 0);
}

void meetings_end(struct net *net)
{
    struct problem problem;
    problem_set(&problem, PROBLEM_BUSY, "", "", "the server is stopping");
    for (size_t i = 0; net->meetings && i < net->meetings->n; i++) {
        struct kept_meeting *kept = net->meetings->list[i];
        if (kept->ticket)
            kept->done(kept->context, NULL, &problem);
        kept->done = NULL;
        kept->ticket = 0;
    }
}

void meetings_finish(struct net *net)
{
    struct meetings *all = net->meetings;
    while (all && all->n)
        drop(all, all->list[0]);
    if (all) {
        free(all->places);
        free(all->list);
        free(all);
    }
    net->meetings = NULL;
}

/* The life of rooms: made, put to sleep, woken, deleted. */
#include "server/net/rooms.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/net/asleep.h"
#include "server/net/bridge.h"
#include "server/net/can_write.h"
#include "server/net/keep.h"
#include "server/net/keep_audit.h"
#include "server/net/keep_recordings.h"
#include "server/net/meeting_list.h"
#include "server/net/net.h"
#include "server/net/schedule.h"
#include "server/wire/random.h"

struct net_room *rooms_find(const struct net *net, const char *id)
{
    for (size_t i = 0; i < net->n_rooms; i++)
        if (strcmp(room_id(net->rooms[i]->room), id) == 0)
            return net->rooms[i];
    return NULL;
}

static const char *address(void *context, void *connection)
{
    (void)context;
    return ws_client(connection);
}

static const struct identity *identity(void *context, void *connection)
{
    struct net *net = context;
    struct visitor *visitor = ws_owner(connection);
    if (net->is_still && visitor->identity.user[0])
        (void)net->is_still(net->rights, &visitor->identity); /* whether it ends is looked at with time */
    return &visitor->identity;
}

static bool role_of(void *context, const struct room *room, const struct identity *who, enum wire_member_role *role)
{
    const struct net *net = context;
    return plan_rights_role(&net->plan_rights, net->fleet, who, room_plan_id(room), role);
}

static bool is_loopback(const char *client)
{
    return strncmp(client, "127.", 4) == 0 || strcmp(client, "::1") == 0;
}

static bool sees_identity(void *context, const struct room *room, void *connection)
{
    const struct net *net = context;
    const struct identity *who = identity(context, connection);
    if (who->source == IDENTITY_MACHINE)
        return net->is_alone && is_loopback(ws_client(connection));
    return plan_rights_check(&net->plan_rights, net->fleet, who, ACCESS_IDENTITY, room_plan_id(room));
}

static void send_text(void *context, void *connection, const char *text)
{
    (void)context;
    ws_send_text(connection, text);
}

static void send_latest(void *context, void *connection, uint32_t key, const char *text)
{
    (void)context;
    ws_send_latest(connection, key, text);
}

_Static_assert((int)WS_SLOTS == (int)ROOM_WATCH,
               "a slot for each view, the last one for the small picture of the presenter");

static void send_frame(void *context, void *connection, const struct frame_header *header, struct frame *frame)
{
    (void)context;
    ws_send_frame(connection, header, frame);
}

static void close_connection(void *context, void *connection)
{
    (void)context;
    ws_close(connection, WS_CLOSE_NORMAL);
}

static void close_signed_out(void *context, void *connection)
{
    (void)context;
    ws_close(connection, WS_CLOSE_POLICY);
}

/* ---- rooms ------------------------------------------------------------------------------------------------------ */

const char *rooms_plan_id_now(const struct net *net, const char *plan_id, char known[64])
{
    struct fleet_plan plan;
    (void)snprintf(known, 64, "%s", fleet_plan_find(net->fleet, plan_id, &plan) ? plan.id : plan_id);
    return known;
}

/* 40 random bits as "7q4k-m2wz". */
static bool make_id(char id[16])
{
    char letters[8 + 1];
    if (!random_letters(letters, 8))
        return false;
    (void)snprintf(id, 16, "%.4s-%s", letters, letters + 4);
    return true;
}

static struct net_room *add_room(struct net *net, const char *id, const char *plan_id)
{
    const struct room_callbacks callbacks = { .render = bridge_render,
                                              .forget = bridge_forget,
                                              .scene_changed = bridge_scene_changed,
                                              .send_text = send_text,
                                              .send_latest = send_latest,
                                              .send_frame = send_frame,
                                              .close = close_connection,
                                              .address = address,
                                              .identity = identity,
                                              .caller = keep_caller,
                                              .role_of = role_of,
                                              .sees_identity = sees_identity,
                                              .close_signed_out = close_signed_out,
                                              .context = net,
                                              .item_changed = keep_item_changed,
                                              .item_first = net->store ? keep_item_first : NULL,
                                              .can_write = keep_can_write,
                                              .kept_changed = keep_changed,
                                              .audited = keep_audited,
                                              .audit_has_place = keep_audit_has_place,
                                              .is_saved = keep_is_saved,
                                              .recorded = net->store ? keep_recorded : NULL,
                                              .recording_deleted = keep_recording_deleted,
                                              .replay_read = keep_replay_read,
                                              .meeting = net->meeting_doors };
    struct net_room *room = mem_new(sizeof *room);
    *room = (struct net_room){ .net = net,
                               .room = room_create(id, plan_id, &callbacks, &net->limits),
                               .state = FLEET_CLOSED };
    net->rooms[net->n_rooms++] = room;
    return room;
}

static void close_because(struct net *net, size_t index, const char *reason)
{
    struct net_room *room = net->rooms[index];
    meetings_look_at_room(net, room_id(room->room)); /* for the last time */
    room_end_because(room->room, reason);
    room_audit_flush(room->room, clock_now_us());
    net->rooms[index] = net->rooms[--net->n_rooms];
    bridge_close_room(room);
    for (struct visitor *visitor = net->visitors; visitor; visitor = visitor->next)
        if (visitor->room == room) {
            if (!room_has_member(room->room, visitor->connection)) /* members get theirs from room_destroy */
                ws_bye(visitor->connection, WS_CLOSE_NORMAL, reason, -1);
            bridge_leave(visitor);
            visitor->room = NULL;
        }
    room_count(room->room, &net->closed);
    room_destroy(room->room);
    keep_room_finish(room);
    free(room);
}

void rooms_close(struct net *net, size_t index)
{
    close_because(net, index, "the room is closed");
}

/* Puts the room to sleep: it was used, nobody is connected, and it is on disk as it is. False: not now. */
static bool put_to_sleep(struct net *net, size_t index)
{
    const struct net_room *room = net->rooms[index];
    struct store_room kept;
    if (room->empty_since_us)
        room_recording_cut(room->room, clock_now_us()); /* written first */
    if (!net->store || !room->empty_since_us || !room_was_used(room->room) || !keep_is_written(room) ||
        !room_keep(room->room, ROOM_MEMBERS, &kept))
        return false;
    struct store_summary facts = { .created_ms = kept.created_ms,
                                   .used_ms =
                                       (int64_t)time(NULL) * 1000 - (clock_now_us() - room->empty_since_us) / 1000,
                                   .revision = kept.revision,
                                   .n_decided = (uint32_t)room_n_decided(room->room),
                                   .n_members = (uint32_t)kept.n_members };
    (void)snprintf(facts.id, sizeof facts.id, "%s", room_id(room->room));
    (void)snprintf(facts.plan, sizeof facts.plan, "%s", room_plan_id(room->room));
    (void)snprintf(facts.owner, sizeof facts.owner, "%s", kept.owner);
    (void)snprintf(facts.name, sizeof facts.name, "%s", kept.name);
    facts.is_open = kept.is_open;
    facts.is_changed = kept.is_changed;
    facts.n_notes = (uint32_t)room_n_notes(room->room);
    facts.names = mem_array(ROOM_NAMES_BYTES, 1, ROOM_NAMES_BYTES, NULL);
    if (facts.names)
        room_names_in(room->room, facts.names);
    facts.users = room_users_in(room->room);
    facts.people = kept.people;
    kept.people = NULL;
    room_kept_finish(&kept);
    asleep_add(net, &facts);
    close_because(net, index, ROOM_SLEEPS); /* told to who listens, and to walls */
    return true;
}

int64_t rooms_idle_left_us(const struct net *net, int64_t now_us)
{
    int64_t least_us = INT64_MAX;
    const int64_t idle_us = net->room_idle_close_s * INT64_C(1000000),
                  wall_us = net->n_unchanged ? clock_wall_ms() * 1000 : 0;
    for (size_t i = 0; idle_us > 0 && i < net->n_rooms; i++) {
        const int64_t since_us = net->rooms[i]->empty_since_us, left_us = since_us + idle_us - now_us;
        if (since_us && left_us < least_us)
            least_us = left_us;
    }
    for (size_t i = 0; idle_us > 0 && net->n_unchanged && i < net->n_asleep; i++) {
        const int64_t left_us = net->asleep[i].facts.used_ms * 1000 + idle_us - wall_us;
        if (!net->asleep[i].facts.is_changed && left_us < least_us)
            least_us = left_us;
    }
    return least_us > 0 ? least_us : 0;
}

static const char nothing_changed[] = "nobody was in the room for a long time, and nobody had changed anything in it";

void rooms_close_idle(struct net *net)
{
    const int64_t now_us = clock_now_us(), after_us = net->room_idle_close_s * INT64_C(1000000),
                  before_ms = net->n_unchanged ? clock_wall_ms() - after_us / 1000 : 0;
    for (size_t i = net->n_rooms; net->room_idle_close_s > 0 && i-- > 0;) {
        const struct net_room *room = net->rooms[i];
        if (!room->empty_since_us || now_us - room->empty_since_us < after_us)
            continue;
        if (room_was_changed(room->room) && put_to_sleep(net, i)) {
            log_info("room put to sleep: nobody there for %d s", net->room_idle_close_s);
        } else if (!net->store || !room_was_used(room->room) || !room_was_changed(room->room)) {
            log_info("room closed: nobody there for %d s", net->room_idle_close_s);
            net_room_delete(net, room_id(room->room), nothing_changed);
        }
    }
    for (size_t i = net->n_asleep; net->room_idle_close_s > 0 && net->n_unchanged && i-- > 0;)
        if (!net->asleep[i].facts.is_changed && !net->asleep[i].ticket && net->asleep[i].facts.used_ms <= before_ms)
            net_room_delete(net, net->asleep[i].facts.id, nothing_changed);
}

/* True if one more room may be awake, perhaps because another one was put to sleep. */
static bool make_place(struct net *net)
{
    size_t longest = net->n_rooms;
    if (net->n_rooms < (size_t)net->max_rooms)
        return true;
    for (size_t i = 0; i < net->n_rooms; i++)
        if (net->rooms[i]->empty_since_us && room_was_used(net->rooms[i]->room) && keep_is_written(net->rooms[i]) &&
            (longest == net->n_rooms || net->rooms[i]->empty_since_us < net->rooms[longest]->empty_since_us))
            longest = i;
    return longest < net->n_rooms && put_to_sleep(net, longest);
}

bool net_may_own_more(const struct net *net, const char *user, struct problem *problem)
{
    const size_t most = (size_t)net->max_rooms / 4 ? (size_t)net->max_rooms / 4 : 1, most_kept = STORE_MAX_ROOMS / 4;
    size_t n = 0, n_asleep = 0;
    for (size_t i = 0; i < net->n_rooms; i++)
        n += strcmp(room_owner(net->rooms[i]->room), user) == 0;
    for (size_t i = 0; i < net->n_asleep && user[0]; i++)
        n_asleep += strcmp(net->asleep[i].facts.owner, user) == 0;
    if (!user[0] || (n < most && n + n_asleep < most_kept))
        return true;
    problem_set(problem, PROBLEM_LIMIT, "", "own", "%zu rooms of yours are in use and %zu sleep: delete some", n,
                n_asleep);
    problem->retry_after_ms = 60000;
    return false;
}

struct room *net_room_create(struct net *net, const char *plan_id, const cJSON *bookmark, struct problem *problem)
{
    char id[16];
    if (atomic_load(&net->is_stopping)) {
        problem_set(problem, PROBLEM_BUSY, "", "", "the server is stopping");
        return NULL;
    }
    if (net->n_rooms + net->n_asleep >= STORE_MAX_ROOMS) {
        problem_set(problem, PROBLEM_LIMIT, "", "", "%zu rooms are kept already, at most %d can be: delete some",
                    net->n_rooms + net->n_asleep, STORE_MAX_ROOMS);
        return NULL;
    }
    if (!make_place(net)) {
        problem_set(problem, PROBLEM_LIMIT, "", "", "there are %zu rooms already, at most %d are allowed", net->n_rooms,
                    net->max_rooms);
        return NULL;
    }
    if (!id_is_valid(plan_id)) {
        problem_set(problem, PROBLEM_VALIDATION, "/plan", "pattern",
                    "/plan is \"%.40s\", expected 1 to 63 of a-z, 0-9 and -", plan_id);
        return NULL;
    }
    do
        if (!make_id(id)) {
            problem_set(problem, PROBLEM_INTERNAL, "", "", "the system gave no random numbers");
            return NULL;
        }
    while (rooms_find(net, id) || asleep_find(net, id));
    if (!fleet_open(net->fleet, plan_id, problem))
        return NULL;
    char known[64];
    struct net_room *room = add_room(net, id, rooms_plan_id_now(net, plan_id, known));
    room->keep.changed = net->store ? ROOM_ALL_PARTS : 0;
    schedule_at(net, 0);
    if (bookmark && !room_begin_with(room->room, bookmark, problem)) {
        rooms_close(net, net->n_rooms - 1);
        return NULL;
    }
    bridge_report_plan(room);
    schedule_settle(room);
    return room->room;
}

struct room *net_replay_create(struct net *net, const struct room *of_room, const char *recording,
                               struct problem *problem)
{
    char plan_id[64], room_of[64];
    const uint32_t n_named = room_n_named(of_room);
    const struct room_recording *facts = room_recording(of_room, recording);
    if (!facts) {
        problem_set(problem, PROBLEM_NOT_FOUND, "/recording/id", "", "the room has no recording \"%.63s\"", recording);
        return NULL;
    }
    if (facts->state == WIRE_RECORDING_STATE_RUNNING) {
        problem_set(problem, PROBLEM_CONFLICT, "/recording/id", "", "the recording still runs: end it first");
        return NULL;
    }
    struct room_recording copy = *facts; /* making a room may put the other one to sleep */
    copy.marks = facts->marks ? cJSON_Duplicate(facts->marks, true) : NULL;
    (void)snprintf(plan_id, sizeof plan_id, "%s", room_plan_id(of_room));
    (void)snprintf(room_of, sizeof room_of, "%s", room_id(of_room));
    struct room *room = net_room_create(net, plan_id, NULL, problem);
    if (room) {
        rooms_find(net, room_id(room))->keep.changed = 0; /* it is on disk already, as a recording */
        room_replay_begin(room, room_of, n_named, &copy, clock_now_us());
    }
    room_recording_finish(&copy);
    return room;
}

struct room *net_room_find(struct net *net, const char *id)
{
    struct net_room *room = rooms_find(net, id);
    return room ? room->room : NULL;
}

void net_room_delete(struct net *net, const char *id, const char *reason)
{
    struct problem gone;
    char deleted[64]; /* id may be the room's own */
    (void)snprintf(deleted, sizeof deleted, "%s", id);
    size_t index = 0;
    while (index < net->n_rooms && strcmp(room_id(net->rooms[index]->room), deleted) != 0)
        index++;
    if (index < net->n_rooms)
        close_because(net, index, reason);
    else if (!asleep_find(net, deleted))
        return;
    asleep_remove(net, deleted);
    keep_delete(net, deleted);
    problem_set(&gone, PROBLEM_NOT_FOUND, "", "", "%s", reason);
    asleep_tell(net, deleted, &gone);
}

static void delete_of_plan(struct net *net, const char *id, const char *plan_id, const char *address,
                           const char *reason)
{
    char deleted[64];
    cJSON *detail = cJSON_CreateObject();
    (void)snprintf(deleted, sizeof deleted, "%s", id);
    cJSON_AddStringToObject(detail, "why", reason);
    net_audit_by(net, keep_caller(net), address, deleted, plan_id, "deleted", detail);
    net_room_delete(net, deleted, reason);
}

void net_rooms_delete_of_plan(struct net *net, const char *plan_id, const char *address, const char *reason)
{
    for (size_t i = net->n_rooms; i-- > 0;)
        if (strcmp(room_plan_id(net->rooms[i]->room), plan_id) == 0)
            delete_of_plan(net, room_id(net->rooms[i]->room), plan_id, address, reason);
    char known[64];
    for (size_t i = net->n_asleep; i-- > 0;)
        if (strcmp(rooms_plan_id_now(net, net->asleep[i].facts.plan, known), plan_id) == 0)
            delete_of_plan(net, net->asleep[i].facts.id, plan_id, address, reason);
}

size_t net_n_decided(const struct net *net, const char *id)
{
    const struct net_room *room = rooms_find(net, id);
    const struct asleep_room *asleep = room ? NULL : asleep_find(net, id);
    return room ? room_n_decided(room->room) : asleep ? asleep->facts.n_decided : 0;
}

size_t net_n_decided_of_plan(const struct net *net, const char *plan_id)
{
    size_t n = 0;
    char known[64];
    for (size_t i = 0; i < net->n_rooms; i++)
        if (strcmp(room_plan_id(net->rooms[i]->room), plan_id) == 0)
            n += room_n_decided(net->rooms[i]->room);
    for (size_t i = 0; i < net->n_asleep; i++)
        if (strcmp(rooms_plan_id_now(net, net->asleep[i].facts.plan, known), plan_id) == 0)
            n += net->asleep[i].facts.n_decided;
    return n;
}

bool net_room_is_asleep(const struct net *net, const char *id)
{
    return asleep_find(net, id) != NULL;
}

void net_room_wake(struct net *net, const char *id,
                   void (*done)(void *context, const char *room_id, const struct problem *problem), void *context)
{
    asleep_wake(net, id, done, context);
}

bool net_admits_guests(const struct net *net)
{
    return net->limits.admits_guests;
}

size_t net_n_asleep(const struct net *net)
{
    return net->n_asleep;
}

bool net_asleep_is_seen_by(const struct net *net, const char *room_id, const struct identity *who)
{
    const struct asleep_room *room = asleep_find(net, room_id);
    return room && net_asleep_is_listed_to(net, (size_t)(room - net->asleep), who);
}

bool net_asleep_is_listed_to(const struct net *net, size_t index, const struct identity *who)
{
    const struct store_summary *facts = &net->asleep[index].facts;
    enum wire_member_role role;
    if (who->source == IDENTITY_MACHINE)
        return true;
    const bool has_role = plan_rights_role(&net->plan_rights, net->fleet, who, facts->plan, &role);
    if (room_people_name(facts->owner, facts->people, who, has_role) ||
        (has_role && meetings_ask_in(net, facts->id, who)))
        return true;
    return has_role && (facts->is_open || (!facts->owner[0] && role == WIRE_MEMBER_ROLE_PLANNER));
}

/* ---- the store -------------------------------------------------------------------------------------------------- */

void rooms_was_read(struct net *net, const struct store_answer *answer)
{
    struct problem problem = { 0 };
    struct asleep_room *asleep = asleep_of_answer(net, answer);
    const struct waiter *bookmark = asleep ? NULL : asleep_waiter_of_answer(net, answer);
    char token[64] = "";
    if (bookmark) {
        memcpy(token, bookmark->room, sizeof token);
        asleep = answer->room ? asleep_find(net, answer->room->id) : NULL;
    }
    if (bookmark && !asleep) {
        problem_set(&problem, PROBLEM_NOT_FOUND, "", "", "there is no bookmark with this token");
        asleep_tell(net, token, answer->room && rooms_find(net, answer->room->id) ? NULL : &problem);
        return;
    }
    if (!asleep)
        return;
    char id[64], plan[64];
    (void)snprintf(id, sizeof id, "%s", asleep->facts.id);
    (void)snprintf(plan, sizeof plan, "%s", asleep->facts.plan);
    asleep->ticket = 0;
    if (!answer->room) {
        problem_set(&problem, PROBLEM_STORAGE, "", "", "the room cannot be read from the disk: %s", answer->error.text);
    } else if (!make_place(net)) {
        problem_set(&problem, PROBLEM_LIMIT, "", "", "there are %zu rooms in use, at most %d are allowed", net->n_rooms,
                    net->max_rooms);
    } else {
        asleep_remove(net, id);
        char known[64];
        struct net_room *room = add_room(net, id, rooms_plan_id_now(net, plan, known));
        keep_restore(room, answer->room);
        bridge_report_plan(room);
        schedule_settle(room);
    }
    asleep_tell(net, id, problem.type == PROBLEM_NONE ? NULL : &problem);
    if (token[0])
        asleep_tell(net, token, problem.type == PROBLEM_NONE ? NULL : &problem);
}

void net_bookmark_wake(struct net *net, const char *token,
                       void (*done)(void *context, const char *room_id, const struct problem *problem), void *context)
{
    asleep_wake_bookmark(net, token, done, context);
}

size_t net_n_rooms(const struct net *net)
{
    return net->n_rooms;
}

struct room *net_room_at(const struct net *net, size_t index)
{
    return index < net->n_rooms ? net->rooms[index]->room : NULL;
}

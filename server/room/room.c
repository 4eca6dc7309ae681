/* Creates and destroys a room; takes the renderer's states and members' messages. */
#include "server/room/room.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "core/base/mem.h"
#include "server/room/entry.h"
#include "server/room/items/acceptance.h"
#include "server/room/items/item_list.h"
#include "server/room/items/items.h"
#include "server/room/items/record_body.h"
#include "server/room/log/recording.h"
#include "server/room/log/replay.h"
#include "server/room/out/audit.h"
#include "server/room/out/listeners.h"
#include "server/room/out/saved.h"
#include "server/room/out/send.h"
#include "server/room/people/admission.h"
#include "server/room/people/control.h"
#include "server/room/people/handover.h"
#include "server/room/people/known.h"
#include "server/room/people/links.h"
#include "server/room/people/look.h"
#include "server/room/people/member.h"
#include "server/room/people/moving.h"
#include "server/room/people/naming.h"
#include "server/room/people/pointers.h"
#include "server/room/people/presenter.h"
#include "server/room/people/removal.h"
#include "server/room/state/event.h"
#include "server/room/state/member_list.h"
#include "server/room/state/presence.h"
#include "server/room/state/roles.h"
#include "server/room/state/who.h"
#include "server/room/streams/display.h"
#include "server/room/streams/lag.h"
#include "server/room/streams/main_view.h"
#include "server/room/streams/pictures.h"
#include "server/room/streams/stream.h"
#include "server/room/streams/wall.h"
#include "server/room/streams/watch.h"
#include "server/room/views/beginning.h"
#include "server/room/views/member_view.h"
#include "server/room/views/shared_scene.h"
#include "server/wire/json_merge.h"
#include "server/wire/message.h"

static const char room_is_closed[] = ROOM_IS_CLOSED;
static const char hello_first[] = "the first message must be hello";

/* ---- life ------------------------------------------------------------------------------------------------------- */

struct room *room_create(const char *id, const char *plan_id, const struct room_callbacks *callbacks,
                         const struct room_limits *limits)
{
    struct room *room = mem_new(sizeof *room);
    assert(id_is_valid(id) && id_is_valid(plan_id));
    (void)snprintf(room->id, sizeof room->id, "%s", id);
    (void)snprintf(room->plan_id, sizeof room->plan_id, "%s", plan_id);
    room->callbacks = *callbacks;
    room->members.max = limits && limits->max_members > 0 && limits->max_members < ROOM_MAX_MEMBERS
                            ? limits->max_members
                            : ROOM_MAX_MEMBERS;
    room->created_at_s = (int64_t)time(NULL); /* wall clock, only to be displayed */
    events_init(room);
    presence_init(room);
    audit_init(room);
    saved_init(room);
    items_init(room);
    acceptances_init(room);
    control_init(room);
    known_init(room);
    admission_init(room);
    room->admits_guests = limits && limits->admits_guests;
    room->is_open_to_everybody = limits && limits->is_open_to_everybody;
    links_init(room);
    look_init(room);
    recordings_init(room, limits && limits->recording_speed > 0 ? limits->recording_speed : 1);
    return room;
}

static void forget_plan(struct room *room)
{
    cJSON_Delete(room->shared.plan);
    cJSON_Delete(room->shared.defaults);
    room->shared.plan = room->shared.defaults = NULL;
}

void room_destroy(struct room *room)
{
    if (!room)
        return;
    recordings_finish(room);
    const bool sleeps = strcmp(room->end_reason, ROOM_SLEEPS) == 0; /* only walls are in it */
    listeners_end(room, room->end_reason[0] ? room->end_reason : room_is_closed);
    for (int i = 0; i < room->members.n; i++)
        if (room->members.list[i]->connection)
            send_bye_for(room, room->members.list[i]->connection, sleeps ? "asleep" : "", -1,
                         room->end_reason[0] ? room->end_reason : room_is_closed);
    members_free(room);
    while (room->streams.first)
        stream_destroy(room, room->streams.first);
    forget_plan(room);
    items_forget_keeping(room);
    items_free(room);
    acceptances_free(room);
    beginning_free(room);
    replay_free(room);
    audit_free(room);
    look_free(room);
    links_free(room);
    control_free(room);
    cJSON_Delete(room->shared.scene);
    cJSON_Delete(room->shared.restored);
    known_free(room);
    admission_free(room);
    saved_free(room);
    presence_free(room);
    events_free(room);
    free(room);
}

const char *room_id(const struct room *room)
{
    return room->id;
}

const char *room_plan_id(const struct room *room)
{
    return room->plan_id;
}

const char *room_name(const struct room *room)
{
    return room->name;
}

void room_end_because(struct room *room, const char *reason)
{
    (void)snprintf(room->end_reason, sizeof room->end_reason, "%s", reason);
}

bool room_was_used(const struct room *room)
{
    return !room->replay && (room->members.n_named > 0 || links_were_made(room) || room->shared.is_changed);
}

bool room_was_changed(const struct room *room)
{
    return room->replay || room->shared.is_changed || room->name[0] || links_were_made(room) || room->items->first ||
           events_n_item_changes(room) > 0 || room->recordings->n > 0;
}

uint32_t room_n_named(const struct room *room)
{
    return room->members.n_named;
}

size_t room_n_decided(const struct room *room)
{
    size_t n = 0;
    for (const struct item *item = room->items->first; item; item = item->next)
        n += record_is_wanted(item->kind);
    return n;
}

size_t room_n_notes(const struct room *room)
{
    size_t n = 0;
    for (const struct item *item = room->items->first; item; item = item->next)
        n += item->kind == WIRE_ITEM_KIND_NOTE;
    return n;
}

void room_count(const struct room *room, struct room_counters *sum)
{
    sum->pictures_requested += room->counters.pictures_requested;
    sum->frames_sent += room->counters.frames_sent;
    sum->frame_bytes += room->counters.frame_bytes;
    sum->frames_skipped += room->counters.frames_skipped;
    sum->messages_refused += room->counters.messages_refused;
    sum->stills_sent += room->counters.stills_sent;
}

/* ---- the renderer ----------------------------------------------------------------------------------------------- */

/* Takes over copies of the plan's documents. Keeps the scene over a restart, without ids that the plan does not have
 * any more: it may have changed on disk. False: no memory, and all is as it was. */
static bool replace_plan(struct room *room, const cJSON *plan_document, const cJSON *default_scene)
{
    cJSON *plan = cJSON_Duplicate(plan_document, true), *defaults = cJSON_Duplicate(default_scene, true);
    cJSON *scene = NULL;
    const cJSON *before = room->shared.scene ? room->shared.scene : room->shared.restored;
    if (plan && defaults)
        scene = before ? scene_document_renew(plan, defaults, before) : beginning_scene(room, plan, defaults);
    if (!scene) {
        cJSON_Delete(plan);
        cJSON_Delete(defaults);
        return false;
    }
    forget_plan(room);
    room->shared.plan = plan;
    room->shared.defaults = defaults;
    if (!before || !json_equal(scene, before)) {
        room->shared.revision++;
        room_event(room, ROOM_SCENE, NULL);
    }
    cJSON_Delete(room->shared.scene);
    cJSON_Delete(room->shared.restored);
    room->shared.scene = scene;
    room->shared.restored = NULL;
    room_event(room, ROOM_PLAN, NULL);
    return true;
}

static void set_state(struct room *room, enum wire_renderer_state state, const char *phase, double percent,
                      const struct problem *problem)
{
    room->renderer.state = state;
    room->renderer.percent = percent >= 0 && percent <= 100 ? percent : 0;
    (void)snprintf(room->renderer.phase, sizeof room->renderer.phase, "%s", phase ? phase : "");
    room->renderer.problem = problem ? *problem : (struct problem){ 0 };
}

/* The plan was read anew: it may be another patient's. */
static void forget_identity(struct room *room)
{
    bool was_named = false;
    for (int i = 0; i < room->members.n; i++) {
        struct member *member = room->members.list[i];
        was_named = was_named || member->is_naming;
        member->is_naming = false;
        member->read_identity_us = 0;
    }
    if (was_named)
        send_members(room);
}

bool room_plan_ready(struct room *room, const cJSON *plan_document, const cJSON *default_scene, const char *gl,
                     bool is_software, int64_t now_us)
{
    room_enter(room, now_us);
    if (!replace_plan(room, plan_document, default_scene)) {
        struct problem problem = { 0 };
        (void)json_no_memory(&problem, "the plan in this room");
        room_renderer_state(room, WIRE_RENDERER_STATE_FAILED, NULL, 0, &problem, now_us);
        return false;
    }
    (void)snprintf(room->renderer.gl, sizeof room->renderer.gl, "%s", gl ? gl : "");
    if (room->renderer.is_software != is_software) {
        room->renderer.is_software = is_software;
        streams_restart_pace(room);
    }
    set_state(room, WIRE_RENDERER_STATE_READY, NULL, 0, NULL);
    forget_identity(room);
    acceptances_revision(room, "");
    streams_forget_requests(room);
    streams_changed(room, true);
    send_plan(room);
    streams_remove_bad_overrides(room);
    send_renderer_state(room, NULL);
    room->callbacks.scene_changed(room->callbacks.context, room, room->shared.scene, room->shared.revision);
    replay_plan_ready(room);
    room_leave(room);
    return true;
}

void room_renderer_state(struct room *room, enum wire_renderer_state state, const char *phase, double percent,
                         const struct problem *problem, int64_t now_us)
{
    room_enter(room, now_us);
    bool was_ready = room->renderer.state == WIRE_RENDERER_STATE_READY;
    set_state(room, state, phase, percent, problem);
    if (state != WIRE_RENDERER_STATE_READY) {
        streams_forget_requests(room);
    } else if (!was_ready) {
        streams_forget_requests(room);
        streams_changed(room, false);
    }
    send_renderer_state(room, NULL);
    room_leave(room);
}

void room_plan_revision(struct room *room, const char *revision)
{
    (void)snprintf(room->files.revision, sizeof room->files.revision, "%s", revision);
}

bool room_wants_revision(const struct room *room)
{
    return room_replays(room) || recording_wants_revision(room) || acceptances_want_revision(room);
}

void room_revision_came(struct room *room, const char *revision, int64_t now_us)
{
    room_enter(room, now_us);
    recording_revision_came(room, revision);
    acceptances_revision(room, revision);
    replay_revision_came(room, revision);
    room_leave(room);
}

/* ---- messages --------------------------------------------------------------------------------------------------- */

static bool handle_ping(struct room *room, struct member *member, const struct message *message,
                        struct problem *problem)
{
    (void)problem;
    struct message pong = { .type = MESSAGE_PONG, .pong = { message->ping.time_ms } };
    send_to_member(room, member, &pong);
    return true;
}

static bool handle_second_hello(struct room *room, struct member *member, const struct message *message,
                                struct problem *problem)
{
    (void)room;
    (void)message;
    return problem_set(problem, PROBLEM_VALIDATION, "/type", "duplicate", "hello was said already, as %s", member->id);
}

/* The handler of each message. It returns false with a problem when it applied nothing of the message. */
static const struct {
    enum message_type type;
    bool (*handle)(struct room *room, struct member *member, const struct message *message, struct problem *problem);
} handlers[] = {
    { MESSAGE_HELLO, handle_second_hello },
    { MESSAGE_VIEW_OPEN, member_view_open },
    { MESSAGE_VIEW_PATCH, member_view_patch },
    { MESSAGE_VIEW_ACTIVE, member_view_active },
    { MESSAGE_VIEW_CLOSE, member_view_close },
    { MESSAGE_WALL_LAYOUT, wall_layout_set },
    { MESSAGE_WATCH, watch_set },
    { MESSAGE_FOLLOW, member_follow },
    { MESSAGE_PRESENT, presenter_present },
    { MESSAGE_SHOW_EVERYONE, presenter_show_everyone },
    { MESSAGE_CONTROL_REQUEST, control_request },
    { MESSAGE_CONTROL_GIVE, control_give },
    { MESSAGE_CONTROL_REFUSE, control_refuse },
    { MESSAGE_CONTROL_TAKE, control_take },
    { MESSAGE_CONTROL_LOCK, control_lock },
    { MESSAGE_MEMBER_REMOVE, member_remove },
    { MESSAGE_MEETING_NEXT, meeting_next_case },
    { MESSAGE_MEETING_GO, meeting_go_along },
    { MESSAGE_SCENE_PATCH, member_scene_patch },
    { MESSAGE_FRAME_SHOWN, member_frame_shown },
    { MESSAGE_ITEM_PUT, items_put },
    { MESSAGE_ITEM_DELETE, items_delete },
    { MESSAGE_ITEM_HIDE, items_hide },
    { MESSAGE_POINTER, pointer_move },
    { MESSAGE_LOOK_HERE, look_here },
    { MESSAGE_LOOK_COME, look_come },
    { MESSAGE_RECORDING_START, recording_start },
    { MESSAGE_RECORDING_STOP, recording_stop },
    { MESSAGE_REPLAY_PLAY, replay_play },
    { MESSAGE_REPLAY_PAUSE, replay_pause },
    { MESSAGE_REPLAY_SEEK, replay_seek },
    { MESSAGE_REPLAY_LEAVE, replay_leave },
    { MESSAGE_PING, handle_ping },
};

static void whole_number(const cJSON *json, const char *name, double most, int64_t *value)
{
    double number = json_number(json, name, 0);
    *value = number >= 0 && number <= most ? (int64_t)number : 0;
}

void room_audit_refused(struct room *room, const struct member *member, const char *what, const struct problem *problem)
{
    if (problem->type != PROBLEM_FORBIDDEN && problem->type != PROBLEM_NOT_PRESENTER)
        return;
    const struct audit_act row = {
        .by = member, .action = "refused", .detail = cJSON_CreateObject(), .is_refused = true, .before = -1, .after = -1
    };
    cJSON_AddStringToObject(row.detail, "what", what);
    cJSON_AddStringToObject(row.detail, "why", problem->detail);
    audit_tell(room, &row);
}

/* Messages to a newcomer after welcome, in this order. */
static void (*const shown_to_newcomer[])(struct room *room, struct member *member) = {
    acceptances_tell, send_renderer_state, control_send,   saved_show,  files_show, members_show, name_show,
    pointers_show,    look_show,           recording_show, replay_show, walls_show, meeting_show,
};

static void greet(struct room *room, void *connection, const struct message_hello *hello)
{
    struct member *member = member_hello(room, connection, hello);
    for (size_t i = 0; member && i < sizeof shown_to_newcomer / sizeof shown_to_newcomer[0]; i++)
        shown_to_newcomer[i](room, member);
}

/* Messages whose effect is always recorded: without place for that they are refused. */
static bool is_recorded(enum message_type type)
{
    return type == MESSAGE_PRESENT || type == MESSAGE_CONTROL_REQUEST || type == MESSAGE_CONTROL_GIVE ||
           type == MESSAGE_CONTROL_REFUSE || type == MESSAGE_CONTROL_TAKE || type == MESSAGE_CONTROL_LOCK ||
           type == MESSAGE_MEMBER_REMOVE;
}

/* Answers with the problem; type, view and input of the refused text are repeated as far as it can be parsed. False:
 * there was no memory for the answer, and the connection was closed. */
static bool refuse(struct room *room, void *connection, const char *text, size_t n, const struct problem *problem)
{
    const struct member *member = member_of_connection(room, connection);
    char to[41] = "";
    int64_t view = 0, input = 0;
    cJSON *json = n <= WIRE_MAX_CLIENT_BYTES ? json_read(text, n, NULL) : NULL;
    const char *type = json_text(json, "type");
    for (int i = 0; type && i < MESSAGE_N_TYPES; i++)
        if (message_descriptions[i].is_from_client && strcmp(message_descriptions[i].name, type) == 0)
            (void)snprintf(to, sizeof to, "%s", type);
    whole_number(json, "view", ROOM_MAX_VIEWS, &view);
    whole_number(json, "input", UINT32_MAX, &input);
    cJSON_Delete(json);
    room_audit_refused(room, member, to, problem);
    return send_problem(room, connection, to, view, input, problem);
}

/* ---- what follows ----------------------------------------------------------------------------------------------- */

/* Consequences of a change and of time, in this order: members and presenter, then what is shown to whom, then
 * pictures. Each does what is due and returns when it is due again; INT64_MAX: only another entry can make it due. */
static const struct {
    int64_t (*settle)(struct room *room);
    bool is_at_once; /* after each message; the others once for all messages that have come together */
} following[] = {
    { pointers_settle, false },      { look_settle, false },      { saved_settle, false },
    { replay_settle, false },        { displays_settle, false },  { members_settle_lost, true },
    { members_settle, false },       { control_settle, true },    { main_view_settle, true },
    { displays_follow, true },       { walls_follow, true },      { watches_follow, true },
    { streams_send_watches, false }, { watches_settle, false },   { members_settle_away, false },
    { streams_request_due, true },   { presenter_due_us, false }, { send_members_due, false },
    { recording_settle, false },     { audit_settle, false },
};

static int64_t settle(struct room *room, bool only_at_once)
{
    int64_t due_us = INT64_MAX;
    for (size_t i = 0; i < sizeof following / sizeof following[0]; i++) {
        const int64_t us = following[i].is_at_once || !only_at_once ? following[i].settle(room) : INT64_MAX;
        due_us = us < due_us ? us : due_us;
    }
    return due_us;
}

void room_enter(struct room *room, int64_t now_us)
{
    room->now_us = now_us;
}

void room_leave(struct room *room)
{
    room->due_us = settle(room, false);
}

int64_t room_settle(struct room *room, int64_t now_us)
{
    room_enter(room, now_us);
    room_leave(room);
    return room->due_us;
}

int64_t room_due_us(const struct room *room)
{
    return room->due_us;
}

/* After an acknowledgement, which lets the next picture be requested, or one be sent that may be late: no more. There
 * is one for each frame and member. */
static int64_t settle_shown(struct room *room, struct member *member)
{
    stream_send_watch(room, member);
    const int64_t watch_us = watch_settle(room, member), request_us = streams_request_due(room),
                  late_us = room->now_us + LAG_AFTER_US, next_us = watch_us < late_us ? watch_us : late_us;
    return request_us < next_us ? request_us : next_us;
}

bool room_apply(struct room *room, struct member *member, const struct message *message, struct problem *problem)
{
    if (!member_check(member, message_descriptions[message->type].right, problem) ||
        !replay_allows(room, message->type, problem) || (is_recorded(message->type) && !audit_has_place(room, problem)))
        return false;
    for (size_t i = 0; i < sizeof handlers / sizeof handlers[0]; i++)
        if (handlers[i].type == message->type)
            return handlers[i].handle(room, member, message, problem);
    return true;
}

/* Answers a first message that is no hello. */
static void refuse_first(struct room *room, void *connection, const char *text, size_t n, const struct problem *problem)
{
    if (!member_refuse_stranger(room, connection) && refuse(room, connection, text, n, problem))
        send_bye(room, connection, -1, hello_first);
}

/* Applies the message of a text. Returns true for an acknowledgement that was taken. */
static bool take_text(struct room *room, struct member *member, void *connection, const char *text, size_t n)
{
    struct message message;
    struct problem problem = { 0 };
    if (!message_read(text, n, true, &message, &problem)) {
        if (member)
            (void)refuse(room, connection, text, n, &problem);
        else
            refuse_first(room, connection, text, n, &problem);
        return false;
    }
    if (!member && message.type == MESSAGE_HELLO) {
        greet(room, connection, &message.hello);
    } else if (!member) {
        problem_set(&problem, PROBLEM_VALIDATION, "/type", "required", "%s", hello_first);
        refuse_first(room, connection, text, n, &problem);
    } else if (!room_apply(room, member, &message, &problem)) {
        (void)refuse(room, connection, text, n, &problem);
    }
    const bool is_shown = message.type == MESSAGE_FRAME_SHOWN && problem.type == PROBLEM_NONE;
    message_finish(&message);
    return is_shown && member;
}

int64_t room_text_came(struct room *room, void *connection, const char *text, size_t n, int64_t now_us)
{
    room_enter(room, now_us);
    struct member *member = member_who_speaks(room, connection);
    const bool is_shown = take_text(room, member, connection, text, n) && !room->members.has_lost;
    const int64_t due_us = is_shown ? settle_shown(room, member) : now_us;
    if (!is_shown)
        (void)settle(room, true);
    room->due_us = due_us < room->due_us ? due_us : room->due_us;
    return due_us;
}

void room_connection_lost(struct room *room, void *connection, int64_t heard_us, int64_t now_us)
{
    room_enter(room, now_us);
    struct member *member = member_of_connection(room, connection);
    if (member)
        member_disconnected(room, member, heard_us < now_us ? heard_us : now_us);
    room_leave(room);
}

void room_connection_closed(struct room *room, void *connection, int64_t now_us)
{
    room_connection_lost(room, connection, now_us, now_us);
}

void room_sign_in_over(struct room *room, void *connection, int64_t now_us)
{
    room_enter(room, now_us);
    struct member *member = member_of_connection(room, connection);
    send_bye_for(room, connection, "sign-in", -1, "your sign-in has ended");
    if (member)
        member_disconnected(room, member, now_us);
    room_leave(room);
}

/* The member has the role of a link, or of whoever reaches the server, on which grants have no bearing. */
static bool is_without_grants(const struct room *room, const struct member *member)
{
    return !member->connection || !member->user[0] || member->link[0] ||
           who_is_machine(who_connects(room, member->connection));
}

void room_grants_changed(struct room *room, int64_t now_us)
{
    room_enter(room, now_us);
    for (int i = 0; i < room->members.n; i++) {
        struct member *member = room->members.list[i];
        enum wire_member_role role;
        if (is_without_grants(room, member))
            continue;
        const bool has_role = admission_role(room, who_connects(room, member->connection), &role);
        if (has_role && role == member->role)
            continue;
        send_bye_for(room, member->connection, "", has_role ? 0 : -1,
                     has_role ? "you have another role here now" : "you may not be in this room any more");
        member_disconnected(room, member, now_us);
    }
    room_leave(room);
}

bool room_has_member(const struct room *room, void *connection)
{
    return member_of_connection(room, connection) != NULL;
}

bool room_is_followed(const struct room *room, void *connection)
{
    const struct member *member = member_of_connection(room, connection);
    return member && room->presenter && room->presenter != member && room->presenter->connection &&
           member_follows(room, member);
}

/* The clock of a replay, and what it has read. */
#include "server/room/log/replay.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/room/items/item_list.h"
#include "server/room/log/meeting_log.h"
#include "server/room/log/recording.h"
#include "server/room/log/replay_shown.h"
#include "server/room/log/room_recordings.h"
#include "server/room/out/send.h"
#include "server/room/people/presenter.h"
#include "server/room/state/event.h"
#include "server/room/streams/stream.h"
#include "server/wire/json_merge.h"

struct replay {
    char of_room[64];
    struct room_recording facts;
    /* the clock */
    bool is_playing;
    double t_ms, rate, speed; /* t_ms: at since_us; speed: the room's, how often as fast all of it goes */
    int64_t since_us;
    enum wire_replay_state told;
    int64_t told_us, shown_us;
    /* what was read: events from a complete state at from_ms up to the next one at next_ms */
    cJSON *events;
    const cJSON *next; /* event that was not applied yet */
    int64_t from_ms, next_ms;
    bool is_reading, has_failed;
    int64_t asked_ms; /* the time that was asked for last */
    int64_t retry_us;
    int n_failed; /* in a row */
    /* the state at_ms, and what of it is shown */
    cJSON *state, *shown;
    int64_t at_ms;
    char plan_revision[65]; /* of the plan's files now; "": not known yet */
    bool plan_changed;
    cJSON *report;
};

bool room_replays(const struct room *room)
{
    return room->replay != NULL;
}

static double length_ms(const struct replay *replay)
{
    return (double)replay->facts.length_ms;
}

static double time_ms(const struct room *room)
{
    const struct replay *replay = room->replay;
    double t_ms = replay->t_ms;
    if (replay->is_playing)
        t_ms += (double)(room->now_us - replay->since_us) * replay->rate * replay->speed / 1000;
    return t_ms < length_ms(replay) ? t_ms : length_ms(replay);
}

/* The clock goes on from here. */
static void set_time(struct room *room, double t_ms, bool is_playing)
{
    struct replay *replay = room->replay;
    replay->t_ms = t_ms < length_ms(replay) ? t_ms : length_ms(replay);
    replay->since_us = room->now_us;
    replay->is_playing = is_playing;
}

/* ---- telling ---------------------------------------------------------------------------------------------------- */

static enum wire_replay_state state_of(const struct room *room)
{
    const struct replay *replay = room->replay;
    if (replay->has_failed)
        return WIRE_REPLAY_STATE_FAILED;
    if (!room->shared.scene || !replay->state)
        return WIRE_REPLAY_STATE_WAITING;
    if (replay->is_playing)
        return WIRE_REPLAY_STATE_PLAYING;
    return replay->t_ms < length_ms(replay) ? WIRE_REPLAY_STATE_PAUSED : WIRE_REPLAY_STATE_ENDED;
}

static void tell_time(struct room *room, struct member *only)
{
    struct replay *replay = room->replay;
    struct message message = { .type = MESSAGE_REPLAY_AT };
    message.replay_at.state = state_of(room);
    message.replay_at.t_ms = time_ms(room);
    message.replay_at.rate = replay->rate;
    if (only) {
        send_to_member(room, only, &message);
        return;
    }
    replay->told = message.replay_at.state;
    replay->told_us = room->now_us;
    send_to_all(room, &message);
}

/* only NULL: to all */
static void tell_what(struct room *room, struct member *only)
{
    const struct replay *replay = room->replay;
    struct message message = { .type = MESSAGE_REPLAY };
    struct message_replay *said = &message.replay;
    (void)snprintf(said->room, sizeof said->room, "%s", replay->of_room);
    (void)snprintf(said->recording, sizeof said->recording, "%s", replay->facts.id);
    (void)snprintf(said->by_name, sizeof said->by_name, "%s", replay->facts.by_name);
    said->started_ms = (double)replay->facts.started_ms;
    said->length_ms = length_ms(replay);
    said->plan_changed = replay->plan_changed;
    said->marks = replay->facts.marks ? cJSON_Duplicate(replay->facts.marks, true) : cJSON_CreateArray();
    said->report = replay->report ? cJSON_Duplicate(replay->report, true) : cJSON_CreateArray();
    if (only)
        send_to_member(room, only, &message);
    else
        send_to_all(room, &message);
    message_finish(&message);
}

void replay_show(struct room *room, struct member *member)
{
    const struct replay *replay = room->replay;
    if (!replay)
        return;
    tell_what(room, member);
    if (replay->shown) {
        shown_members(room, member, replay->shown);
        shown_pointers_to(room, member, replay->shown);
    }
    tell_time(room, member);
}

/* ---- showing ---------------------------------------------------------------------------------------------------- */

/* True if the part is another one than what is shown. */
static bool differs(const struct replay *replay, enum log_part part)
{
    return !replay->shown || !json_equal(log_state_part(replay->shown, part), log_state_part(replay->state, part));
}

static void show(struct room *room)
{
    struct replay *replay = room->replay;
    cJSON *shown = cJSON_Duplicate(replay->state, true);
    if (!shown)
        return; /* no memory: at the next time */
    const int n_before = cJSON_GetArraySize(replay->report);
    if (differs(replay, LOG_SCENE) && !shown_scene(room, shown, replay->plan_changed ? &replay->report : NULL)) {
        cJSON_Delete(shown);
        return;
    }
    if (replay->plan_changed && (n_before != cJSON_GetArraySize(replay->report) || !replay->shown))
        tell_what(room, NULL);
    if (differs(replay, LOG_VIEWS))
        shown_views(room, shown);
    if (differs(replay, LOG_ITEMS))
        shown_items(room, shown);
    if (differs(replay, LOG_MEMBERS))
        shown_members(room, NULL, shown);
    shown_pointers(room, replay->shown, shown);
    cJSON_Delete(replay->shown);
    replay->shown = shown;
    replay->shown_us = room->now_us;
}

static int64_t least(int64_t a, int64_t b)
{
    return a < b ? a : b;
}

/* ---- reading ---------------------------------------------------------------------------------------------------- */

static void forget_part(struct replay *replay)
{
    cJSON_Delete(replay->events);
    replay->events = NULL;
    replay->next = NULL;
}

static void fail(struct room *room, const struct problem *problem)
{
    struct replay *replay = room->replay;
    log_error("room %s: the recording cannot be read: %s", room->id, problem->detail);
    replay->has_failed = true;
    replay->is_reading = false;
    const int64_t pause_ms = (int64_t)REPLAY_RETRY_MS << (replay->n_failed < 5 ? replay->n_failed : 5);
    replay->retry_us = room->now_us + pause_ms * 1000;
    replay->n_failed++;
    set_time(room, time_ms(room), replay->is_playing);
    forget_part(replay);
    tell_time(room, NULL);
}

static bool has_part_for(const struct replay *replay, int64_t t_ms)
{
    return replay->events && t_ms >= replay->from_ms && t_ms < replay->next_ms;
}

/* Brings the state to this time. False: the part of the log is not there; it is being read. */
static bool reach(struct room *room, int64_t t_ms)
{
    struct replay *replay = room->replay;
    struct problem problem = { 0 };
    if (!has_part_for(replay, t_ms)) {
        if (!replay->is_reading && room->now_us >= replay->retry_us && room->callbacks.replay_read) {
            replay->is_reading = true;
            replay->asked_ms = t_ms;
            if (!room->callbacks.replay_read(room->callbacks.context, room, replay->of_room, replay->facts.id, t_ms,
                                             &problem))
                fail(room, &problem);
        }
        return false;
    }
    if (t_ms < replay->at_ms)
        replay->next = replay->events->child; /* a complete state */
    const cJSON *first = replay->events->child;
    for (; replay->next && (log_event_ms(replay->next) <= t_ms || replay->next == first);
         replay->next = replay->next->next)
        if (!meeting_log_apply(&replay->state, replay->next, &problem)) {
            fail(room, &problem);
            return false;
        }
    replay->at_ms = t_ms;
    return true;
}

/* A part of the log begins with a complete state, and holds the time it was asked for: what begins later is the first
 * that there is. False with problem: it would be read for ever, or be applied to another state. */
static bool fits(const struct replay *replay, const cJSON *events, int64_t next_ms, struct problem *problem)
{
    if (!log_event_is_state(events->child))
        return problem_set(problem, PROBLEM_STORAGE, "", "", "it does not begin with a state");
    if (next_ms <= replay->asked_ms || next_ms <= log_event_ms(events->child))
        return problem_set(problem, PROBLEM_STORAGE, "", "", "its parts are not in order");
    return true;
}

void replay_came(struct room *room, const char *const *texts, size_t n, int64_t next_ms, const struct problem *problem)
{
    struct replay *replay = room->replay;
    struct problem found = problem ? *problem : (struct problem){ 0 };
    if (!replay)
        return;
    replay->is_reading = false;
    cJSON *events = meeting_log_read_all(texts, n, &found);
    if (!events || !fits(replay, events, next_ms, &found)) {
        cJSON_Delete(events);
        fail(room, &found);
        return;
    }
    forget_part(replay);
    replay->has_failed = false;
    replay->events = events;
    replay->next = events->child;
    replay->from_ms = least(log_event_ms(events->child), replay->asked_ms);
    replay->next_ms = next_ms;
    replay->at_ms = replay->from_ms;
}

/* ---- time ------------------------------------------------------------------------------------------------------- */

/* When the clock has come to this time of the recording. */
static int64_t due_us(const struct replay *replay, double t_ms)
{
    const double wait_us = (t_ms - replay->t_ms) * 1000 / (replay->rate * replay->speed);
    return replay->since_us + (wait_us > 0 ? (int64_t)wait_us + 1 : 0);
}

int64_t replay_settle(struct room *room)
{
    struct replay *replay = room->replay;
    if (!replay)
        return INT64_MAX;
    if (!room->shared.scene) {
        set_time(room, replay->t_ms, replay->is_playing); /* the clock waits for the plan */
        return INT64_MAX;
    }
    if (!replay->state && replay->is_playing)
        set_time(room, replay->t_ms, true); /* and for the disk */
    const double t_ms = time_ms(room);
    if (replay->is_playing && !(t_ms < length_ms(replay)))
        set_time(room, length_ms(replay), false);
    const bool is_there = reach(room, (int64_t)t_ms);
    if (is_there && room->now_us >= replay->shown_us + REPLAY_EVERY_MS * INT64_C(1000))
        show(room);
    if (state_of(room) != replay->told ||
        (replay->is_playing && room->now_us >= replay->told_us + REPLAY_TELL_MS * INT64_C(1000)))
        tell_time(room, NULL);
    if (!is_there)
        return replay->has_failed && !replay->is_reading ? replay->retry_us : INT64_MAX; /* room_replay_came follows */
    int64_t again_us = INT64_MAX;
    if (replay->shown_us < room->now_us && !json_equal(replay->shown, replay->state))
        again_us = replay->shown_us + REPLAY_EVERY_MS * INT64_C(1000);
    if (!replay->is_playing)
        return again_us;
    int64_t next_us = due_us(replay, replay->next                  ? (double)log_event_ms(replay->next)
                                     : replay->next_ms < INT64_MAX ? (double)replay->next_ms
                                                                   : length_ms(replay));
    if (next_us < replay->shown_us + REPLAY_EVERY_MS * INT64_C(1000))
        next_us = replay->shown_us + REPLAY_EVERY_MS * INT64_C(1000);
    again_us = least(again_us, next_us);
    again_us = least(again_us, due_us(replay, length_ms(replay)));
    return least(again_us, replay->told_us + REPLAY_TELL_MS * INT64_C(1000));
}

/* ---- messages --------------------------------------------------------------------------------------------------- */

static bool refuse_ordinary(struct problem *problem)
{
    return problem_set(problem, PROBLEM_CONFLICT, "", "", "this room plays no recording");
}

/* After a change of the clock by a member. */
static bool moved(struct room *room)
{
    room->replay->shown_us = 0; /* at once */
    (void)replay_settle(room);
    tell_time(room, NULL);
    return true;
}

bool replay_play(struct room *room, struct member *member, const struct message *message, struct problem *problem)
{
    (void)member;
    if (!room->replay)
        return refuse_ordinary(problem);
    const double t_ms = time_ms(room);
    set_time(room, t_ms < length_ms(room->replay) ? t_ms : 0, true);
    room->replay->rate = message->replay_play.rate;
    return moved(room);
}

bool replay_pause(struct room *room, struct member *member, const struct message *message, struct problem *problem)
{
    (void)member;
    (void)message;
    if (!room->replay)
        return refuse_ordinary(problem);
    set_time(room, time_ms(room), false);
    return moved(room);
}

bool replay_seek(struct room *room, struct member *member, const struct message *message, struct problem *problem)
{
    (void)member;
    if (!room->replay)
        return refuse_ordinary(problem);
    set_time(room, message->replay_seek.t_ms, room->replay->is_playing);
    room->replay->n_failed = 0; /* what is there may be readable */
    room->replay->retry_us = 0;
    return moved(room);
}

bool replay_leave(struct room *room, struct member *member, const struct message *message, struct problem *problem)
{
    struct replay *replay = room->replay;
    if (!replay)
        return refuse_ordinary(problem);
    if (!room->shared.scene)
        return problem_set(problem, PROBLEM_BUSY, "", "", "the plan is not loaded yet");
    room->replay = NULL;
    if (!presenter_take_over(room, member, (uint32_t)message->replay_leave.input, problem)) {
        room->replay = replay;
        return false;
    }
    shown_pointers(room, replay->shown, NULL);
    shown_members(room, NULL, NULL);
    const struct message left = { .type = MESSAGE_REPLAY_AT,
                                  .replay_at = {
                                      .state = WIRE_REPLAY_STATE_LEFT, .t_ms = replay->t_ms, .rate = replay->rate } };
    send_to_all(room, &left);
    room->replay = replay;
    replay_free(room);
    room->shared.is_changed = true;
    room_event(room, ROOM_ALL_PARTS, NULL);
    for (const struct item *item = room->items->first; item && room->callbacks.item_changed; item = item->next)
        room->callbacks.item_changed(room->callbacks.context, room, item->row, item->id);
    return true;
}

bool replay_allows(const struct room *room, enum message_type type, struct problem *problem)
{
    static const enum message_type refused[] = {
        MESSAGE_SCENE_PATCH,    MESSAGE_PRESENT,        MESSAGE_SHOW_EVERYONE, MESSAGE_CONTROL_REQUEST,
        MESSAGE_CONTROL_GIVE,   MESSAGE_CONTROL_REFUSE, MESSAGE_CONTROL_TAKE,  MESSAGE_CONTROL_LOCK,
        MESSAGE_ITEM_PUT,       MESSAGE_ITEM_DELETE,    MESSAGE_ITEM_HIDE,     MESSAGE_RECORDING_START,
        MESSAGE_RECORDING_STOP,
    };
    for (size_t i = 0; room->replay && i < sizeof refused / sizeof refused[0]; i++)
        if (refused[i] == type)
            return problem_set(problem, PROBLEM_CONFLICT, "", "",
                               "this room plays a recording: nothing is changed in it before the replay is left");
    return true;
}

/* ---- beginning and end ------------------------------------------------------------------------------------------ */

/* The document says little of the values in the files, the revision nothing of how they are read. */
static bool has_other_plan(const struct room *room)
{
    const struct replay *replay = room->replay;
    const char *then = replay->facts.plan_revision, *now = replay->plan_revision;
    char sum[20];
    return !recording_plan_sum(room, sum) || strcmp(sum, replay->facts.plan_sum) != 0 ||
           (then[0] && now[0] && strcmp(then, now) != 0);
}

void replay_revision_came(struct room *room, const char *revision)
{
    struct replay *replay = room->replay;
    if (!replay)
        return;
    (void)snprintf(replay->plan_revision, sizeof replay->plan_revision, "%s", revision);
    if (room->shared.scene && has_other_plan(room) != replay->plan_changed)
        replay_plan_ready(room);
}

void replay_plan_ready(struct room *room)
{
    struct replay *replay = room->replay;
    if (!replay)
        return;
    replay->plan_changed = has_other_plan(room);
    cJSON_Delete(replay->report);
    replay->report = NULL;
    cJSON_Delete(replay->shown); /* all of it is shown anew */
    replay->shown = NULL;
    replay->shown_us = 0;
    tell_what(room, NULL);
    (void)replay_settle(room);
}

void replay_begin(struct room *room, const char *of_room, uint32_t n_named, const struct room_recording *recording)
{
    struct replay *replay = mem_new(sizeof *replay);
    *replay = (struct replay){
        .facts = *recording, .rate = 1, .speed = room->recordings->speed, .told = WIRE_REPLAY_STATE_WAITING
    };
    (void)snprintf(replay->of_room, sizeof replay->of_room, "%s", of_room);
    replay->facts.marks = recording->marks ? cJSON_Duplicate(recording->marks, true) : NULL;
    room->members.n_named = n_named;
    room->replay = replay;
    if (room->shared.scene)
        replay_plan_ready(room);
}

void replay_free(struct room *room)
{
    struct replay *replay = room->replay;
    if (!replay)
        return;
    room_recording_finish(&replay->facts);
    forget_part(replay);
    cJSON_Delete(replay->state);
    cJSON_Delete(replay->shown);
    cJSON_Delete(replay->report);
    free(replay);
    room->replay = NULL;
}

/* Writes the meeting log of a room. */
#include "server/room/log/recording.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/room/items/item_list.h"
#include "server/room/log/meeting_log.h"
#include "server/room/log/recorded_parts.h"
#include "server/room/log/room_recordings.h"
#include "server/room/out/audit.h"
#include "server/room/out/send.h"
#include "server/room/state/event.h"
#include "server/room/state/member_list.h"
#include "server/room/state/roles.h"
#include "server/wire/json.h"
#include "server/wire/random.h"

static const int64_t every_us = RECORDING_EVERY_MS * INT64_C(1000), batch_us = RECORDING_BATCH_MS * INT64_C(1000),
                     empty_us = ROOM_RECORDING_EMPTY_S * INT64_C(1000000);

struct recorder {
    struct meeting_log *log;
    struct room_recording *facts;
    int64_t start_us, sampled_us, written_us, empty_since_us; /* empty_since_us 0: somebody is there */
    bool has_events;                                          /* perhaps; since the last batch */
    bool is_unsure;                                           /* there was no memory to look at what has changed */
    char presenter[64];
};

void recordings_init(struct room *room, double speed)
{
    room->recordings = mem_new(sizeof *room->recordings);
    room->recordings->speed = speed;
}

/* ---- facts ------------------------------------------------------------------------------------------------------ */

const struct room_recording *room_recording(const struct room *room, const char *id)
{
    for (int i = 0; i < room->recordings->n; i++)
        if (strcmp(room->recordings->list[i].id, id) == 0)
            return &room->recordings->list[i];
    return NULL;
}

void room_recording_finish(struct room_recording *recording)
{
    cJSON_Delete(recording->marks);
    recording->marks = NULL;
}

static int64_t recorded_ms(const struct room *room, const struct recorder *recorder)
{
    return (int64_t)((double)(room->now_us - recorder->start_us) * room->recordings->speed / 1000);
}

cJSON *recordings_list(const struct room *room)
{
    cJSON *list = cJSON_CreateArray();
    for (int i = 0; i < room->recordings->n; i++) {
        const struct room_recording *facts = &room->recordings->list[i];
        const bool runs = room->recorder && room->recorder->facts == facts;
        cJSON *row = cJSON_CreateObject();
        cJSON_AddStringToObject(row, "id", facts->id);
        cJSON_AddStringToObject(row, "state", wire_recording_state_words.words[facts->state]);
        cJSON_AddNumberToObject(row, "started_ms", (double)facts->started_ms);
        cJSON_AddNumberToObject(row, "length_ms",
                                (double)(runs ? recorded_ms(room, room->recorder) : facts->length_ms));
        cJSON_AddStringToObject(row, "by", facts->by);
        cJSON_AddStringToObject(row, "by_name", facts->by_name);
        cJSON_AddNumberToObject(row, "n_events", facts->n_events);
        cJSON_AddNumberToObject(row, "n_bytes", (double)facts->n_bytes);
        json_add(row, "marks", facts->marks ? cJSON_Duplicate(facts->marks, true) : cJSON_CreateArray());
        json_append(list, row);
    }
    return list;
}

static void fill_in(const struct room *room, const struct room_recording *facts, struct message *message)
{
    *message = (struct message){ .type = MESSAGE_RECORDING };
    struct message_recording *said = &message->recording;
    (void)snprintf(said->id, sizeof said->id, "%s", facts->id);
    (void)snprintf(said->by, sizeof said->by, "%s", facts->by);
    (void)snprintf(said->by_name, sizeof said->by_name, "%s", facts->by_name);
    said->state = facts->state;
    said->started_ms = (double)facts->started_ms;
    said->length_ms = (double)(room->recorder && room->recorder->facts == facts ? recorded_ms(room, room->recorder)
                                                                                : facts->length_ms);
}

static void tell(struct room *room, const struct room_recording *facts)
{
    struct message message;
    fill_in(room, facts, &message);
    send_to_all(room, &message);
}

void recording_show(struct room *room, struct member *member)
{
    struct message message;
    if (!room->recorder)
        return;
    fill_in(room, room->recorder->facts, &message);
    send_to_member(room, member, &message);
}

bool recording_plan_sum(const struct room *room, char digits[20])
{
    (void)json_no_memory(NULL, "what came before");
    cJSON *plan = room->shared.plan ? cJSON_Duplicate(room->shared.plan, true) : NULL;
    cJSON_DeleteItemFromObjectCaseSensitive(plan, "load_ms"); /* measured: another one each time */
    char *text = plan ? json_print(plan) : NULL;
    cJSON_Delete(plan);
    uint64_t sum = UINT64_C(0xcbf29ce484222325); /* FNV-1a, 64 bits */
    for (const char *at = text; at && *at; at++)
        sum = (sum ^ (uint8_t)*at) * UINT64_C(0x100000001b3);
    (void)snprintf(digits, 20, "%016llx", (unsigned long long)sum);
    const bool ok = text != NULL;
    free(text);
    return ok;
}

bool room_plan_differs(const struct room *room, const struct room_recording *recording)
{
    const char *then = recording->plan_revision, *now = room->files.revision;
    char sum[20];
    return !recording_plan_sum(room, sum) || strcmp(sum, recording->plan_sum) != 0 ||
           (then[0] && now[0] && strcmp(then, now) != 0);
}

bool recording_wants_revision(const struct room *room)
{
    return room->recorder && !room->recorder->facts->plan_revision[0];
}

void recording_revision_came(struct room *room, const char *revision)
{
    struct room_recording *facts = room->recorder ? room->recorder->facts : NULL;
    if (facts && !facts->plan_revision[0]) /* kept with the next batch, or the end */
        (void)snprintf(facts->plan_revision, sizeof facts->plan_revision, "%s", revision);
}

/* ---- what has changed ------------------------------------------------------------------------------------------- */

static void mark(struct recorder *recorder, int64_t t_ms, const char *kind, const char *name)
{
    if (!recorder->facts->marks)
        recorder->facts->marks = cJSON_CreateArray();
    if (cJSON_GetArraySize(recorder->facts->marks) >= ROOM_MAX_MARKS)
        return;
    cJSON *entry = cJSON_CreateArray();
    json_append(entry, cJSON_CreateNumber((double)t_ms));
    json_append(entry, cJSON_CreateString(kind));
    json_append(entry, cJSON_CreateString(name));
    json_append(recorder->facts->marks, entry);
}

static void mark_presenter(const struct room *room, struct recorder *recorder, int64_t t_ms)
{
    const char *id = room->presenter ? room->presenter->id : "";
    if (strcmp(id, recorder->presenter) == 0)
        return;
    (void)snprintf(recorder->presenter, sizeof recorder->presenter, "%s", id);
    mark(recorder, t_ms, "presenter", room->presenter ? room->presenter->name : "");
}

static void put_item(struct room *room, struct recorder *recorder, int64_t t_ms, const char *id)
{
    const struct item *item = items_find(room, id);
    const cJSON *before =
        cJSON_GetObjectItemCaseSensitive(log_state_part(meeting_log_state(recorder->log), LOG_ITEMS), id);
    if (item && !before && item->kind == WIRE_ITEM_KIND_NOTE && !item->parent[0])
        mark(recorder, t_ms, "note", item->author_name);
    meeting_log_put(recorder->log, t_ms, LOG_ITEMS, id, item ? json_read(item->row, strlen(item->row), NULL) : NULL);
}

static bool is_dirty(const struct room *room)
{
    return events_unrecorded(room)->parts || events_unrecorded(room)->n_items;
}

static void sample(struct room *room)
{
    struct recorder *recorder = room->recorder;
    struct meeting_log *log = recorder->log;
    const int64_t t_ms = recorded_ms(room, recorder);
    const struct unrecorded *unrecorded = events_unrecorded(room);
    const unsigned dirty = unrecorded->parts;
    const size_t n_refused = mem_n_refused();
    if (dirty & ROOM_MEMBERS) {
        meeting_log_put_all(log, t_ms, LOG_MEMBERS, recorded_members(room));
        mark_presenter(room, recorder, t_ms);
    }
    if ((dirty & ROOM_SCENE) && room->shared.scene)
        meeting_log_put(log, t_ms, LOG_SCENE, "scene", recorded_scene(room));
    if (dirty & (ROOM_SCENE | ROOM_VIEWS))
        meeting_log_put_all(log, t_ms, LOG_VIEWS, recorded_views(room));
    if (dirty & ROOM_POINTERS)
        meeting_log_put_all(log, t_ms, LOG_POINTERS, recorded_pointers(room));
    if (dirty & ROOM_ITEMS)
        meeting_log_put_all(log, t_ms, LOG_ITEMS, recorded_items(room));
    for (size_t i = 0; i < unrecorded->n_items; i++)
        put_item(room, recorder, t_ms, unrecorded->items[i]);
    recorder->is_unsure = mem_n_refused() != n_refused;
    if (recorder->is_unsure) {
        log_error("room %s: a part of a recording is lost: no memory", room->id);
        meeting_log_restart(log);
    }
    unrecorded_reset(room, recorder->is_unsure ? ROOM_ALL_RECORDED : 0);
    recorder->sampled_us = room->now_us;
    recorder->has_events = !recorder->is_unsure;
}

/* ---- batches ---------------------------------------------------------------------------------------------------- */

static void audit(struct room *room, const struct room_recording *facts, const struct member *by)
{
    const char *state = wire_recording_state_words.words[facts->state];
    const struct audit_act act = {
        .by = by, .action = "recording", .detail = cJSON_CreateObject(), .before = -1, .after = -1
    };
    cJSON_AddStringToObject(act.detail, "id", facts->id);
    cJSON_AddStringToObject(act.detail, "state", state);
    audit_tell(room, &act);
}

/* by: who ended it; NULL: nobody did. */
static void end(struct room *room, enum wire_recording_state state, const struct member *by)
{
    struct recorder *recorder = room->recorder;
    struct room_recording *facts = recorder->facts;
    facts->state = state;
    room->recorder = NULL;
    meeting_log_destroy(recorder->log);
    free(recorder);
    if (room->callbacks.recorded)
        room->callbacks.recorded(room->callbacks.context, room, facts, NULL);
    audit(room, facts, by);
    tell(room, facts);
}

/* Hands over what was logged since the last batch. */
static void write_batch(struct room *room)
{
    struct recorder *recorder = room->recorder;
    struct room_recording *facts = recorder->facts;
    struct log_batch batch = { 0 };
    const int64_t t_ms = recorded_ms(room, recorder);
    recorder->has_events = false;
    recorder->written_us = room->now_us;
    if (recorder->is_unsure || !meeting_log_take(recorder->log, t_ms, &batch)) {
        if (batch.n_events) /* they are lost */
            unrecorded_reset(room, ROOM_ALL_RECORDED);
        return;
    }
    const size_t n = strlen(batch.text);
    if (facts->n_bytes + n > ROOM_MAX_RECORDING_BYTES || facts->n_events + batch.n_events > ROOM_MAX_RECORDING_EVENTS ||
        t_ms > ROOM_MAX_RECORDING_S * INT64_C(1000)) {
        free(batch.text);
        end(room, WIRE_RECORDING_STATE_FULL, NULL);
        return;
    }
    facts->length_ms = t_ms;
    facts->n_bytes += n;
    facts->n_events += batch.n_events;
    facts->n_batches++;
    room->callbacks.recorded(room->callbacks.context, room, facts, &batch);
}

/* Writes all that is not written yet. False: it was full, and has ended. */
static bool write_all(struct room *room)
{
    if (is_dirty(room))
        sample(room);
    write_batch(room);
    return room->recorder != NULL;
}

int64_t recording_settle(struct room *room)
{
    struct recorder *recorder = room->recorder;
    if (!recorder)
        return INT64_MAX;
    if (room_n_connected(room))
        recorder->empty_since_us = 0;
    else if (!recorder->empty_since_us)
        recorder->empty_since_us = room->now_us;
    if (recorder->empty_since_us && room->now_us >= recorder->empty_since_us + empty_us) {
        if (write_all(room))
            end(room, WIRE_RECORDING_STATE_EMPTY, NULL);
        return INT64_MAX;
    }
    if (is_dirty(room) && room->now_us >= recorder->sampled_us + every_us)
        sample(room);
    if (recorder->has_events && room->now_us >= recorder->written_us + batch_us) {
        write_batch(room);
        if (!room->recorder)
            return INT64_MAX;
    }
    int64_t due_us = recorder->empty_since_us ? recorder->empty_since_us + empty_us : INT64_MAX;
    if (is_dirty(room) && recorder->sampled_us + every_us < due_us)
        due_us = recorder->sampled_us + every_us;
    if (recorder->has_events && recorder->written_us + batch_us < due_us)
        due_us = recorder->written_us + batch_us;
    return due_us;
}

/* ---- beginning and end ------------------------------------------------------------------------------------------ */

static void make_id(const struct room *room, char id[32])
{
    enum { ID_BYTES = 5 };
    do {
        char digits[2 * ID_BYTES + 1];
        random_hex(digits, ID_BYTES);
        (void)snprintf(id, 32, "rec-%s", digits);
    } while (room_recording(room, id));
}

static bool may_start(const struct room *room, const struct member *member, struct problem *problem)
{
    if (!member_presents(room, member))
        return refuse_not_presenter(room, problem, "record the meeting");
    if (!room->callbacks.recorded)
        return problem_set(problem, PROBLEM_STORAGE, "", "",
                           "this server keeps no rooms (--data is not given), so there is no place for a recording");
    if (room->recorder)
        return problem_set(problem, PROBLEM_CONFLICT, "", "", "the meeting is being recorded already");
    if (!room->shared.scene) {
        problem_set(problem, PROBLEM_BUSY, "", "", "the plan is not loaded yet");
        if (problem)
            problem->retry_after_ms = 500;
        return false;
    }
    if (room->recordings->n == ROOM_MAX_RECORDINGS)
        return problem_set(problem, PROBLEM_LIMIT, "", "",
                           "the room has %d recordings, and more are not allowed: delete some", room->recordings->n);
    return true;
}

bool recording_start(struct room *room, struct member *member, const struct message *message, struct problem *problem)
{
    struct timespec now;
    (void)message;
    if (!may_start(room, member, problem))
        return false;
    struct meeting_log *log = meeting_log_create();
    if (!log)
        return json_no_memory(problem, "a recording");
    struct room_recording *facts = &room->recordings->list[room->recordings->n];
    *facts = (struct room_recording){ .state = WIRE_RECORDING_STATE_RUNNING };
    if (!recording_plan_sum(room, facts->plan_sum)) {
        meeting_log_destroy(log);
        return json_no_memory(problem, "a recording");
    }
    make_id(room, facts->id);
    room->recordings->n++;
    (void)snprintf(facts->by, sizeof facts->by, "%s", member->id);
    (void)snprintf(facts->by_name, sizeof facts->by_name, "%s", member->name);
    (void)clock_gettime(CLOCK_REALTIME, &now); /* only to be displayed */
    facts->started_ms = now.tv_sec * INT64_C(1000) + now.tv_nsec / 1000000;
    room->recorder = mem_new(sizeof *room->recorder);
    *room->recorder =
        (struct recorder){ .log = log, .facts = facts, .start_us = room->now_us, .written_us = room->now_us };
    unrecorded_reset(room, ROOM_ALL_RECORDED);
    (void)snprintf(room->recorder->presenter, sizeof room->recorder->presenter, "%s", member->id);
    audit(room, facts, member);
    sample(room);
    write_batch(room);
    if (room->recorder)
        tell(room, facts);
    return true;
}

bool recording_stop(struct room *room, struct member *member, const struct message *message, struct problem *problem)
{
    (void)message;
    if (!room->recorder)
        return problem_set(problem, PROBLEM_CONFLICT, "", "", "the meeting is not being recorded");
    if (!member_presents(room, member) && role_rank(member->role) < role_rank(WIRE_MEMBER_ROLE_PRESENTER) &&
        strcmp(room->recorder->facts->by, member->id) != 0)
        return refuse_not_presenter(room, problem, "end a recording that another member began");
    if (write_all(room)) {
        room->recorder->facts->length_ms = recorded_ms(room, room->recorder);
        end(room, WIRE_RECORDING_STATE_STOPPED, member);
    }
    return true;
}

bool recording_delete(struct room *room, const char *id)
{
    int index = 0;
    while (index < room->recordings->n && strcmp(room->recordings->list[index].id, id) != 0)
        index++;
    if (index == room->recordings->n)
        return false;
    struct room_recording *facts = &room->recordings->list[index];
    if (room->recorder && room->recorder->facts == facts)
        end(room, WIRE_RECORDING_STATE_STOPPED, NULL);
    facts->state = WIRE_RECORDING_STATE_DELETED;
    tell(room, facts);
    if (room->callbacks.recording_deleted)
        room->callbacks.recording_deleted(room->callbacks.context, room, facts->id);
    room_recording_finish(facts);
    if (room->recorder && room->recorder->facts > facts)
        room->recorder->facts--;
    room->recordings->n--;
    memmove(facts, facts + 1, (size_t)(room->recordings->n - index) * sizeof *facts);
    return true;
}

void room_restore_recording(struct room *room, struct room_recording *recording)
{
    if (room->recordings->n == ROOM_MAX_RECORDINGS || !id_is_valid(recording->id) ||
        room_recording(room, recording->id)) {
        room_recording_finish(recording);
        return;
    }
    if (recording->state == WIRE_RECORDING_STATE_RUNNING)
        recording->state = WIRE_RECORDING_STATE_CUT;
    room->recordings->list[room->recordings->n++] = *recording;
    recording->marks = NULL;
}

void room_recording_restart(struct room *room)
{
    if (!room->recorder)
        return;
    meeting_log_restart(room->recorder->log);
    room->recorder->has_events = true;
}

void recording_cut(struct room *room)
{
    if (room->recorder && write_all(room))
        end(room, WIRE_RECORDING_STATE_CUT, NULL);
}

void recordings_finish(struct room *room)
{
    recording_cut(room);
    unrecorded_reset(room, 0);
    for (int i = 0; i < room->recordings->n; i++)
        room_recording_finish(&room->recordings->list[i]);
    free(room->recordings);
    room->recordings = NULL;
}

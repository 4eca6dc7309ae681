/* Facts of recordings as JSON, batches, and who waits for a part of one. */
#include "server/net/keep_recordings.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/net/bridge.h"
#include "server/net/net.h"
#include "server/net/schedule.h"
#include "server/room/log/meeting_log.h"
#include "server/wire/json.h"

/* ---- to the store ----------------------------------------------------------------------------------------------- */

/* The room's entry; NULL: it is being closed, or rooms are not kept. */
static struct net_room *find_entry(const struct net *net, const struct room *room)
{
    for (size_t i = 0; net->store && i < net->n_rooms; i++)
        if (net->rooms[i]->room == room)
            return net->rooms[i];
    return NULL;
}

static char *write_facts(const struct room_recording *facts)
{
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "state", wire_recording_state_words.words[facts->state]);
    cJSON_AddNumberToObject(json, "started_ms", (double)facts->started_ms);
    cJSON_AddNumberToObject(json, "length_ms", (double)facts->length_ms);
    cJSON_AddNumberToObject(json, "n_batches", facts->n_batches);
    cJSON_AddNumberToObject(json, "n_events", facts->n_events);
    cJSON_AddNumberToObject(json, "n_bytes", (double)facts->n_bytes);
    cJSON_AddStringToObject(json, "by", facts->by);
    cJSON_AddStringToObject(json, "by_name", facts->by_name);
    cJSON_AddStringToObject(json, "plan_mark", facts->plan_sum); /* its name in databases */
    cJSON_AddStringToObject(json, "plan_revision", facts->plan_revision);
    json_add(json, "marks", facts->marks ? cJSON_Duplicate(facts->marks, true) : cJSON_CreateArray());
    char *text = json_print(json);
    cJSON_Delete(json);
    return text;
}

/* The place for what is to be written of a recording; NULL: no memory. */
static struct store_recording *place_of(struct net_room *room, const char *id)
{
    for (size_t i = 0; i < room->keep.n_recordings; i++)
        if (strcmp(room->keep.recordings[i].id, id) == 0)
            return &room->keep.recordings[i];
    void *more = realloc(room->keep.recordings, (room->keep.n_recordings + 1) * sizeof room->keep.recordings[0]);
    if (!more)
        return NULL;
    room->keep.recordings = more;
    struct store_recording *recording = &room->keep.recordings[room->keep.n_recordings++];
    schedule_at(room->net, 0);
    *recording = (struct store_recording){ 0 };
    (void)snprintf(recording->id, sizeof recording->id, "%s", id);
    return recording;
}

/* Takes batch->text. */
static bool add_batch(struct store_recording *recording, uint32_t place, struct log_batch *batch)
{
    void *more = realloc(recording->batches, (recording->n_batches + 1) * sizeof recording->batches[0]);
    if (!more)
        return false;
    recording->batches = more;
    recording->batches[recording->n_batches++] =
        (struct store_batch){ .place = place, .t_ms = batch->t_ms, .is_state = batch->is_state, .text = batch->text };
    batch->text = NULL;
    return true;
}

void keep_recorded(void *context, struct room *room, const struct room_recording *facts, struct log_batch *batch)
{
    struct net_room *entry = find_entry(context, room);
    if (entry)
        bridge_tell_revision(entry);
    struct store_recording *recording = entry ? place_of(entry, facts->id) : NULL;
    char *text = recording ? write_facts(facts) : NULL;
    if (text) {
        free(recording->facts);
        recording->facts = text;
    }
    if (batch && (!text || !add_batch(recording, facts->n_batches - 1, batch))) {
        if (entry) {
            log_error("room %s: a part of a recording is lost: no memory", room_id(room));
            room_recording_restart(room); /* what follows is whole again */
        }
        free(batch->text);
    }
}

void keep_recording_deleted(void *context, struct room *room, const char *id)
{
    struct net_room *entry = find_entry(context, room);
    struct store_recording *recording = entry ? place_of(entry, id) : NULL;
    if (!recording)
        return;
    store_recording_finish(recording);
    (void)snprintf(recording->id, sizeof recording->id, "%s", id);
}

void keep_recordings_finish(struct net_room *room)
{
    for (size_t i = 0; i < room->keep.n_recordings; i++)
        store_recording_finish(&room->keep.recordings[i]);
    free(room->keep.recordings);
    room->keep.recordings = NULL;
    room->keep.n_recordings = 0;
}

/* ---- from the store --------------------------------------------------------------------------------------------- */

static double number_below(const cJSON *json, const char *name, double most)
{
    const double number = json_number(json, name, 0);
    return number >= 0 && number <= most ? number : 0;
}

/* [[t_ms, kind, name]], as pages are told. */
static bool are_marks(const cJSON *marks)
{
    const cJSON *mark;
    if (!cJSON_IsArray(marks) || cJSON_GetArraySize(marks) > ROOM_MAX_MARKS)
        return false;
    cJSON_ArrayForEach(mark, marks) if (!cJSON_IsArray(mark) || cJSON_GetArraySize(mark) != 3 ||
                                        !cJSON_IsNumber(cJSON_GetArrayItem(mark, 0)) ||
                                        !cJSON_IsString(cJSON_GetArrayItem(mark, 1)) ||
                                        !cJSON_IsString(cJSON_GetArrayItem(mark, 2))) return false;
    return true;
}

/* False: it is damaged. */
static bool read_facts(const char *text, struct room_recording *facts)
{
    cJSON *json = json_read(text, strlen(text), NULL), *marks;
    const char *state = json_text(json, "state");
    facts->state = WIRE_RECORDING_STATE_CUT;
    for (size_t i = 0; state && i < wire_recording_state_words.n; i++)
        if (strcmp(state, wire_recording_state_words.words[i]) == 0)
            facts->state = (enum wire_recording_state)i;
    facts->started_ms = (int64_t)number_below(json, "started_ms", 9007199254740991.0);
    facts->length_ms = (int64_t)number_below(json, "length_ms", LOG_MAX_T_MS);
    facts->n_batches = (uint32_t)number_below(json, "n_batches", ROOM_MAX_RECORDING_EVENTS);
    facts->n_events = (uint32_t)number_below(json, "n_events", ROOM_MAX_RECORDING_EVENTS);
    facts->n_bytes = (uint64_t)number_below(json, "n_bytes", ROOM_MAX_RECORDING_BYTES);
    json_put_text(facts->by, sizeof facts->by, json, "by");
    json_put_text(facts->by_name, sizeof facts->by_name, json, "by_name");
    json_put_text(facts->plan_sum, sizeof facts->plan_sum, json, "plan_mark");
    json_put_text(facts->plan_revision, sizeof facts->plan_revision, json, "plan_revision"); /* older ones have none */
    marks = cJSON_DetachItemFromObjectCaseSensitive(json, "marks");
    if (are_marks(marks))
        facts->marks = marks;
    else
        cJSON_Delete(marks);
    const bool ok = json != NULL;
    cJSON_Delete(json);
    return ok;
}

void keep_recordings_restore(struct room *room, const struct store_room *row)
{
    for (size_t i = 0; i < row->n_recordings; i++) {
        struct room_recording facts = { .id = "" };
        (void)snprintf(facts.id, sizeof facts.id, "%.31s", row->recordings[i].id);
        if (read_facts(row->recordings[i].facts, &facts))
            room_restore_recording(room, &facts);
        else
            log_error("room %s: a recording is not readable in the database and is left out", room_id(room));
    }
}

/* ---- parts ------------------------------------------------------------------------------------------------------ */

bool net_recording_read(struct net *net, const char *room, const char *recording, int64_t t_ms, net_part_read *done,
                        void *context, struct problem *problem)
{
    if (net->store && store_read_part(net->store, room, recording, t_ms, net->n_tickets + 1)) {
        struct part_reader *reader = mem_new(sizeof *reader);
        *reader =
            (struct part_reader){ .next = net->readers, .ticket = ++net->n_tickets, .done = done, .context = context };
        net->readers = reader;
        return true;
    }
    problem_set(problem, PROBLEM_BUSY, "", "", "the disk has too much to do to read the recording now");
    if (problem)
        problem->retry_after_ms = 1000;
    return false;
}

void keep_part_was_read(struct net *net, const struct store_answer *answer)
{
    struct part_reader **at = &net->readers;
    struct problem problem;
    while (*at && (*at)->ticket != answer->ticket)
        at = &(*at)->next;
    struct part_reader *reader = *at;
    if (!reader)
        return;
    *at = reader->next;
    if (answer->part) {
        reader->done(reader->context, (const char *const *)answer->part->texts, answer->part->n, answer->part->next_ms,
                     NULL);
    } else {
        problem_set(&problem, answer->error.code == ERROR_NOT_FOUND ? PROBLEM_NOT_FOUND : PROBLEM_STORAGE, "", "",
                    "the recording cannot be read: %s", answer->error.text);
        reader->done(reader->context, NULL, 0, INT64_MAX, &problem);
    }
    free(reader);
}

void keep_readers_finish(struct net *net)
{
    struct problem problem;
    problem_set(&problem, PROBLEM_BUSY, "", "", "the server is stopping");
    while (net->readers) {
        struct part_reader *reader = net->readers;
        net->readers = reader->next;
        reader->done(reader->context, NULL, 0, INT64_MAX, &problem);
        free(reader);
    }
}

/* For a room that plays; it may be gone by now. */
struct asking_room {
    struct net *net;
    char id[64];
};

static void give_to_room(void *context, const char *const *texts, size_t n, int64_t next_ms,
                         const struct problem *problem)
{
    struct asking_room *asking = context;
    struct net_room *entry = NULL;
    for (size_t i = 0; i < asking->net->n_rooms; i++)
        if (strcmp(room_id(asking->net->rooms[i]->room), asking->id) == 0)
            entry = asking->net->rooms[i];
    if (entry) {
        room_replay_came(entry->room, texts, n, next_ms, problem, clock_now_us());
        schedule_room(entry);
    }
    free(asking);
}

bool keep_replay_read(void *context, struct room *room, const char *of_room, const char *recording, int64_t t_ms,
                      struct problem *problem)
{
    struct asking_room *asking = mem_new(sizeof *asking);
    asking->net = context;
    (void)snprintf(asking->id, sizeof asking->id, "%s", room_id(room));
    if (net_recording_read(context, of_room, recording, t_ms, give_to_room, asking, problem))
        return true;
    free(asking);
    return false;
}

/* Finds what has changed, and puts it together again: meeting_log.h. */
#include "server/room/log/meeting_log.h"

#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/wire/bookmark.h"
#include "server/wire/json_merge.h"
#include "wire_gen.h"

const char *const log_part_words[LOG_N_PARTS] = { "scene", "views", "pointers", "items", "members" };

static const char state_word[] = "state";

/* ---- states ----------------------------------------------------------------------------------------------------- */

cJSON *log_state_create(void)
{
    cJSON *state = cJSON_CreateObject();
    for (int part = 0; part < LOG_N_PARTS; part++)
        cJSON_AddObjectToObject(state, log_part_words[part]);
    if (cJSON_GetArraySize(state) == LOG_N_PARTS)
        return state;
    cJSON_Delete(state);
    return NULL;
}

cJSON *log_state_part(const cJSON *state, enum log_part part)
{
    return cJSON_GetObjectItemCaseSensitive(state, log_part_words[part]);
}

/* The entry of this id, and in *after the first one behind its place (NULL: at the end). */
static cJSON *find_entry(const cJSON *entries, const char *id, cJSON **after)
{
    cJSON *entry = entries->child;
    int order = -1;
    while (entry && (order = strcmp(entry->string, id)) < 0)
        entry = entry->next;
    *after = entry;
    return entry && order == 0 ? entry : NULL;
}

/* Puts an entry to its place, in the stead of the one that has its id. Takes document; NULL: the entry goes. False: no
 * memory, and all is as it was. */
static bool set_entry(cJSON *entries, const char *id, cJSON *document)
{
    cJSON *after, *before = find_entry(entries, id, &after);
    if (!document) {
        if (before)
            cJSON_Delete(cJSON_DetachItemViaPointer(entries, before));
        return true;
    }
    if (!cJSON_AddItemToObject(entries, id, document)) { /* gives it its name */
        cJSON_Delete(document);
        return false;
    }
    if (before) {
        (void)cJSON_DetachItemViaPointer(entries, document);
        return cJSON_ReplaceItemViaPointer(entries, before, document);
    }
    for (cJSON *next; after && after != document; after = next) { /* those behind it */
        next = after->next;
        json_append(entries, cJSON_DetachItemViaPointer(entries, after));
    }
    return true;
}

/* True if both are printed alike. */
static bool is_same(const cJSON *a, const cJSON *b)
{
    if (!a || !b || (a->type & 0xff) != (b->type & 0xff))
        return false;
    if (cJSON_IsNumber(a))
        return memcmp(&a->valuedouble, &b->valuedouble, sizeof a->valuedouble) == 0;
    if (cJSON_IsString(a))
        return strcmp(a->valuestring, b->valuestring) == 0;
    for (a = a->child, b = b->child; a && b; a = a->next, b = b->next)
        if ((a->string && strcmp(a->string, b->string) != 0) || !is_same(a, b))
            return false;
    return !a && !b;
}

/* ---- writing ---------------------------------------------------------------------------------------------------- */

struct meeting_log {
    cJSON *state, *pending;        /* pending: events that were not taken yet */
    bool is_begun, is_state;       /* begun: there is a state, taken or not; is_state: pending begins with one */
    size_t n_state_bytes, n_bytes; /* of the last state; of the changes since */
};

struct meeting_log *meeting_log_create(void)
{
    struct meeting_log *log = mem_new(sizeof *log);
    log->state = log_state_create();
    log->pending = cJSON_CreateArray();
    if (log->state && log->pending)
        return log;
    meeting_log_destroy(log);
    return NULL;
}

void meeting_log_destroy(struct meeting_log *log)
{
    if (!log)
        return;
    cJSON_Delete(log->state);
    cJSON_Delete(log->pending);
    free(log);
}

const cJSON *meeting_log_state(const struct meeting_log *log)
{
    return log->state;
}

static cJSON *add_event(struct meeting_log *log, int64_t t_ms, const char *part)
{
    cJSON *event = cJSON_CreateObject();
    cJSON_AddNumberToObject(event, "t_ms", (double)t_ms);
    cJSON_AddStringToObject(event, "part", part);
    json_append(log->pending, event);
    return event;
}

/* Adds what makes `after` from `before`: a patch if that gives the same, else the whole document. */
static void add_change(cJSON *event, const cJSON *before, const cJSON *after)
{
    cJSON *patch = before ? bookmark_difference(before, after) : NULL,
          *merged = patch ? json_merge(before, patch) : NULL;
    bool is_enough = merged && is_same(merged, after);
    cJSON_Delete(merged);
    if (is_enough) {
        json_add(event, "patch", patch);
        return;
    }
    cJSON_Delete(patch);
    json_add(event, "whole", cJSON_Duplicate(after, true));
}

void meeting_log_put(struct meeting_log *log, int64_t t_ms, enum log_part part, const char *id, cJSON *document)
{
    cJSON *entries = log_state_part(log->state, part), *after;
    const cJSON *before = find_entry(entries, id, &after);
    if (document ? is_same(before, document) : !before) {
        cJSON_Delete(document);
        return;
    }
    if (log->is_begun) {
        cJSON *event = add_event(log, t_ms, log_part_words[part]);
        cJSON_AddStringToObject(event, "id", id);
        if (document)
            add_change(event, before, document);
        else
            cJSON_AddTrueToObject(event, "gone");
    }
    if (!set_entry(entries, id, document))
        meeting_log_restart(log);
}

void meeting_log_put_all(struct meeting_log *log, int64_t t_ms, enum log_part part, cJSON *entries)
{
    for (cJSON *entry = entries ? log_state_part(log->state, part)->child : NULL, *next; entry; entry = next) {
        next = entry->next;
        if (!cJSON_GetObjectItemCaseSensitive(entries, entry->string))
            meeting_log_put(log, t_ms, part, entry->string, NULL);
    }
    for (cJSON *entry = entries ? entries->child : NULL, *next; entry; entry = next) {
        next = entry->next;
        char *id = mem_copy_text(entry->string);
        meeting_log_put(log, t_ms, part, id, cJSON_DetachItemViaPointer(entries, entry));
        free(id);
    }
    cJSON_Delete(entries);
}

void meeting_log_restart(struct meeting_log *log)
{
    cJSON_Delete(log->pending);
    log->pending = cJSON_CreateArray();
    log->is_begun = log->is_state = false;
}

static bool state_is_due(const struct meeting_log *log)
{
    return log->n_bytes >= LOG_STATE_LEAST_BYTES && log->n_bytes >= LOG_STATE_TIMES * log->n_state_bytes;
}

static void add_state(struct meeting_log *log, int64_t t_ms)
{
    cJSON *event = add_event(log, t_ms, state_word);
    json_add(event, "whole", cJSON_Duplicate(log->state, true));
    log->is_begun = log->is_state = true;
}

bool meeting_log_take(struct meeting_log *log, int64_t t_ms, struct log_batch *batch)
{
    if (!log->is_begun)
        add_state(log, t_ms);
    if (!log->pending || !log->pending->child)
        return false;
    *batch = (struct log_batch){ .t_ms = log_event_ms(log->pending->child),
                                 .is_state = log->is_state,
                                 .n_events = (uint32_t)cJSON_GetArraySize(log->pending),
                                 .text = json_print(log->pending) };
    meeting_log_restart(log);
    if (!batch->text)
        return false;
    const size_t n = strlen(batch->text);
    log->is_begun = true;
    log->n_state_bytes = batch->is_state ? n : log->n_state_bytes;
    log->n_bytes = batch->is_state ? 0 : log->n_bytes + n;
    if (state_is_due(log))
        add_state(log, t_ms);
    return true;
}

/* ---- reading ---------------------------------------------------------------------------------------------------- */

cJSON *meeting_log_read_all(const char *const *texts, size_t n, struct problem *problem)
{
    cJSON *all = cJSON_CreateArray();
    bool ok = all && n > 0;
    for (size_t i = 0; ok && i < n; i++) {
        cJSON *events = meeting_log_read(texts[i], strlen(texts[i]), problem);
        ok = events != NULL;
        if (!ok || !events->child) {
            cJSON_Delete(events);
            continue;
        }
        cJSON *first = events->child, *last = first->prev; /* appended as a whole: the lists may be long */
        events->child = NULL;
        cJSON_Delete(events);
        if (!all->child) {
            all->child = first;
            continue;
        }
        cJSON *end = all->child->prev;
        end->next = first;
        first->prev = end;
        all->child->prev = last;
    }
    if (ok && all->child)
        return all;
    if (problem->type == PROBLEM_NONE)
        problem_set(problem, PROBLEM_STORAGE, "", "", "nothing of it is on the disk");
    cJSON_Delete(all);
    return NULL;
}

int64_t log_event_ms(const cJSON *event)
{
    return (int64_t)json_number(event, "t_ms", -1);
}

static bool is_damaged(struct problem *problem, const char *what)
{
    return problem_set(problem, PROBLEM_VALIDATION, "", "type", "the recording is damaged: %s", what);
}

static int part_of(const cJSON *event)
{
    const char *word = json_text(event, "part");
    for (int part = 0; word && part < LOG_N_PARTS; part++)
        if (strcmp(word, log_part_words[part]) == 0)
            return part;
    return word && strcmp(word, state_word) == 0 ? LOG_N_PARTS : -1;
}

bool log_event_is_state(const cJSON *event)
{
    return part_of(event) == LOG_N_PARTS;
}

static bool check_state(const cJSON *whole, struct problem *problem)
{
    for (int part = 0; part < LOG_N_PARTS; part++) {
        const cJSON *entries = log_state_part(whole, (enum log_part)part), *entry;
        const char *last = "";
        if (!cJSON_IsObject(entries) || cJSON_GetArraySize(entries) > LOG_MAX_ENTRIES)
            return is_damaged(problem, "a part of a state is missing or too large");
        cJSON_ArrayForEach(entry, entries)
        {
            if (!cJSON_IsObject(entry) || strcmp(last, entry->string) >= 0)
                return is_damaged(problem, "a state is not in order");
            last = entry->string;
        }
    }
    return true;
}

static bool check_event(const cJSON *event, double last_ms, struct problem *problem)
{
    const double t_ms = json_number(event, "t_ms", -1);
    const cJSON *whole = cJSON_GetObjectItemCaseSensitive(event, "whole"),
                *patch = cJSON_GetObjectItemCaseSensitive(event, "patch");
    const char *id = json_text(event, "id");
    int part = part_of(event);
    if (!(t_ms >= last_ms && t_ms <= LOG_MAX_T_MS))
        return is_damaged(problem, "an event's time goes back");
    if (part < 0)
        return is_damaged(problem, "an event is of no part");
    if (part == LOG_N_PARTS)
        return check_state(whole, problem);
    if (!id || !id[0] || strlen(id) > 160)
        return is_damaged(problem, "an event has no id");
    if (!json_flag(event, "gone", false) && !cJSON_IsObject(whole) && !cJSON_IsObject(patch))
        return is_damaged(problem, "an event says nothing");
    return true;
}

cJSON *meeting_log_read(const char *text, size_t n, struct problem *problem)
{
    if (n > LOG_MAX_TEXT_BYTES) {
        is_damaged(problem, "a batch is too large");
        return NULL;
    }
    cJSON *events = json_read(text, n, problem);
    if (!events)
        return NULL;
    bool ok = cJSON_IsArray(events) || is_damaged(problem, "a batch is no list");
    double last_ms = 0;
    for (const cJSON *event = events->child; ok && event; event = event->next) {
        ok = check_event(event, last_ms, problem);
        last_ms = json_number(event, "t_ms", 0);
    }
    if (ok)
        return events;
    cJSON_Delete(events);
    return NULL;
}

bool meeting_log_apply(cJSON **state, const cJSON *event, struct problem *problem)
{
    const cJSON *whole = cJSON_GetObjectItemCaseSensitive(event, "whole"),
                *patch = cJSON_GetObjectItemCaseSensitive(event, "patch");
    const int part = part_of(event);
    if (part == LOG_N_PARTS) {
        cJSON *next = cJSON_Duplicate(whole, true);
        if (!next)
            return json_no_memory(problem, "a recording");
        cJSON_Delete(*state);
        *state = next;
        return true;
    }
    if (!*state || part < 0)
        return is_damaged(problem, "it does not begin with a state");
    const char *id = json_text(event, "id");
    cJSON *entries = log_state_part(*state, (enum log_part)part), *after;
    const cJSON *before = find_entry(entries, id, &after);
    if (json_flag(event, "gone", false))
        return set_entry(entries, id, NULL);
    if (patch && !before)
        return is_damaged(problem, "it changes what is not there");
    if (!before && cJSON_GetArraySize(entries) >= LOG_MAX_ENTRIES)
        return is_damaged(problem, "a part of a state is too large");
    cJSON *document = patch ? json_merge(before, patch) : cJSON_Duplicate(whole, true);
    return (document && set_entry(entries, id, document)) || json_no_memory(problem, "a recording");
}

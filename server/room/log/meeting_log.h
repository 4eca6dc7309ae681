#pragma once
/* The log of a meeting: what a room was at any time, as complete states and the changes between them. A state is five
 * parts, each a set of JSON documents by id, sorted by id:
 *   scene     one, "scene": {revision, scene}
 *   views     the shared ones by kind, number and plane, as "3d-1": {document, by}
 *   pointers  by member: {view, point_mm}
 *   items     rows of notes, replies and bookmarks, as in the message welcome
 *   members   {name, color, role, connected, following, presenting}
 * An event is {t_ms, part, id} with one of patch (RFC 7396, on the document as it was), whole, gone; or {t_ms, part:
 * "state", whole}. Events of one batch stand in one text, a list. Applied in their order they give, member for member
 * and digit for digit, what was put in. Pure: no room, no clock, no disk. One thread. */
#include "server/wire/json.h"

enum {
    LOG_STATE_LEAST_BYTES = 128 << 10, /* of changes, before another complete state is written */
    LOG_STATE_TIMES = 3,               /* and this multiple of the last state's bytes: states are a quarter of a log */
    LOG_MAX_TEXT_BYTES = 32 << 20,     /* of one batch */
    LOG_MAX_ENTRIES = 4096,            /* of one part */
    LOG_MAX_T_MS = 1000000000          /* eleven days */
};

enum log_part { LOG_SCENE, LOG_VIEWS, LOG_POINTERS, LOG_ITEMS, LOG_MEMBERS, LOG_N_PARTS };
extern const char *const log_part_words[LOG_N_PARTS];

/* A state without anything in it; NULL: no memory. */
NODISCARD cJSON *log_state_create(void);
/* A part of a state: an object of documents. */
cJSON *log_state_part(const cJSON *state, enum log_part part);

/* ---- writing ---------------------------------------------------------------------------------------------------- */

struct log_batch {
    int64_t t_ms;  /* of its first event */
    bool is_state; /* it begins with a complete state */
    uint32_t n_events;
    char *text; /* for free() */
};

struct meeting_log;
struct meeting_log *meeting_log_create(void);
void meeting_log_destroy(struct meeting_log *log);
/* At t_ms, which never goes back, the document of this id is this one (taken); NULL: there is none any more. */
void meeting_log_put(struct meeting_log *log, int64_t t_ms, enum log_part part, const char *id, cJSON *document);
/* Like meeting_log_put, for all documents of the part: entries (taken) is an object of them in any order; NULL: there
 * was no memory for it, and all stays as it is. */
void meeting_log_put_all(struct meeting_log *log, int64_t t_ms, enum log_part part, cJSON *entries);
/* The events since the last call. False: there are none, or there was no memory; then the next batch begins with a
 * state, and what was between is lost. */
NODISCARD bool meeting_log_take(struct meeting_log *log, int64_t t_ms, struct log_batch *batch);
/* The next batch begins with a state: what was written is lost. */
void meeting_log_restart(struct meeting_log *log);
/* The documents that were put, as a state; borrowed. */
const cJSON *meeting_log_state(const struct meeting_log *log);

/* ---- reading ---------------------------------------------------------------------------------------------------- */

/* The events of a batch, checked: times that do not go back, parts, ids, documents that are objects. NULL with
 * problem. */
NODISCARD cJSON *meeting_log_read(const char *text, size_t n, struct problem *problem);
/* All events of the batches as one list, at least one. NULL with problem. */
NODISCARD cJSON *meeting_log_read_all(const char *const *texts, size_t n, struct problem *problem);
int64_t log_event_ms(const cJSON *event);
bool log_event_is_state(const cJSON *event);
/* The state after the event, in the stead of *state (NULL: none yet, and only a complete state can be applied).
 * False with problem: *state is as it was. */
NODISCARD bool meeting_log_apply(cJSON **state, const cJSON *event, struct problem *problem);

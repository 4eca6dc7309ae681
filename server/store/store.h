#pragma once
/* Rooms and accounts on disk: an SQLite file with a thread of its own. Others hand it writes and reads, which never
 * wait for the disk; each is answered. Writes that come together are committed together, each whole or not at all.
 * While the disk is full or fails, writes stay in memory and are tried again. Knows rows and texts, not what they mean.
 */
#include <stdbool.h>

#include "core/base/error.h"
#include "server/store/store_rows.h"

enum {
    STORE_QUEUE = 4096,      /* requests that may wait */
    STORE_MAX_ROOMS = 10000, /* listed; a caller keeps no more */
    STORE_RECORDS_AT_ONCE = 1000,
    STORE_AUDIT_AT_ONCE = 1000,
    STORE_AUDIT_LOOKED_AT = 10000, /* rows of the audit that one reading looks at: writes wait meanwhile */
    STORE_LOG_HEAD_S = 3600,       /* the newest row of the audit goes to the log, if there are new ones */
    STORE_RETRY_MS = 500,          /* pause after a failed commit; doubled each time up to */
    STORE_RETRY_AT_MOST_MS = 4000
};

struct store;

enum store_event {
    STORE_OPENED,  /* rooms, accounts: what is on disk; is_new: an earlier file was damaged and moved aside while it was
                      open */
    STORE_WRITTEN, /* the write `ticket` is on disk; error.code set: it can never be written, and was dropped */
    STORE_READ,    /* room, or NULL with error */
    STORE_PART,    /* part, or NULL with error */
    STORE_AUDIT,   /* audit, the newest row first; NULL with error */
    STORE_ERASE,   /* erased, or error: of store_erase_begin or store_erase_finish */
    STORE_RECORDS, /* records, without item and body, the newest first, or one with them; NULL with error */
    STORE_FAILING, /* nothing can be written now: error; tried again and again */
    STORE_FINE     /* it can be written again */
};

struct store_answer {
    enum store_event event;
    uint64_t ticket;
    struct error error;
    struct store_room *room;            /* the receiver's */
    struct store_part *part;            /* the receiver's */
    struct store_summary *rooms;        /* the receiver's */
    struct store_accounts *accounts;    /* the receiver's */
    struct store_meeting **meetings;    /* of STORE_OPENED; the receiver's */
    struct store_statement *statements; /* likewise */
    size_t n_rooms, n_meetings, n_statements;
    struct store_record *records; /* the receiver's */
    size_t n_records;
    struct store_audit_row *audit; /* the receiver's */
    size_t n_audit_rows;
    struct store_erased erased;
    int64_t next_n; /* of STORE_AUDIT: the rows with lower numbers were not looked at; 0: there are none */
    bool is_new;
    size_t n_audit;  /* of STORE_WRITTEN: rows of the audit that were in the write */
    int64_t audit_n; /* of STORE_OPENED and STORE_WRITTEN without error: the newest row of the audit */
    char audit_hash[STORE_AUDIT_HASH]; /* its hash */
};
void store_answer_free(struct store_answer *answer);

struct store_options {
    const char *path;                                             /* of the database; its folder exists */
    void (*answered)(void *context, struct store_answer *answer); /* takes answer; store's thread, or store_create's */
    void *context;
};

/* Opens the database, or says with STORE_FAILING that it is opened later. STORE_OPENED or STORE_FAILING has been
 * answered before it returns.
 *   errors ERROR_UNSUPPORTED  a newer program made the database
 *          ERROR_MEMORY       no thread */
NODISCARD struct store *store_create(const struct store_options *options, struct error *err);
/* Writes what was handed over, with one more try where it failed, and closes. */
void store_destroy(struct store *store);

/* False: too many wait, and room stays the caller's; ask again later. Else takes room. ticket comes back. Any thread. A
 * room with an empty id is no room: its meeting and its rows for the audit alone are written. They are also written
 * when the room they came with can never be. */
bool store_write(struct store *store, struct store_room *room, uint64_t ticket);
/* Like store_write; takes accounts. Those whose commit fails wait for the disk as rooms do. */
bool store_write_accounts(struct store *store, struct store_accounts *accounts, uint64_t ticket);
bool store_delete(struct store *store, const char *room_id, uint64_t ticket);
bool store_read(struct store *store, const char *room_id, uint64_t ticket);
/* Records with time and number before those of the record `before` ("": the newest), at most STORE_RECORDS_AT_ONCE; id
 * not "": this record alone, with item and body. */
bool store_read_records(struct store *store, const char *id, const char *before, uint64_t ticket);
/* Rows of the audit, the newest first, of the next STORE_AUDIT_LOOKED_AT ones below query->before_n. */
bool store_read_audit(struct store *store, const struct store_audit_query *query, uint64_t ticket);
/* is_begin: notes on the disk that this plan is to be erased; once that is answered without error it will be, also by
 * the next start. Else erases it, after all writes before; with error: it is tried again at the next start. */
bool store_erase(struct store *store, const struct store_erase *what, bool is_begin, uint64_t ticket);
/* Erases what an earlier daemon did not come to erase. Before the database is opened and the plans are listed. */
void store_erase_resume(const char *database);
/* A part of a recording: the batches from the last one with a state at or before t_ms on, up to the next such one. */
bool store_read_part(struct store *store, const char *room_id, const char *recording, int64_t t_ms, uint64_t ticket);

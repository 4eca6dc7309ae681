#define _GNU_SOURCE
/* The store's thread: batches, commits, tries again. */
#include "server/store/store.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "core/base/mem.h"
#include "core/base/queue.h"
#include "server/store/accounts.h"
#include "server/store/audit.h"
#include "server/store/audit_read.h"
#include "server/store/database.h"
#include "server/store/erase.h"
#include "server/store/heads.h"
#include "server/store/meetings.h"
#include "server/store/recordings.h"
#include "server/store/records.h"
#include "server/store/rows.h"
#include "server/store/sql.h"
#include "server/store/statements.h"

enum { MAX_BATCH = 256, MAX_PENDING = STORE_QUEUE };

enum request_kind {
    REQUEST_WRITE,
    REQUEST_WRITE_ACCOUNTS,
    REQUEST_DELETE,
    REQUEST_READ,
    REQUEST_READ_PART,
    REQUEST_READ_RECORDS,
    REQUEST_READ_AUDIT,
    REQUEST_ERASE_BEGIN,
    REQUEST_ERASE_FINISH
};

struct request {
    struct request *next; /* in the list of writes that are not yet on disk */
    enum request_kind kind;
    uint64_t ticket;
    char room_id[64];
    struct store_room *room;         /* of a write */
    struct store_accounts *accounts; /* of REQUEST_WRITE_ACCOUNTS */
    char recording[64];              /* of a part that is read; of records, those before this one */
    int64_t t_ms;
    struct store_audit_query *query; /* of rows of the audit */
    struct store_erase *erase;       /* of REQUEST_ERASE_... */
    struct error refusal;            /* why the room can never be written; its rows for the audit are left */
};

struct store {
    pthread_t thread;
    char path[DATABASE_PATH_SIZE];
    struct store_options options;
    struct queue *queue;
    /* the store's thread only */
    sqlite3 *db;                   /* NULL: not open now */
    struct request *first, **last; /* writes in their order */
    size_t n_pending;
    bool is_failing, was_open;
    struct error failure; /* as last told */
    int64_t retry_us, pause_ms;
    struct audit_head head;   /* of the audit on disk */
    int64_t logged_n, log_us; /* its number when it was last logged; when it is logged next, if it is another then */
};

void store_answer_free(struct store_answer *answer)
{
    if (!answer)
        return;
    store_room_free(answer->room);
    store_part_free(answer->part);
    store_summaries_free(answer->rooms, answer->n_rooms);
    store_accounts_free(answer->accounts);
    for (size_t i = 0; i < answer->n_records; i++)
        store_record_finish(&answer->records[i]);
    free(answer->records);
    audit_rows_free(answer->audit, answer->n_audit_rows);
    meetings_free(answer->meetings, answer->n_meetings);
    statements_free(answer->statements, answer->n_statements);
    free(answer);
}

static void request_free(void *item)
{
    struct request *request = item;
    store_room_free(request->room);
    store_accounts_free(request->accounts);
    free(request->query);
    free(request->erase);
    free(request);
}

static void answer(struct store *store, const struct store_answer *said)
{
    struct store_answer *copy = mem_new(sizeof *copy);
    *copy = *said;
    store->options.answered(store->options.context, copy);
}

/* The head goes to the log, where nobody who changes the database reaches it. */
static void log_head(struct store *store)
{
    if (store->head.n != store->logged_n)
        log_info("audit: %lld rows, head %s", (long long)store->head.n, store->head.hash);
    store->logged_n = store->head.n;
    store->log_us = clock_now_us() + STORE_LOG_HEAD_S * INT64_C(1000000);
}

/* Rows that were there once are not: that itself is recorded, once. */
static void record_loss(struct store *store, const struct audit_head *noted)
{
    char row[400], *rows[] = { row };
    struct error err = { 0 };
    log_error("the audit ends with row %lld, and row %lld with the hash %s was there: rows were removed or changed, or "
              "another database was put in its place",
              (long long)store->head.n, (long long)noted->n, noted->hash);
    (void)snprintf(row, sizeof row,
                   "{\"time_ms\":%lld,\"room\":\"\",\"plan\":\"\",\"member\":\"\",\"name\":\"\",\"role\":\"\","
                   "\"address\":\"\",\"action\":\"head-missing\",\"detail\":{\"rows\":%lld,\"head\":\"%s\"},"
                   "\"revision_before\":null,\"revision_after\":null,\"result\":\"done\"}",
                   (long long)clock_wall_ms(), (long long)noted->n, noted->hash);
    bool ok = sql_run(store->db, "BEGIN IMMEDIATE", &err) && audit_append(store->db, rows, 1, &err) &&
              sql_run(store->db, "COMMIT", &err);
    if (!ok) {
        log_error("the audit: %s", err.text);
        (void)sqlite3_exec(store->db, "ROLLBACK", NULL, NULL, NULL);
    } else if (audit_read_head(store->db, &store->head, &err)) {
        heads_write(store->path, &store->head);
    }
}

/* Compares the audit with its newest row as it was noted beside the database. */
static void compare_head(struct store *store)
{
    struct audit_head noted;
    struct error err = { 0 };
    heads_read(store->path, &noted);
    if (!audit_read_head(store->db, &store->head, &err))
        return;
    if (noted.n && !audit_has_row(store->db, &noted))
        record_loss(store, &noted);
    else if (store->head.n)
        heads_write(store->path, &store->head);
    log_head(store);
}

/* The newest row of the audit; without one, or when it cannot be read, none. */
static void read_head(struct store *store, struct store_answer *said)
{
    struct audit_head head;
    struct error err = { 0 };
    if (!audit_read_head(store->db, &head, &err))
        log_error("%s", err.text);
    else
        store->head = head;
    said->audit_n = head.n;
    memcpy(said->audit_hash, head.hash, sizeof said->audit_hash);
}

/* ---- opening ---------------------------------------------------------------------------------------------------- */

static void fail(struct store *store, const struct error *err)
{
    bool is_news = !store->is_failing || strcmp(store->failure.text, err->text) != 0;
    store->pause_ms = store->is_failing ? 2 * store->pause_ms : STORE_RETRY_MS;
    if (store->pause_ms > STORE_RETRY_AT_MOST_MS)
        store->pause_ms = STORE_RETRY_AT_MOST_MS;
    store->retry_us = clock_now_us() + store->pause_ms * 1000;
    store->is_failing = true;
    if (!is_news)
        return;
    store->failure = *err;
    log_error("nothing can be stored now: %s", err->text);
    answer(store, &(struct store_answer){ .event = STORE_FAILING, .error = *err });
}

static void recover(struct store *store)
{
    if (!store->is_failing)
        return;
    store->is_failing = false;
    log_info("storing goes on");
    answer(store, &(struct store_answer){ .event = STORE_FINE });
}

static bool open_database(struct store *store, struct error *err)
{
    char moved[DATABASE_PATH_SIZE];
    struct store_answer opened = { .event = STORE_OPENED };
    store->db = database_open(store->path, moved, err);
    if (moved[0])
        log_error("%s was damaged; it lies aside as %s, and a new one was begun", store->path, moved);
    if (!store->db)
        return false;
    opened.rooms = rows_list_rooms(store->db, STORE_MAX_ROOMS, &opened.n_rooms, err);
    opened.accounts = opened.rooms ? accounts_read(store->db, err) : NULL;
    opened.meetings = opened.accounts ? meetings_read(store->db, &opened.n_meetings, err) : NULL;
    if (!opened.meetings || !(opened.statements = statements_read(store->db, &opened.n_statements, err))) {
        meetings_free(opened.meetings, opened.n_meetings);
        store_summaries_free(opened.rooms, opened.n_rooms);
        store_accounts_free(opened.accounts);
        database_close(store->db);
        store->db = NULL;
        return false;
    }
    compare_head(store);
    read_head(store, &opened);
    opened.is_new = store->was_open && moved[0] != 0;
    store->was_open = true;
    answer(store, &opened);
    return true;
}

/* ---- writing ---------------------------------------------------------------------------------------------------- */

static bool apply(struct store *store, const struct request *request, struct error *err)
{
    if (request->kind == REQUEST_DELETE)
        return rows_delete_room(store->db, request->room_id, err);
    if (request->kind == REQUEST_WRITE_ACCOUNTS)
        return accounts_write(store->db, request->accounts, err);
    return (request->room->id[0] == 0 || (request->room->is_prompt ? rows_write_prompt(store->db, request->room, err)
                                                                   : rows_write_room(store->db, request->room, err))) &&
           (!request->room->meeting || meetings_write(store->db, request->room->meeting, err)) &&
           (!request->room->statement || statements_write(store->db, request->room->statement, err)) &&
           audit_append(store->db, request->room->audit, request->room->n_audit, err);
}

/* Commits the first n pending writes together. */
static bool commit(struct store *store, size_t n, struct error *err)
{
    const struct request *request = store->first;
    bool ok = sql_run(store->db, "BEGIN IMMEDIATE", err);
    for (size_t i = 0; ok && i < n; i++, request = request->next)
        ok = apply(store, request, err);
    ok = ok && sql_run(store->db, "COMMIT", err);
    if (!ok && !sqlite3_get_autocommit(store->db))
        (void)sqlite3_exec(store->db, "ROLLBACK", NULL, NULL, NULL);
    return ok;
}

static void finish(struct store *store, size_t n, const struct error *err)
{
    struct store_answer head = { 0 };
    const int64_t n_before = store->head.n;
    if (!err)
        read_head(store, &head);
    if (store->head.n > n_before)
        heads_write(store->path, &store->head);
    while (n-- > 0) {
        struct request *request = store->first;
        store->first = request->next;
        store->n_pending--;
        if (!store->first)
            store->last = &store->first;
        struct store_answer written = { .event = STORE_WRITTEN, .ticket = request->ticket, .audit_n = head.audit_n };
        memcpy(written.audit_hash, head.audit_hash, sizeof written.audit_hash);
        written.error = err ? *err : request->refusal;
        written.n_audit = request->room ? request->room->n_audit : 0;
        answer(store, &written);
        request_free(request);
    }
}

/* The first pending write can never work: leaves of it what is for the audit. False: there is no such thing. */
static bool keep_audit_alone(struct store *store, const struct error *err)
{
    struct request *request = store->first;
    if (!request->room || !request->room->n_audit || !request->room->id[0] || request->room->is_prompt)
        return false;
    request->room->id[0] = 0;
    request->refusal = *err;
    return true;
}

static void refuse_write(struct store *store, struct request *request, const struct error *err)
{
    const struct store_answer written = {
        .event = STORE_WRITTEN, .ticket = request->ticket, .error = *err, .n_audit = request->room->n_audit
    };
    answer(store, &written);
    request_free(request);
}

/* Nothing can be written now: what is to be written now or never is answered and dropped. */
static void refuse_prompt(struct store *store, const struct error *err)
{
    struct request **at = &store->first;
    while (*at) {
        struct request *request = *at;
        if (!request->room || !request->room->is_prompt) {
            at = &request->next;
            continue;
        }
        *at = request->next;
        store->n_pending--;
        refuse_write(store, request, err);
    }
    store->last = at;
}

/* Brings pending writes to the disk as far as that goes now. */
static void write_pending(struct store *store)
{
    struct error err = { 0 };
    if (!store->db && !open_database(store, &err)) {
        fail(store, &err);
        refuse_prompt(store, &err);
        return;
    }
    while (store->n_pending > 0) {
        size_t n = store->n_pending < MAX_BATCH ? store->n_pending : MAX_BATCH;
        err = (struct error){ 0 };
        bool ok = commit(store, n, &err);
        if (!ok && err.code == ERROR_STATE && n > 1) { /* one of them is bad: it must not hold up the others */
            n = 1;
            err = (struct error){ 0 };
            ok = commit(store, n, &err);
        }
        if (ok) {
            finish(store, n, NULL);
        } else if (err.code == ERROR_STATE) {
            log_error("a change cannot be stored: %s", err.text);
            if (!keep_audit_alone(store, &err))
                finish(store, n, &err);
        } else {
            if (err.code == ERROR_FORMAT) { /* damaged: opening moves it aside */
                database_close(store->db);
                store->db = NULL;
            }
            fail(store, &err);
            refuse_prompt(store, &err);
            return;
        }
    }
    recover(store);
}

static void read_room(struct store *store, const struct request *request)
{
    struct store_answer read = { .event = STORE_READ, .ticket = request->ticket };
    if (!store->db)
        read.error = store->failure;
    else
        read.room = rows_read_room(store->db, request->room_id, &read.error);
    if (store->db && !read.room && read.error.code == ERROR_NOT_FOUND)
        read.room = rows_read_saved(store->db, request->room_id, &read.error);
    answer(store, &read);
}

static void read_part(struct store *store, const struct request *request)
{
    struct store_answer read = { .event = STORE_PART, .ticket = request->ticket };
    if (!store->db)
        read.error = store->failure;
    else
        read.part = recordings_read_part(store->db, request->room_id, request->recording, request->t_ms, &read.error);
    answer(store, &read);
}

static void read_records(struct store *store, const struct request *request)
{
    struct store_answer read = { .event = STORE_RECORDS, .ticket = request->ticket };
    if (!store->db)
        read.error = store->failure;
    else
        read.records = records_read(store->db, request->room_id, request->recording, &read.n_records, &read.error);
    answer(store, &read);
}

static void read_audit(struct store *store, const struct request *request)
{
    struct store_answer read = { .event = STORE_AUDIT, .ticket = request->ticket };
    if (!store->db)
        read.error = store->failure;
    else
        read.audit = audit_read(store->db, request->query, &read.n_audit_rows, &read.next_n, &read.error);
    read.audit_n = store->head.n;
    memcpy(read.audit_hash, store->head.hash, sizeof read.audit_hash);
    answer(store, &read);
}

static void erase(struct store *store, const struct request *request)
{
    struct store_answer said = { .event = STORE_ERASE, .ticket = request->ticket };
    write_pending(store);
    if (!store->db || store->n_pending > 0)
        said.error = store->failure;
    else
        erase_plan(store->db, store->path, request->erase, request->kind == REQUEST_ERASE_BEGIN, &said);
    read_head(store, &said);
    answer(store, &said);
}

static void take(struct store *store, struct request *request)
{
    if (request->kind != REQUEST_WRITE && request->kind != REQUEST_WRITE_ACCOUNTS && request->kind != REQUEST_DELETE) {
        if (request->kind == REQUEST_READ)
            read_room(store, request);
        else if (request->kind == REQUEST_READ_PART)
            read_part(store, request);
        else if (request->kind == REQUEST_READ_AUDIT)
            read_audit(store, request);
        else if (request->kind == REQUEST_ERASE_BEGIN || request->kind == REQUEST_ERASE_FINISH)
            erase(store, request);
        else
            read_records(store, request);
        request_free(request);
        return;
    }
    if (store->is_failing && request->room && request->room->is_prompt) {
        refuse_write(store, request, &store->failure);
        return;
    }
    request->next = NULL;
    *store->last = request;
    store->last = &request->next;
    store->n_pending++;
}

/* How long to wait for a request: until the next try, while there is one to make, or the next line in the log. */
static int64_t wait_ms(const struct store *store)
{
    if (!store->is_failing && store->head.n == store->logged_n)
        return -1;
    int64_t left_us = (store->is_failing ? store->retry_us : store->log_us) - clock_now_us();
    return left_us > 0 ? left_us / 1000 + 1 : 0;
}

static bool is_closed(struct request *request)
{
    return request->kind == REQUEST_READ && !request->room_id[0];
}

static void *work(void *context)
{
    struct store *store = context;
    bool ends = false;
    (void)pthread_setname_np(pthread_self(), "store");
    while (!ends) {
        struct request *request =
            store->n_pending < MAX_PENDING || !store->is_failing ? queue_take(store->queue, wait_ms(store)) : NULL;
        if (!request && store->n_pending >= MAX_PENDING) {
            (void)nanosleep(&(struct timespec){ .tv_nsec = 50000000 }, NULL);
        }
        for (; request; request = store->n_pending < MAX_PENDING ? queue_try_take(store->queue) : NULL) {
            if (is_closed(request)) {
                ends = true;
                request_free(request);
                break;
            }
            take(store, request);
        }
        if (!ends && clock_now_us() >= store->log_us)
            log_head(store);
        if (ends || (store->is_failing ? clock_now_us() >= store->retry_us : store->n_pending > 0))
            write_pending(store);
    }
    return NULL;
}

/* ---- life ------------------------------------------------------------------------------------------------------- */

struct store *store_create(const struct store_options *options, struct error *err)
{
    struct store *store = mem_new(sizeof *store);
    struct error found = { 0 };
    store->options = *options;
    store->last = &store->first;
    (void)snprintf(store->path, sizeof store->path, "%s", options->path);
    store->options.path = store->path;
    store->queue = queue_create(STORE_QUEUE, request_free);
    if (!open_database(store, &found)) {
        if (found.code == ERROR_UNSUPPORTED) {
            error_set(err, found.code, "%s", found.text);
            goto fail;
        }
        fail(store, &found);
    }
    if (pthread_create(&store->thread, NULL, work, store) == 0)
        return store;
    error_set(err, ERROR_MEMORY, "no thread could be started for the store");
fail:
    database_close(store->db);
    queue_destroy(store->queue);
    free(store);
    return NULL;
}

static bool put(struct store *store, enum request_kind kind, const char *room_id, struct store_room *room,
                uint64_t ticket)
{
    struct request *request = mem_new(sizeof *request);
    *request = (struct request){ .kind = kind, .ticket = ticket, .room = room };
    (void)snprintf(request->room_id, sizeof request->room_id, "%s", room_id);
    if (queue_try_put(store->queue, request))
        return true;
    free(request);
    return false;
}

bool store_write(struct store *store, struct store_room *room, uint64_t ticket)
{
    return put(store, REQUEST_WRITE, room->id, room, ticket);
}

bool store_write_accounts(struct store *store, struct store_accounts *accounts, uint64_t ticket)
{
    struct request *request = mem_new(sizeof *request);
    *request = (struct request){ .kind = REQUEST_WRITE_ACCOUNTS, .ticket = ticket, .accounts = accounts };
    if (queue_try_put(store->queue, request))
        return true;
    free(request);
    return false;
}

bool store_delete(struct store *store, const char *room_id, uint64_t ticket)
{
    return put(store, REQUEST_DELETE, room_id, NULL, ticket);
}

bool store_read(struct store *store, const char *room_id, uint64_t ticket)
{
    return put(store, REQUEST_READ, room_id, NULL, ticket);
}

bool store_read_records(struct store *store, const char *id, const char *before, uint64_t ticket)
{
    struct request *request = mem_new(sizeof *request);
    *request = (struct request){ .kind = REQUEST_READ_RECORDS, .ticket = ticket };
    (void)snprintf(request->room_id, sizeof request->room_id, "%s", id);
    (void)snprintf(request->recording, sizeof request->recording, "%s", before);
    if (queue_try_put(store->queue, request))
        return true;
    free(request);
    return false;
}

bool store_read_audit(struct store *store, const struct store_audit_query *query, uint64_t ticket)
{
    struct request *request = mem_new(sizeof *request);
    *request = (struct request){ .kind = REQUEST_READ_AUDIT, .ticket = ticket, .query = mem_new(sizeof *query) };
    *request->query = *query;
    if (queue_try_put(store->queue, request))
        return true;
    request_free(request);
    return false;
}

bool store_erase(struct store *store, const struct store_erase *what, bool is_begin, uint64_t ticket)
{
    struct request *request = mem_new(sizeof *request);
    *request = (struct request){ .kind = is_begin ? REQUEST_ERASE_BEGIN : REQUEST_ERASE_FINISH, .ticket = ticket };
    request->erase = mem_new(sizeof *what);
    *request->erase = *what;
    if (queue_try_put(store->queue, request))
        return true;
    request_free(request);
    return false;
}

bool store_read_part(struct store *store, const char *room_id, const char *recording, int64_t t_ms, uint64_t ticket)
{
    struct request *request = mem_new(sizeof *request);
    *request = (struct request){ .kind = REQUEST_READ_PART, .ticket = ticket, .t_ms = t_ms };
    (void)snprintf(request->room_id, sizeof request->room_id, "%s", room_id);
    (void)snprintf(request->recording, sizeof request->recording, "%s", recording);
    if (queue_try_put(store->queue, request))
        return true;
    free(request);
    return false;
}

void store_destroy(struct store *store)
{
    if (!store)
        return;
    while (!put(store, REQUEST_READ, "", NULL, 0)) { /* the end of all requests: the queue drains soon */
        struct timespec pause = { .tv_nsec = 1000000 };
        (void)nanosleep(&pause, NULL);
    }
    (void)pthread_join(store->thread, NULL);
    if (store->n_pending)
        log_error("%zu changes are lost: %s", store->n_pending, store->failure.text);
    while (store->first) {
        struct request *request = store->first;
        store->first = request->next;
        request_free(request);
    }
    log_head(store);
    database_close(store->db);
    queue_destroy(store->queue);
    free(store);
}

#pragma once
/* The audit: rows that are only ever added, one chain of hashes over the whole database. The hash of a row is SHA-256
 * over the hash of the row before it, as 64 lower case hex digits (64 zeros before row 1), and the bytes of its text.
 * Internal to server/store, but for its limits. */
#include <sqlite3.h>

#include "core/base/error.h"
#include "server/store/store_rows.h"

struct audit_head { /* the newest row */
    int64_t n;      /* rows are numbered from 1; 0: there is none */
    char hash[STORE_AUDIT_HASH];
};

/* Errors of both: those of sql_fail. */
NODISCARD bool audit_read_head(sqlite3 *db, struct audit_head *head, struct error *err);
bool audit_has_row(sqlite3 *db, const struct audit_head *row); /* with this number and hash */
/* Adds rows inside a transaction of the caller's. Each is a JSON object without n, which becomes its first field:
 * {"n":17,"time_ms":...}. */
NODISCARD bool audit_append(sqlite3 *db, char *const *rows, size_t n, struct error *err);
/* Hash of a row with this text, after a row with the hash `before`. */
void audit_hash(const char before[STORE_AUDIT_HASH], const char *text, char hash[STORE_AUDIT_HASH]);
/* SHA-256 of bytes; of a text. */
void audit_digest_bytes(const void *data, size_t n, char hash[STORE_AUDIT_HASH]);
void audit_digest(const char *text, char hash[STORE_AUDIT_HASH]);
extern const char audit_no_hash[STORE_AUDIT_HASH]; /* before row 1 */

/* Adds rows to the audit, and computes their hashes by libsodium. */
#include "server/store/audit.h"

#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/store/sql.h"

const char audit_no_hash[STORE_AUDIT_HASH] = "0000000000000000000000000000000000000000000000000000000000000000";

void audit_digest_bytes(const void *data, size_t n, char hash[STORE_AUDIT_HASH])
{
    unsigned char bytes[crypto_hash_sha256_BYTES];
    (void)crypto_hash_sha256(bytes, data, n);
    (void)sodium_bin2hex(hash, STORE_AUDIT_HASH, bytes, sizeof bytes);
}

void audit_digest(const char *text, char hash[STORE_AUDIT_HASH])
{
    audit_digest_bytes(text, strlen(text), hash);
}

void audit_hash(const char before[STORE_AUDIT_HASH], const char *text, char hash[STORE_AUDIT_HASH])
{
    crypto_hash_sha256_state state;
    unsigned char bytes[crypto_hash_sha256_BYTES];
    (void)crypto_hash_sha256_init(&state);
    (void)crypto_hash_sha256_update(&state, (const unsigned char *)before, STORE_AUDIT_HASH - 1);
    (void)crypto_hash_sha256_update(&state, (const unsigned char *)text, strlen(text));
    (void)crypto_hash_sha256_final(&state, bytes);
    (void)sodium_bin2hex(hash, STORE_AUDIT_HASH, bytes, sizeof bytes);
}

bool audit_read_head(sqlite3 *db, struct audit_head *head, struct error *err)
{
    *head = (struct audit_head){ 0 };
    memcpy(head->hash, audit_no_hash, sizeof head->hash);
    sqlite3_stmt *row = sql_prepare(db, "SELECT n, hash FROM audit ORDER BY n DESC LIMIT 1", err);
    if (!row)
        return false;
    int step = sqlite3_step(row);
    if (step == SQLITE_ROW) {
        head->n = sqlite3_column_int64(row, 0);
        sql_text(row, 1, head->hash, sizeof head->hash);
    }
    bool ok = step == SQLITE_ROW || step == SQLITE_DONE || sql_fail(db, "reading the audit", err);
    (void)sqlite3_finalize(row);
    return ok;
}

bool audit_has_row(sqlite3 *db, const struct audit_head *wanted)
{
    char hash[STORE_AUDIT_HASH] = "";
    sqlite3_stmt *row = sql_prepare(db, "SELECT hash FROM audit WHERE n = ?1", NULL);
    if (!row)
        return false;
    (void)sqlite3_bind_int64(row, 1, wanted->n);
    if (sqlite3_step(row) == SQLITE_ROW)
        sql_text(row, 0, hash, sizeof hash);
    (void)sqlite3_finalize(row);
    return strcmp(hash, wanted->hash) == 0;
}

/* The newest row's number and hash, beside the table. */
static bool write_head(sqlite3 *db, const struct audit_head *head, struct error *err)
{
    sqlite3_stmt *row = sql_prepare(db, "UPDATE audit_head SET n = ?1, hash = ?2 WHERE id = 1", err);
    if (!row)
        return false;
    (void)sqlite3_bind_int64(row, 1, head->n);
    sql_bind_text(row, 2, head->hash);
    bool ok = sql_step(row, "writing the audit", err);
    (void)sqlite3_finalize(row);
    return ok;
}

bool audit_append(sqlite3 *db, char *const *rows, size_t n, struct error *err)
{
    struct audit_head head;
    if (n == 0)
        return true;
    if (!audit_read_head(db, &head, err))
        return false;
    sqlite3_stmt *row = sql_prepare(db, "INSERT INTO audit(n, row, hash) VALUES(?1, ?2, ?3)", err);
    bool ok = row != NULL;
    for (size_t i = 0; ok && i < n; i++) {
        const size_t size = strlen(rows[i]) + 40;
        char *text = mem_array(size, 1, 1 << 16, err), hash[STORE_AUDIT_HASH];
        if (!text) {
            ok = false;
            break;
        }
        head.n++;
        (void)snprintf(text, size, "{\"n\":%lld,%s", (long long)head.n, rows[i] + 1);
        audit_hash(head.hash, text, hash);
        (void)sqlite3_bind_int64(row, 1, head.n);
        sql_bind_text(row, 2, text);
        sql_bind_text(row, 3, hash);
        ok = sql_step(row, "writing the audit", err);
        memcpy(head.hash, hash, sizeof hash);
        free(text);
    }
    (void)sqlite3_finalize(row);
    return ok && write_head(db, &head, err);
}

#pragma once
/* Checks the audit of a database, row by row. */
#include <stdint.h>

#include "core/base/error.h"
#include "server/store/store_rows.h"

struct audit_facts {
    int64_t n_rows, first_ms, last_ms; /* times since 1970; 0: no row */
    int64_t n_items;                   /* items and records that were compared with their rows */
    char head[STORE_AUDIT_HASH];       /* hash of the newest row; 64 zeros: no row */
    bool is_export;                    /* rows in a file, as GET /audit gives them */
    int64_t n_gaps;                    /* of an export: places between which rows are not in the file */
};

/* Reads the database at path, also while a daemon writes it. head: a hash that was given away earlier, as with the
 * record of a room: one of the rows must still have it; NULL: none. Checked are the chain, that its end is the one
 * noted in the database and beside it, and that items and records are what their rows say, none of them missing or
 * added. A file of rows that GET /audit gave (format=ndjson) is checked by verify_rows.h. errors  ERROR_NOT_FOUND there
 * is no database, or it is older than the audit ERROR_FORMAT     the chain is broken: the sentence names the first row
 * that does not fit, and how ERROR_IO */
NODISCARD bool store_verify_audit(const char *path, const char *head, struct audit_facts *facts, struct error *err);

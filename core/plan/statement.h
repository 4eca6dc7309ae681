#pragma once
/* A person's statement of whom a plan is of: that the patients its files name are one person, or who the patient
 * is that they do not name. Plain data; who may state it, and where it is kept, is decided by the server. */
#include <stdbool.h>
#include <stdint.h>

#include "core/plan/origin.h"

enum statement_kind {
    STATEMENT_NONE,
    STATEMENT_ONE_PERSON, /* the patients of the files count as one */
    STATEMENT_IDENTITY    /* the files name nobody: the patient is statement.patient */
};
enum statement_state {
    STATEMENT_USED,
    STATEMENT_OUTDATED,    /* it was made of other files: it does not count */
    STATEMENT_UNREAD,      /* whether it was made of these files could not be found out: it does not count now */
    STATEMENT_CONTRADICTED /* the files name a patient, and another than was stated: the files count */
};
struct plan_statement {
    enum statement_kind kind;
    enum statement_state state;
    char by[164], words[1204];   /* who has said it, and why */
    int64_t time_ms;             /* since 1970 */
    struct plan_patient patient; /* of STATEMENT_IDENTITY: id, name, birth_date */
};

const char *statement_kind_word(enum statement_kind kind);    /* "", "one-person", "identity" */
const char *statement_state_word(enum statement_state state); /* "used", "outdated", "unread", "contradicted" */
/* The files that were read, beside those of the statement; other ones also where it was withdrawn. */
enum statement_files { STATEMENT_OTHER_FILES, STATEMENT_SAME_FILES, STATEMENT_FILES_UNREAD };

struct plan;
/* Makes the statement the plan's, whose state it sets, and reports it. Only while the plan is not yet frozen, after it
 * was loaded and kept in the cache.
 *
 *   statement   kind not STATEMENT_NONE
 *   files       unless STATEMENT_SAME_FILES it changes nothing */
void plan_state(struct plan *plan, const struct plan_statement *statement, enum statement_files files);

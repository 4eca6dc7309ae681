#pragma once
/* Receives uploaded archives: each is written to a file of its own as it comes (spool.h), never kept in memory. HTTP
 * thread only. Knows nothing of libmicrohttpd and of archives' contents. */
#include "server/http/call.h"

enum {
    INTAKE_MAX_FILES = 4,        /* at once */
    INTAKE_MAX_OF_USER = 2,      /* of one user, who would hold all of them */
    INTAKE_STEP_BYTES = 8 << 20, /* disk space granted at a time to a sender that announces no length; the disk is
                                    checked again after each step */
    INTAKE_RETRY_MS = 5000,
    INTAKE_WINDOW_MS = 60000,      /* in each window ... */
    INTAKE_WINDOW_BYTES = 64 << 10 /* ... so much must come: a kilobyte a second */
};

struct intake;
struct intake_file;

/* folder: where "<n>.part" is written; NULL: uploads are refused. reserve_bytes: left free on its disk, also when
 * several archives come at once. errors ERROR_IO */
NODISCARD struct intake *intake_create(const char *folder, uint64_t max_bytes, uint64_t reserve_bytes,
                                       struct error *err);
void intake_wait(struct intake *intake); /* until the disk has taken all: no moved is called afterwards */
void intake_destroy(struct intake *intake);
/* For tests: another window than INTAKE_WINDOW_MS. */
void intake_set_window_ms(struct intake *intake, int ms);

/* For tests: another source for the disk's free bytes; *failed is an errno, or 0. */
void intake_set_disk(struct intake *intake, uint64_t (*free_bytes)(void *context, int *failed), void *context);

/* True if the call's body is an archive: POST /api/v1/plans. */
bool intake_is_for(const struct call *call);
/* Begins to receive an archive. length: announced bytes; -1: not announced. Returns NULL with problem:
 * PROBLEM_FORBIDDEN, PROBLEM_MEDIA_TYPE, PROBLEM_TOO_LARGE, PROBLEM_LIMIT, PROBLEM_STORAGE
 * moved(context): as in spool.h, another thread's: intake_add or intake_end can go on. */
NODISCARD struct intake_file *intake_begin(struct intake *intake, const struct call *call, int64_t length,
                                           void (*moved)(void *context), void *context, struct problem *problem);
/* Takes the next bytes, as many as *n_taken says: fewer than n, and the rest is to be given when the disk has moved.
 * Returns false with problem: PROBLEM_TOO_LARGE, PROBLEM_STORAGE, PROBLEM_TOO_SLOW; then the caller calls intake_drop.
 */
NODISCARD bool intake_add(struct intake_file *file, const char *bytes, size_t n, size_t *n_taken,
                          struct problem *problem);
/* True: the archive is whole on the disk, or it failed. False: to be called again when the disk has moved. */
NODISCARD bool intake_end(struct intake_file *file);
/* After intake_end. Returns the archive's path, the caller's to free, and its size. Takes file. On failure returns NULL
 * with problem and removes the file. */
NODISCARD char *intake_finish(struct intake_file *file, uint64_t *n_bytes, struct problem *problem);
/* The archive will not become whole: removes the file. Takes file; NULL is allowed. */
void intake_drop(struct intake_file *file);

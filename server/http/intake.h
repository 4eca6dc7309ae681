#pragma once
/* Archives that are being received: each goes to a file of its own in one folder as it comes, and never into memory. On
 * the HTTP thread only. Knows nothing of libmicrohttpd, and not what is in an archive. */
#include "server/http/call.h"

enum {
    INTAKE_MAX_FILES = 4,        /* received at once */
    INTAKE_STEP_BYTES = 8 << 20, /* of the disk are granted at once to a sender who does not say how much comes; so
                                    often it is looked at */
    INTAKE_RETRY_MS = 5000,
    INTAKE_WINDOW_MS = 60000,      /* in which */
    INTAKE_WINDOW_BYTES = 64 << 10 /* have to come, or the place is given to others: a kilobyte a second */
};

struct intake;
struct intake_file;

/* folder: "<n>.part" is written there; NULL: no uploads, each is refused. reserve_bytes: what stays free on its disk,
 * however many archives come at once. */
NODISCARD struct intake *intake_create(const char *folder, uint64_t max_bytes, uint64_t reserve_bytes);
void intake_destroy(struct intake *intake);
/* Another window than INTAKE_WINDOW_MS, for tests. */
void intake_set_window_ms(struct intake *intake, int ms);

/* Another disk than the folder's, for tests: its free bytes, or failed with an errno. */
void intake_set_disk(struct intake *intake, uint64_t (*free_bytes)(void *context, int *failed), void *context);

/* Whether the call's body is an archive: POST /api/v1/plans. */
bool intake_is_for(const struct call *call);
/* Begins with one. length: the bytes that are announced, -1 when the sender does not say. NULL with problem:
 * PROBLEM_FORBIDDEN, PROBLEM_MEDIA_TYPE, PROBLEM_TOO_LARGE, PROBLEM_LIMIT, PROBLEM_STORAGE */
NODISCARD struct intake_file *intake_begin(struct intake *intake, const struct call *call, int64_t length,
                                           struct problem *problem);
/* More of it. false with problem (PROBLEM_TOO_LARGE, PROBLEM_STORAGE, PROBLEM_TOO_SLOW when too little comes): drop it.
 */
NODISCARD bool intake_add(struct intake_file *file, const char *bytes, size_t n, struct problem *problem);
/* All has come: gives the file's path, free() it, and its size. Takes file. NULL with problem, and nothing is left. */
NODISCARD char *intake_finish(struct intake_file *file, uint64_t *n_bytes, struct problem *problem);
/* Nothing more will come: removes the file. Takes file; NULL is nothing. */
void intake_drop(struct intake_file *file);

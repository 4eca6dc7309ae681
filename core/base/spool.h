#pragma once
/* Files that a thread of their own opens, writes and closes: a disk that stalls holds up whoever gives it bytes, and
 * nobody else. Functions: one thread, the caller's. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/base/error.h"

enum { SPOOL_BLOCK_BYTES = 256 << 10 }; /* a file has two: one is filled while the other is written */

struct spool;
struct spool_file;

/* errors ERROR_IO */
NODISCARD struct spool *spool_create(struct error *err);
/* Waits until all that was given is done. No moved is called after it. */
void spool_wait(struct spool *spool);
void spool_destroy(struct spool *spool); /* each file was left; waits like spool_wait; NULL is allowed */

/* Begins a new file at this path, for its owner alone, and never through a link. moved: called on the spool's thread
 * once for each spool_write and spool_end that had to wait, when it can go on; not after spool_leave. */
struct spool_file *spool_open(struct spool *spool, const char *path, void (*moved)(void *context), void *context);
/* Takes the first bytes; returns how many. Less than n: it waits for the disk. */
size_t spool_write(struct spool_file *file, const void *bytes, size_t n);
/* True: all bytes are in the file and it is closed, or it failed. False: it waits for the disk; call it again. */
bool spool_end(struct spool_file *file);
int spool_failed(struct spool_file *file); /* errno of what failed; 0: nothing did */
uint64_t spool_written(struct spool_file *file);
/* Removes the file from the disk unless it is kept, which spool_end must have ended. Takes file; does not wait. */
void spool_leave(struct spool_file *file, bool is_kept);

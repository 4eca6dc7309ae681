#pragma once
/* Memory: small fixed structs that may abort, and sizes from outside that may not. */
#include <stddef.h>
#include <stdint.h>

#include "core/base/error.h"

/* Zeroed; aborts when there is none. For small structs of fixed size only. */
NODISCARD void *mem_new(size_t size);

/* Keeps MEM_RESERVE_BYTES for mem_new, which takes them when there is nothing else: under a limit of memory, what was
 * too large can then be answered. To be called again from time to time; does nothing while they are there. Any thread.
 */
enum { MEM_RESERVE_BYTES = 1 << 20 };
void mem_keep_reserve(void);

/* Zeroed array of n things of size bytes; the product is checked for overflow and against limit_bytes.
 * errors ERROR_LIMIT, ERROR_MEMORY. n == 0 gives a unique pointer. Free with free(). */
NODISCARD void *mem_array(size_t n, size_t size, uint64_t limit_bytes, struct error *err);

/* The same for arrays of megabytes, NOT zeroed: on huge pages where the system has them, as the page faults of a fresh
 * array can take longer than filling it. */
NODISCARD void *mem_large_array(size_t n, size_t size, uint64_t limit_bytes, struct error *err);

/* malloc for a library that does not say why a call of it failed (cJSON): a failure counts in error_n_memory. A small
 * request is first met from the reserve, as by mem_new. */
enum { MEM_COUNTED_SMALL_BYTES = 4096 };
NODISCARD void *mem_counted(size_t size);
size_t mem_n_refused(void); /* how often mem_counted gave nothing, on this thread */

/* Copy of a string; aborts when there is no memory. */
NODISCARD char *mem_copy_text(const char *text);

#pragma once
/* Memory allocation. Small structs of fixed size: mem_new, which aborts. Sizes that depend on input: mem_array, which
 * is checked and reports ERROR_MEMORY. All are freed with free(); thread: any. */
#include <stddef.h>
#include <stdint.h>

#include "core/base/error.h"

/* Zeroed; aborts when memory and the reserve are exhausted. Only for small structs of fixed size. */
NODISCARD void *mem_new(size_t size);

/* Sets MEM_RESERVE_BYTES aside, which mem_new and mem_counted free when malloc fails: after a large request failed
 * under a memory limit, the small allocations of its error answer still succeed. Call it again from time to time, to
 * refill a reserve that was used; otherwise it does nothing. */
enum { MEM_RESERVE_BYTES = 1 << 20 };
void mem_keep_reserve(void);

/* Zeroed array of n elements of size bytes; n == 0 gives a unique pointer.
 *   errors  ERROR_LIMIT   n * size overflows or exceeds limit_bytes
 *           ERROR_MEMORY */
NODISCARD void *mem_array(size_t n, size_t size, uint64_t limit_bytes, struct error *err);

/* Like mem_array, for arrays of megabytes, but NOT zeroed. Uses huge pages where the system has them, because the page
 * faults of a fresh array can take longer than filling it. */
NODISCARD void *mem_large_array(size_t n, size_t size, uint64_t limit_bytes, struct error *err);

/* malloc for a library that does not report why a call failed (cJSON). A failure sets ERROR_MEMORY, so it counts in
 * error_n_memory. Requests of at most MEM_COUNTED_SMALL_BYTES use the reserve, as mem_new does. */
enum { MEM_COUNTED_SMALL_BYTES = 4096 };
NODISCARD void *mem_counted(size_t size);
size_t mem_n_refused(void); /* number of times mem_counted returned NULL on this thread */

/* Copy of a string; aborts as mem_new does. */
NODISCARD char *mem_copy_text(const char *text);

/* Puts text, which may be NULL, into an array of size bytes, cut to it. */
void mem_put_text(char *to, size_t size, const char *text);

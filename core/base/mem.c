/* Allocation with checks, and the reserve for small requests. */
#include "core/base/mem.h"

#include <inttypes.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

/* Freed when a small allocation fails. Usually a large one failed before it, and its caller needs a little memory to
 * report that. */
static _Atomic(void *) reserve;

void mem_keep_reserve(void)
{
    if (atomic_load(&reserve))
        return;
    void *none = NULL, *kept = malloc(MEM_RESERVE_BYTES);
    if (!atomic_compare_exchange_strong(&reserve, &none, kept))
        free(kept);
}

void *mem_new(size_t size)
{
    void *p = calloc(1, size ? size : 1);
    if (!p) {
        free(atomic_exchange(&reserve, NULL));
        p = calloc(1, size ? size : 1);
    }
    if (!p)
        abort();
    return p;
}

static _Thread_local size_t n_refused;

size_t mem_n_refused(void)
{
    return n_refused;
}

void *mem_counted(size_t size)
{
    void *p = malloc(size);
    void *kept = p || size > MEM_COUNTED_SMALL_BYTES ? NULL : atomic_exchange(&reserve, NULL);
    if (kept) {
        free(kept);
        p = malloc(size);
    }
    if (!p) {
        n_refused++;
        error_set(NULL, ERROR_MEMORY, "no memory for %zu bytes", size);
    }
    return p;
}

static bool array_bytes(size_t n, size_t size, uint64_t limit_bytes, uint64_t *bytes, struct error *err)
{
    if (!__builtin_mul_overflow((uint64_t)n, (uint64_t)size, bytes) && *bytes <= limit_bytes)
        return true;
    return error_set(err, ERROR_LIMIT, "%zu items of %zu bytes are more than the limit of %" PRIu64 " bytes", n, size,
                     limit_bytes);
}

void *mem_array(size_t n, size_t size, uint64_t limit_bytes, struct error *err)
{
    uint64_t bytes;
    if (!array_bytes(n, size, limit_bytes, &bytes, err))
        return NULL;
    void *p = calloc(bytes ? (size_t)bytes : 1, 1);
    if (!p)
        error_set(err, ERROR_MEMORY, "no memory for %" PRIu64 " bytes", bytes);
    return p;
}

void *mem_large_array(size_t n, size_t size, uint64_t limit_bytes, struct error *err)
{
    const uint64_t huge = (uint64_t)2 << 20;
    uint64_t bytes;
    if (!array_bytes(n, size, limit_bytes, &bytes, err))
        return NULL;
    /* The last part gets a huge page only if it fills at least half of one. */
    uint64_t on_huge = bytes > UINT64_MAX - huge ? 0 : (bytes + huge / 2) / huge * huge;
    uint64_t all = on_huge > bytes ? on_huge : bytes;
    void *p = NULL;
    if (on_huge && posix_memalign(&p, (size_t)huge, (size_t)all) == 0)
        (void)madvise(p, (size_t)on_huge, MADV_HUGEPAGE); /* a kernel without huge pages refuses: still usable */
    else
        p = on_huge ? NULL : malloc(bytes ? (size_t)bytes : 1);
    if (!p)
        error_set(err, ERROR_MEMORY, "no memory for %" PRIu64 " bytes", bytes);
    return p;
}

char *mem_copy_text(const char *text)
{
    size_t n = strlen(text) + 1;
    char *copy = mem_new(n);
    memcpy(copy, text, n);
    return copy;
}

void mem_put_text(char *to, size_t size, const char *text)
{
    size_t n = text ? strnlen(text, size - 1) : 0;
    memcpy(to, text ? text : "", n);
    to[n] = 0;
}

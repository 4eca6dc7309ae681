#include "core/base/mem.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

void *mem_new(size_t size)
{
    void *p = calloc(1, size ? size : 1);
    if (!p)
        abort();
    return p;
}

void *mem_array(size_t n, size_t size, uint64_t limit_bytes, struct error *err)
{
    uint64_t bytes;
    if (__builtin_mul_overflow((uint64_t)n, (uint64_t)size, &bytes) || bytes > limit_bytes) {
        error_set(err, ERROR_LIMIT, "%zu items of %zu bytes are more than the limit of %" PRIu64 " bytes", n, size,
                  limit_bytes);
        return NULL;
    }
    void *p = calloc(bytes ? (size_t)bytes : 1, 1);
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

/* Filling and prefixing errors; counting those of memory. */
#include "core/base/error.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

static _Thread_local size_t n_memory;

size_t error_n_memory(void)
{
    return n_memory;
}

bool error_set(struct error *err, enum error_code code, const char *format, ...)
{
    n_memory += code == ERROR_MEMORY;
    if (!err)
        return false;
    err->code = code;
    va_list args;
    va_start(args, format);
    (void)vsnprintf(err->text, sizeof err->text, format, args);
    va_end(args);
    return false;
}

bool error_is_shortage(int reason)
{
    return reason == EMFILE || reason == ENFILE || reason == ENOMEM;
}

void error_prefix(struct error *err, const char *format, ...)
{
    if (!err)
        return;
    char text[sizeof err->text];
    va_list args;
    va_start(args, format);
    int n = vsnprintf(text, sizeof text, format, args);
    va_end(args);
    if (n < 0)
        return;
    size_t used = strnlen(text, sizeof text - 1);
    if (used + 2 < sizeof text) {
        text[used++] = ':';
        text[used++] = ' ';
        size_t room = sizeof text - used - 1;
        size_t old = strnlen(err->text, sizeof err->text);
        if (old > room)
            old = room;
        memcpy(text + used, err->text, old);
        text[used + old] = 0;
    }
    memcpy(err->text, text, sizeof text);
}

const char *error_word(enum error_code code)
{
    switch (code) {
    case ERROR_NONE: return "none";
    case ERROR_RANGE: return "range";
    case ERROR_LIMIT: return "limit";
    case ERROR_MEMORY: return "memory";
    case ERROR_FORMAT: return "format";
    case ERROR_UNSUPPORTED: return "unsupported";
    case ERROR_NOT_FOUND: return "not-found";
    case ERROR_IO: return "io";
    case ERROR_STATE: return "state";
    case ERROR_CANCELLED: return "cancelled";
    case ERROR_GL: return "gl";
    }
    return "unknown";
}

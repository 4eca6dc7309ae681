#pragma once
/* Why a call failed: a code for the program, a sentence for a person.
 * Knows nothing of the modules that fail. Allocates nothing, so it can also report lack of memory. */
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>

#define NODISCARD __attribute__((warn_unused_result))
#define PRINTF_LIKE(format_at, args_at) __attribute__((format(printf, format_at, args_at)))

enum error_code {
    ERROR_NONE = 0,
    ERROR_RANGE,       /* a value is outside what is allowed or present */
    ERROR_LIMIT,       /* a documented limit was exceeded: size, count, time */
    ERROR_MEMORY,      /* an allocation failed, or no descriptor was free */
    ERROR_FORMAT,      /* bytes or text that break their format */
    ERROR_UNSUPPORTED, /* well formed, but not supported by this program */
    ERROR_NOT_FOUND,   /* the named file, region, plan, room does not exist */
    ERROR_IO,          /* reading, writing, connecting or starting a process failed */
    ERROR_STATE,       /* not possible in the current state: already done, not ready, stale */
    ERROR_CANCELLED,   /* the caller or user cancelled */
    ERROR_GL           /* the graphics driver failed */
};

/* Lives on the caller's stack. text is one sentence, cut at its size. Zero it before use: `struct error err = { 0 };`
 */
struct error {
    enum error_code code;
    char text[240];
};

/* Fills err (NULL is allowed) and returns false: `return error_set(...);` is a whole failure. */
bool error_set(struct error *err, enum error_code code, const char *format, ...) PRINTF_LIKE(3, 4);

/* Number of times ERROR_MEMORY was set on this thread, calls with err == NULL included. A caller that skips unreadable
 * parts compares the number before and after, to tell a bad file from a failed allocation. */
size_t error_n_memory(void);

/* True for the errno values of a process short of memory or descriptors: they say nothing of the file at hand. */
bool error_is_shortage(int reason);

/* Adds context in front on the way up: "plan head-3: region 7: label 300 is not in the volume". */
void error_prefix(struct error *err, const char *format, ...) PRINTF_LIKE(2, 3);

/* The code's stable lower-case word, "range", "limit", ...; for logs, problems and tests. */
const char *error_word(enum error_code code);

#pragma once
/* Logging to standard error, one line an event: UTC time, program, level, text; at most 1024 bytes. Never a patient's
 * name, never a token. Thread: any; a line is one write(2), so lines of several threads do not mix. */
#include "core/base/error.h"

enum log_level { LOG_DEBUG, LOG_INFO, LOG_WARN, LOG_ERROR };

/* Call in main before other threads start. program is kept, not copied; lines below `least` are dropped. */
void log_start(const char *program, enum log_level least);
void log_line(enum log_level level, const char *format, ...) PRINTF_LIKE(2, 3);

#define log_debug(...) log_line(LOG_DEBUG, __VA_ARGS__)
#define log_info(...) log_line(LOG_INFO, __VA_ARGS__)
#define log_warn(...) log_line(LOG_WARN, __VA_ARGS__)
#define log_error(...) log_line(LOG_ERROR, __VA_ARGS__)

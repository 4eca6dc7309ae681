#pragma once
/* Exit codes of `beamroom`, and the line on standard error that goes with each failure. */
#include "core/base/error.h"

enum exit_code { EXIT_DONE = 0, EXIT_REFUSED = 1, EXIT_USAGE = 2 };

/* "beamroom NAME: ...; see beamroom NAME --help" on standard error. Returns EXIT_USAGE. */
int command_usage_error(const char *name, const char *format, ...) PRINTF_LIKE(2, 3);
/* "beamroom NAME: ..." on standard error, without control characters. Returns EXIT_REFUSED. */
int command_refused(const char *name, const struct error *err);

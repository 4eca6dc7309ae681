#pragma once
/* Calls of a running daemon over the control socket of its data folder. */
#include "core/base/error.h"
#include "server/wire/json.h"

/* data_folder NULL: the daemon's own default. body is taken; NULL: none. The answer is the caller's, NULL where it is
 * empty. False: the daemon refused, or cannot be reached; err says why.
 *   errors  ERROR_NOT_FOUND  no daemon with --sign-in runs on this folder
 *           ERROR_IO, ERROR_FORMAT, ERROR_STATE (refused) */
NODISCARD bool control_call(const char *data_folder, const char *method, const char *path, cJSON *body, cJSON **answer,
                            struct error *err);

#pragma once
/* Lists that `beamroom user` and `beamroom token` print of a running daemon. */
#include "server/cli/account_words.h"
#include "server/cli/control.h"

/* Prints why, and returns the exit code. command: its name. */
int account_refused(const char *command, const struct error *err);
/* Prints each row of a list, or with --json the answer as it is; returns the exit code.
 *   path, list  of the call, and the name of the list in its answer */
int account_list(const struct account_words *words, const char *command, const char *path, const char *list,
                 void (*print)(const cJSON *row));

#pragma once
/* The subcommands of `beamroom`, one file each. They print and choose an exit code; the work is core's. */
#include "core/plan/plan.h"

enum exit_code { EXIT_DONE = 0, EXIT_REFUSED = 1, EXIT_USAGE = 2 };

/* argv[0] is the subcommand's name. */
int command_bench(int argc, char **argv);
int command_convert(int argc, char **argv);
int command_export(int argc, char **argv);
int command_info(int argc, char **argv);
int command_phantom(int argc, char **argv);
int command_render(int argc, char **argv);

/* "beamroom NAME: ...; see beamroom NAME --help" on standard error. Returns EXIT_USAGE. */
int command_usage_error(const char *name, const char *format, ...) PRINTF_LIKE(2, 3);
/* "beamroom NAME: ..." on standard error, without control characters. Returns EXIT_REFUSED. */
int command_refused(const char *name, const struct error *err);

/* Takes "--max-mib N" or "--max-mib=N" out of the words of any command: what opening a plan may take. false: said what
 * is wrong. */
NODISCARD bool command_take_limit(int *argc, char **argv);

/* The plan in a folder, its id made from the folder's name. NULL after saying why on standard error. */
NODISCARD struct plan *command_open_plan(const char *name, const char *folder);

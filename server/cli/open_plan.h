#pragma once
/* Opening a plan's folder for a subcommand, within the memory that --max-mib allows. */
#include "core/plan/plan.h"

/* Removes "--max-mib N" or "--max-mib=N" from the words of any subcommand: the memory that opening a plan may take, for
 * all later calls of command_open_plan. argv[0] is the subcommand's name. False after the usage error was printed. */
NODISCARD bool command_take_limit(int *argc, char **argv);

/* The plan in a folder, its id made from the folder's name; the caller's to destroy. NULL after the reason was printed
 * on standard error in the name of the subcommand. */
NODISCARD struct plan *command_open_plan(const char *name, const char *folder);

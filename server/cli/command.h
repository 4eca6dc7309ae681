#pragma once
/* The subcommands of `beamroom`, one file each. They print and choose an exit code; the work is core's. */

enum exit_code { EXIT_DONE = 0, EXIT_REFUSED = 1, EXIT_USAGE = 2 };

/* argv[0] is the subcommand's name. */
int command_phantom(int argc, char **argv);

/* "beamroom NAME: ...; see beamroom NAME --help" on standard error. Returns EXIT_USAGE. */
int command_usage_error(const char *name, const char *format, ...) __attribute__((format(printf, 2, 3)));

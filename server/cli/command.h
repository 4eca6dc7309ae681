#pragma once
/* The subcommands of `beamroom`, one file each. They parse words, print, and return an exit code (exit_code.h); the
 * work is core's. argv[0] is the subcommand's name. */
int command_bench(int argc, char **argv);
int command_convert(int argc, char **argv);
int command_export(int argc, char **argv);
int command_info(int argc, char **argv);
int command_phantom(int argc, char **argv);
int command_render(int argc, char **argv);
int command_token(int argc, char **argv);
int command_transport(int argc, char **argv);
int command_user(int argc, char **argv);

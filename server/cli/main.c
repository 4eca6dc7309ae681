/* `beamroom`: chooses the subcommand by the first word. */
#include <stdio.h>
#include <string.h>

#include "core/base/standard_files.h"
#include "server/cli/command.h"
#include "server/cli/exit_code.h"
#include "server/cli/open_plan.h"

static const struct command {
    const char *name, *about;
    int (*run)(int argc, char **argv);
} commands[] = {
    { "bench", "measure every way of showing the regions of plans", command_bench },
    { "convert", "write a plan of any format as a plan folder of our own", command_convert },
    { "export", "write the surface of a region as STL, PLY or GLB", command_export },
    { "info", "print what a plan holds and what was noticed while reading it", command_info },
    { "phantom", "write the demo plan, a made-up head", command_phantom },
    { "render", "draw one picture of a plan", command_render },
    { "token", "make, list and revoke tokens of scripts at a running daemon", command_token },
    { "transport", "compute the dose of a beam in a plan's regions", command_transport },
    { "user", "add, disable and list people who sign in at a running daemon", command_user },
};
enum { N_COMMANDS = sizeof commands / sizeof *commands };

static void print_help(FILE *out)
{
    fputs("usage: beamroom COMMAND [OPTION]...\n"
          "Works on boron neutron capture therapy plans without the daemon; manages who signs in there.\n\n",
          out);
    for (int i = 0; i < N_COMMANDS; i++)
        fprintf(out, "  %-10s %s\n", commands[i].name, commands[i].about);
    fputs("\n  beamroom COMMAND --help   what a command takes and gives\n"
          "  beamroom --version        the version\n"
          "  beamroom COMMAND ... --max-mib N   refuse a plan that would take more than N MiB to open\n\n"
          "Exit status: 0 done; 1 refused, with the reason on standard error; 2 wrong usage.\n"
          "For research and plan review; not a medical device.\n",
          out);
}

int main(int argc, char **argv)
{
    standard_files_fill();
    if (argc < 2) {
        print_help(stderr);
        return EXIT_USAGE;
    }
    if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0 || strcmp(argv[1], "help") == 0) {
        print_help(stdout);
        return EXIT_DONE;
    }
    if (strcmp(argv[1], "--version") == 0) {
        puts("beamroom " BEAMROOM_VERSION);
        return EXIT_DONE;
    }
    for (int i = 0; i < N_COMMANDS; i++)
        if (strcmp(argv[1], commands[i].name) == 0) {
            argc--;
            argv++;
            int code = command_take_limit(&argc, argv) ? commands[i].run(argc, argv) : EXIT_USAGE;
            if (fflush(stdout) != 0 || ferror(stdout)) {
                fprintf(stderr, "beamroom %s: standard output cannot be written\n", argv[0]);
                return EXIT_REFUSED;
            }
            return code;
        }
    fprintf(stderr, "beamroom: there is no command '%s'; see beamroom --help\n", argv[1]);
    return EXIT_USAGE;
}

/* `beamroom bench`: measures every way of showing every region of plans, and writes the page. */
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/file_write.h"
#include "core/base/mem.h"
#include "server/cli/bench_thesis.h"
#include "server/cli/command.h"
#include "server/cli/exit_code.h"
#include "server/cli/open_plan.h"
#include "server/cli/text.h"

enum { MAX_PLANS = 8, DEFAULT_REPEATS = 5, MAX_REPEATS = 100 };

struct bench_arguments {
    char **folders;
    int n_folders, n_repeats;
    const char *out; /* NULL: standard output */
    enum render_back_end back_end;
};

static void print_help(void)
{
    printf(
        "usage: beamroom bench --thesis DIR... [OPTION]...\n"
        "Shows every region of the plans in the folders DIR in every way there is, one after the other, and writes a page of figures\n"
        "(Markdown) beside those of the thesis on Sera3d: polygons, vertices, time to make and to draw, area, volume, distances.\n\n"
        "  -o, --output OUT  the page; standard output when left out\n"
        "  --repeat N        medians of N, 1 to %d (default %d)\n"
        "  --gl BACKEND      auto (default), egl-device, egl-surfaceless, osmesa or soft\n"
        "  --help            this text\n",
        MAX_REPEATS, DEFAULT_REPEATS);
}

/* False when there is nothing to measure; *code is then the exit code. */
static bool parse_arguments(int argc, char **argv, struct bench_arguments *arguments, int *code)
{
    static const struct option long_options[] = {
        { "thesis", no_argument, NULL, 't' },       { "output", required_argument, NULL, 'o' },
        { "repeat", required_argument, NULL, 'r' }, { "gl", required_argument, NULL, 'g' },
        { "help", no_argument, NULL, 'h' },         { NULL, 0, NULL, 0 }
    };
    bool is_thesis = false;
    char *end;
    *code = EXIT_USAGE;
    *arguments = (struct bench_arguments){ .n_repeats = DEFAULT_REPEATS, .back_end = RENDER_AUTO };
    opterr = 0;
    for (int option; (option = getopt_long(argc, argv, "ho:", long_options, NULL)) != -1;) {
        switch (option) {
        case 't': is_thesis = true; break;
        case 'o': arguments->out = optarg; break;
        case 'r':
            arguments->n_repeats = (int)strtol(optarg, &end, 10);
            if (*end || arguments->n_repeats < 1 || arguments->n_repeats > MAX_REPEATS)
                return command_usage_error("bench", "--repeat '%s' is not a number from 1 to %d", optarg, MAX_REPEATS),
                       false;
            break;
        case 'g':
            if (!render_back_end_from_word(optarg, &arguments->back_end))
                return command_usage_error("bench",
                                           "--gl '%s' is not auto, egl-device, egl-surfaceless, osmesa or soft",
                                           optarg),
                       false;
            break;
        case 'h':
            print_help();
            *code = EXIT_DONE;
            return false;
        default:
            return command_usage_error("bench", "'%s' is not an option or lacks its value", argv[optind - 1]), false;
        }
    }
    if (!is_thesis)
        return command_usage_error("bench", "what to measure is needed: --thesis"), false;
    if (optind == argc || argc - optind > MAX_PLANS)
        return command_usage_error("bench", "1 to %d folders of plans are needed, %d are given", MAX_PLANS,
                                   argc - optind),
               false;
    arguments->folders = argv + optind;
    arguments->n_folders = argc - optind;
    return true;
}

static bool write_page(const struct bench_arguments *arguments, const struct bench_machine *machine,
                       const struct bench_plan *plans, struct error *err)
{
    char *page = bench_page(machine, plans, (size_t)arguments->n_folders);
    if (!page)
        return error_set(err, ERROR_MEMORY, "no memory for the page");
    bool is_written = arguments->out ? file_write(arguments->out, (const uint8_t *)page, strlen(page), err)
                                     : fputs(page, stdout) >= 0;
    free(page);
    return is_written;
}

int command_bench(int argc, char **argv)
{
    struct bench_arguments arguments;
    struct error err = { 0 };
    int code;
    if (!parse_arguments(argc, argv, &arguments, &code))
        return code;
    struct renderer *renderer = renderer_create(arguments.back_end, &err);
    if (!renderer)
        return command_refused("bench", &err);
    struct bench_machine machine;
    bench_machine_look(&machine, renderer_facts(renderer));
    struct bench_plan plans[MAX_PLANS] = { { .name = "" } };
    bool is_measured = true;
    for (int i = 0; is_measured && i < arguments.n_folders; i++) {
        struct plan *plan = command_open_plan("bench", arguments.folders[i]);
        struct derive *derived = plan ? derive_create(plan) : NULL;
        is_measured = plan && bench_measure(derived, renderer, arguments.n_repeats, &plans[i], &err);
        if (plan)
            renderer_forget(renderer, plan);
        derive_destroy(derived);
        plan_destroy(plan);
    }
    if (is_measured)
        is_measured = write_page(&arguments, &machine, plans, &err);
    for (int i = 0; i < arguments.n_folders; i++)
        bench_plan_finish(&plans[i]);
    renderer_destroy(renderer);
    if (is_measured)
        return EXIT_DONE;
    return err.code == ERROR_NONE ? EXIT_REFUSED : command_refused("bench", &err);
}

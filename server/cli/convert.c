#include <getopt.h>
#include <stdio.h>

#include "core/base/clock.h"
#include "core/plan/plan_write.h"
#include "server/cli/command.h"
#include "server/cli/text.h"

static void print_help(void)
{
    fputs("usage: beamroom convert DIR OUT\n"
          "Opens the plan in the folder DIR, whatever its files are, and writes it as a plan folder of Beamroom's own into the new\n"
          "folder OUT: images, regions and doses as NIfTI, the names and colours of regions, beams and tracks, and a plan.json that\n"
          "names it all. Opened again it is the same plan.\n\n"
          "  --help   this text\n\n"
          "Voxel values stay as they are; NIfTI-2 is written where the 32-bit numbers of NIfTI-1 would move a voxel by more than\n"
          "1e-7 mm. Regions that overlap go into several label maps. What was noticed while reading is printed, not written.\n",
          stdout);
}

static void print_noticed(const struct report *report)
{
    size_t n_of[3] = { 0 };
    for (size_t i = 0; i < report->n_lines; i++)
        n_of[report->lines[i].severity]++;
    if (report->n_lines > 0)
        printf("  noticed: %zu errors, %zu warnings, %zu notes; beamroom info lists them\n", n_of[REPORT_ERROR], n_of[REPORT_WARNING],
               n_of[REPORT_NOTE]);
}

static void print_done(const struct plan *plan, const char *out, double seconds)
{
    size_t n_components = 0;
    for (size_t i = 0; i < plan->n_doses; i++)
        n_components += plan->doses[i].n_components;
    text_print(stdout, out, 0);
    printf(": %zu images, %zu regions, %zu dose components, %zu beams, %zu track segments, written in %.2f s\n", plan->n_images,
           plan->regions.n_regions, n_components, plan->n_beams, plan->tracks.n_segments, seconds);
    print_noticed(&plan->report);
}

int command_convert(int argc, char **argv)
{
    static const struct option long_options[] = { { "help", no_argument, NULL, 'h' }, { NULL, 0, NULL, 0 } };
    opterr = 0;
    for (int option; (option = getopt_long(argc, argv, "h", long_options, NULL)) != -1;) {
        if (option != 'h')
            return command_usage_error("convert", "'%s' is not an option", argv[optind - 1]);
        print_help();
        return EXIT_DONE;
    }
    if (argc - optind != 2)
        return command_usage_error("convert", "the plan's folder and a new folder are needed, %d words are given", argc - optind);
    struct plan *plan = command_open_plan("convert", argv[optind]);
    if (!plan)
        return EXIT_REFUSED;
    struct error err = { 0 };
    int64_t began_us = clock_now_us();
    bool is_written = plan_write(plan, argv[optind + 1], &err);
    if (is_written)
        print_done(plan, argv[optind + 1], (double)(clock_now_us() - began_us) / 1e6);
    plan_destroy(plan);
    return is_written ? EXIT_DONE : command_refused("convert", &err);
}

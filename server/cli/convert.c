/* `beamroom convert`: writes a plan of any format as a plan folder of our own. */
#include <getopt.h>
#include <stdio.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/load/write_plan.h"
#include "server/cli/command.h"
#include "server/cli/exit_code.h"
#include "server/cli/open_plan.h"
#include "server/cli/text.h"

static void print_help(void)
{
    fputs(
        "usage: beamroom convert DIR OUT\n"
        "Opens the plan in the folder DIR, whatever its files are, and writes it as a plan folder of Beamroom's own into the new\n"
        "folder OUT: images, regions and doses as NIfTI, the names and colours of regions, beams, tracks, depth curves and\n"
        "preferences, and a plan.json that names it all. Opened again it is the same plan.\n\n"
        "  --help   this text\n\n"
        "Voxel values stay as they are; NIfTI-2 is written where the 32-bit numbers of NIfTI-1 would move a voxel by more than\n"
        "1e-7 mm. Regions that overlap go into several label maps. What of DIR is not in OUT is said, by name, on standard error.\n"
        "Not part of any plan, and so never in OUT: contours as they were drawn (regions are their voxels), a beam's control points,\n"
        "who the patient is, and what was noticed while reading.\n",
        stdout);
}

/* True if the line reports something that the folder holds and the plan does not. */
static bool is_about_loss(const struct report_line *line)
{
    static const char *const codes[] = { "plan.ignored-file",
                                         "plan.too-many-files",
                                         "file.not-read",
                                         "part.unreadable",
                                         "dicom.unreadable",
                                         "dicom.not-used",
                                         "dicom.duplicate",
                                         "dicom.too-many",
                                         "image.frames-left-out",
                                         "region.surroundings",
                                         "region.absent",
                                         "region.unused-names",
                                         "region.contours-left-out",
                                         "hierarchy.cycle",
                                         "hierarchy.line",
                                         "region.none",
                                         "dose.all-zero",
                                         "dose.left-out",
                                         "dose.weight-zero",
                                         "beam.left-out",
                                         "curve.unread",
                                         "preferences.unread",
                                         "preferences.levels",
                                         "tracks.unsupported",
                                         "tracks.zero-length",
                                         "tracks.bad-lines",
                                         "tracks.far",
                                         "plan.unknown-key",
                                         "beam.moves",
                                         "beam.arc",
                                         "region.contours-refused",
                                         "dose.unsupported",
                                         "dose.unknown-column",
                                         "dose.mask-unread",
                                         "image.slices-repeated",
                                         "preferences.map",
                                         "write.labels-cleared",
                                         "write.does-not-fit" };
    bool is_one = line->severity == REPORT_ERROR;
    for (size_t i = 0; i < sizeof codes / sizeof codes[0]; i++)
        is_one |= strcmp(line->code, codes[i]) == 0;
    return is_one;
}

static void print_lost(const struct report *report)
{
    for (size_t i = 0; i < report->n_lines; i++) {
        const struct report_line *line = &report->lines[i];
        if (!is_about_loss(line))
            continue;
        fputs("not carried over: ", stderr);
        text_print(stderr, line->where, 0);
        fputs(line->where[0] ? ": " : "", stderr);
        text_print(stderr, line->sentence, 0);
        fputc('\n', stderr);
    }
    if (report->n_dropped > 0)
        fprintf(stderr, "not carried over: maybe more; the report was full, and %zu of its lines are not kept\n",
                report->n_dropped);
}

static void print_noticed(const struct report *report)
{
    size_t n_of[3] = { 0 };
    for (size_t i = 0; i < report->n_lines; i++)
        n_of[report->lines[i].severity]++;
    if (report->n_lines > 0)
        printf("  noticed: %zu errors, %zu warnings, %zu notes; beamroom info lists them\n", n_of[REPORT_ERROR],
               n_of[REPORT_WARNING], n_of[REPORT_NOTE]);
}

static void print_done(const struct plan *plan, const char *out, double seconds)
{
    size_t n_components = 0;
    for (size_t i = 0; i < plan->n_doses; i++)
        n_components += plan->doses[i].n_components;
    text_print(stdout, out, 0);
    printf(
        ": %zu images, %zu regions, %zu dose components, %zu beams, %zu track segments, %zu depth curves, %zu isodose levels, %zu "
        "colours, written in %.2f s\n",
        plan->n_images, plan->regions.n_regions, n_components, plan->n_beams, plan->tracks.n_segments, plan->n_curves,
        plan->preferences.n_levels, plan->preferences.n_colors, seconds);
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
        return command_usage_error("convert", "the plan's folder and a new folder are needed, %d words are given",
                                   argc - optind);
    struct plan *plan = command_open_plan("convert", argv[optind]);
    if (!plan)
        return EXIT_REFUSED;
    struct error err = { 0 };
    struct report lost = { 0 };
    int64_t began_us = clock_now_us();
    bool is_written = plan_write(plan, argv[optind + 1], &lost, &err);
    if (is_written) {
        print_done(plan, argv[optind + 1], (double)(clock_now_us() - began_us) / 1e6);
        print_lost(&plan->report);
        print_lost(&lost);
    }
    report_finish(&lost);
    plan_destroy(plan);
    return is_written ? EXIT_DONE : command_refused("convert", &err);
}

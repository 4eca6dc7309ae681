/* `beamroom info`: prints what a plan holds and its report. */
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/dose/weights.h"
#include "core/plan/fit.h"
#include "server/cli/command.h"
#include "server/cli/exit_code.h"
#include "server/cli/info_origins.h"
#include "server/cli/open_plan.h"
#include "server/cli/text.h"
#include "server/wire/plan_document.h"
#include "server/wire/plan_origins.h"

enum { LINE_LETTERS = 96, NAME_LETTERS = 34, ID_LETTERS = 12 };

static void print_help(void)
{
    fputs(
        "usage: beamroom info DIR [--json] [--identity]\n"
        "Opens the plan in the folder DIR and prints what it holds: patients, treatment plans, images, regions and what\n"
        "lies inside what, doses, beams, particle tracks, and everything noticed while reading.\n\n"
        "  --json       the same as one JSON object, as the daemon's API gives it\n"
        "  --identity   patients by name, ID and birth date; without it they are masked\n"
        "  --help       this text\n\n"
        "Points and lengths are millimetres toward the patient's left, back and top (LPS).\n",
        stdout);
}

static void print_grid(const struct grid *grid)
{
    struct vec3 spacing = grid_spacing_mm(grid);
    char letters[4], size[40], step[60];
    grid_letters(grid, letters);
    snprintf(size, sizeof size, "%u x %u x %u", grid->size[0], grid->size[1], grid->size[2]);
    snprintf(step, sizeof step, "%.4g x %.4g x %.4g mm", spacing.x, spacing.y, spacing.z);
    printf("  %-16s %-26s %s", size, step, letters);
}

static void print_images(const struct plan *plan)
{
    if (plan->n_images == 0)
        return;
    printf("\nImages\n");
    for (size_t i = 0; i < plan->n_images; i++) {
        const struct plan_image *image = &plan->images[i];
        printf("  ");
        text_print(stdout, image->id, ID_LETTERS);
        if (strlen(image->id) > ID_LETTERS)
            printf("\n%*s", 2 + ID_LETTERS, ""); /* the columns go on in the next line */
        printf(" ");
        text_print(stdout, image->modality, 4);
        print_grid(&image->volume->grid);
        printf("  %.6g to %.6g%s", image->volume->low, image->volume->high, *image->unit ? " " : "");
        text_print(stdout, image->unit, 0);
        printf("%s\n", image->is_inverted ? ", low values white" : "");
    }
}

static void print_region(const struct region_set *set, size_t index)
{
    const struct region *region = &set->regions[index];
    int depth = region_depth(set, index), indent = 2 + 2 * (depth < 8 ? depth : 8);
    printf("%*s", indent, "");
    text_print(stdout, region->name, NAME_LETTERS - indent);
    printf("  %10.2f", region->volume_cm3);
    text_print_count(stdout, region->n_voxels, 14);
    if (region->n_voxels > 0)
        printf("  (%6.1f, %6.1f, %6.1f)", region->centre_lps_mm.x, region->centre_lps_mm.y, region->centre_lps_mm.z);
    printf("%s%s\n", region->n_voxels == 0 ? "  empty" : "", region->touches_edge ? "  cut" : "");
}

/* Prints each region below its parent; siblings in file order. */
static void print_regions_in(const struct region_set *set, int parent)
{
    for (size_t i = 0; i < set->n_regions; i++)
        if (set->regions[i].parent == parent) {
            print_region(set, i);
            print_regions_in(set, (int)i);
        }
}

static void print_regions(const struct region_set *set)
{
    static const char *const source[] = { [HIERARCHY_NONE] = "",
                                          [HIERARCHY_FILE] = ", inside each other as the plan says",
                                          [HIERARCHY_DERIVED] = ", inside each other as derived" };
    if (set->n_regions == 0)
        return;
    printf("\n%zu region%s%s\n%*s  %10s%14s  %s\n", set->n_regions, set->n_regions == 1 ? "" : "s",
           source[set->hierarchy], NAME_LETTERS, "", "cm3", "univels", "centre, mm");
    print_regions_in(set, -1);
    for (size_t i = 0; i < set->n_regions; i++)
        if (set->regions[i].touches_edge) {
            printf("  cut: reaches the edge of the scan, so the region may go on beyond it\n");
            break;
        }
}

/* Whether the dose may lie on the image, and what its total lacks. */
static void print_fit(const struct plan *plan, size_t index)
{
    const struct dose *dose = &plan->doses[index];
    static const char *const until[] = { [FIT_NEEDS_NOTHING] = "",
                                         [FIT_NEEDS_ACCEPTANCE] = " It is drawn once a person accepts it.",
                                         [FIT_NEEDS_NEVER] = "" };
    struct fit_part part = { FIT_DOSE, index };
    for (size_t i = 0; i < plan->n_images; i++) {
        char why[FIT_WHY_SIZE];
        struct fit_part image = { FIT_IMAGE, i };
        struct fit fit = fit_of(plan, part, image);
        fit_sentence(plan, part, image, fit.relation, why);
        char line[FIT_WHY_SIZE + 80];
        snprintf(line, sizeof line, "fit %s: %s%s", fit_relation_word(fit.relation), why, until[fit_pair_needs(&fit)]);
        text_print_wrapped(stdout, line, 2, 100);
    }
    uint32_t missing = dose_missing_summands(dose);
    bool has_summands = false;
    for (size_t c = 0; c < dose->n_components; c++)
        has_summands |= dose_is_summand(dose->components[c].quantity);
    for (int q = 0, n = 0; has_summands && q < DOSE_N_QUANTITIES; q++)
        if (missing >> q & 1)
            printf("%s%s", n++ ? ", " : "  its weighted total is without ", dose_quantity_word((enum dose_quantity)q));
    printf("%s", has_summands && missing ? "\n" : "");
}

static void print_doses(const struct plan *plan)
{
    for (size_t i = 0; i < plan->n_doses; i++) {
        const struct dose *dose = &plan->doses[i];
        printf("\nDose ");
        text_print(stdout, dose->id, 0);
        if (*dose->name) {
            printf(" \"");
            text_print(stdout, dose->name, 0);
            printf("\"");
        }
        printf(", ");
        text_print(stdout, *dose->unit ? dose->unit : "no unit given", 0);
        printf(" per ");
        text_print(stdout, *dose->per ? dose->per : "(not said)", 0);
        printf("%s", dose->mask ? ", with a mask of where it is valid" : "");
        if (dose->has_frame && dose->frame != DOSE_FRAME_SAME)
            printf(", frame of reference %s",
                   dose->frame == DOSE_FRAME_DIFFERS ? "differs from the image's" : "unknown");
        printf("\n");
        print_fit(plan, i);
        for (size_t c = 0; c < dose->n_components; c++) {
            const struct dose_component *component = &dose->components[c];
            char unit[DOSE_UNIT_SIZE];
            dose_unit_of(dose, component->quantity, unit);
            printf("  %-19s%-8s", dose_quantity_word(component->quantity), component->is_per_ppm ? " per ppm" : "");
            print_grid(&component->values->grid);
            printf("  %.4g to %.4g", component->values->low, component->values->high);
            if (strcmp(unit, dose->unit) != 0)
                printf(" %s", unit);
            if (component->has_boron_ppm)
                printf(", with boron at %g ppm", component->boron_ppm);
            double body = dose->body_high[component->quantity], reference = dose->reference[component->quantity];
            if (body > 0 || reference > 0)
                printf("\n     ");
            if (body > 0)
                printf(" in the regions up to %.4g%s", body, reference > 0 ? ";" : "");
            if (reference > 0)
                printf(" 100 %% is %.4g", reference);
            printf("\n");
        }
    }
}

static void print_if_given(const char *what, double value, const char *unit)
{
    if (isfinite(value))
        printf("  %s %.5g %s", what, value, unit);
}

/* Prints the treatment machine's settings of a beam, in one or two lines. */
static void print_delivery(const struct beam *beam)
{
    const struct beam_delivery *d = &beam->delivery;
    printf("    ");
    text_print(stdout, beam->name, 0);
    printf("%s", *beam->name ? ": " : "");
    text_print(stdout, *d->radiation ? d->radiation : "radiation not said", 0);
    if (*d->machine) {
        printf(" by ");
        text_print(stdout, d->machine, 0);
    }
    print_if_given("energy", d->energy_mev, "MeV");
    printf("\n  ");
    print_if_given("gantry", d->gantry_deg, "deg");
    if (isfinite(d->gantry_travel_deg) && d->gantry_travel_deg != 0)
        print_if_given("to", d->gantry_stop_deg, "deg");
    print_if_given("couch", d->couch_deg, "deg");
    print_if_given("collimator", d->collimator_deg, "deg");
    printf("  position %s\n    %zu control points", patient_position_word(d->patient_position), d->n_control_points);
    print_if_given("source to axis", d->sad_mm, "mm");
    if (isfinite(d->opening_x_mm[0]) && isfinite(d->opening_y_mm[0]))
        printf("  opening %.4g x %.4g mm", d->opening_x_mm[1] - d->opening_x_mm[0],
               d->opening_y_mm[1] - d->opening_y_mm[0]);
    if (isfinite(d->dose_gy) || isfinite(d->meterset))
        printf("\n  ");
    print_if_given("dose", d->dose_gy, "Gy a fraction");
    print_if_given("meterset", d->meterset, d->meterset_unit);
    printf("\n");
}

static void print_beams(const struct plan *plan)
{
    if (plan->n_beams > 0)
        printf("\nBeams\n");
    for (size_t i = 0; i < plan->n_beams; i++) {
        const struct beam *beam = &plan->beams[i];
        struct vec3 entry = beam->entry_lps_mm, target = beam->target_lps_mm;
        printf("  ");
        text_print(stdout, beam->id, 12);
        printf("  from (%.1f, %.1f, %.1f) to (%.1f, %.1f, %.1f)", entry.x, entry.y, entry.z, target.x, target.y,
               target.z);
        if (isfinite(beam->aperture_mm))
            printf(", aperture %.4g mm\n", beam->aperture_mm);
        else
            printf("%s\n", beam->has_delivery ? "" : ", aperture unknown");
        if (beam->has_delivery)
            print_delivery(beam);
    }
}

static void print_tracks(const struct track_set *tracks)
{
    if (tracks->n_segments == 0)
        return;
    printf("\nParticle tracks, ");
    text_print_count(stdout, tracks->n_segments, 0);
    printf(" segments\n");
    for (int class = 0; class < TRACK_N_CLASSES; class ++)
        if (tracks->n_of_class[class] > 0) {
            printf("  %-15s", track_class_word((enum track_class) class));
            text_print_count(stdout, tracks->n_of_class[class], 9);
            printf("\n");
        }
}

static void print_curves(const struct plan *plan)
{
    for (size_t i = 0; i < plan->n_curves; i++) {
        const struct dose_curve *curve = &plan->curves[i];
        printf("\nCurve ");
        text_print(stdout, curve->id, 0);
        printf(", %s per ", curve->unit);
        text_print(stdout, curve->per, 0);
        printf(", depth %.4g to %.4g mm, radius %.4g to %.4g mm\n", curve->depths_mm[0],
               curve->depths_mm[curve->n_depths - 1], curve->radii_mm[0], curve->radii_mm[curve->n_radii - 1]);
        for (size_t c = 0; c < curve->n_columns; c++) {
            char unit[DOSE_UNIT_SIZE];
            double depth, value;
            dose_quantity_unit(curve->unit, curve->quantities[c], unit);
            printf("  %-19s%-8s", dose_quantity_word(curve->quantities[c]), curve->is_per_ppm[c] ? " per ppm" : "");
            if (dose_curve_peak(curve, c, &depth, &value))
                printf("  at most %.4g %s on the axis, %.4g mm deep", value, unit, depth);
            printf("\n");
        }
    }
}

static void print_preferences(const struct plan_preferences *preferences)
{
    if (preferences->n_levels > 0)
        printf("\nContour levels\n ");
    for (size_t i = 0; i < preferences->n_levels; i++)
        printf(" %.4g %% #%02x%02x%02x%s", preferences->levels[i].percent, preferences->levels[i].rgb[0],
               preferences->levels[i].rgb[1], preferences->levels[i].rgb[2],
               i + 1 == preferences->n_levels ? "\n"
               : i % 6 == 5                   ? ",\n "
                                              : ",");
}

static void print_report(const struct report *report)
{
    if (report->n_lines == 0)
        return;
    printf("\nNoticed while reading\n");
    for (size_t i = 0; i < report->n_lines; i++) {
        const struct report_line *line = &report->lines[i];
        printf("  %s %s  ", report_severity_word(line->severity), line->code);
        text_print(stdout, line->where, 0);
        printf("\n");
        text_print_wrapped(stdout, line->sentence, 4, LINE_LETTERS);
    }
    if (report->n_dropped > 0)
        printf("  and %zu more\n", report->n_dropped);
}

static void print_plan(const struct plan *plan, bool is_full)
{
    text_print(stdout, *plan->name ? plan->name : plan->id, 0);
    printf("%s\n", plan->is_phantom ? "  [phantom, made up]" : "");
    text_print_wrapped(stdout, plan->note, 2, LINE_LETTERS);
    printf("  read in %.0f ms\n", (double)plan->load_us / 1000);
    info_print_origins(plan, is_full);
    print_images(plan);
    print_regions(&plan->regions);
    print_doses(plan);
    print_beams(plan);
    print_tracks(&plan->tracks);
    print_curves(plan);
    print_preferences(&plan->preferences);
    print_report(&plan->report);
}

static void print_json(const struct plan *plan, bool is_full)
{
    cJSON *document = plan_document(plan);
    if (is_full)
        json_add(document, "identity", plan_identity(plan));
    char *text = json_write(document);
    cJSON_Delete(document);
    puts(text);
    free(text);
}

int command_info(int argc, char **argv)
{
    static const struct option long_options[] = { { "json", no_argument, NULL, 'j' },
                                                  { "identity", no_argument, NULL, 'i' },
                                                  { "help", no_argument, NULL, 'h' },
                                                  { NULL, 0, NULL, 0 } };
    bool is_json = false, is_full = false;
    opterr = 0;
    for (int option; (option = getopt_long(argc, argv, "h", long_options, NULL)) != -1;) {
        switch (option) {
        case 'j': is_json = true; break;
        case 'i': is_full = true; break;
        case 'h': print_help(); return EXIT_DONE;
        default: return command_usage_error("info", "'%s' is not an option", argv[optind - 1]);
        }
    }
    if (argc - optind != 1)
        return command_usage_error("info", "one folder is needed, %d are given", argc - optind);
    struct plan *plan = command_open_plan("info", argv[optind]);
    if (!plan)
        return EXIT_REFUSED;
    if (is_json)
        print_json(plan, is_full);
    else
        print_plan(plan, is_full);
    plan_destroy(plan);
    return EXIT_DONE;
}

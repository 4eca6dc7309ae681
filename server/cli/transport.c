/* `beamroom transport`: computes the dose of a beam in a plan's regions. */
#include <getopt.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "core/base/parallel.h"
#include "core/load/write_plan.h"
#include "server/cli/command.h"
#include "server/cli/exit_code.h"
#include "server/cli/open_plan.h"
#include "server/cli/text.h"
#include "server/cli/transport_parts.h"

enum { LIST_NEUTRONS = 400000, LIST_PHOTONS = 32000 };

struct words {
    const char *plan, *out, *beam;
    bool has_entry, has_target, is_sera_cells;
    struct vec3 entry_lps_mm, target_lps_mm;
    uint64_t n_histories, seed;
    enum transport_mode mode;
    double cell_mm;           /* 0: not said */
    double neutrons_per_unit; /* of a file of particles; 0: not given */
};
struct beam_read {
    struct beam_file file;
    struct beam_particles particles; /* none: the file has a source */
};

static void print_help(void)
{
    printf(
        "usage: beamroom transport DIR -o OUT [--beam FILE] [--entry X,Y,Z --target X,Y,Z] [--histories N]\n"
        "Computes the dose of a neutron beam in the regions of the plan in DIR by Monte Carlo, and writes the plan with that dose\n"
        "as its last into the new folder OUT. Approximate, not for treatment: docs/live-dose.md has its validation and limits.\n\n"
        "  -o OUT               a new folder\n"
        "  --beam FILE          a beam file (\"beamroom-beam\"), or a beam of the library: %s\n"
        "                       (default: DIR/beam.json, else goorley); or particles: .mcpl, .mcpl.gz, .IAEAheader\n"
        "  --neutrons-per-unit N  real neutrons that a file of particles stands for, for each unit of the source\n"
        "  --entry X,Y,Z        centre of the aperture, mm, patient LPS (default: the beam file's, else the beam file's\n"
        "                       distance from the source of the plan's first beam, unless a treatment plan gave that)\n"
        "  --target X,Y,Z       a point the beam's axis goes through\n"
        "  --histories N        neutrons that are followed, 16 to 1e11 (default 1000000); the error falls with their root\n"
        "  --seed N             of the random numbers (default 1); equal input gives equal files\n"
        "  --mode full|hybrid   full (default): every neutron is followed to its end; hybrid: farther than 1 cm from air slow\n"
        "                       neutrons diffuse, which is faster and within 2 %% of it\n"
        "  --cells MM           side of the cells, 1 to 50 (default 5); what is not air counts\n"
        "  --sera-cells         instead of them those of the plan's first dose, tallied whole, air included, as seraMC does\n"
        "  --help               this text\n",
        transport_library_names());
}

static bool parse_point(const char *text, struct vec3 *point)
{
    double values[3];
    for (int i = 0; i < 3; i++) {
        char *end;
        values[i] = strtod(text, &end);
        if (end == text || !(values[i] >= -1e4 && values[i] <= 1e4) || *end != (i < 2 ? ',' : '\0'))
            return false;
        text = end + 1;
    }
    *point = vec3(values[0], values[1], values[2]);
    return true;
}

/* A whole number, "4e6" too. */
static bool parse_count(const char *text, double low, double high, uint64_t *count)
{
    char *end;
    double value = strtod(text, &end);
    if (end == text || *end || !(value >= low && value <= high) || (double)(uint64_t)value != value)
        return false;
    *count = (uint64_t)value;
    return true;
}

static bool parse_mm(const char *text, double low, double high, double *mm)
{
    char *end;
    *mm = strtod(text, &end);
    return end != text && !*end && *mm >= low && *mm <= high;
}

/* 0, or the exit status after a usage error. */
static int take_option(struct words *words, int option, const char *word)
{
    char *end;
    switch (option) {
    case 'o': words->out = optarg; return 0;
    case 'b': words->beam = optarg; return 0;
    case 'p':
        words->neutrons_per_unit = strtod(optarg, &end);
        return end != optarg && !*end && words->neutrons_per_unit >= 1e-30 && words->neutrons_per_unit <= 1e30
                   ? 0
                   : command_usage_error("transport", "--neutrons-per-unit '%s' is not a number from 1e-30 to 1e30",
                                         optarg);
    case 'c': words->is_sera_cells = true; return 0;
    case 'e':
        words->has_entry = true;
        return parse_point(optarg, &words->entry_lps_mm)
                   ? 0
                   : command_usage_error("transport", "--entry '%s' is not of the form X,Y,Z, mm", optarg);
    case 't':
        words->has_target = true;
        return parse_point(optarg, &words->target_lps_mm)
                   ? 0
                   : command_usage_error("transport", "--target '%s' is not of the form X,Y,Z, mm", optarg);
    case 'n':
        return parse_count(optarg, 16, 1e11, &words->n_histories)
                   ? 0
                   : command_usage_error("transport", "--histories '%s' is not a whole number from 16 to 1e11", optarg);
    case 'w':
        return parse_mm(optarg, 1, 50, &words->cell_mm)
                   ? 0
                   : command_usage_error("transport", "--cells '%s' is not a number from 1 to 50, mm", optarg);
    case 's':
        return parse_count(optarg, 0, 9e15, &words->seed)
                   ? 0
                   : command_usage_error("transport", "--seed '%s' is not a whole number from 0 to 9e15", optarg);
    case 'm':
        words->mode = strcmp(optarg, "hybrid") == 0 ? TRANSPORT_HYBRID : TRANSPORT_FULL;
        return words->mode == TRANSPORT_HYBRID || strcmp(optarg, "full") == 0
                   ? 0
                   : command_usage_error("transport", "--mode is \"%s\", expected full or hybrid", optarg);
    default: return command_usage_error("transport", "'%s' is not an option or lacks its value", word);
    }
}

static int take_words(struct words *words, int argc, char **argv)
{
    static const struct option long_options[] = { { "beam", required_argument, NULL, 'b' },
                                                  { "entry", required_argument, NULL, 'e' },
                                                  { "target", required_argument, NULL, 't' },
                                                  { "histories", required_argument, NULL, 'n' },
                                                  { "seed", required_argument, NULL, 's' },
                                                  { "neutrons-per-unit", required_argument, NULL, 'p' },
                                                  { "mode", required_argument, NULL, 'm' },
                                                  { "sera-cells", no_argument, NULL, 'c' },
                                                  { "cells", required_argument, NULL, 'w' },
                                                  { "help", no_argument, NULL, 'h' },
                                                  { NULL, 0, NULL, 0 } };
    opterr = 0;
    for (int option; (option = getopt_long(argc, argv, "ho:", long_options, NULL)) != -1;) {
        if (option == 'h') {
            print_help();
            return -1;
        }
        int status = take_option(words, option, argv[optind - 1]);
        if (status != 0)
            return status;
    }
    if (argc - optind != 1 || !words->out)
        return command_usage_error("transport", "one folder and -o OUT are needed, %d words are given", argc - optind);
    if (words->has_entry != words->has_target)
        return command_usage_error("transport", "--entry and --target belong together");
    if (words->cell_mm > 0 && words->is_sera_cells)
        return command_usage_error("transport", "--cells and --sera-cells are of different cells");
    if (words->mode == TRANSPORT_HYBRID && (words->is_sera_cells || (words->cell_mm > 0 && words->cell_mm != 5)))
        return command_usage_error("transport",
                                   "--cells and --sera-cells need --mode full: hybrid mode has cells of 5 mm");
    words->plan = argv[optind];
    return 0;
}

/* DIR/beam.json if it is there, else the library's. */
static bool read_beam(const struct words *words, struct beam_read *beam, struct error *err)
{
    if (words->beam)
        return transport_read_beam(words->beam, &beam->file, &beam->particles, err);
    char path[4096];
    snprintf(path, sizeof path, "%s/beam.json", words->plan);
    if (transport_read_beam(path, &beam->file, &beam->particles, err))
        return true;
    if (err->code != ERROR_NOT_FOUND)
        return false;
    *err = (struct error){ 0 };
    return transport_read_beam("goorley", &beam->file, &beam->particles, err);
}

static bool take_strength(const struct words *words, struct beam_file *file, struct error *err)
{
    struct beam_file_particles *particles = &file->particles;
    bool is_said = particles->neutrons_per_unit + particles->histories_per_unit > 0;
    if (words->neutrons_per_unit > 0 && !particles->path[0])
        return error_set(err, ERROR_STATE, "--neutrons-per-unit is for files of particles, and the beam is none");
    if (words->neutrons_per_unit > 0) {
        particles->neutrons_per_unit = words->neutrons_per_unit;
        particles->histories_per_unit = 0;
    } else if (particles->path[0] && !is_said)
        return error_set(
            err, ERROR_NOT_FOUND,
            "%.100s does not say how many real neutrons it stands for; --neutrons-per-unit does, or a beam "
            "file with \"particles\"",
            particles->path);
    return true;
}

static bool take_pose(const struct words *words, const struct plan *plan, struct beam_file *file, struct error *err)
{
    if (words->has_entry) {
        file->entry_lps_mm = words->entry_lps_mm;
        file->target_lps_mm = words->target_lps_mm;
    } else if (!file->has_pose && file->particles.path[0])
        return error_set(
            err, ERROR_NOT_FOUND,
            "a file of particles does not say where its aperture is in the patient; --entry and --target do");
    else if (!file->has_pose && plan->n_beams > 0) {
        if (!transport_pose_of_beam(plan, 0, file, err))
            return false;
    } else if (!file->has_pose)
        return error_set(err, ERROR_NOT_FOUND,
                         "neither the beam's file nor the plan says where the beam is; --entry and --target do");
    return vec3_length(vec3_sub(file->target_lps_mm, file->entry_lps_mm)) > 1e-3 ||
           error_set(err, ERROR_RANGE, "entry and target are the same point");
}

/* The cells of the plan's first dose if they are wanted. What the dose refers to does not matter, but for its patient,
 * frame and place. */
static bool take_cells(const struct words *words, const struct plan *plan, const struct grid **cells, struct error *err)
{
    *cells = NULL;
    if (!words->is_sera_cells)
        return true;
    if (plan->n_doses == 0 || plan->doses[0].n_components == 0)
        return error_set(err, ERROR_NOT_FOUND, "--sera-cells: the plan has no dose whose cells could be taken");
    struct fit_part dose = { FIT_DOSE, 0 }, region = fit_part_of_region(plan, (size_t)transport_first_region(plan));
    struct fit fit = fit_of(plan, dose, region);
    if (fit.reasons & (1U << FIT_PATIENT | 1U << FIT_FRAME | 1U << FIT_APART))
        return transport_fits(plan, dose, err);
    *cells = &plan->doses[0].components[0].values->grid;
    return true;
}

static bool write(const struct words *words, const struct plan *plan, struct error *err)
{
    struct report lost = { 0 };
    bool is_written = plan_write(plan, words->out, &lost, err);
    transport_print_report(&lost);
    report_finish(&lost);
    return is_written;
}

static void print_result(const struct transport_result *result, const char *out)
{
    const struct volume *boron = result->values[TRANSPORT_BORON], *error = result->errors[TRANSPORT_BORON];
    double sum = 0, n = 0;
    for (size_t i = 0; i < grid_n_voxels(&boron->grid); i++) {
        double value = (double)((const float *)boron->voxels)[i];
        if (value > .5 * boron->high) {
            sum += (double)((const float *)error->voxels)[i] / value;
            n++;
        }
    }
    text_print(stdout, out, 0);
    printf(": %" PRIu64
           " histories in %.1f s, %.0f a second; boron's error is %.1f %% on average where it is above half of its "
           "maximum\n",
           result->n_histories, result->seconds, (double)result->n_histories / result->seconds,
           n > 0 ? 100 * sum / n : 0);
    printf(
        "of 100 neutrons that reach the patient's box %.1f leave it and %.1f are absorbed; %.1f of the beam miss it\n",
        100 * result->balance.leaked, 100 * result->balance.absorbed, 100 * result->balance.missed);
    puts("approximate, not for treatment");
}

static bool make_list(struct phase_space *list, const struct words *words, const struct beam_read *beam, int n_threads,
                      struct error *err)
{
    size_t n = words->n_histories < LIST_NEUTRONS ? (size_t)words->n_histories : LIST_NEUTRONS;
    if (beam->file.particles.path[0])
        return transport_list_of_particles(list, &beam->file, &beam->particles, n, LIST_PHOTONS, words->seed, err);
    return phase_space_of_source(list, &beam->file.source, n, LIST_PHOTONS, words->seed, n_threads, NULL, err);
}

static bool simulate(const struct words *words, struct plan *plan, const struct beam_read *read,
                     const struct transport_scene *scene, struct error *err)
{
    const struct beam_file *file = &read->file;
    struct phase_space beam;
    struct transport_result result;
    const struct grid *cells;
    if (!take_cells(words, plan, &cells, err))
        return false;
    int n_threads = parallel_cores();
    if (!make_list(&beam, words, read, n_threads, err))
        return false;
    struct vec3 along = vec3_sub(file->target_lps_mm, file->entry_lps_mm);
    struct transport_input input = { .mode = words->mode,
                                     .grid = scene->grid,
                                     .voxels = scene->voxels,
                                     .materials = scene->materials,
                                     .n_materials = scene->n_materials,
                                     .beam = &beam,
                                     .aperture_lps_mm = file->entry_lps_mm,
                                     .direction_lps = vec3_normalize(along),
                                     .n_histories = words->n_histories,
                                     .seed = words->seed,
                                     .cells = cells,
                                     .cell_mm = words->cell_mm > 0 ? words->cell_mm : 5,
                                     .is_whole_cells = words->is_sera_cells,
                                     .n_threads = n_threads };
    bool is_done = transport_run(&input, &result, err);
    phase_space_finish(&beam);
    if (!is_done)
        return false;
    print_result(&result, words->out);
    is_done = transport_add_dose(plan, &result, file->per, words->mode, words->seed, err) && write(words, plan, err);
    transport_result_finish(&result);
    return is_done;
}

/* Before hours of work, and not after. */
static bool is_free(const char *out, const struct plan *plan, struct error *err)
{
    if (plan->n_doses == PLAN_MAX_DOSES)
        return error_set(err, ERROR_LIMIT, "the plan has %d doses already, at most %d", PLAN_MAX_DOSES, PLAN_MAX_DOSES);
    struct folder folder;
    char **names;
    size_t n_names;
    struct stat status;
    if (stat(out, &status) != 0)
        return true;
    if (!folder_open(&folder, out, err))
        return false;
    bool is_listed = folder_list(&folder, &names, &n_names, err);
    folder_close(&folder);
    if (!is_listed)
        return false;
    folder_free_names(names, n_names);
    return n_names == 0 || error_set(err, ERROR_STATE, "%.180s is there already and is not empty", out);
}

static bool run(const struct words *words, struct plan *plan, struct beam_read *beam, struct error *err)
{
    struct transport_scene scene;
    struct beam_file *file = &beam->file;
    if (!is_free(words->out, plan, err) || !read_beam(words, beam, err) || !take_strength(words, file, err) ||
        !take_pose(words, plan, file, err))
        return false;
    fputs("beam: ", stdout);
    text_print(stdout,
               file->name[0]             ? file->name
               : file->particles.path[0] ? file->particles.path
                                         : file->source.name,
               0);
    printf(", aperture at %g, %g, %g, to %g, %g, %g mm\n", file->entry_lps_mm.x, file->entry_lps_mm.y,
           file->entry_lps_mm.z, file->target_lps_mm.x, file->target_lps_mm.y, file->target_lps_mm.z);
    if (!transport_scene_init(&scene, plan, file, err))
        return false;
    bool is_done = simulate(words, plan, beam, &scene, err);
    transport_scene_finish(&scene);
    return is_done;
}

int command_transport(int argc, char **argv)
{
    struct words words = { .n_histories = 1000000, .seed = 1 };
    int status = take_words(&words, argc, argv);
    if (status != 0)
        return status < 0 ? EXIT_DONE : status;
    static struct beam_read beam;
    struct error err = { 0 };
    struct plan *plan = command_open_plan("transport", words.plan);
    if (!plan)
        return EXIT_REFUSED;
    bool is_done = run(&words, plan, &beam, &err);
    plan_destroy(plan);
    beam_particles_finish(&beam.particles);
    return is_done ? EXIT_DONE : command_refused("transport", &err);
}

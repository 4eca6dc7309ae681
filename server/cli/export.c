/* `beamroom export`: writes the shape of a region as STL, PLY or GLB. */
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "core/base/file_write.h"
#include "core/derive/shapes.h"
#include "core/plan/fit.h"
#include "server/cli/command.h"
#include "server/cli/exit_code.h"
#include "server/cli/open_plan.h"
#include "server/cli/text.h"
#include "server/wire/shape_query.h"

#define FILE_MAX_BYTES ((uint64_t)8 << 30)

struct export_arguments {
    const char *folder, *region, *out;
    struct shape_query shape;
};

static void print_help(void)
{
    printf(
        "usage: beamroom export DIR REGION -o OUT.stl|OUT.ply|OUT.glb [OPTION]...\n"
        "Writes the surface of a region of the plan in the folder DIR, with everything inside it, for other programs.\n\n"
        "  -o, --output OUT  the file; its ending says whether binary STL, binary PLY or GLB (glTF 2.0)\n"
        "  --as WHAT         surface (default), univels, nurbs or fan: what the region is shown as\n"
        "  --algorithm NAME  of a surface: smooth (default), marching-cubes or eight-cell, Sera3d's: through the centres of univels\n"
        "  --order N         of NURBS: 2 linear, 3 quadratic, 4 cubic (default)\n"
        "  --sampling HOW    of NURBS: traces (default) or degree-bins\n"
        "  --bins N          of NURBS: control points around a slice, 8 to 360\n"
        "  --normals WHICH   vertex (default) or face: PLY and GLB without vertex normals, for flat shading\n"
        "  --help            this text\n\n"
        "REGION is an id, as beamroom info --json gives it. Points are mm toward the patient's left, back and top (DICOM LPS);\n"
        "a GLB's node turns them to metres, top up, as glTF wants. The file names plan and region by id, and nobody else.\n");
}

/* The region of an id. NULL on failure: err lists the ids that the plan has. */
static const struct region *find_region(const struct plan *plan, const char *id, struct error *err)
{
    const struct region *region = region_find(&plan->regions, id);
    if (region && fit_is_of_other(plan, fit_part_of_region(plan, (size_t)(region - plan->regions.regions)))) {
        error_set(err, ERROR_STATE, "the region \"%.63s\" belongs to another patient than the one shown", id);
        return NULL;
    }
    if (region)
        return region;
    char list[160] = "";
    for (size_t i = 0, used = 0; i < plan->regions.n_regions; i++) {
        const char *other = plan->regions.regions[i].id;
        if (used + strlen(other) + sizeof ", ..." >= sizeof list) {
            (void)snprintf(list + used, sizeof list - used, ", ...");
            break;
        }
        used += (size_t)snprintf(list + used, sizeof list - used, "%s%s", used ? ", " : "", other);
    }
    error_set(err, ERROR_NOT_FOUND, "the plan has no region \"%.63s\"; it has %s", id, *list ? list : "none");
    return NULL;
}

static bool export_region(const struct plan *plan, const struct export_arguments *arguments, struct error *err)
{
    const struct region *region = find_region(plan, arguments->region, err);
    if (!region)
        return false;
    struct shape_facts facts;
    const struct shape_query *query = &arguments->shape;
    const struct shape_want want = { subject_region((size_t)(region - plan->regions.regions)), query->key,
                                     SURFACE_FULL };
    struct derive *derived = derive_create(plan);
    struct shape *shape = derive_shape(derived, &want, &facts, err);
    const char *method = query->key.representation == REPRESENTATION_SURFACE
                             ? surface_algorithm_word(query->key.algorithm)
                             : region_representation_word(query->key.representation);
    const struct mesh_export_about about = { plan->id,
                                             region->id,
                                             method,
                                             plan->is_phantom,
                                             query->is_faceted || (shape && shape->is_faceted),
                                             { region->rgb[0], region->rgb[1], region->rgb[2] } };
    size_t n_bytes = 0;
    uint8_t *bytes = shape ? mesh_export(shape->mesh, query->format, &about, FILE_MAX_BYTES, &n_bytes, err) : NULL;
    shape_unref(shape);
    derive_destroy(derived);
    bool is_written = bytes && file_write(arguments->out, bytes, n_bytes, err);
    free(bytes);
    if (is_written) {
        text_print(stdout, arguments->out, 0);
        printf(": %zu triangles, %zu vertices, %.2f cm2, %.3f cm3, %zu bytes\n", facts.n_triangles, facts.n_vertices,
               facts.area_mm2 / 100, facts.volume_mm3 / 1000, n_bytes);
    }
    return is_written;
}

/* The format that the ending of the path names; NULL: none. */
static const char *format_of_path(const char *path)
{
    static const char *const words[] = { "stl", "ply", "glb" };
    const char *dot = strrchr(path, '.');
    for (size_t i = 0; dot && i < sizeof words / sizeof words[0]; i++)
        if (strcasecmp(dot + 1, words[i]) == 0)
            return words[i];
    return NULL;
}

/* False when there is nothing to write; *code is then the exit code. The options of the shape are read by the same
 * function as those of the API. */
static bool parse_arguments(int argc, char **argv, struct export_arguments *arguments, cJSON *words, int *code)
{
    static const struct option long_options[] = { { "output", required_argument, NULL, 'o' },
                                                  { "as", required_argument, NULL, 'r' },
                                                  { "algorithm", required_argument, NULL, 'a' },
                                                  { "normals", required_argument, NULL, 'n' },
                                                  { "order", required_argument, NULL, 'd' },
                                                  { "sampling", required_argument, NULL, 's' },
                                                  { "bins", required_argument, NULL, 'b' },
                                                  { "help", no_argument, NULL, 'h' },
                                                  { NULL, 0, NULL, 0 } };
    *code = EXIT_USAGE;
    opterr = 0;
    for (int option, at = -1; (option = getopt_long(argc, argv, "ho:", long_options, &at)) != -1;) {
        switch (option) {
        case 'o': arguments->out = optarg; break;
        case 'h':
            print_help();
            *code = EXIT_DONE;
            return false;
        case '?':
            return command_usage_error("export", "'%s' is not an option or lacks its value", argv[optind - 1]), false;
        default:
            cJSON_DeleteItemFromObjectCaseSensitive(words, option == 'r' ? "representation" : long_options[at].name);
            cJSON_AddStringToObject(words, option == 'r' ? "representation" : long_options[at].name, optarg);
        }
    }
    if (argc - optind != 2)
        return command_usage_error("export", "one folder and one region are needed, %d words are given", argc - optind),
               false;
    if (!arguments->out)
        return command_usage_error("export", "where to write is needed: -o OUT.stl, OUT.ply or OUT.glb"), false;
    if (!format_of_path(arguments->out))
        return command_usage_error("export", "-o '%s' does not end in .stl, .ply or .glb", arguments->out), false;
    cJSON_AddStringToObject(words, "format", format_of_path(arguments->out));
    struct problem problem;
    if (!shape_query_read(words, &arguments->shape, &problem))
        return command_usage_error("export", "--%s", problem.detail), false;
    arguments->folder = argv[optind];
    arguments->region = argv[optind + 1];
    return true;
}

int command_export(int argc, char **argv)
{
    struct export_arguments arguments = { 0 };
    struct error err = { 0 };
    int code;
    cJSON *words = cJSON_CreateObject();
    bool is_understood = parse_arguments(argc, argv, &arguments, words, &code);
    cJSON_Delete(words);
    if (!is_understood)
        return code;
    struct plan *plan = command_open_plan("export", arguments.folder);
    if (!plan)
        return EXIT_REFUSED;
    code = export_region(plan, &arguments, &err) ? EXIT_DONE : command_refused("export", &err);
    plan_destroy(plan);
    return code;
}

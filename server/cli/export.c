#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "core/base/file_write.h"
#include "core/surface/mesh_export.h"
#include "server/cli/command.h"
#include "server/cli/text.h"

#define FILE_MAX_BYTES ((uint64_t)8 << 30)

struct export_job {
    const char *folder, *region, *out;
    enum mesh_format format;
    enum surface_algorithm algorithm;
    bool is_faceted;
};

static void print_help(void)
{
    printf("usage: beamroom export DIR REGION -o OUT.stl|OUT.ply|OUT.glb [OPTION]...\n"
           "Writes the surface of a region of the plan in the folder DIR, with everything inside it, for other programs.\n\n"
           "  -o, --output OUT  the file; its ending says whether binary STL, binary PLY or GLB (glTF 2.0)\n"
           "  --algorithm NAME  marching-cubes (default); eight-cell, Sera3d's: through the centres of univels; smooth: without stairs\n"
           "  --normals WHICH   vertex (default) or face: PLY and GLB without vertex normals, for flat shading\n"
           "  --help            this text\n\n"
           "REGION is an id, as beamroom info --json gives it. Points are mm toward the patient's left, back and top (DICOM LPS);\n"
           "a GLB's node turns them to metres, top up, as glTF wants. The file names plan and region by id, and nobody else.\n");
}

/* NULL with err, which lists the regions there are. */
static const struct region *find_region(const struct plan *plan, const char *id, struct error *err)
{
    const struct region *region = region_find(&plan->regions, id);
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

static bool export_region(struct plan *plan, const struct export_job *job, struct error *err)
{
    const struct region *region = find_region(plan, job->region, err);
    if (!region)
        return false;
    struct surface_facts facts;
    struct mesh *mesh = plan_surface(plan, (size_t)(region - plan->regions.regions), job->algorithm, SURFACE_FULL, &facts, err);
    const struct mesh_export_about about = { plan->id, region->id, surface_algorithm_word(job->algorithm), plan->is_phantom, job->is_faceted,
                                             { region->rgb[0], region->rgb[1], region->rgb[2] } };
    size_t n_bytes = 0;
    uint8_t *bytes = mesh ? mesh_export(mesh, job->format, &about, FILE_MAX_BYTES, &n_bytes, err) : NULL;
    mesh_unref(mesh);
    bool is_written = bytes && file_write(job->out, bytes, n_bytes, err);
    free(bytes);
    if (is_written) {
        text_print(stdout, job->out, 0);
        printf(": %zu triangles, %zu vertices, %.2f cm2, %.3f cm3, %zu bytes\n", facts.n_triangles, facts.n_vertices, facts.area_mm2 / 100,
               facts.volume_mm3 / 1000, n_bytes);
    }
    return is_written;
}

static bool format_from_path(const char *path, enum mesh_format *format)
{
    const char *dot = strrchr(path, '.');
    for (enum mesh_format f = MESH_STL; dot && f <= MESH_GLB; f++)
        if (strcasecmp(dot + 1, mesh_format_word(f)) == 0) {
            *format = f;
            return true;
        }
    return false;
}

/* false with *code when there is nothing to write */
static bool parse_arguments(int argc, char **argv, struct export_job *job, int *code)
{
    static const struct option long_options[] = { { "output", required_argument, NULL, 'o' },
                                                  { "algorithm", required_argument, NULL, 'a' },
                                                  { "normals", required_argument, NULL, 'n' },
                                                  { "help", no_argument, NULL, 'h' },
                                                  { NULL, 0, NULL, 0 } };
    *code = EXIT_USAGE;
    opterr = 0;
    for (int option; (option = getopt_long(argc, argv, "ho:", long_options, NULL)) != -1;) {
        switch (option) {
        case 'o':
            job->out = optarg;
            break;
        case 'a':
            if (!surface_algorithm_from_word(optarg, &job->algorithm))
                return command_usage_error("export", "--algorithm '%s' is not marching-cubes, eight-cell or smooth", optarg), false;
            break;
        case 'n':
            job->is_faceted = strcmp(optarg, "face") == 0;
            if (!job->is_faceted && strcmp(optarg, "vertex") != 0)
                return command_usage_error("export", "--normals '%s' is not vertex or face", optarg), false;
            break;
        case 'h':
            print_help();
            *code = EXIT_DONE;
            return false;
        default:
            return command_usage_error("export", "'%s' is not an option or lacks its value", argv[optind - 1]), false;
        }
    }
    if (argc - optind != 2)
        return command_usage_error("export", "one folder and one region are needed, %d words are given", argc - optind), false;
    if (!job->out)
        return command_usage_error("export", "where to write is needed: -o OUT.stl, OUT.ply or OUT.glb"), false;
    if (!format_from_path(job->out, &job->format))
        return command_usage_error("export", "-o '%s' does not end in .stl, .ply or .glb", job->out), false;
    job->folder = argv[optind];
    job->region = argv[optind + 1];
    return true;
}

int command_export(int argc, char **argv)
{
    struct export_job job = { 0 };
    struct error err = { 0 };
    int code;
    if (!parse_arguments(argc, argv, &job, &code))
        return code;
    struct plan *plan = command_open_plan("export", job.folder);
    if (!plan)
        return EXIT_REFUSED;
    code = export_region(plan, &job, &err) ? EXIT_DONE : command_refused("export", &err);
    plan_destroy(plan);
    return code;
}

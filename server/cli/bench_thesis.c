/* The measurements of `beamroom bench --thesis`. */
#include "server/cli/bench_thesis.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/scene/camera.h"

static const struct method {
    const char *name;
    struct shape_key key;
} methods[] = {
    { "surface, smooth", { .representation = REPRESENTATION_SURFACE, .algorithm = SURFACE_SMOOTH } },
    { "surface, marching cubes", { .representation = REPRESENTATION_SURFACE, .algorithm = SURFACE_MARCHING_CUBES } },
    { "surface, 8-cell", { .representation = REPRESENTATION_SURFACE, .algorithm = SURFACE_EIGHT_CELL } },
    { "univels", { .representation = REPRESENTATION_UNIVELS } },
    { "fan", { .representation = REPRESENTATION_FAN } },
    { "NURBS, linear, traces",
      { .representation = REPRESENTATION_NURBS, .nurbs_order = 2, .nurbs_sampling = NURBS_TRACES, .nurbs_bins = 36 } },
    { "NURBS, quadratic, traces",
      { .representation = REPRESENTATION_NURBS, .nurbs_order = 3, .nurbs_sampling = NURBS_TRACES, .nurbs_bins = 36 } },
    { "NURBS, cubic, traces",
      { .representation = REPRESENTATION_NURBS, .nurbs_order = 4, .nurbs_sampling = NURBS_TRACES, .nurbs_bins = 36 } },
    { "NURBS, cubic, degree bins",
      { .representation = REPRESENTATION_NURBS,
        .nurbs_order = 4,
        .nurbs_sampling = NURBS_DEGREE_BINS,
        .nurbs_bins = 36 } },
    { "outlines, traced", { .representation = REPRESENTATION_OUTLINE, .outline = OUTLINE_TRACED } },
    { "outlines, marching squares", { .representation = REPRESENTATION_OUTLINE, .outline = OUTLINE_MARCHING_SQUARES } },
    { "points", { .representation = REPRESENTATION_POINTS } },
    { "points, inner boundary too", { .representation = REPRESENTATION_POINTS, .has_inner_boundary = true } },
    { "solid", { .representation = REPRESENTATION_SOLID } },
};
enum { N_METHODS = sizeof methods / sizeof methods[0], MAX_SAMPLES = 500 };

static int compare(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *samples, size_t n)
{
    qsort(samples, n, sizeof *samples, compare);
    return n ? samples[n / 2] : NAN;
}

void bench_machine_look(struct bench_machine *machine, const struct render_facts *facts)
{
    struct utsname name;
    *machine = (struct bench_machine){ .processor = "unknown processor",
                                       .system = "unknown system",
                                       .n_cores = parallel_cores() };
    FILE *in = fopen("/proc/cpuinfo", "re");
    char line[256];
    while (in && fgets(line, sizeof line, in))
        if (strncmp(line, "model name", 10) == 0 && strchr(line, ':')) {
            (void)snprintf(machine->processor, sizeof machine->processor, "%.127s", strchr(line, ':') + 2);
            machine->processor[strcspn(machine->processor, "\n")] = 0;
            break;
        }
    if (in)
        fclose(in);
    if (uname(&name) == 0)
        (void)snprintf(machine->system, sizeof machine->system, "%.40s %.40s %.20s", name.sysname, name.release,
                       name.machine);
    (void)snprintf(machine->back_end, sizeof machine->back_end, "%s",
                   facts->back_end == RENDER_SOFT ? "our own rasteriser (soft)" : facts->renderer);
}

/* ---- pictures --------------------------------------------------------------------------------------------------- */

static const enum scene_representation scene_representations[REPRESENTATION_N] = {
    [REPRESENTATION_SURFACE] = SCENE_REPRESENTATION_SURFACE, [REPRESENTATION_OUTLINE] = SCENE_REPRESENTATION_OUTLINE,
    [REPRESENTATION_POINTS] = SCENE_REPRESENTATION_POINTS,   [REPRESENTATION_UNIVELS] = SCENE_REPRESENTATION_UNIVELS,
    [REPRESENTATION_SOLID] = SCENE_REPRESENTATION_SOLID,     [REPRESENTATION_NURBS] = SCENE_REPRESENTATION_NURBS,
    [REPRESENTATION_FAN] = SCENE_REPRESENTATION_FAN,
};

/* A scene that shows one region alone (-1: none) in the representation of the key, without slices. */
static void set_scene(const struct plan *plan, int region, const struct shape_key *key, struct scene *scene)
{
    static const enum scene_algorithm algorithms[SURFACE_N_ALGORITHMS] = { [SURFACE_MARCHING_CUBES] =
                                                                               SCENE_ALGORITHM_MARCHING_CUBES,
                                                                           [SURFACE_EIGHT_CELL] =
                                                                               SCENE_ALGORITHM_EIGHT_CELL,
                                                                           [SURFACE_SMOOTH] = SCENE_ALGORITHM_SMOOTH };
    scene_for_plan(plan, scene);
    for (size_t i = 0; i < scene->n_regions; i++) {
        bool is_it = region >= 0 && strcmp(scene->regions[i].id, plan->regions.regions[region].id) == 0;
        scene->regions[i].value.visible = is_it;
        scene->regions[i].value.opacity = 1;
        if (is_it)
            scene->regions[i].value.representation = scene_representations[key->representation];
    }
    if (key) {
        scene->surface.algorithm = algorithms[key->algorithm];
        scene->outline.method =
            key->outline == OUTLINE_TRACED ? SCENE_OUTLINE_METHOD_TRACED : SCENE_OUTLINE_METHOD_MARCHING_SQUARES;
        scene->points.inner_boundary = key->has_inner_boundary;
    }
    if (key && key->representation == REPRESENTATION_NURBS) {
        scene->nurbs.order = key->nurbs_order;
        scene->nurbs.sampling =
            key->nurbs_sampling == NURBS_TRACES ? SCENE_NURBS_SAMPLING_TRACES : SCENE_NURBS_SAMPLING_DEGREE_BINS;
        scene->nurbs.bins = key->nurbs_bins;
    }
    scene->image.slices.axial.visible = scene->image.slices.coronal.visible = scene->image.slices.sagittal.visible =
        false;
}

/* Shows the image in one of the ways, as far as it is not culled. */
static void show_image(struct scene *scene, enum bench_image_way way)
{
    struct scene_volume_style *volume = &scene->image.volume;
    scene->image.slices.axial.visible = way == BENCH_SLICE;
    if (way == BENCH_SLICE || way == BENCH_NO_IMAGE)
        return;
    bool is_ray = way == BENCH_RAY || way == BENCH_RAY_PLAIN;
    volume->visible = true;
    volume->method = is_ray ? SCENE_VOLUME_METHOD_RAY : SCENE_VOLUME_METHOD_SLICES;
    volume->interpolation = way == BENCH_VOLUME_NEAREST ? SCENE_INTERPOLATION_NEAREST : SCENE_INTERPOLATION_LINEAR;
    volume->shaded = way == BENCH_RAY;
    volume->steps = 256;
    if (!is_ray)
        volume->cull_below = scene->image.cull_below;
}

/* A snapshot from the home camera turned by turn_deg around the patient's long axis. Takes the scene. */
static struct snapshot *turned(struct derive *derived, struct scene *scene, double turn_deg, struct error *err)
{
    struct view view = view_default;
    struct scene_camera home;
    char field[128];
    camera_home(derive_plan(derived), SCENE_KIND_3D, &home);
    struct vec3 arm = vec3_sub(home.position_mm, home.target_mm);
    double c = cos(turn_deg * M_PI / 180), s = sin(turn_deg * M_PI / 180);
    view.size_px[0] = view.size_px[1] = BENCH_SIZE_PX;
    view.camera = home;
    view.camera.position_mm = vec3_add(home.target_mm, vec3(c * arm.x - s * arm.y, s * arm.x + c * arm.y, arm.z));
    return snapshot_create(derived, scene, &view, 0, field, err);
}

/* Median time of n pictures, each turned 7 degrees further. One more before them, which uploads, is not counted. */
static bool time_pictures(struct derive *derived, struct renderer *renderer, int region, const struct shape_key *key,
                          bool is_faceted, enum bench_image_way way, int n, double *median_ms, struct error *err)
{
    double samples[MAX_SAMPLES];
    const struct render_options options = { BENCH_SIZE_PX, BENCH_SIZE_PX, SURFACE_FULL, false };
    for (int i = -1; i < n; i++) {
        struct scene scene;
        struct camera camera;
        struct render_timing timing;
        set_scene(derive_plan(derived), region, key, &scene);
        scene.surface.normals = is_faceted ? SCENE_NORMALS_FACE : SCENE_NORMALS_VERTEX;
        show_image(&scene, way);
        struct snapshot *snapshot = turned(derived, &scene, 7 * i, err);
        struct image *image = snapshot ? render_snapshot(renderer, snapshot, &options, &camera, &timing, err) : NULL;
        snapshot_unref(snapshot);
        if (!image)
            return false;
        image_destroy(image);
        if (i >= 0)
            samples[i] = (double)(timing.draw_us + timing.read_us) / 1000;
    }
    *median_ms = median(samples, (size_t)n);
    return true;
}

/* ---- shapes ----------------------------------------------------------------------------------------------------- */

/* Times the way from the region's univels to its shape, n_repeats times, then pictures of it. A shape that is refused
 * gives a row with the reason. */
static bool measure(struct derive *derived, struct renderer *renderer, size_t region, const struct method *method,
                    int n_repeats, struct bench_row *row, struct error *err)
{
    double samples[MAX_SAMPLES];
    const struct plan *plan = derive_plan(derived);
    const struct shape_want want = { subject_region(region), method->key, SURFACE_FULL };
    *row = (struct bench_row){ .method = method->name, .draw_ms = NAN, .made_ms = NAN };
    (void)snprintf(row->region, sizeof row->region, "%s", plan->regions.regions[region].name);
    derive_set_budget(derived, 0); /* nothing is kept, so each shape is built again */
    for (int i = 0; i < n_repeats; i++) {
        struct error refusal = { 0 };
        struct shape *shape = derive_shape(derived, &want, &row->facts, &refusal);
        if (!shape) {
            (void)snprintf(row->refusal, sizeof row->refusal, "%s", refusal.text);
            derive_set_budget(derived, DERIVE_BUDGET_BYTES);
            return true;
        }
        samples[i] = row->facts.build_ms;
        bool is_measured = i + 1 < n_repeats || derive_shape_distance(derived, &want, shape, &row->facts, err);
        shape_unref(shape);
        if (!is_measured)
            return false;
    }
    derive_set_budget(derived, DERIVE_BUDGET_BYTES);
    row->made_ms = median(samples, (size_t)n_repeats);
    bool is_drawn = time_pictures(derived, renderer, (int)region, &method->key, false, BENCH_NO_IMAGE, 5 * n_repeats,
                                  &row->draw_ms, err);
    renderer_forget(renderer, plan);
    return is_drawn;
}

/* Times the way from region to triangles, with the normals that the row of the table needs. */
static bool measure_table1(struct derive *derived, struct renderer *renderer, size_t region, int n_repeats,
                           struct bench_row rows[3], struct error *err)
{
    const struct plan *plan = derive_plan(derived);
    for (int i = 0; i < 3; i++) {
        struct bench_row *row = &rows[i];
        const struct shape_key key = { .representation = REPRESENTATION_SURFACE,
                                       .algorithm = i < 2 ? SURFACE_EIGHT_CELL : SURFACE_MARCHING_CUBES };
        double samples[MAX_SAMPLES];
        *row = (struct bench_row){ .method = "", .draw_ms = NAN };
        for (int n = 0; n < n_repeats; n++) {
            int64_t began_us = clock_now_us();
            struct mask *mask = mask_from_region(&plan->regions, region, parallel_cores(), err);
            struct mesh *mesh = mask ? surface_make(key.algorithm, mask, &surface_defaults, err) : NULL;
            bool is_made = mesh && (i == 0 || mesh_make_normals(mesh, parallel_cores(), err));
            samples[n] = (double)(clock_now_us() - began_us) / 1000;
            row->facts.n_triangles = is_made ? mesh->n_triangles : 0;
            mask_destroy(mask);
            mesh_unref(mesh);
            if (!is_made)
                return false;
        }
        row->made_ms = median(samples, (size_t)n_repeats);
        if (!time_pictures(derived, renderer, (int)region, &key, i == 0, BENCH_NO_IMAGE, 5 * n_repeats, &row->draw_ms,
                           err))
            return false;
    }
    renderer_forget(renderer, plan);
    return true;
}

bool bench_measure(struct derive *derived, struct renderer *renderer, int n_repeats, struct bench_plan *result,
                   struct error *err)
{
    const struct plan *plan = derive_plan(derived);
    size_t largest = SIZE_MAX, n_regions = plan->regions.n_regions;
    *result = (struct bench_plan){ .is_phantom = plan->is_phantom };
    for (int way = 0; way < BENCH_N_IMAGE_WAYS; way++)
        result->image_fps[way] = NAN;
    (void)snprintf(result->name, sizeof result->name, "%s", plan->name);
    result->rows = mem_new((n_regions * N_METHODS + 1) * sizeof *result->rows);
    for (size_t r = 0; r < n_regions; r++) {
        if (plan->regions.regions[r].n_voxels == 0)
            continue;
        bool is_scalp = strcmp(plan->regions.regions[r].id, "scalp") == 0,
             has_scalp = largest != SIZE_MAX && strcmp(plan->regions.regions[largest].id, "scalp") == 0;
        if (largest == SIZE_MAX || is_scalp ||
            (!has_scalp && plan->regions.regions[r].n_voxels > plan->regions.regions[largest].n_voxels))
            largest = r; /* the scalp, the region of the thesis, if the plan has it */
        for (size_t m = 0; m < N_METHODS; m++)
            if (!measure(derived, renderer, r, &methods[m], n_repeats, &result->rows[result->n_rows++], err))
                return false;
    }
    if (largest == SIZE_MAX)
        return error_set(err, ERROR_RANGE, "the plan \"%s\" has no region with a voxel", plan->name);
    (void)snprintf(result->scalp, sizeof result->scalp, "%s", plan->regions.regions[largest].name);
    if (!measure_table1(derived, renderer, largest, n_repeats, result->table1, err))
        return false;
    for (int way = 0; plan->n_images > 0 && way < BENCH_N_IMAGE_WAYS; way++) {
        double ms;
        if (!time_pictures(derived, renderer, -1, NULL, false, (enum bench_image_way)way, 5 * n_repeats, &ms, err))
            return false;
        result->image_fps[way] = 1000 / ms;
    }
    return true;
}

void bench_plan_finish(struct bench_plan *result)
{
    free(result->rows);
}

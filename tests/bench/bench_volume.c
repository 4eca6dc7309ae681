/* Draws a made CT head of 256^3 voxels as a volume: skin, bone and soft tissue while the camera goes round it and as a
 * still, the largest value, the mean, and slices. With BEAMROOM_DATA also the first CT found there of the names below.
 * bench_volume --dump FOLDER writes the head instead, with the camera and the transfer functions, for another program
 * to draw: volume.raw (int16, x fastest) and volume.json. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/derive/volume_bricks.h"
#include "core/load/load.h"
#include "core/render/render.h"
#include "core/scene/camera.h"
#include "tests/bench/vtk_volume.h"
#include "volume_presets.h"

enum { REPEATS = 11, SIDE = 256 };
static const double spacing_mm = 0.9;

static struct renderer *soft;

static void stop(const struct error *err)
{
    fprintf(stderr, "bench_volume: %s\n", err->text);
    exit(1);
}

/* ---- a head ------------------------------------------------------------------------------------------------------- */

static double ellipsoid(struct vec3 p, struct vec3 centre, struct vec3 half)
{
    struct vec3 d = vec3_sub(p, centre);
    double r = vec3_length(vec3((d.x) / half.x, d.y / half.y, d.z / half.z));
    return (r - 1) * fmin(half.x, fmin(half.y, half.z)); /* roughly the distance in mm; negative inside */
}

/* Blends from the value outside a distance to the one inside, over three voxels. */
static double into(double outside, double inside, double distance_mm)
{
    double part = fmin(fmax(0.5 - distance_mm / (3 * spacing_mm), 0), 1);
    return outside + (inside - outside) * part;
}

/* HU at a point in mm from the head's middle: skin, fat, skull with orbits, nose and ear canals, brain, ventricles,
 * jaw, spine; and a head rest. */
static double head_hu(struct vec3 p)
{
    double hu = -1000;
    hu = into(hu, -300, fmax(fabs(vec3_length(vec3(p.x, p.y - 20, 0)) - 118) - 1.5, p.y < 60 ? 9 : -9)); /* rest */
    double skin = ellipsoid(p, vec3(0, 0, 12), vec3(78, 96, 92));
    skin = fmin(skin, ellipsoid(p, vec3(0, -18, -62), vec3(52, 66, 52))); /* jaw */
    skin = fmin(skin, ellipsoid(p, vec3(0, 10, -100), vec3(52, 56, 60))); /* neck */
    skin = fmin(skin, ellipsoid(p, vec3(0, -96, -20), vec3(12, 16, 22))); /* nose */
    skin = fmin(skin, fmin(ellipsoid(p, vec3(78, 10, -12), vec3(10, 18, 30)),
                           ellipsoid(p, vec3(-78, 10, -12), vec3(10, 18, 30))));
    hu = into(hu, -40, skin);
    hu = into(hu, 45, skin + 3.5);
    double skull = ellipsoid(p, vec3(0, 2, 16), vec3(70, 87, 82)),
           inner = ellipsoid(p, vec3(0, 2, 16), vec3(63, 80, 75));
    double face = ellipsoid(p, vec3(0, -56, -36), vec3(42, 26, 40));
    hu = into(hu, 1000, fmax(fmin(skull, face), -112 - p.z));
    hu = into(hu, 500, fmax(skull, -inner) + 2.5); /* spongy bone between the tables */
    for (int side = -1; side <= 1; side += 2) {
        hu = into(hu, 30, ellipsoid(p, vec3(side * 30, -78, -8), vec3(18, 24, 17)));      /* orbit */
        hu = into(hu, -1000, ellipsoid(p, vec3(side * 24, -62, -40), vec3(13, 16, 15)));  /* sinus */
        hu = into(hu, -1000, ellipsoid(p, vec3(side * 66, 10, -16), vec3(16, 3.5, 3.5))); /* ear canal */
    }
    hu = into(hu, -1000, ellipsoid(p, vec3(0, -72, -34), vec3(8, 22, 18)));
    hu = into(hu, 36, inner);
    hu = into(hu, 6,
              fmin(ellipsoid(p, vec3(10, 0, 24), vec3(7, 30, 9)), ellipsoid(p, vec3(-10, 0, 24), vec3(7, 30, 9))));
    double jaw = fmax(fabs(vec3_length(vec3(p.x, (p.y + 20) * 0.8, 0)) - 44) - 5, fabs(p.z + 84) - 12);
    hu = into(hu, 1300, fmax(jaw, p.y + 8));
    double spine = vec3_length(vec3(p.x, p.y - 26, 0)) - 15;
    hu = into(hu, fabs(remainder(p.z, 17)) < 6 ? 700 : 60, fmax(spine, p.z + 62));
    return hu;
}

/* Noise of about mean 0 and deviation 1; the same on every machine. */
static double noise(uint32_t *state)
{
    double sum = 0;
    for (int i = 0; i < 4; i++) {
        *state = *state * 1664525u + 1013904223u;
        sum += (double)(*state >> 8) / (1 << 24) - 0.5;
    }
    return sum * 1.732;
}

/* At every second voxel and between those linear, as the head is no finer. */
static void fill_slabs(void *context, int part, int n_parts)
{
    struct volume *volume = context;
    enum { HALF = SIDE / 2 + 1 };
    float(*coarse)[HALF][HALF] = mem_new(2 * sizeof *coarse);
    for (int k = part; k < SIDE; k += n_parts) {
        int16_t *voxel = (int16_t *)volume->voxels + (size_t)k * SIDE * SIDE;
        uint32_t state = (uint32_t)k + 1;
        for (int layer = 0; layer <= k % 2; layer++)
            for (int j = 0; j < HALF; j++)
                for (int i = 0; i < HALF; i++)
                    coarse[layer][j][i] = (float)head_hu(
                        affine_point(&volume->grid.lps_mm_from_ijk, vec3(2 * i, 2 * j, k - k % 2 + 2 * layer)));
        for (int j = 0; j < SIDE; j++)
            for (int i = 0; i < SIDE; i++) {
                double hu = 0;
                for (int corner = 0; corner < 8; corner++)
                    hu += 0.125 *
                          (double)
                              coarse[corner & k & 1][(j + (corner >> 1 & j & 1)) / 2][(i + (corner >> 2 & i & 1)) / 2];
                *voxel++ = (int16_t)fmax(-1024, hu + noise(&state) * (hu < -900 ? 8 : 18));
            }
    }
    free(coarse);
}

static struct plan *make_head(void)
{
    struct error err = { 0 };
    struct grid grid;
    double low = -(SIDE - 1) / 2.0 * spacing_mm;
    struct affine map = { { vec3(spacing_mm, 0, 0), vec3(0, spacing_mm, 0), vec3(0, 0, spacing_mm) },
                          vec3(low, low, low) };
    struct plan *plan = plan_create("head");
    struct plan_image *image = &plan->images[plan->n_images++];
    if (!grid_init(&grid, (uint32_t[3]){ SIDE, SIDE, SIDE }, &map, &err) ||
        !(image->volume = volume_create(&grid, VOXEL_I16, &err)))
        stop(&err);
    parallel_run(parallel_cores(), fill_slabs, image->volume);
    volume_measure(image->volume);
    snprintf(image->id, sizeof image->id, "ct");
    snprintf(image->modality, sizeof image->modality, "CT");
    snprintf(image->unit, sizeof image->unit, "HU");
    image->window_center = 40;
    image->window_width = 400;
    plan->bounds_lps_mm = grid_bounds_lps_mm(&grid);
    return plan;
}

/* ---- pictures ------------------------------------------------------------------------------------------------------- */

struct way {
    const char *name;
    enum scene_volume_method method;
    const char *preset;
    bool is_shaded;
    enum scene_interpolation interpolation;
};

static const struct volume_preset *preset_of(const char *name)
{
    for (size_t i = 0; i < n_volume_presets; i++)
        if (strcmp(volume_presets[i].name, name) == 0)
            return &volume_presets[i];
    return NULL;
}

static void set_camera(const struct plan *plan, int step, struct scene_camera *camera)
{
    camera_home(plan, SCENE_KIND_3D, camera);
    double distance = vec3_length(vec3_sub(camera->position_mm, camera->target_mm)) * 0.72, turn = 0.5 + 0.06 * step;
    camera->position_mm =
        vec3_add(camera->target_mm, vec3_scale(vec3_normalize(vec3(sin(turn), -cos(turn), 0.25)), distance));
}

static struct image *draw(struct derive *derived, const struct way *way, int step, int width_px, int height_px,
                          bool is_still, struct render_timing *timing)
{
    const struct plan *plan = derive_plan(derived);
    struct scene scene;
    struct view view = view_default;
    struct error err = { 0 };
    char field[128];
    scene_for_plan(plan, &scene);
    for (size_t i = 0; i < scene.n_regions; i++)
        scene.regions[i].value.visible = false;
    scene.image.slices.axial.visible = scene.image.slices.coronal.visible = scene.image.slices.sagittal.visible = false;
    struct scene_volume_style *style = &scene.image.volume;
    style->visible = true;
    style->method = way->method;
    style->shaded = way->is_shaded;
    style->interpolation = way->interpolation;
    style->cull_below = way->method == SCENE_VOLUME_METHOD_SLICES ? -300 : style->cull_below;
    if (way->preset) {
        const struct volume_preset *preset = preset_of(way->preset);
        free(style->points);
        style->points = mem_new(preset->n_points * sizeof *style->points);
        memcpy(style->points, preset->points, preset->n_points * sizeof *style->points);
        style->n_points = preset->n_points;
    }
    view.size_px[0] = 1024;
    view.size_px[1] = 768;
    set_camera(plan, step, &view.camera);
    struct snapshot *snapshot = snapshot_create(derived, &scene, &view, 1, field, &err);
    struct render_options options = { width_px, height_px, SURFACE_FULL, is_still };
    struct camera camera;
    struct image *image = snapshot ? render_snapshot(soft, snapshot, &options, &camera, timing, &err) : NULL;
    if (!image)
        stop(&err);
    snapshot_unref(snapshot);
    return image;
}

static int compare(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

static void bench(struct derive *derived, const char *what, const struct way *way, bool is_still)
{
    int width_px = is_still ? 1024 : 512, height_px = is_still ? 768 : 384;
    double ms[REPEATS], cpu_ms[REPEATS];
    struct render_timing timing = { 0 };
    image_destroy(draw(derived, way, -1, width_px, height_px, is_still, &timing)); /* makes the bricks */
    for (int i = 0; i < REPEATS; i++) {
        timing = (struct render_timing){ 0 };
        clock_t began = clock();
        image_destroy(draw(derived, way, i, width_px, height_px, is_still, &timing));
        cpu_ms[i] = (double)(clock() - began) * 1e3 / CLOCKS_PER_SEC;
        ms[i] = (double)timing.draw_us / 1e3;
    }
    qsort(ms, REPEATS, sizeof ms[0], compare);
    printf("{\"name\":\"volume, %s, %s, %s\",\"value\":%.2f,\"unit\":\"ms\",\"note\":\"%d x %d%s; %s; %.1f ms of "
           "processor time; median of %d\"}\n",
           what, way->name, is_still ? "still" : "moving", ms[REPEATS / 2], width_px, height_px,
           is_still ? ", anti-aliased" : "", renderer_facts(soft)->renderer, cpu_ms[REPEATS / 2], REPEATS);
    fflush(stdout);
}

/* Cost of a new image, once, and of a new transfer function. */
static void bench_bricks(struct derive *derived, const char *what)
{
    struct error err = { 0 };
    int64_t began_us = clock_now_us();
    struct volume_bricks *bricks = volume_bricks_get(derived, 0, &err);
    if (!bricks)
        stop(&err);
    printf("{\"name\":\"volume, %s, bricks of an image\",\"value\":%.2f,\"unit\":\"ms\",\"note\":\"%u x %u x %u\"}\n",
           what, (double)(clock_now_us() - began_us) / 1e3, bricks->n[0], bricks->n[1], bricks->n[2]);
    derive_result_unref(&bricks->base);
    double ms[REPEATS];
    for (int i = 0; i < REPEATS; i++) {
        struct volume_range range = { 100 + i, 3000 };
        began_us = clock_now_us();
        struct volume_leaps *leaps = volume_leaps_get(derived, 0, &range, 1, &err);
        ms[i] = (double)(clock_now_us() - began_us) / 1e3;
        if (!leaps)
            stop(&err);
        derive_result_unref(&leaps->base);
    }
    qsort(ms, REPEATS, sizeof ms[0], compare);
    printf(
        "{\"name\":\"volume, %s, bricks of a transfer function\",\"value\":%.2f,\"unit\":\"ms\",\"note\":\"median of "
        "%d\"}\n",
        what, ms[REPEATS / 2], REPEATS);
}

static const struct way ways[] = {
    { "bone", SCENE_VOLUME_METHOD_RAY, "Bone", true, SCENE_INTERPOLATION_LINEAR },
    { "skin", SCENE_VOLUME_METHOD_RAY, "Skin", true, SCENE_INTERPOLATION_LINEAR },
    { "soft tissue", SCENE_VOLUME_METHOD_RAY, "Soft tissue", true, SCENE_INTERPOLATION_LINEAR },
    { "soft tissue, not lit", SCENE_VOLUME_METHOD_RAY, "Soft tissue", false, SCENE_INTERPOLATION_LINEAR },
    { "largest value", SCENE_VOLUME_METHOD_MIP, NULL, true, SCENE_INTERPOLATION_LINEAR },
    { "mean", SCENE_VOLUME_METHOD_AVERAGE, NULL, true, SCENE_INTERPOLATION_LINEAR },
    { "256 slices", SCENE_VOLUME_METHOD_SLICES, NULL, true, SCENE_INTERPOLATION_LINEAR },
    { "256 slices, nearest", SCENE_VOLUME_METHOD_SLICES, NULL, true, SCENE_INTERPOLATION_NEAREST },
};

static void bench_plan(struct plan *plan, const char *what)
{
    struct derive *derived = derive_create(plan);
    bench_bricks(derived, what);
    for (size_t i = 0; i < sizeof ways / sizeof ways[0]; i++)
        for (int is_still = 0; is_still < 2; is_still++)
            bench(derived, what, &ways[i], is_still);
    renderer_forget(soft, plan);
    derive_destroy(derived);
    plan_destroy(plan);
}

/* ---- beside VTK ----------------------------------------------------------------------------------------------------- */

static double median(double values[REPEATS], int n)
{
    qsort(values, (size_t)n, sizeof values[0], compare);
    return values[n / 2];
}

/* Ours and a mapper of VTK draw the same picture in turn, both from the eye of set_camera, in steps of a voxel where it
 * moves and of half a voxel in a still, where ours has four rays for a pixel and VTK one. */
static void bench_beside(struct derive *derived, const struct way *way, struct vtk_volume *vtk, const char *mapper,
                         bool is_still, int n)
{
    int size_px[2] = { is_still ? 1024 : 512, is_still ? 768 : 384 };
    double step_mm = is_still ? spacing_mm / 2 : spacing_mm;
    double ours_ms[REPEATS], theirs_ms[REPEATS], theirs_busy_ms[REPEATS];
    struct render_timing timing;
    for (int i = -1; i < n; i++) { /* the first prepares and does not count */
        struct scene_camera camera;
        struct vtk_volume_time theirs;
        const char *method = way->method == SCENE_VOLUME_METHOD_MIP ? "mip" : "ray";
        set_camera(derive_plan(derived), i, &camera);
        timing = (struct render_timing){ 0 };
        image_destroy(draw(derived, way, i, size_px[0], size_px[1], is_still, &timing));
        if (!vtk_volume_draw(vtk, mapper, method, step_mm, size_px, &camera, &theirs))
            stop(&(struct error){ .text = "the VTK side" });
        if (i < 0)
            continue;
        ours_ms[i] = (double)(timing.draw_us + timing.read_us) / 1e3;
        theirs_ms[i] = theirs.ms;
        theirs_busy_ms[i] = theirs.busy_ms;
    }
    double ours = median(ours_ms, n), theirs = median(theirs_ms, n);
    bool is_smart = strcmp(mapper, "smart") == 0;
    printf(
        "{\"name\":\"volume beside VTK, %s, %s\",\"value\":%.2f,\"unit\":\"ms\",\"peer\":\"%s %s\",\"peer_value\":%.2f,"
        "\"ratio\":%.2f,\"note\":\"made head 256^3, %d x %d%s; theirs %.0f ms of processor time, %s; median of %d\"}\n",
        way->name, is_still ? "still" : "moving", ours,
        is_smart ? "vtkSmartVolumeMapper" : "vtkFixedPointVolumeRayCastMapper", vtk->version, theirs, theirs / ours,
        size_px[0], size_px[1], is_still ? ", ours anti-aliased" : "", median(theirs_busy_ms, n),
        is_smart ? vtk->gl : "its own rays", n);
    fflush(stdout);
}

static void bench_vtk(struct plan *plan)
{
    struct derive *derived = derive_create(plan);
    for (size_t i = 0; i < sizeof ways / sizeof ways[0]; i++) {
        const struct way *way = &ways[i];
        const struct volume_preset *preset = way->preset ? preset_of(way->preset) : preset_of("Bone");
        struct vtk_volume vtk;
        if (way->method != SCENE_VOLUME_METHOD_RAY && way->method != SCENE_VOLUME_METHOD_MIP)
            continue;
        if (!vtk_volume_start(&vtk, plan->images[0].volume, preset->points, preset->n_points, way->is_shaded)) {
            fprintf(stderr, "bench_volume: no VTK for Python here: our times only\n");
            break;
        }
        for (int is_still = 0; is_still < 2; is_still++) {
            bench_beside(derived, way, &vtk, "fixed", is_still, 5);
            if (i == 0) /* seconds a picture */
                bench_beside(derived, way, &vtk, "smart", is_still, 3);
        }
        vtk_volume_end(&vtk);
    }
    renderer_forget(soft, plan);
    derive_destroy(derived);
}

/* ---- for another program -------------------------------------------------------------------------------------------- */

static void dump(const struct plan *plan, const char *folder)
{
    const struct volume *volume = plan->images[0].volume;
    const struct grid *grid = &volume->grid;
    struct scene_camera camera;
    char path[4096];
    set_camera(plan, 0, &camera);
    snprintf(path, sizeof path, "%s/volume.raw", folder);
    FILE *raw = fopen(path, "wb");
    snprintf(path, sizeof path, "%s/volume.json", folder);
    FILE *json = fopen(path, "w");
    if (!raw || !json ||
        fwrite(volume->voxels, voxel_size(volume->type), grid_n_voxels(grid), raw) != grid_n_voxels(grid))
        stop(&(struct error){ .text = "the folder cannot be written to" });
    struct vec3 origin = grid->lps_mm_from_ijk.origin;
    fprintf(json, "{\"size\":[%u,%u,%u],\"spacing_mm\":[%.17g,%.17g,%.17g],\"origin_lps_mm\":[%.17g,%.17g,%.17g],",
            grid->size[0], grid->size[1], grid->size[2], spacing_mm, spacing_mm, spacing_mm, origin.x, origin.y,
            origin.z);
    fprintf(
        json,
        "\"camera\":{\"position_mm\":[%.17g,%.17g,%.17g],\"target_mm\":[%.17g,%.17g,%.17g],\"up\":[%.17g,%.17g,%.17g],"
        "\"fov_deg\":%.17g},\"presets\":[",
        camera.position_mm.x, camera.position_mm.y, camera.position_mm.z, camera.target_mm.x, camera.target_mm.y,
        camera.target_mm.z, camera.up.x, camera.up.y, camera.up.z, camera.fov_deg);
    for (size_t i = 0, n = 0; i < n_volume_presets; i++) {
        const struct volume_preset *preset = &volume_presets[i];
        if (!preset->is_hu)
            continue;
        fprintf(json, "%s{\"name\":\"%s\",\"points\":[", n++ ? "," : "", preset->name);
        for (size_t p = 0; p < preset->n_points; p++)
            fprintf(json, "%s{\"value\":%g,\"rgb\":[%u,%u,%u],\"opacity_of_1_mm\":%g}", p ? "," : "",
                    preset->points[p].value, preset->points[p].color_rgb >> 16, preset->points[p].color_rgb >> 8 & 255,
                    preset->points[p].color_rgb & 255, preset->points[p].opacity);
        fprintf(json, "]}");
    }
    fprintf(json, "]}\n");
    fclose(raw);
    fclose(json);
}

int main(int argc, char **argv)
{
    struct error err = { 0 };
    struct plan *head = make_head();
    if (argc == 3 && strcmp(argv[1], "--dump") == 0) {
        dump(head, argv[2]);
        plan_destroy(head);
        return 0;
    }
    soft = renderer_create(RENDER_SOFT, &err);
    if (!soft)
        stop(&err);
    bench_vtk(head);
    bench_plan(head, "made head 256^3");
    static const char *const real[] = { "dicom-head-phantom", "openkbp-pt99" };
    for (size_t i = 0; getenv("BEAMROOM_DATA") && i < sizeof real / sizeof real[0]; i++) {
        char folder[4096];
        snprintf(folder, sizeof folder, "%s/%s", getenv("BEAMROOM_DATA"), real[i]);
        struct plan *plan = plan_load(folder, real[i], NULL, &err);
        if (plan)
            bench_plan(plan, real[i]);
    }
    renderer_destroy(soft);
    return 0;
}

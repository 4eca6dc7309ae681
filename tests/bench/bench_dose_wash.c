/* Draws the demo plan with a colourwash of a weighted dose on a grid of 128^3, whose weights differ between four
 * tissues: the axial pane, a new slice with each picture; five opaque regions in the wash's colours, and cut open, with
 * the camera going round; the head as a volume. Each beside the same picture without the wash. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/load/load.h"
#include "core/render/render.h"
#include "core/scene/camera.h"

enum { REPEATS = 15, WIDTH = 1024, HEIGHT = 768, SIDE = 128 };

static struct renderer *soft, *gl; /* gl: NULL where there is none */
static struct plan *plan;
static struct derive *derived;

static int compare(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

static double median(double values[REPEATS])
{
    qsort(values, REPEATS, sizeof values[0], compare);
    return values[REPEATS / 2];
}

static void stop(const struct error *err)
{
    fprintf(stderr, "bench_dose_wash: %s\n", err->text);
    exit(1);
}

/* A dose of the plan's four components, each a bell curve around another point, on a grid around the plan that is
 * turned against the image's. */
static void make_dose(void)
{
    static const enum dose_quantity quantities[] = { DOSE_BORON, DOSE_NITROGEN, DOSE_FAST, DOSE_GAMMA };
    const struct box3 *box = &plan->bounds_lps_mm;
    struct vec3 middle = vec3_scale(vec3_add(box->low, box->high), 0.5), size = vec3_sub(box->high, box->low);
    const double c = cos(0.2), s = sin(0.2), mm = 1.1 / SIDE;
    struct affine map = { { vec3(size.x * mm * c, size.x * mm * s, 0), vec3(-size.y * mm * s, size.y * mm * c, 0),
                            vec3(0, 0, size.z * mm) },
                          { 0, 0, 0 } };
    map.origin = vec3_sub(middle, affine_vector(&map, vec3(SIDE / 2.0, SIDE / 2.0, SIDE / 2.0)));
    struct grid grid;
    struct error err = { 0 };
    const uint32_t sides[3] = { SIDE, SIDE, SIDE };
    if (!grid_init(&grid, sides, &map, &err))
        stop(&err);
    dose_finish(&plan->doses[0]);
    plan->n_doses = 1;
    struct dose *dose = &plan->doses[0];
    *dose = (struct dose){ .id = "made", .unit = "Gy", .has_frame = true, .frame = DOSE_FRAME_SAME, .n_components = 4 };
    for (size_t q = 0; q < 4; q++) {
        struct volume *volume = volume_create(&grid, VOXEL_F32, &err);
        if (!volume)
            stop(&err);
        float *at = volume->voxels;
        for (int k = 0; k < SIDE; k++)
            for (int j = 0; j < SIDE; j++)
                for (int i = 0; i < SIDE; i++) {
                    double x = i - 60.0 - 4.0 * (double)q, y = j - 55.0, z = k - 70.0;
                    *at++ = (float)(10 * exp(-(x * x + y * y + z * z) / (800.0 + 500.0 * (double)q)));
                }
        volume_measure(volume);
        dose->components[q] =
            (struct dose_component){ .quantity = quantities[q], .is_per_ppm = q == 0, .values = volume };
    }
}

/* Weights of four sets over five regions, and six levels of % of a value. */
static void show_dose(struct scene *scene)
{
    struct scene_dose_style *style = &scene->dose;
    free(style->weights);
    style->n_weights = plan->regions.n_regions;
    style->weights = mem_new(style->n_weights * sizeof *style->weights);
    for (size_t i = 0; i < style->n_weights; i++) {
        snprintf(style->weights[i].id, sizeof style->weights[i].id, "%s", plan->regions.regions[i].id);
        style->weights[i].value = scene_tissue_weights_default;
        style->weights[i].value.cbe = 1.3 + 0.5 * (double)(i % 4);
    }
    style->quantity = SCENE_DOSE_QUANTITY_WEIGHTED;
    style->reference.kind = SCENE_DOSE_REFERENCE_KIND_VALUE;
    style->reference.value = 250;
    for (size_t i = 0; i < style->n_levels; i++)
        style->levels[i].value.value = 5 + 15 * (double)i;
    style->wash.below_percent = 5;
    style->wash.visible = true;
}

enum what { PANE, SLICES, SURFACES, CUT, VOLUME };

static struct snapshot *snapshot_of(enum what what, bool has_wash, int step)
{
    struct scene scene;
    struct view view = view_default;
    struct error err = { 0 };
    char field[128];
    scene_for_plan(plan, &scene);
    view.kind = what == PANE ? SCENE_KIND_AXIAL : SCENE_KIND_3D;
    camera_home(plan, view.kind, &view.camera);
    scene.outline.on_slices = false;
    for (size_t i = 0; what != PANE && i < scene.n_regions; i++) {
        scene.regions[i].value.opacity = 1;
        scene.regions[i].value.visible = what == SURFACES || what == CUT;
        scene.regions[i].value.texture = has_wash ? SCENE_TEXTURE_DOSE : SCENE_TEXTURE_NONE;
    }
    scene.image.slices.axial.visible = scene.image.slices.coronal.visible = scene.image.slices.sagittal.visible =
        what == SLICES;
    scene.image.volume.visible = what == VOLUME;
    if (what == CUT)
        scene.clip.axial_high.enabled = scene.clip.sagittal_low.enabled = true;
    if (what == CUT) {
        scene.clip.axial_high.position_mm = 20;
        scene.clip.sagittal_low.position_mm = -20;
    }
    if (what == PANE)
        scene.image.slices.axial.position_mm += step;
    else {
        struct vec3 home = vec3_sub(view.camera.position_mm, view.camera.target_mm);
        double turn = 0.6 + 0.05 * step;
        view.camera.position_mm =
            vec3_add(view.camera.target_mm,
                     vec3_scale(vec3_normalize(vec3(sin(turn), -cos(turn), 0.25)), vec3_length(home)));
    }
    show_dose(&scene);
    scene.dose.wash.visible = has_wash;
    scene.dose.wash.volume = true;
    struct snapshot *snapshot = snapshot_create(derived, &scene, &view, 1, field, &err);
    if (!snapshot)
        stop(&err);
    return snapshot;
}

static double draw_ms(struct renderer *renderer, enum what what, bool has_wash, int step)
{
    struct error err = { 0 };
    struct camera camera;
    struct render_timing timing;
    struct render_options options = { WIDTH, HEIGHT, SURFACE_COARSE, false };
    struct snapshot *snapshot = snapshot_of(what, has_wash, step);
    struct image *image = render_snapshot(renderer, snapshot, &options, &camera, &timing, &err);
    if (!image)
        stop(&err);
    image_destroy(image);
    snapshot_unref(snapshot);
    return (double)(timing.draw_us + timing.read_us) / 1e3;
}

static void bench(const char *name, enum what what)
{
    double with[REPEATS], without[REPEATS], peer[REPEATS] = { 0 };
    (void)draw_ms(soft, what, true, -1); /* makes the surfaces and the field */
    (void)draw_ms(soft, what, false, -1);
    if (gl)
        (void)draw_ms(gl, what, true, -1);
    for (int i = 0; i < REPEATS; i++) {
        with[i] = draw_ms(soft, what, true, i);
        without[i] = draw_ms(soft, what, false, i);
        if (gl)
            peer[i] = draw_ms(gl, what, true, i);
    }
    double ours = median(with), plain = median(without), theirs = median(peer);
    printf("{\"name\":\"wash, %s\",\"value\":%.1f,\"unit\":\"pictures/s\",", name, 1e3 / ours);
    if (gl)
        printf("\"peer\":\"%s, %s\",\"peer_value\":%.1f,\"ratio\":%.2f,",
               render_back_end_word(renderer_facts(gl)->back_end), renderer_facts(gl)->renderer, 1e3 / theirs,
               theirs / ours);
    printf("\"note\":\"%d x %d, %.2f ms, without the wash %.2f ms; dose %d^3 in 4 tissues; %s; median of %d\"}\n",
           WIDTH, HEIGHT, ours, plain, SIDE, renderer_facts(soft)->renderer, REPEATS);
    fflush(stdout);
}

int main(void)
{
    const char *plans = getenv("BEAMROOM_DEMO") ? getenv("BEAMROOM_DEMO") : "build/demo/plans";
    char folder[4096];
    struct error err = { 0 };
    snprintf(folder, sizeof folder, "%s/phantom", plans);
    plan = plan_load(folder, "phantom", NULL, &err);
    if (!plan)
        stop(&err);
    make_dose();
    derived = derive_create(plan);
    soft = renderer_create(RENDER_SOFT, &err);
    for (int back_end = RENDER_EGL_DEVICE; !gl && back_end <= RENDER_OSMESA; back_end++)
        gl = renderer_create((enum render_back_end)back_end, NULL);
    bench("axial pane", PANE);
    bench("3 slices in space", SLICES);
    bench("surfaces of 5 regions", SURFACES);
    bench("surfaces and 2 caps of 5 regions", CUT);
    bench("volume, moving", VOLUME);
    renderer_forget(soft, plan);
    renderer_destroy(soft);
    if (gl) {
        renderer_forget(gl, plan);
        renderer_destroy(gl);
    }
    derive_destroy(derived);
    plan_destroy(plan);
    return 0;
}

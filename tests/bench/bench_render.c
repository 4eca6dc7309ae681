/* Draws and compresses the demo plan as a new room shows it: five surfaces, four of them translucent, and an axial
 * slice. The camera goes round it, with coarse surfaces at 100, 75, 60 and 50 % of 1024 x 768 as while moving, and with
 * full anti-aliased surfaces as in a still; then the axial pane, a new slice with each picture, with the outlines where
 * it cuts the surfaces; then cuts with caps, as in a room that cuts the head open. Our own rasteriser and the OpenGL of
 * this machine draw each picture in turn; the picture is compressed as JPEG and as PNG. Last the size classes that
 * followers are sent, of a picture of 1440 x 900. */
#include <stdio.h>
#include <stdlib.h>

#include "core/base/clock.h"
#include "core/base/image_reduce.h"
#include "core/encode/encode.h"
#include "core/load/load.h"
#include "core/render/render.h"
#include "core/scene/camera.h"

enum { REPEATS = 15 };

static int full_width = 1024, full_height = 768;

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
    fprintf(stderr, "bench_render: %s\n", err->text);
    exit(1);
}

/* Planes that cut the head in a picture, with caps. */
enum cut { CUT_NONE, CUT_SLICE, CUT_THREE, CUT_DRAGGED, CUT_OPENED, CUT_OCCLUDED };

/* CUT_SLICE: an axial plane with the slice in it. CUT_THREE: axial, coronal and sagittal plane through the brain, all
 * five regions opaque. CUT_DRAGGED: an oblique plane too, another one in each picture. CUT_OPENED: those three without
 * caps; CUT_OCCLUDED: and with ambient occlusion. */
static void set_cut(struct scene *scene, enum cut cut, int step)
{
    if (cut == CUT_NONE)
        return;
    scene->clip.axial_high.enabled = true;
    scene->clip.axial_high.position_mm = scene->image.slices.axial.position_mm;
    if (cut == CUT_SLICE)
        return;
    scene->clip.axial_high.position_mm = 20;
    scene->clip.coronal_low.enabled = scene->clip.sagittal_low.enabled = true;
    scene->clip.coronal_low.position_mm = -10;
    scene->clip.sagittal_low.position_mm = -20;
    for (size_t i = 0; i < scene->n_regions; i++)
        scene->regions[i].value.opacity = 1;
    if (cut == CUT_OPENED || cut == CUT_OCCLUDED)
        scene->clip.axial_high.cap = scene->clip.coronal_low.cap = scene->clip.sagittal_low.cap = false;
    scene->still.ambient_occlusion = cut == CUT_OCCLUDED;
    if (cut == CUT_DRAGGED) {
        scene->clip.free.enabled = true;
        scene->clip.free.normal = vec3(1, -1, 2);
        scene->clip.free.origin_mm = vec3(0, 0, 20 + step);
    }
}

/* One picture; step moves the camera round the plan (or the slice through it). */
static struct image *draw(struct renderer *renderer, enum scene_kind kind, int step, double scale,
                          enum surface_detail detail, bool is_still, enum cut cut, struct render_timing *timing)
{
    struct scene scene;
    struct view view = view_default;
    struct error err = { 0 };
    char field[128];
    scene_for_plan(plan, &scene);
    set_cut(&scene, cut, step);
    view.kind = kind;
    camera_home(plan, kind, &view.camera);
    if (kind == SCENE_KIND_3D) {
        struct vec3 home = vec3_sub(view.camera.position_mm, view.camera.target_mm);
        double distance = vec3_length(home), turn = 0.6 + 0.05 * step;
        view.camera.position_mm =
            vec3_add(view.camera.target_mm, vec3_scale(vec3_normalize(vec3(sin(turn), -cos(turn), 0.25)), distance));
    } else
        scene.image.slices.axial.position_mm += step;
    struct snapshot *snapshot = snapshot_create(derived, &scene, &view, 1, field, &err);
    struct render_options options = { (int)(full_width * scale), (int)(full_height * scale), detail, is_still };
    struct camera camera;
    struct image *image = snapshot ? render_snapshot(renderer, snapshot, &options, &camera, timing, &err) : NULL;
    if (!image)
        stop(&err);
    snapshot_unref(snapshot);
    return image;
}

/* Until the picture is in memory: drawing and reading back. */
static double draw_ms(struct renderer *renderer, enum scene_kind kind, int step, double scale,
                      enum surface_detail detail, bool is_still, enum cut cut, struct render_timing *timing)
{
    image_destroy(draw(renderer, kind, step, scale, detail, is_still, cut, timing));
    return (double)(timing->draw_us + timing->read_us) / 1e3;
}

static void bench_cut(const char *name, enum scene_kind kind, double scale, enum surface_detail detail, bool is_still,
                      enum cut cut)
{
    double ours_ms[REPEATS], peer_ms[REPEATS] = { 0 };
    struct render_timing timing;
    (void)draw_ms(soft, kind, -1, scale, detail, is_still, cut, &timing); /* makes the surfaces, uploads */
    if (gl)
        (void)draw_ms(gl, kind, -1, scale, detail, is_still, cut, &timing);
    for (int i = 0; i < REPEATS; i++) {
        if (gl)
            peer_ms[i] = draw_ms(gl, kind, i, scale, detail, is_still, cut, &timing);
        ours_ms[i] = draw_ms(soft, kind, i, scale, detail, is_still, cut, &timing);
    }
    double ours = median(ours_ms), peer = median(peer_ms);
    printf("{\"name\":\"draw, %s\",\"value\":%.2f,\"unit\":\"ms\",", name, ours);
    if (gl)
        printf("\"peer\":\"%s, %s\",\"peer_value\":%.2f,\"ratio\":%.2f,",
               render_back_end_word(renderer_facts(gl)->back_end), renderer_facts(gl)->renderer, peer, peer / ours);
    printf("\"note\":\"%d x %d, %zu triangles%s; %s; median of %d\"}\n", (int)(full_width * scale),
           (int)(full_height * scale), timing.n_triangles, is_still ? ", anti-aliased" : "",
           renderer_facts(soft)->renderer, REPEATS);
}

static void bench_drawing(const char *name, enum scene_kind kind, double scale, enum surface_detail detail,
                          bool is_still)
{
    bench_cut(name, kind, scale, detail, is_still, CUT_NONE);
}

static void bench_encoding(const char *name, struct encode_options options)
{
    struct encoder *encoder = encoder_create();
    struct render_timing timing;
    struct image *image = draw(soft, SCENE_KIND_3D, 3, 1, SURFACE_FULL, true, CUT_NONE, &timing);
    double ms[REPEATS];
    size_t n_bytes = 0;
    for (int i = 0; i < REPEATS; i++) {
        struct error err = { 0 };
        struct encoded out;
        int64_t began_us = clock_now_us();
        if (!encode_image(encoder, image, &options, &out, &err))
            stop(&err);
        ms[i] = (double)(clock_now_us() - began_us) / 1e3;
        n_bytes = out.n_bytes;
        free(out.bytes);
    }
    printf("{\"name\":\"encode, %s\",\"value\":%.2f,\"unit\":\"ms\",\"note\":\"%d x %d, %zu bytes; median of %d\"}\n",
           name, median(ms), full_width, full_height, n_bytes, REPEATS);
    image_destroy(image);
    encoder_destroy(encoder);
}

/* Cost that followers with small windows add to a picture of 1440 x 900: each size class reduced and compressed, beside
 * the whole picture drawn and compressed. divisor 1: the whole one. */
static void bench_class(const char *name, const struct image *image, double draw_ms, int divisor,
                        struct encode_options options)
{
    struct encoder *encoder = encoder_create();
    double ms[REPEATS], reduce_ms[REPEATS];
    size_t n_bytes = 0;
    for (int i = 0; i < REPEATS; i++) {
        struct error err = { 0 };
        struct encoded out;
        int64_t began_us = clock_now_us();
        struct image *reduced = divisor > 1 ? image_reduce(image, divisor, &err) : NULL;
        reduce_ms[i] = (double)(clock_now_us() - began_us) / 1e3;
        if ((divisor > 1 && !reduced) || !encode_image(encoder, reduced ? reduced : image, &options, &out, &err))
            stop(&err);
        ms[i] = (double)(clock_now_us() - began_us) / 1e3;
        n_bytes = out.n_bytes;
        free(out.bytes);
        image_destroy(reduced);
    }
    printf("{\"name\":\"size class 1/%d, %s\",\"value\":%.2f,\"unit\":\"ms\",\"note\":\"%zu bytes; reducing alone %.2f "
           "ms; the whole picture is drawn in %.1f ms; median of %d\"}\n",
           divisor, name, median(ms), n_bytes, median(reduce_ms), draw_ms, REPEATS);
    encoder_destroy(encoder);
}

static void bench_classes(const char *name, enum scene_kind kind, bool is_still)
{
    const struct encode_options options = { ENCODE_JPEG, is_still ? 92 : 80, is_still };
    struct render_timing timing;
    full_width = 1440;
    full_height = 900;
    image_destroy(draw(soft, kind, 2, 1, is_still ? SURFACE_FULL : SURFACE_COARSE, is_still, CUT_NONE, &timing));
    struct image *image = draw(soft, kind, 3, 1, is_still ? SURFACE_FULL : SURFACE_COARSE, is_still, CUT_NONE, &timing);
    for (int divisor = 1; divisor <= 4; divisor *= 2)
        bench_class(name, image, (double)(timing.draw_us + timing.read_us) / 1e3, divisor, options);
    image_destroy(image);
}

static struct renderer *start(enum render_back_end back_end)
{
    struct error err = { 0 };
    int64_t began_us = clock_now_us();
    struct renderer *renderer = renderer_create(back_end, &err);
    if (renderer)
        printf("{\"name\":\"start %s\",\"value\":%.1f,\"unit\":\"ms\",\"note\":\"%s\"}\n",
               render_back_end_word(back_end), (double)(clock_now_us() - began_us) / 1e3,
               renderer_facts(renderer)->renderer);
    return renderer;
}

int main(void)
{
    const char *plans = getenv("BEAMROOM_DEMO") ? getenv("BEAMROOM_DEMO") : "build/demo/plans";
    char folder[4096];
    struct error err = { 0 };
    snprintf(folder, sizeof folder, "%s/phantom", plans);
    plan = plan_load(folder, "phantom", NULL, &err);
    derived = plan ? derive_create(plan) : NULL;
    if (!plan)
        stop(&err);
    soft = start(RENDER_SOFT);
    for (int back_end = RENDER_EGL_DEVICE; !gl && back_end <= RENDER_OSMESA; back_end++)
        gl = start((enum render_back_end)back_end);

    bench_drawing("moving", SCENE_KIND_3D, 1, SURFACE_COARSE, false);
    bench_drawing("moving at 75 %", SCENE_KIND_3D, 0.75, SURFACE_COARSE, false);
    bench_drawing("moving at 60 %", SCENE_KIND_3D, 0.6, SURFACE_COARSE, false);
    bench_drawing("moving at 50 %", SCENE_KIND_3D, 0.5, SURFACE_COARSE, false);
    bench_drawing("still", SCENE_KIND_3D, 1, SURFACE_FULL, true);
    bench_drawing("axial pane", SCENE_KIND_AXIAL, 1, SURFACE_COARSE, false);
    bench_cut("moving, slice and cap", SCENE_KIND_3D, 1, SURFACE_COARSE, false, CUT_SLICE);
    bench_cut("moving, 3 caps of 5 opaque regions", SCENE_KIND_3D, 1, SURFACE_COARSE, false, CUT_THREE);
    bench_cut("dragging an oblique plane, 4 caps", SCENE_KIND_3D, 1, SURFACE_COARSE, false, CUT_DRAGGED);
    bench_cut("still, 3 caps of 5 opaque regions", SCENE_KIND_3D, 1, SURFACE_FULL, true, CUT_THREE);
    bench_cut("still, opened, 5 opaque regions", SCENE_KIND_3D, 1, SURFACE_FULL, true, CUT_OPENED);
    bench_cut("still, opened, ambient occlusion", SCENE_KIND_3D, 1, SURFACE_FULL, true, CUT_OCCLUDED);
    bench_encoding("JPEG quality 80 4:2:0", (struct encode_options){ ENCODE_JPEG, 80, false });
    bench_encoding("JPEG quality 92 4:4:4", (struct encode_options){ ENCODE_JPEG, 92, true });
    bench_encoding("PNG", (struct encode_options){ ENCODE_PNG, 0, false });
    bench_classes("3-D, moving", SCENE_KIND_3D, false);
    bench_classes("3-D, still", SCENE_KIND_3D, true);
    bench_classes("axial pane, moving", SCENE_KIND_AXIAL, false);
    bench_classes("axial pane, still", SCENE_KIND_AXIAL, true);

    renderer_forget(soft, plan);
    renderer_destroy(soft);
    if (gl)
        renderer_forget(gl, plan);
    renderer_destroy(gl);
    derive_destroy(derived);
    plan_destroy(plan);
    return 0;
}

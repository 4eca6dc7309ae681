/* Draws a million segments of particle tracks of about 10 mm, in a ball as large as a head, at 1024 x 768: alone, and
 * in the demo plan as a new room shows it; moving and still, with the camera going round. A moving picture of them
 * alone must take 50 ms at most: twenty a second. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "core/load/load.h"
#include "core/render/render.h"
#include "core/scene/camera.h"

enum { N_SEGMENTS = 1000000, REPEATS = 15, WIDTH = 1024, HEIGHT = 768 };
static const double most_ms = 50, ball_mm = 95, length_mm = 10;

static struct renderer *renderer;
static struct plan *plan;
static struct derive *derived;

static void stop(const struct error *err)
{
    fprintf(stderr, "bench_tracks: %s\n", err->text);
    exit(1);
}

static int compare(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

/* xorshift; -1 .. 1 */
static double random_number(void)
{
    static uint64_t state = 88172645463325252u;
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return (double)(state >> 11) * 0x1p-52 - 1;
}

static struct vec3 random_in_ball(double radius)
{
    for (;;) {
        struct vec3 p = vec3(random_number(), random_number(), random_number());
        if (vec3_dot(p, p) <= 1)
            return vec3_scale(p, radius);
    }
}

/* In place of the plan's own: in paths of 20 segments, as particles go. */
static void make_tracks(void)
{
    struct box3 box = plan->bounds_lps_mm;
    struct vec3 middle = vec3_scale(vec3_add(box.low, box.high), 0.5), at = middle;
    track_set_finish(&plan->tracks);
    plan->tracks.segments = mem_new(N_SEGMENTS * sizeof *plan->tracks.segments);
    plan->tracks.n_segments = N_SEGMENTS;
    for (size_t i = 0; i < N_SEGMENTS; i++) {
        struct track_segment *segment = &plan->tracks.segments[i];
        if (i % 20 == 0)
            at = vec3_add(middle, random_in_ball(ball_mm));
        struct vec3 way = vec3_normalize(random_in_ball(1));
        struct vec3 to = vec3_add(at, vec3_scale(way, length_mm * (1 + 0.5 * random_number())));
        if (vec3_length(vec3_sub(to, middle)) > ball_mm)
            to = vec3_add(at, vec3_scale(vec3_normalize(vec3_sub(middle, at)), length_mm));
        *segment = (struct track_segment){ .from_lps_mm = { (float)at.x, (float)at.y, (float)at.z },
                                           .to_lps_mm = { (float)to.x, (float)to.y, (float)to.z },
                                           .energy_mev = NAN,
                                           .class = (uint8_t)(i / 20 % TRACK_LOST) };
        plan->tracks.n_of_class[segment->class]++;
        at = to;
    }
}

static double draw_ms(int step, bool is_alone, bool is_still)
{
    struct scene scene;
    struct view view = view_default;
    struct error err = { 0 };
    char field[128];
    scene_for_plan(plan, &scene);
    scene.tracks.visible = true;
    for (size_t i = 0; is_alone && i < scene.n_regions; i++)
        scene.regions[i].value.visible = false;
    if (is_alone)
        scene.image.slices.axial.visible = scene.image.slices.coronal.visible = scene.image.slices.sagittal.visible =
            false;
    camera_home(plan, SCENE_KIND_3D, &view.camera);
    double distance = vec3_length(vec3_sub(view.camera.position_mm, view.camera.target_mm)), turn = 0.6 + 0.05 * step;
    view.camera.position_mm =
        vec3_add(view.camera.target_mm, vec3_scale(vec3_normalize(vec3(sin(turn), -cos(turn), 0.25)), distance));
    int64_t began_us = clock_now_us();
    struct snapshot *snapshot = snapshot_create(derived, &scene, &view, 1, field, &err);
    struct render_options options = { WIDTH, HEIGHT, is_still ? SURFACE_FULL : SURFACE_COARSE, is_still };
    struct camera camera;
    struct render_timing timing;
    struct image *image = snapshot ? render_snapshot(renderer, snapshot, &options, &camera, &timing, &err) : NULL;
    if (!image)
        stop(&err);
    double ms = (double)(clock_now_us() - began_us) / 1e3;
    if (getenv("BENCH_PICTURE") && step == 3) {
        FILE *file = fopen(getenv("BENCH_PICTURE"), "wb");
        fprintf(file, "P6 %d %d 255\n", WIDTH, HEIGHT);
        for (size_t i = 0; i < WIDTH * HEIGHT; i++)
            fwrite(image->rgba + 4 * i, 1, 3, file);
        fclose(file);
    }
    image_destroy(image);
    snapshot_unref(snapshot);
    return ms;
}

/* Processor time of all threads of this program. */
static double processor_ms(void)
{
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return 1e3 * (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
           1e-3 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

/* The median, ms. */
static double bench(const char *name, bool is_alone, bool is_still)
{
    double ms[REPEATS];
    (void)draw_ms(-1, is_alone, is_still); /* makes the surfaces and the buffers */
    double began_ms = processor_ms();
    for (int i = 0; i < REPEATS; i++)
        ms[i] = draw_ms(i, is_alone, is_still);
    double busy_ms = (processor_ms() - began_ms) / REPEATS;
    qsort(ms, REPEATS, sizeof ms[0], compare);
    double middle = ms[REPEATS / 2];
    printf("{\"name\":\"%s\",\"value\":%.1f,\"unit\":\"ms\",\"note\":\"%.1f pictures/s, %d x %d, %d segments; %s; "
           "median of %d, fastest %.1f, processors busy %.1f\"}\n",
           name, middle, 1000 / middle, WIDTH, HEIGHT, N_SEGMENTS, renderer_facts(renderer)->renderer, REPEATS, ms[0],
           busy_ms);
    return middle;
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
    make_tracks();
    derived = derive_create(plan);
    renderer = renderer_create(RENDER_SOFT, &err);
    if (!renderer)
        stop(&err);
    double moving_ms = bench("tracks, moving", true, false);
    bench("tracks among the demo plan's regions, moving", false, false);
    bench("tracks, still", true, true);
    bench("tracks among the demo plan's regions, still", false, true);
    renderer_forget(renderer, plan);
    renderer_destroy(renderer);
    derive_destroy(derived);
    plan_destroy(plan);
    if (moving_ms <= most_ms)
        return 0;
    fprintf(stderr, "bench_tracks: a moving picture takes %.1f ms, more than %.0f\n", moving_ms, most_ms);
    return 1;
}

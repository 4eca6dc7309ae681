/* Pictures of many tracks: our own rasteriser and OpenGL draw the same ones, and our own gives equal bytes on any
 * processor and with any number of threads. */
#include "tests/render/track_scene.h"

enum { N_TRACKS = 1500 };

/* Makes tracks of all classes, in and around the ball, some from far away. */
static struct plan *make_many(void)
{
    struct plan *plan = tracks_plan();
    tracks_random_begin();
    for (int i = 0; i < N_TRACKS; i++) {
        struct vec3 from = tracks_random_in_ball(38), way = tracks_random_in_ball(i % 50 ? 12 : 400);
        tracks_add(plan, (enum track_class)(i % TRACK_N_CLASSES), from, vec3_add(from, way));
    }
    return plan;
}

struct shot {
    const char *name;
    double width_px, least_db;
    bool is_still, is_parallel, is_cut, is_inside;
};
/* A sample of a line's edge goes either way where places are rounded to 1/256 of a sample. */
static const struct shot shots[] = {
    { .name = "still", .width_px = 1.5, .least_db = 38, .is_still = true },
    { .name = "still, wide, cut", .width_px = 4, .least_db = 38, .is_still = true, .is_cut = true },
    { .name = "moving", .width_px = 1.5, .least_db = 26 },
    { .name = "moving, wide, parallel", .width_px = 3, .least_db = 40, .is_parallel = true },
    { .name = "moving, cut, parallel", .width_px = 1, .least_db = 26, .is_cut = true, .is_parallel = true },
    { .name = "still, from inside", .width_px = 2, .least_db = 38, .is_still = true, .is_inside = true },
    { .name = "moving, from inside", .width_px = 1, .least_db = 26, .is_inside = true },
};
enum { N_SHOTS = sizeof shots / sizeof shots[0] };

static struct image *take(struct renderer *renderer, struct plan *plan, const struct shot *shot)
{
    struct scene scene = tracks_scene(plan);
    struct renderer *other = shots_renderer;
    shots_style(&scene, "ball")->visible = !shot->is_inside;
    shots_style(&scene, "ball")->opacity = 0.3;
    scene.tracks.width_px = shot->width_px;
    scene.tracks.depth_cue = true;
    scene.clip.free.enabled = scene.clip.axial_high.enabled = shot->is_cut;
    scene.clip.free.normal = vec3(1, -1, 0.5);
    scene.clip.axial_high.position_mm = 9;
    struct view view = shots_view_from(tracks_middle, vec3(0.5, -1, 0.4), tracks_up, TRACKS_PX_PER_MM);
    if (!shot->is_parallel) {
        view.camera.projection = SCENE_PROJECTION_PERSPECTIVE;
        view.camera.has_height_mm = false;
        view.camera.position_mm = shot->is_inside ? vec3(5, -8, 4) : vec3(70, -140, 56);
    }
    shots_renderer = renderer;
    struct image *image = tracks_take(plan, &scene, view, shot->is_still);
    shots_renderer = other;
    scene_finish(&scene);
    return image;
}

static double psnr_db(const struct image *a, const struct image *b)
{
    size_t n = (size_t)a->width_px * (size_t)a->height_px;
    double sum = 0;
    for (size_t i = 0; i < 4 * n; i++)
        if (i % 4 < 3)
            sum += pow((double)a->rgba[i] - (double)b->rgba[i], 2);
    return sum > 0 ? 10 * log10(255.0 * 255.0 * 3 * (double)n / sum) : INFINITY;
}

static void tracks_are_the_same_as_without_opengl(void **context)
{
    (void)context;
    struct renderer *soft = renderer_create(RENDER_SOFT, NULL);
    struct plan *plan = make_many();
    bool is_good = true;
    for (size_t i = 0; i < N_SHOTS; i++) {
        struct image *a = take(soft, plan, &shots[i]), *b = take(shots_renderer, plan, &shots[i]);
        double db = psnr_db(a, b);
        printf("  %s: %.1f dB\n", shots[i].name, db);
        is_good &= db >= shots[i].least_db;
        image_destroy(a);
        image_destroy(b);
    }
    assert_true(is_good);
    renderer_destroy(soft);
    shots_forget(plan);
}

static void threads_and_processors_make_no_difference(void **context)
{
    (void)context;
    static const struct {
        int n_threads;
        bool is_portable;
    } ways[] = { { 1, false }, { 3, false }, { 2, true } };
    struct plan *plan = make_many();
    for (size_t i = 0; i < N_SHOTS; i++) {
        struct image *first = NULL;
        for (size_t way = 0; way < sizeof ways / sizeof ways[0]; way++) {
            struct renderer *soft = renderer_create(RENDER_SOFT, NULL);
            renderer_tune(soft, ways[way].n_threads, ways[way].is_portable);
            struct image *image = take(soft, plan, &shots[i]);
            if (first)
                assert_memory_equal(first->rgba, image->rgba, (size_t)SHOTS_WIDTH * SHOTS_HEIGHT * 4);
            image_destroy(first ? image : NULL);
            first = first ? first : image;
            renderer_destroy(soft);
        }
        image_destroy(first);
    }
    shots_forget(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tracks_are_the_same_as_without_opengl),
        cmocka_unit_test(threads_and_processors_make_no_difference),
    };
    return shots_run_drivers("tracks, agreement", tests, sizeof tests / sizeof tests[0]);
}

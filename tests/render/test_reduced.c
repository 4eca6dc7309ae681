/* Pictures at a half and a quarter of their size, as the pipeline makes them beside the whole one. */
#include <pthread.h>

#include "core/pipeline/pipeline.h"
#include "tests/render/shots.h"

enum { WIDTH = 403, HEIGHT = 301 }; /* no multiples */

struct receiver {
    pthread_mutex_t mutex;
    pthread_cond_t came;
    bool has_come;
    struct pipeline_frame frame;
};

static void on_started(void *context, const struct render_facts *facts, const struct error *err)
{
    (void)context, (void)facts, (void)err;
}

static void on_frame(void *context, struct pipeline_frame *frame)
{
    struct receiver *receiver = context;
    pthread_mutex_lock(&receiver->mutex);
    receiver->frame = *frame;
    receiver->has_come = true;
    pthread_cond_signal(&receiver->came);
    pthread_mutex_unlock(&receiver->mutex);
}

static double nested(struct vec3 p)
{
    double r = vec3_length(vec3_sub(p, vec3(2, -1, 1)));
    return r < 5 ? 2 : r < 13 ? 1 : 0;
}
static double waves(struct vec3 p)
{
    return 200 * sin(p.x * 0.7) * cos(p.y * 0.5) + 10 * p.z;
}
static const struct made_region regions[] = { { "outer", -1, 0xd8a890 }, { "inner", 0, 0x50c060 } };

static const struct encode_options jpeg = { ENCODE_JPEG, 92, true };
static const struct render_options still = { WIDTH, HEIGHT, SURFACE_FULL, true };

static struct snapshot *make_snapshot(struct plan *plan, enum scene_kind kind)
{
    struct scene scene;
    struct view view = view_default;
    struct error err = { 0 };
    char field[128];
    scene_for_plan(plan, &scene);
    view.kind = kind;
    view.size_px[0] = WIDTH;
    view.size_px[1] = HEIGHT;
    struct snapshot *snapshot = snapshot_create(derived_of(plan), &scene, &view, 1, field, &err);
    assert_non_null(snapshot);
    return snapshot;
}

static struct pipeline_frame draw(struct pipeline *pipeline, struct receiver *receiver, struct snapshot *snapshot,
                                  bool half, bool quarter)
{
    const struct pipeline_request request = {
        .id = 1, .snapshot = snapshot, .render = still, .encode = jpeg, .is_reduced = { half, quarter }
    };
    struct error err = { 0 };
    receiver->has_come = false;
    assert_true(pipeline_submit(pipeline, &request, &err));
    pthread_mutex_lock(&receiver->mutex);
    while (!receiver->has_come)
        pthread_cond_wait(&receiver->came, &receiver->mutex);
    pthread_mutex_unlock(&receiver->mutex);
    assert_int_equal(receiver->frame.error.code, ERROR_NONE);
    return receiver->frame;
}

/* The bytes that an image of these means has. */
static void expect_reduced(const struct encoded *is, const struct image *whole, int divisor)
{
    struct error err = { 0 };
    const int width = (int)ceil((double)WIDTH / divisor), height = (int)ceil((double)HEIGHT / divisor);
    struct image *means = image_create(width, height, &err);
    struct encoder *encoder = encoder_create();
    struct encoded expected;
    for (int i = 0; i < width * height * 4; i++) {
        const int column = i / 4 % width, row = i / 4 / width;
        double sum = 0;
        int n = 0;
        for (int y = row * divisor; y < (row + 1) * divisor && y < HEIGHT; y++)
            for (int x = column * divisor; x < (column + 1) * divisor && x < WIDTH; x++, n++)
                sum += whole->rgba[4 * (y * WIDTH + x) + i % 4];
        means->rgba[i] = (uint8_t)floor(sum / n + 0.5);
    }
    assert_true(encode_image(encoder, means, &jpeg, &expected, &err));
    assert_int_equal(is->n_bytes, expected.n_bytes);
    assert_memory_equal(is->bytes, expected.bytes, expected.n_bytes);
    free(expected.bytes);
    encoder_destroy(encoder);
    image_destroy(means);
}

static void free_frame(struct pipeline_frame *frame)
{
    free(frame->picture.bytes);
    for (int i = 0; i < IMAGE_N_REDUCED; i++)
        free(frame->reduced[i].bytes);
}

static void expect_all(struct pipeline *pipeline, struct receiver *receiver, struct plan *plan, enum scene_kind kind)
{
    struct error err = { 0 };
    struct camera camera;
    struct render_timing timing;
    struct snapshot *snapshot = make_snapshot(plan, kind);
    struct image *whole = render_snapshot(shots_renderer, snapshot, &still, &camera, &timing, &err);
    assert_non_null(whole);
    struct pipeline_frame alone = draw(pipeline, receiver, snapshot_ref(snapshot), false, false);
    struct pipeline_frame all = draw(pipeline, receiver, snapshot_ref(snapshot), true, true);
    struct pipeline_frame quarter = draw(pipeline, receiver, snapshot, false, true);
    assert_null(alone.reduced[0].bytes);
    assert_null(alone.reduced[1].bytes);
    assert_null(quarter.reduced[0].bytes);
    assert_int_equal(all.picture.n_bytes, alone.picture.n_bytes); /* the whole picture is what it was */
    assert_memory_equal(all.picture.bytes, alone.picture.bytes, alone.picture.n_bytes);
    expect_reduced(&all.reduced[0], whole, 2);
    expect_reduced(&all.reduced[1], whole, 4);
    expect_reduced(&quarter.reduced[1], whole, 4);
    free_frame(&alone);
    free_frame(&all);
    free_frame(&quarter);
    image_destroy(whole);
}

static void reduced_pictures_have_the_means_of_the_whole_which_stays_the_same(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(32);
    struct plan *plan = made_plan(&grid, nested, regions, 2);
    made_plan_add_image(plan, &grid, VOXEL_I16, waves);
    struct receiver receiver = { .mutex = PTHREAD_MUTEX_INITIALIZER, .came = PTHREAD_COND_INITIALIZER };
    struct pipeline_callbacks callbacks = { on_started, on_frame, &receiver };
    struct error err = { 0 };
    struct pipeline *pipeline = pipeline_create(RENDER_SOFT, false, &callbacks, &err);
    assert_non_null(pipeline);
    expect_all(pipeline, &receiver, plan, SCENE_KIND_3D);
    expect_all(pipeline, &receiver, plan, SCENE_KIND_AXIAL);
    pipeline_destroy(pipeline);
    shots_forget(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reduced_pictures_have_the_means_of_the_whole_which_stays_the_same),
    };
    return shots_run_soft("reduced", tests, sizeof tests / sizeof tests[0]);
}

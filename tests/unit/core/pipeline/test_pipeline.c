/* The threads of the pipeline, with the stub behind render.h: drivers and sanitizers do not get on. */
#include <pthread.h>
#include <unistd.h>

#include "core/pipeline/pipeline.h"
#include "tests/check.h"
#include "tests/derived_of.h"
#include "tests/made_plan.h"

enum { MAX_FRAMES = 256 };

struct receiver {
    pthread_mutex_t mutex;
    pthread_cond_t changed;
    bool is_started, has_facts;
    struct error why_not;
    bool is_closed; /* a delivery waits until it is opened */
    int hold_ms;    /* how long a delivery takes */
    size_t n_frames;
    uint64_t ids[MAX_FRAMES];
    enum error_code codes[MAX_FRAMES];
    struct pipeline_frame last; /* its picture kept */
};

static void receiver_init(struct receiver *receiver)
{
    *receiver = (struct receiver){ 0 };
    pthread_mutex_init(&receiver->mutex, NULL);
    pthread_cond_init(&receiver->changed, NULL);
}

static void receiver_finish(struct receiver *receiver)
{
    free(receiver->last.picture.bytes);
    free(receiver->last.marked.bytes);
    pthread_cond_destroy(&receiver->changed);
    pthread_mutex_destroy(&receiver->mutex);
}

static void on_started(void *context, const struct render_facts *facts, const struct error *err)
{
    struct receiver *receiver = context;
    pthread_mutex_lock(&receiver->mutex);
    receiver->is_started = true;
    receiver->has_facts = facts != NULL;
    receiver->why_not = *err;
    pthread_cond_broadcast(&receiver->changed);
    pthread_mutex_unlock(&receiver->mutex);
}

static void on_frame(void *context, struct pipeline_frame *frame)
{
    struct receiver *receiver = context;
    pthread_mutex_lock(&receiver->mutex);
    while (receiver->is_closed)
        pthread_cond_wait(&receiver->changed, &receiver->mutex);
    if (receiver->hold_ms)
        usleep((useconds_t)receiver->hold_ms * 1000);
    if (receiver->n_frames == MAX_FRAMES)
        abort();
    receiver->codes[receiver->n_frames] = frame->error.code;
    receiver->ids[receiver->n_frames++] = frame->id;
    free(receiver->last.picture.bytes);
    free(receiver->last.marked.bytes);
    receiver->last = *frame;
    pthread_cond_broadcast(&receiver->changed);
    pthread_mutex_unlock(&receiver->mutex);
}

static void wait_for(struct receiver *receiver, size_t n_frames)
{
    pthread_mutex_lock(&receiver->mutex);
    while (!receiver->is_started || receiver->n_frames < n_frames)
        pthread_cond_wait(&receiver->changed, &receiver->mutex);
    pthread_mutex_unlock(&receiver->mutex);
}

static void open_receiver(struct receiver *receiver)
{
    pthread_mutex_lock(&receiver->mutex);
    receiver->is_closed = false;
    pthread_cond_broadcast(&receiver->changed);
    pthread_mutex_unlock(&receiver->mutex);
}

static double label(struct vec3 p)
{
    return vec3_length(p) < 5;
}
static const struct made_region ball[] = { { "ball", -1, 0xff0000 } };

static struct plan *small_plan(void)
{
    struct grid grid = made_cube_grid(16);
    return made_plan(&grid, label, ball, 1);
}

static struct pipeline *start_back_end(struct receiver *receiver, enum render_back_end back_end, bool is_stub)
{
    struct pipeline_callbacks callbacks = { on_started, on_frame, receiver };
    struct error err = { 0 };
    struct pipeline *pipeline = pipeline_create(back_end, is_stub, &callbacks, &err);
    assert_non_null(pipeline);
    return pipeline;
}

static struct pipeline *start(struct receiver *receiver)
{
    return start_back_end(receiver, RENDER_AUTO, true);
}

static bool submit_picture(struct pipeline *pipeline, struct plan *plan, uint64_t id, uint64_t source, int width_px,
                           int height_px, bool is_still, struct error *err)
{
    struct scene scene;
    struct view view = view_default;
    char field[128];
    scene_for_plan(plan, &scene);
    struct snapshot *snapshot = snapshot_create(derived_of(plan), &scene, &view, (uint32_t)id, field, err);
    struct pipeline_request request = { .id = id,
                                        .source = source,
                                        .snapshot = snapshot,
                                        .render = { width_px, height_px, SURFACE_COARSE, is_still },
                                        .encode = { ENCODE_JPEG, 80, false } };
    return pipeline_submit(pipeline, &request, err);
}

static bool submit_kind(struct pipeline *pipeline, struct plan *plan, uint64_t id, int width_px, bool is_still,
                        struct error *err)
{
    return submit_picture(pipeline, plan, id, 1, width_px, 48, is_still, err);
}

static bool submit(struct pipeline *pipeline, struct plan *plan, uint64_t id, int width_px, struct error *err)
{
    return submit_kind(pipeline, plan, id, width_px, true, err);
}

static void frames_come_back_in_order_and_none_is_lost(void **state)
{
    (void)state;
    struct receiver receiver;
    receiver_init(&receiver);
    struct plan *plan = small_plan();
    struct pipeline *pipeline = start(&receiver);
    for (uint64_t id = 1; id <= 200; id++) {
        struct error err = { 0 };
        while (!submit(pipeline, plan, id, 64, &err)) { /* full: what a caller does is its business; here it waits */
            assert_int_equal(err.code, ERROR_LIMIT);
            usleep(500);
        }
    }
    wait_for(&receiver, 200);
    for (size_t i = 0; i < 200; i++)
        assert_int_equal(receiver.ids[i], i + 1);
    assert_true(receiver.has_facts);
    assert_int_equal(receiver.last.error.code, ERROR_NONE);
    assert_int_equal(receiver.last.width_px, 64);
    assert_int_equal(receiver.last.height_px, 48);
    assert_true(receiver.last.is_still);
    assert_true(receiver.last.picture.n_bytes > 100);
    assert_int_equal(receiver.last.picture.bytes[0], 0xff); /* a JPEG begins so */
    assert_int_equal(receiver.last.picture.bytes[1], 0xd8);
    /* the view's own camera, also from the stub: 30 degrees to the side and 12 above */
    assert_close(receiver.last.camera.forward.y, cos(MATH_PI / 6) * cos(MATH_PI / 15), 1e-9);
    pipeline_destroy(pipeline);
    plan_and_derived_destroy(plan);
    receiver_finish(&receiver);
}

static void a_marked_copy_is_made_where_words_are_given_and_the_picture_is_what_it_was(void **state)
{
    (void)state;
    struct receiver receiver;
    receiver_init(&receiver);
    struct plan *plan = small_plan();
    struct pipeline *pipeline = start(&receiver);
    struct encoded plain;
    for (int is_marked = 0; is_marked < 2; is_marked++) {
        struct error err = { 0 };
        struct scene scene = { 0 };
        struct view view = view_default;
        char field[128];
        scene_for_plan(plan, &scene);
        struct snapshot *snapshot = snapshot_create(derived_of(plan), &scene, &view, 0, field, &err);
        const struct pipeline_request request = { .id = (uint64_t)is_marked,
                                                  .snapshot = snapshot,
                                                  .render = { 320, 240, SURFACE_COARSE, true },
                                                  .encode = { ENCODE_JPEG, 80, false },
                                                  .mark = is_marked ? "Draft beam" : NULL };
        assert_true(pipeline_submit(pipeline, &request, &err));
        wait_for(&receiver, (size_t)is_marked + 1);
        if (!is_marked) {
            assert_null(receiver.last.marked.bytes);
            plain = receiver.last.picture;
            receiver.last.picture = (struct encoded){ 0 };
        }
    }
    assert_int_equal(receiver.last.picture.n_bytes, plain.n_bytes);
    assert_memory_equal(receiver.last.picture.bytes, plain.bytes, plain.n_bytes);
    assert_true(receiver.last.marked.n_bytes > plain.n_bytes); /* of grey alone */
    free(plain.bytes);
    pipeline_destroy(pipeline);
    plan_and_derived_destroy(plan);
    receiver_finish(&receiver);
}

static void moving_pictures_overtake_stills_but_not_for_ever(void **state)
{
    (void)state;
    struct receiver receiver;
    receiver_init(&receiver);
    receiver.is_closed = true; /* no picture leaves before all are asked for */
    struct plan *plan = small_plan();
    struct pipeline *pipeline = start(&receiver);
    struct error err = { 0 };
    uint64_t id = 1;
    for (; id <= 6; id++) /* more than both threads can have taken meanwhile */
        assert_true(submit_kind(pipeline, plan, id, 64, false, &err));
    assert_true(submit_kind(pipeline, plan, 100, 64, true, &err));
    assert_true(submit_kind(pipeline, plan, 101, 64, true, &err));
    for (; id <= 16; id++)
        assert_true(submit_kind(pipeline, plan, id, 64, false, &err));
    open_receiver(&receiver);
    wait_for(&receiver, 18);
    for (size_t i = 0; i < 14; i++) /* eight of the ten that came after the stills */
        assert_int_equal(receiver.ids[i], i + 1);
    assert_int_equal(receiver.ids[14], 100);
    assert_int_equal(receiver.ids[15], 101);
    assert_int_equal(receiver.ids[16], 15);
    assert_int_equal(receiver.ids[17], 16);
    pipeline_destroy(pipeline);
    plan_and_derived_destroy(plan);
    receiver_finish(&receiver);
}

static void what_is_dropped_while_it_waits_is_not_drawn(void **state)
{
    (void)state;
    struct receiver receiver;
    receiver_init(&receiver);
    receiver.is_closed = true;
    struct plan *plan = small_plan();
    struct pipeline *pipeline = start(&receiver);
    struct error err = { 0 };
    /* until the receiver is opened at most three are drawn: one with the encode thread, two that wait for it */
    for (uint64_t id = 1; id <= 20; id++)
        assert_true(submit(pipeline, plan, id, 64, &err));
    for (uint64_t id = 10; id <= 19; id++)
        pipeline_drop(pipeline, id);
    pipeline_drop(pipeline, 1000); /* never submitted */
    open_receiver(&receiver);
    wait_for(&receiver, 10);
    for (size_t i = 0; i < 9; i++)
        assert_int_equal(receiver.ids[i], i + 1);
    assert_int_equal(receiver.ids[9], 20);
    pipeline_destroy(pipeline);
    plan_and_derived_destroy(plan);
    receiver_finish(&receiver);
}

/* More drops than messages fit in the inbox: those that find no room do nothing, and no request is lost. */
static void any_number_of_drops_blocks_nobody_and_loses_no_request(void **state)
{
    (void)state;
    struct receiver receiver;
    receiver_init(&receiver);
    struct plan *plan = small_plan();
    struct pipeline *pipeline = start(&receiver);
    struct error err = { 0 };
    for (uint64_t id = 1; id <= 40; id++) {
        for (uint64_t unknown = 1000; unknown < 1500; unknown++)
            pipeline_drop(pipeline, unknown);
        assert_true(submit(pipeline, plan, id, 64, &err));
    }
    wait_for(&receiver, 40);
    for (size_t i = 0; i < 40; i++)
        assert_int_equal(receiver.ids[i], i + 1);
    pipeline_destroy(pipeline);
    plan_and_derived_destroy(plan);
    receiver_finish(&receiver);
}

static void a_picture_that_cannot_be_drawn_comes_back_as_an_error(void **state)
{
    (void)state;
    struct receiver receiver;
    receiver_init(&receiver);
    struct plan *plan = small_plan();
    struct pipeline *pipeline = start(&receiver);
    struct error err = { 0 };
    assert_true(submit(pipeline, plan, 5, 0, &err));
    assert_true(submit(pipeline, plan, 6, 64, &err));
    wait_for(&receiver, 2);
    assert_int_equal(receiver.ids[0], 5);
    assert_int_equal(receiver.codes[0], ERROR_RANGE); /* no picture is 0 wide */
    assert_int_equal(receiver.codes[1], ERROR_NONE);  /* and the next one is a picture again */
    pipeline_destroy(pipeline);
    plan_and_derived_destroy(plan);
    receiver_finish(&receiver);
}

static void more_than_the_limit_is_refused_and_never_blocks(void **state)
{
    (void)state;
    struct receiver receiver;
    receiver_init(&receiver);
    receiver.is_closed = true;
    receiver.hold_ms = 20;
    struct plan *plan = small_plan();
    struct pipeline *pipeline = start(&receiver);
    size_t n_taken = 0, n_refused = 0;
    for (uint64_t id = 1; id <= PIPELINE_MAX_WAITING + 36; id++) {
        struct error err = { 0 };
        if (submit(pipeline, plan, id, 64, &err))
            n_taken++;
        else {
            assert_int_equal(err.code, ERROR_LIMIT);
            n_refused++;
        }
    }
    assert_true(n_refused > 0);
    assert_in_range(n_taken, PIPELINE_MAX_WAITING,
                    PIPELINE_MAX_WAITING + 4); /* being drawn, two drawn, being compressed */
    open_receiver(&receiver);
    pipeline_destroy(pipeline); /* with most of them still waiting */
    assert_true(receiver.n_frames < n_taken);
    plan_and_derived_destroy(plan);
    receiver_finish(&receiver);
}

/* Under the receiver's mutex. */
static size_t n_delivered(const struct receiver *receiver, uint64_t first, uint64_t last)
{
    size_t n = 0;
    for (size_t i = 0; i < receiver->n_frames; i++)
        n += receiver->ids[i] >= first && receiver->ids[i] <= last;
    return n;
}

static void wait_for_id(struct receiver *receiver, uint64_t id)
{
    pthread_mutex_lock(&receiver->mutex);
    while (n_delivered(receiver, id, id) == 0)
        pthread_cond_wait(&receiver->changed, &receiver->mutex);
    pthread_mutex_unlock(&receiver->mutex);
}

/* A large one takes a hundred times as long as a small one. Were pictures drawn one after the other, a small one that
 * is asked for when the last came would have to wait for a large one each time. */
static void large_pictures_of_one_source_do_not_hold_up_small_ones_of_another(void **state)
{
    (void)state;
    enum { N_LARGE = 8, N_SMALL = 24 };
    for (int is_still = 0; is_still < 2; is_still++) {
        struct receiver receiver;
        receiver_init(&receiver);
        struct plan *plan = small_plan();
        struct pipeline *pipeline = start_back_end(&receiver, RENDER_SOFT, false);
        struct error err = { 0 };
        for (uint64_t id = 1; id <= N_LARGE; id++)
            assert_true(submit_picture(pipeline, plan, id, 7, 4096, 4096, is_still, &err));
        for (uint64_t id = 101; id <= 100 + N_SMALL; id++) {
            assert_true(submit_picture(pipeline, plan, id, 8, 160, 120, false, &err));
            wait_for_id(&receiver, id);
        }
        pthread_mutex_lock(&receiver.mutex);
        size_t n_large = n_delivered(&receiver, 1, N_LARGE);
        pthread_mutex_unlock(&receiver.mutex);
        assert_true(n_large < N_LARGE);
        for (uint64_t id = 1; id <= N_LARGE; id++)
            pipeline_drop(pipeline, id);
        pipeline_destroy(pipeline);
        for (size_t i = 0; i < receiver.n_frames; i++)
            assert_int_equal(receiver.codes[i], ERROR_NONE);
        plan_and_derived_destroy(plan);
        receiver_finish(&receiver);
    }
}

static void a_picture_that_is_dropped_while_it_is_drawn_is_drawn_no_further(void **state)
{
    (void)state;
    struct receiver receiver;
    receiver_init(&receiver);
    struct plan *plan = small_plan();
    struct pipeline *pipeline = start_back_end(&receiver, RENDER_SOFT, false);
    struct error err = { 0 };
    for (uint64_t id = 1; id <= 20; id++) { /* some are dropped before they are begun, some in the middle */
        assert_true(submit_picture(pipeline, plan, id, 7, 4096, 4096, true, &err));
        usleep((useconds_t)(id % 4 * 10000));
        pipeline_drop(pipeline, id);
    }
    assert_true(submit_picture(pipeline, plan, 21, 7, 64, 48, true, &err));
    wait_for_id(&receiver, 21);
    pipeline_destroy(pipeline);
    plan_and_derived_destroy(plan);
    receiver_finish(&receiver);
}

static void it_can_be_destroyed_in_any_state(void **state)
{
    (void)state;
    for (int n_submitted = 0; n_submitted < 12; n_submitted++) {
        struct receiver receiver;
        receiver_init(&receiver);
        struct plan *plan = small_plan();
        struct pipeline *pipeline = start(&receiver);
        for (int i = 0; i < n_submitted; i++) {
            struct error err = { 0 };
            assert_true(submit(pipeline, plan, (uint64_t)i, 64, &err));
        }
        if (n_submitted % 3 == 1)
            wait_for(&receiver, (size_t)n_submitted / 2);
        pipeline_destroy(pipeline);
        plan_and_derived_destroy(plan);
        receiver_finish(&receiver);
    }
    pipeline_destroy(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frames_come_back_in_order_and_none_is_lost),
        cmocka_unit_test(a_marked_copy_is_made_where_words_are_given_and_the_picture_is_what_it_was),
        cmocka_unit_test(moving_pictures_overtake_stills_but_not_for_ever),
        cmocka_unit_test(what_is_dropped_while_it_waits_is_not_drawn),
        cmocka_unit_test(any_number_of_drops_blocks_nobody_and_loses_no_request),
        cmocka_unit_test(a_picture_that_cannot_be_drawn_comes_back_as_an_error),
        cmocka_unit_test(more_than_the_limit_is_refused_and_never_blocks),
        cmocka_unit_test(large_pictures_of_one_source_do_not_hold_up_small_ones_of_another),
        cmocka_unit_test(a_picture_that_is_dropped_while_it_is_drawn_is_drawn_no_further),
        cmocka_unit_test(it_can_be_destroyed_in_any_state),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

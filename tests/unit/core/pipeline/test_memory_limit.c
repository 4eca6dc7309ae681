/* Drawing under a limit of memory: whatever the limit, a picture or an answer that says what was too large, and the
 * process goes on. */
#include <pthread.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/mem.h"
#include "core/pipeline/pipeline.h"
#include "tests/check.h"
#include "tests/derived_of.h"
#include "tests/made_plan.h"

#if defined(__SANITIZE_THREAD__) || defined(__SANITIZE_ADDRESS__)
enum { IS_SANITIZED = 1 }; /* they map terabytes */
#else
enum { IS_SANITIZED = 0 };
#endif

enum { ALL_DRAWN = 0, SOME_TOO_LARGE = 1, STOPPED = 2, WRONG_ANSWER = 3, N_PICTURES = 5 };

struct receiver {
    pthread_mutex_t mutex;
    pthread_cond_t changed;
    int n_frames, n_too_large;
    bool is_wrong;
};

static void on_started(void *context, const struct render_facts *facts, const struct error *err)
{
    (void)context, (void)facts, (void)err;
}

static void on_frame(void *context, struct pipeline_frame *frame)
{
    struct receiver *receiver = context;
    pthread_mutex_lock(&receiver->mutex);
    receiver->n_frames++;
    receiver->n_too_large += frame->error.code == ERROR_MEMORY;
    if (frame->error.code == ERROR_MEMORY && !strstr(frame->error.text, frame->id == 3 ? "48 x 48" : " x "))
        receiver->is_wrong = true;
    if (frame->error.code != ERROR_MEMORY && (frame->error.code != ERROR_NONE || frame->picture.n_bytes == 0))
        receiver->is_wrong = true;
    free(frame->picture.bytes);
    pthread_cond_broadcast(&receiver->changed);
    pthread_mutex_unlock(&receiver->mutex);
}

static double label(struct vec3 p)
{
    return vec3_length(p) < 10 ? 2 : vec3_length(p) < 14 ? 1 : 0;
}
static const struct made_region balls[] = { { "outer", -1, 0xff0000 }, { "inner", 0, 0x00ff00 } };

static struct pipeline_request picture(struct plan *plan, uint64_t id, int side_px, enum encode_codec codec)
{
    struct scene scene;
    struct view view = view_default;
    char field[128];
    struct error err = { 0 };
    scene_for_plan(plan, &scene);
    return (struct pipeline_request){ .id = id,
                                      .source = id,
                                      .snapshot = snapshot_create(derived_of(plan), &scene, &view, 1, field, &err),
                                      .render = { side_px, side_px, SURFACE_FULL, true },
                                      .encode = { codec, 90, true } };
}

/* In a process of its own, which may take so much more than it has. */
static int draw_within(uint64_t more_bytes)
{
    static const struct {
        int side_px;
        enum encode_codec codec;
    } wanted[N_PICTURES] = {
        { 4096, ENCODE_JPEG }, { 2048, ENCODE_PNG }, { 48, ENCODE_JPEG }, { 4096, ENCODE_JPEG }, { 1024, ENCODE_JPEG }
    };
    struct receiver receiver = { .n_frames = 0 };
    struct pipeline_callbacks callbacks = { on_started, on_frame, &receiver };
    struct grid grid = made_cube_grid(40);
    struct plan *plan = made_plan(&grid, label, balls, 2);
    struct error err = { 0 };
    pthread_mutex_init(&receiver.mutex, NULL);
    pthread_cond_init(&receiver.changed, NULL);
    mem_keep_reserve();
    unsigned long long data = 0;
    FILE *file = fopen("/proc/self/status", "re");
    for (char line[256]; file && fgets(line, sizeof line, file);)
        (void)sscanf(line, "VmData: %llu", &data);
    if (file)
        fclose(file);
    struct rlimit limit = { data * 1024 + more_bytes, data * 1024 + more_bytes };
    if (setrlimit(RLIMIT_DATA, &limit) != 0)
        return WRONG_ANSWER;
    struct pipeline *pipeline = pipeline_create(RENDER_SOFT, false, &callbacks, &err);
    if (!pipeline)
        return err.code == ERROR_MEMORY ? SOME_TOO_LARGE : WRONG_ANSWER; /* not even its threads */
    for (int i = 0; i < N_PICTURES; i++) {
        struct pipeline_request request = picture(plan, (uint64_t)i + 1, wanted[i].side_px, wanted[i].codec);
        if (!request.snapshot || !pipeline_submit(pipeline, &request, &err))
            return WRONG_ANSWER;
    }
    pthread_mutex_lock(&receiver.mutex);
    while (receiver.n_frames < N_PICTURES)
        pthread_cond_wait(&receiver.changed, &receiver.mutex);
    pthread_mutex_unlock(&receiver.mutex);
    pipeline_destroy(pipeline);
    plan_and_derived_destroy(plan);
    return receiver.is_wrong ? WRONG_ANSWER : receiver.n_too_large ? SOME_TOO_LARGE : ALL_DRAWN;
}

static int outcome_within(uint64_t more_bytes)
{
    int status = 0;
    pid_t child = fork();
    if (child == 0)
        _exit(draw_within(more_bytes));
    assert_true(child > 0 && waitpid(child, &status, 0) == child);
    return WIFEXITED(status) ? WEXITSTATUS(status) : STOPPED;
}

static void whatever_the_limit_there_is_a_picture_or_an_answer(void **state)
{
    (void)state;
    if (IS_SANITIZED)
        skip();
    static const int limits_mib[] = { 1, 2, 3, 9, 12, 18, 24, 30, 50, 66, 80 };
    for (size_t i = 0; i < sizeof limits_mib / sizeof limits_mib[0]; i++) {
        int outcome = outcome_within((uint64_t)limits_mib[i] << 20);
        if (outcome > SOME_TOO_LARGE)
            printf("with %d MiB more\n", limits_mib[i]);
        assert_in_range(outcome, ALL_DRAWN, SOME_TOO_LARGE);
    }
    assert_int_equal(outcome_within((uint64_t)40 << 20),
                     SOME_TOO_LARGE); /* the image of 4096 x 4096 pixels alone takes 64 MiB */
    assert_int_equal(outcome_within((uint64_t)1 << 30), ALL_DRAWN);
}

/* One of 64 MiB fits, two do not: the second waits for the first. */
static void pictures_that_fit_one_after_the_other_are_all_drawn(void **state)
{
    (void)state;
    if (IS_SANITIZED)
        skip();
    assert_int_equal(outcome_within((uint64_t)125 << 20), ALL_DRAWN);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(whatever_the_limit_there_is_a_picture_or_an_answer),
        cmocka_unit_test(pictures_that_fit_one_after_the_other_are_all_drawn),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

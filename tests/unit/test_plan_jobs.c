/* Loading as a job: how far it is, giving it up, and what it may take. */
#define _GNU_SOURCE
#include <stdio.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "core/formats/nifti_write.h"
#include "core/plan/plan.h"
#include "tests/check.h"
#include "tests/made_plan.h"
#include "tests/unit/data_folder.h"

enum { N_IMAGES = 16, SIDE = 512, N_SLICES = 96 };

/* A folder with as many names of one packed image of 24 MiB as a plan may have. */
static void make_large_folder(char folder[256])
{
    struct error err = { 0 };
    const uint32_t size[3] = { SIDE, SIDE, N_SLICES };
    struct grid grid = made_grid(SIDE, SIDE, N_SLICES, made_affine(vec3(0.5, 0, 0), vec3(0, 0.5, 0), vec3(0, 0, 2), size, vec3(0, 0, 0)));
    struct volume *volume = volume_create(&grid, VOXEL_U8, &err);
    assert_non_null(volume);
    for (size_t at = 0; at < grid_n_voxels(&grid); at += 97)
        ((uint8_t *)volume->voxels)[at] = (uint8_t)(at >> 9);
    char first[300], next[300];
    folder_make(folder);
    snprintf(first, sizeof first, "%s/image-00.nii.gz", folder);
    assert_true(nifti_write(first, volume, NULL, &err));
    volume_unref(volume);
    for (int i = 1; i < N_IMAGES; i++) {
        snprintf(next, sizeof next, "%s/image-%02d.nii.gz", folder, i);
        assert_int_equal(link(first, next), 0);
    }
}

struct watch {
    double percent, highest_before_end;
    size_t n_steps, n_falls;
    atomic_bool cancel;
    double cancel_from; /* percent */
    int64_t cancelled_us;
    char last[96];
};

static void step(void *context, const char *phase, double percent)
{
    struct watch *watch = context;
    watch->n_steps++;
    watch->n_falls += percent < watch->percent;
    watch->percent = percent;
    if (percent < 100)
        watch->highest_before_end = percent;
    snprintf(watch->last, sizeof watch->last, "%s", phase);
    if (percent >= watch->cancel_from && !atomic_load(&watch->cancel)) {
        watch->cancelled_us = clock_now_us();
        atomic_store(&watch->cancel, true);
    }
}

static void progress_grows_with_the_bytes_read_and_ends_at_100(void **state)
{
    (void)state;
    char folder[256];
    make_large_folder(folder);
    struct watch watch = { .cancel_from = 1000 };
    struct plan_load_options options = { .progress = { step, &watch, &watch.cancel } };
    struct error err = { 0 };
    struct plan *plan = plan_load(folder, "p", &options, &err);
    assert_string_equal(err.text, "");
    assert_int_equal(plan->n_images, N_IMAGES);
    assert_close(watch.percent, 100, 0);
    assert_string_equal(watch.last, "loaded");
    assert_int_equal(watch.n_falls, 0);
    assert_true(watch.n_steps >= 3);
    assert_true(watch.highest_before_end > 15);
    plan_destroy(plan);
    folder_remove(folder);
}

static void a_load_is_given_up_within_a_fifth_of_a_second_wherever_it_is(void **state)
{
    (void)state;
    static const double from[] = { 0, 5.5, 20, 45, 70 };
    char folder[256];
    make_large_folder(folder);
    for (size_t i = 0; i < sizeof from / sizeof from[0]; i++) {
        struct watch watch = { .cancel_from = from[i] };
        struct plan_load_options options = { .progress = { step, &watch, &watch.cancel } };
        struct error err = { 0 };
        struct plan *plan = plan_load(folder, "p", &options, &err);
        int64_t ended_us = clock_now_us();
        if (plan && watch.cancelled_us == 0) { /* no step fell between there and the end */
            plan_destroy(plan);
            continue;
        }
        assert_null(plan);
        assert_int_equal(err.code, ERROR_CANCELLED);
        assert_true(ended_us - watch.cancelled_us < 200000);
    }
    folder_remove(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(progress_grows_with_the_bytes_read_and_ends_at_100),
        cmocka_unit_test(a_load_is_given_up_within_a_fifth_of_a_second_wherever_it_is),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* Loading as a job: how far it is, giving it up, and what it may take. */
#define _GNU_SOURCE
#include <stdio.h>
#include <unistd.h>

#include "core/formats/nifti_write.h"
#include "core/load/load.h"
#include "core/plan/plan.h"
#include "tests/check.h"
#include "tests/made_plan.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/oracle.h"

enum { N_IMAGES = 16, SIDE = 512, N_SLICES = 96 };

/* A folder with as many names of one packed image of 24 MiB as a plan may have. */
static void make_large_folder(char folder[256])
{
    struct error err = { 0 };
    const uint32_t size[3] = { SIDE, SIDE, N_SLICES };
    struct grid grid = made_grid(SIDE, SIDE, N_SLICES,
                                 made_affine(vec3(0.5, 0, 0), vec3(0, 0.5, 0), vec3(0, 0, 2), size, vec3(0, 0, 0)));
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
    double cancelled_s; /* of processor time; 0: not cancelled */
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
        watch->cancelled_s = cpu_s();
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
        double ended_s = cpu_s();
        if (plan && watch.cancelled_s == 0) { /* no step fell between there and the end */
            plan_destroy(plan);
            continue;
        }
        assert_null(plan);
        assert_int_equal(err.code, ERROR_CANCELLED);
        assert_true(ended_s - watch.cancelled_s < 0.2 * (double)sysconf(_SC_NPROCESSORS_ONLN)); /* each is at work */
    }
    folder_remove(folder);
}

/* In a process of its own, as the high-water mark of memory never falls: opens a folder (or nothing) and prints its
 * mark in KiB. */
static int open_and_tell(const char *folder)
{
    struct error err = { 0 };
    struct plan *plan = folder[0] ? plan_load(folder, "p", NULL, &err) : NULL;
    FILE *status = fopen("/proc/self/status", "r");
    char line[256];
    long kib = -1;
    while (status && fgets(line, sizeof line, status))
        if (strncmp(line, "VmHWM:", 6) == 0)
            kib = strtol(line + 6, NULL, 10);
    printf("%ld\n", kib);
    plan_destroy(plan);
    return folder[0] && !plan;
}

static long peak_kib(const char *folder)
{
    char self[] = "/proc/self/exe", what[] = "--open", path[512], answer[64];
    snprintf(path, sizeof path, "%s", folder);
    char *arguments[] = { self, what, path, NULL };
    assert_int_equal(oracle_run(arguments, answer, sizeof answer), 0);
    return strtol(answer, NULL, 10);
}

/* Memory that the plan would take according to the refusal, MiB. */
static double estimated_mib(const char *folder, const char *largest)
{
    struct error err = { 0 };
    struct plan_load_options options = { .max_bytes = 1 << 20 };
    assert_null(plan_load(folder, "p", &options, &err));
    assert_int_equal(err.code, ERROR_LIMIT);
    assert_non_null(strstr(err.text, "1 MiB are allowed"));
    assert_non_null(strstr(err.text, largest));
    const char *at = strstr(err.text, "about ");
    assert_non_null(at);
    return strtod(at + 6, NULL);
}

/* A sanitizer keeps memory of its own and holds back what is freed, so what it measures says nothing of the program. */
static void check_estimate(double estimate_mib, double found_mib)
{
#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
    return;
#endif
#endif
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
    assert_true(estimate_mib < found_mib * PLAN_ESTIMATE_FACTOR && found_mib < estimate_mib * PLAN_ESTIMATE_FACTOR);
#else
    (void)estimate_mib;
    (void)found_mib;
#endif
}

static void a_plan_over_the_limit_is_refused_with_figures_before_it_is_read(void **state)
{
    (void)state;
    char folder[256];
    make_large_folder(folder);
    long before = peak_kib("");
    double began_s = cpu_s();
    double estimate_mib = estimated_mib(folder, "image-");
    assert_true(cpu_s() - began_s < 0.5);
    double found_mib = (double)(peak_kib(folder) - before) / 1024;
    print_message("estimate %.0f MiB, measured %.0f MiB\n", estimate_mib, found_mib);
    check_estimate(estimate_mib, found_mib);

    struct error err = { 0 };
    struct plan_load_options options = { .max_bytes = (uint64_t)(estimate_mib + 2) << 20 };
    struct plan *plan = plan_load(folder, "p", &options, &err);
    assert_string_equal(err.text, "");
    plan_destroy(plan);
    folder_remove(folder);
}

/* Real plans: labels, doses and SERA's files in the sum. */
static void estimates_of_real_plans_are_within_the_stated_factor(void **state)
{
    (void)state;
    static const struct {
        const char *name, *largest;
    } plans[] = { { "glioma-tcga-du7294", "t1c_brain" }, { "gbm-brats2013", "nii.gz" }, { "openkbp-pt99", "nii.gz" } };
    char path[512];
    long before = peak_kib("");
    size_t n = 0;
    for (size_t i = 0; i < sizeof plans / sizeof plans[0]; i++) {
        if (!data_path(plans[i].name, path, sizeof path))
            continue;
        n++;
        double estimate_mib = estimated_mib(path, plans[i].largest),
               found_mib = (double)(peak_kib(path) - before) / 1024;
        print_message("%s: estimate %.0f MiB, measured %.0f MiB\n", plans[i].name, estimate_mib, found_mib);
        check_estimate(estimate_mib, found_mib);
    }
    if (n == 0)
        skip();
}

int main(int argc, char **argv)
{
    if (argc == 3 && strcmp(argv[1], "--open") == 0)
        return open_and_tell(argv[2]);

    const struct CMUnitTest tests[] = {
        cmocka_unit_test(progress_grows_with_the_bytes_read_and_ends_at_100),
        cmocka_unit_test(a_load_is_given_up_within_a_fifth_of_a_second_wherever_it_is),
        cmocka_unit_test(a_plan_over_the_limit_is_refused_with_figures_before_it_is_read),
        cmocka_unit_test(estimates_of_real_plans_are_within_the_stated_factor),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

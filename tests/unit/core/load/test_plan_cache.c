/* A plan kept in the cache is the plan, and nothing but that plan's own cache is believed. */
#define _GNU_SOURCE
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "core/formats/nifti_write.h"
#include "core/load/cache.h"
#include "core/load/cache_fields.h"
#include "core/load/load.h"
#include "core/plan/plan.h"
#include "tests/check.h"
#include "tests/made_plan.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/same_plan.h"

enum {
    SIZE_IMAGE = 248,
    SIZE_REGION = 336,
    SIZE_DOSE = 11608,
    SIZE_BEAM = 14072,
    SIZE_SEGMENT = 32,
    SIZE_VOLUME = 264,
    SIZE_PLAN = 1256064 + sizeof(struct plan_statement) /* a person's, which the cache does not hold */
};

static struct plan *load_with_sources(const char *folder, const char *cache, struct plan_sources **sources)
{
    struct error err = { 0 };
    struct plan *plan =
        plan_load(folder, "p", &(struct plan_load_options){ .cache_folder = cache, .sources = sources }, &err);
    assert_string_equal(err.text, "");
    return plan;
}

static struct plan *load(const char *folder, const char *cache)
{
    return load_with_sources(folder, cache, NULL);
}

static void put_grid(const char *folder, const char *name, enum voxel_type type, uint32_t side)
{
    struct error err = { 0 };
    const uint32_t size[3] = { side, side, side };
    struct grid grid = made_grid(side, side, side,
                                 made_affine(vec3(1.3, 0, 0), vec3(0, 1.3, 0), vec3(0, 0, 1.7), size, vec3(1, 2, 3)));
    struct volume *volume = volume_create(&grid, type, &err);
    for (size_t i = 0; i < grid_n_voxels(&grid); i++) {
        if (type == VOXEL_U8)
            ((uint8_t *)volume->voxels)[i] = i % side > 2 && i % side < 8 ? (uint8_t)(1 + i / side % 3) : 0;
        else
            ((float *)volume->voxels)[i] = (float)(i % 1013) / 3;
    }
    char path[600];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    assert_true(nifti_write_exact(path, volume, NULL, &err));
    volume_unref(volume);
}

static void put_plan(const char *folder)
{
    static const char text[] =
        "{\"format\": \"beamroom-plan\", \"version\": 1, \"name\": \"kept\", \"images\": [{\"id\": \"mr\", \"inverted\": true, \"path\": \"mr.nii.gz\", \"modality\": "
        "\"MR\"}], \"regions\": [{\"path\": \"labels.nii.gz\"}], \"doses\": [{\"id\": \"d\", \"unit\": \"Gy\", \"path\": \"dose.nii.gz\", \"error\": \"mr.nii.gz\", "
        "\"mask\": \"labels.nii.gz\"}], \"beams\": [{\"entry_mm\": [0, 0, 9], \"target_mm\": [0, 0, 0]}],"
        "\"tracks\": [{\"path\": \"t.pp\", \"unit\": \"mm\"}, {\"path\": \"t.csv\"}]}";
    put_grid(folder, "mr.nii.gz", VOXEL_F32, 20);
    put_grid(folder, "labels.nii.gz", VOXEL_U8, 20);
    put_grid(folder, "dose.nii.gz", VOXEL_F32, 12);
    folder_put(folder, "t.pp", "1 2 3 4 5 6 0 1\n", 16);
    folder_put_text(folder, "t.csv",
                    "class,x0_mm,y0_mm,z0_mm,x1_mm,y1_mm,z1_mm,energy_mev\nlost,1,2,3,4,5,7,0.25\nlost,1,2,3,4,5,8,\n");
    folder_put(folder, "plan.json", text, sizeof text - 1);
}

struct world {
    char folder[256], cache[256], file[300];
    struct plan *first;
    struct plan_sources *sources; /* of first */
};

static void world_start(struct world *world)
{
    struct error err = { 0 };
    folder_make(world->folder);
    folder_make(world->cache);
    snprintf(world->file, sizeof world->file, "%s/%s", world->cache, PLAN_CACHE_NAME);
    put_plan(world->folder);
    world->first = load_with_sources(world->folder, world->cache, &world->sources);
    assert_false(world->first->is_from_cache);
    assert_true(plan_cache_store(world->first, world->sources, world->cache, &err));
}

static void world_end(struct world *world)
{
    plan_destroy(world->first);
    plan_sources_destroy(world->sources);
    folder_remove(world->folder);
    folder_remove(world->cache);
}

static bool comes_from_cache(const struct world *world)
{
    struct plan *plan = load(world->folder, world->cache);
    bool is_from_cache = plan->is_from_cache;
    plan_destroy(plan);
    return is_from_cache;
}

static void a_kept_plan_opens_as_the_same_plan_with_its_report(void **state)
{
    (void)state;
    struct world world;
    world_start(&world);
    struct plan *again = load(world.folder, world.cache);
    assert_true(again->is_from_cache);
    assert_same_plan(again, world.first, 0);
    assert_int_equal(again->tracks.n_files, 2);
    assert_string_equal(again->tracks.files[1].path, "t.csv");
    assert_int_equal(again->tracks.files[1].n_segments, 2);
    assert_close(again->tracks.files[1].unit_mm, 1, 0);
    assert_int_equal(again->report.n_lines, world.first->report.n_lines);
    for (size_t i = 0; i < again->report.n_lines; i++)
        assert_memory_equal(&again->report.lines[i], &world.first->report.lines[i], sizeof again->report.lines[i]);
    assert_close(again->doses[0].body_high[DOSE_TOTAL], world.first->doses[0].body_high[DOSE_TOTAL], 0);
    plan_destroy(again);
    world_end(&world);
}

/* Every field of these structs is written by core/load/cache_fields.c. Whoever adds one adds it there, raises
 * PLAN_CACHE_FORMAT and sets the size here. */
static void the_cache_knows_every_field(void **state)
{
    (void)state;
    assert_int_equal(sizeof(struct plan_image), SIZE_IMAGE);
    assert_int_equal(sizeof(struct region), SIZE_REGION);
    assert_int_equal(sizeof(struct dose), SIZE_DOSE);
    assert_int_equal(sizeof(struct beam), SIZE_BEAM);
    assert_int_equal(sizeof(struct track_segment), SIZE_SEGMENT);
    assert_int_equal(sizeof(struct volume), SIZE_VOLUME);
    assert_int_equal(sizeof(struct plan), SIZE_PLAN);
}

static void a_file_that_changes_appears_or_goes_away_makes_the_cache_void(void **state)
{
    (void)state;
    struct world world;
    char path[600], other[600];
    world_start(&world);
    assert_true(comes_from_cache(&world));
    folder_put(world.folder, "notes.txt", "new", 3);
    assert_false(comes_from_cache(&world));
    snprintf(path, sizeof path, "%s/notes.txt", world.folder);
    unlink(path);
    assert_true(comes_from_cache(&world));

    snprintf(path, sizeof path, "%s/dose.nii.gz", world.folder);
    struct timespec times[2] = { { .tv_nsec = UTIME_OMIT }, { .tv_sec = 1000, .tv_nsec = 1 } };
    struct stat about;
    stat(path, &about);
    assert_int_equal(utimensat(AT_FDCWD, path, times, 0), 0);
    assert_false(comes_from_cache(&world));
    times[1] = about.st_mtim;
    assert_int_equal(utimensat(AT_FDCWD, path, times, 0), 0);
    assert_true(comes_from_cache(&world));
    times[1].tv_nsec = (times[1].tv_nsec + 1) % 1000000000;
    assert_int_equal(utimensat(AT_FDCWD, path, times, 0), 0);
    assert_false(comes_from_cache(&world));
    times[1] = about.st_mtim;

    snprintf(other, sizeof other, "%s/moved", world.folder); /* the same bytes and time, but another file */
    assert_int_equal(rename(path, other), 0);
    put_grid(world.folder, "dose.nii.gz", VOXEL_F32, 12);
    unlink(other);
    assert_int_equal(utimensat(AT_FDCWD, path, times, 0), 0);
    stat(path, &about);
    assert_false(comes_from_cache(&world));
    world_end(&world);
}

static void a_damaged_cache_is_not_believed_and_is_written_anew(void **state)
{
    (void)state;
    struct world world;
    struct error err = { 0 };
    size_t n;
    world_start(&world);
    uint8_t *bytes = file_bytes(world.file, &n);
    uint64_t head_bytes;
    memcpy(&head_bytes, bytes + 40, sizeof head_bytes);
    for (size_t at = 0; at < n; at = at < 4096 ? at + 7 : at + 1031) { /* a flipped bit */
        if (at >= 56 + head_bytes && bytes[at] == 0) /* between the volumes nothing is checked, as nothing is used */
            continue;
        bytes[at] ^= (uint8_t)(1 << at % 8);
        folder_put(world.cache, PLAN_CACHE_NAME, bytes, n);
        struct plan *plan = load(world.folder, world.cache);
        assert_false(plan->is_from_cache);
        plan_destroy(plan);
        bytes[at] ^= (uint8_t)(1 << at % 8);
    }
    for (size_t cut = 0; cut < n; cut += cut < 256 ? 13 : n / 23) {
        folder_put(world.cache, PLAN_CACHE_NAME, bytes, cut);
        assert_false(comes_from_cache(&world));
    }
    folder_put(world.cache, PLAN_CACHE_NAME, "something else altogether", 25);
    assert_false(comes_from_cache(&world));
    assert_true(plan_cache_store(world.first, world.sources, world.cache, &err));
    assert_true(comes_from_cache(&world));
    free(bytes);
    world_end(&world);
}

/* Fields alone, without the checksum that would catch it: no flipped bit may crash, and what is accepted is within a
 * plan's bounds. */
static void no_bits_of_the_fields_can_make_an_impossible_plan(void **state)
{
    (void)state;
    struct world world;
    world_start(&world);
    struct fields written = { 0 };
    fields_plan(&written, world.first);
    size_t n_accepted = 0;
    for (size_t bit = 0; bit < 8 * written.size; bit += bit < 40000 ? 1 : 37) {
        struct fields fields = { .is_reading = true, .data = written.data, .size = written.size };
        struct plan *plan = mem_new(sizeof *plan);
        written.data[bit / 8] ^= (uint8_t)(1 << bit % 8);
        fields_plan(&fields, plan);
        written.data[bit / 8] ^= (uint8_t)(1 << bit % 8);
        n_accepted += !fields.is_bad;
        for (size_t r = 0; !fields.is_bad && r < plan->regions.n_regions; r++) {
            assert_true(plan->regions.regions[r].layer < plan->regions.n_layers);
            assert_true(plan->regions.regions[r].parent < (int)plan->regions.n_regions);
        }
        plan_destroy(plan);
    }
    assert_true(n_accepted > 0); /* a digit of a number is as good as another */
    for (size_t cut = 0; cut < written.size; cut += 1 + cut / 50) {
        struct fields fields = { .is_reading = true, .data = written.data, .size = cut };
        struct plan *plan = mem_new(sizeof *plan);
        fields_plan(&fields, plan);
        assert_true(fields.is_bad);
        plan_destroy(plan);
    }
    free(written.data);
    world_end(&world);
}

static bool is_accepted(struct plan *changed)
{
    struct fields written = { 0 };
    fields_plan(&written, changed);
    struct fields fields = { .is_reading = true, .data = written.data, .size = written.size };
    struct plan *plan = mem_new(sizeof *plan);
    fields_plan(&fields, plan);
    plan_destroy(plan);
    free(written.data);
    return !fields.is_bad;
}

static void regions_inside_themselves_and_ids_for_two_are_not_accepted(void **state)
{
    (void)state;
    struct world world;
    world_start(&world);
    struct region *regions = world.first->regions.regions;
    assert_true(world.first->regions.n_regions >= 2);
    assert_true(is_accepted(world.first));
    int parents[2] = { regions[0].parent, regions[1].parent };
    regions[0].parent = 1;
    regions[1].parent = 0;
    assert_false(is_accepted(world.first));
    regions[0].parent = parents[0];
    regions[1].parent = parents[1];
    char id[REGION_ID_SIZE];
    memcpy(id, regions[1].id, sizeof id);
    memcpy(regions[1].id, regions[0].id, sizeof id);
    assert_false(is_accepted(world.first));
    memcpy(regions[1].id, "../x", 5);
    assert_false(is_accepted(world.first));
    memcpy(regions[1].id, id, sizeof id);
    world_end(&world);
}

static void a_cache_for_less_memory_than_it_needs_is_not_read(void **state)
{
    (void)state;
    struct world world;
    struct error err = { 0 };
    world_start(&world);
    struct plan_load_options options = { .max_bytes = 1000, .cache_folder = world.cache };
    assert_null(plan_load(world.folder, "p", &options, &err));
    assert_int_equal(err.code, ERROR_LIMIT);
    world_end(&world);
}

/* In a process that may write files of 4 KiB: nothing is begun, so that no quota ends it, and nothing is left. */
static void a_plan_larger_than_a_file_may_be_is_not_kept(void **state)
{
    (void)state;
    struct world world;
    char partial[600];
    world_start(&world);
    snprintf(partial, sizeof partial, "%s/%s.part", world.cache, PLAN_CACHE_NAME);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        struct error err = { 0 };
        struct rlimit limit = { 4096, 4096 };
        (void)signal(SIGXFSZ, SIG_DFL); /* a write would end the process */
        bool is_refused =
            setrlimit(RLIMIT_FSIZE, &limit) == 0 && !plan_cache_store(world.first, world.sources, world.cache, &err);
        _exit(is_refused && err.code == ERROR_LIMIT && strstr(err.text, "more than a file may have") &&
                      access(partial, F_OK) != 0
                  ? 0
                  : 1);
    }
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
    world_end(&world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_kept_plan_opens_as_the_same_plan_with_its_report),
        cmocka_unit_test(the_cache_knows_every_field),
        cmocka_unit_test(a_file_that_changes_appears_or_goes_away_makes_the_cache_void),
        cmocka_unit_test(a_damaged_cache_is_not_believed_and_is_written_anew),
        cmocka_unit_test(no_bits_of_the_fields_can_make_an_impossible_plan),
        cmocka_unit_test(regions_inside_themselves_and_ids_for_two_are_not_accepted),
        cmocka_unit_test(a_cache_for_less_memory_than_it_needs_is_not_read),
        cmocka_unit_test(a_plan_larger_than_a_file_may_be_is_not_kept),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

#pragma once
/* A volume of cubes of 2 mm of one material in a mono-energetic beam, and what tests of simulations do with it. */
#include "core/base/clock.h"
#include "core/transport/transport.h"
#include "tests/check.h"

enum { SIDE = 40 }; /* voxels along each axis */

/* A volume of cubes of 2 mm, a mono-energetic beam, and the input that joins them. */
struct world_made {
    struct grid grid;
    uint8_t voxels[SIDE * SIDE * SIDE];
    struct material material;
    struct beam_source source;
    struct phase_space beam;
    struct transport_input input;
};

static inline struct world_made *make(double radius_cm, double energy_ev, size_t n_list, uint64_t seed)
{
    struct world_made *world = calloc(1, sizeof *world);
    struct error err = { 0 };
    struct affine map = { { { 2, 0, 0 }, { 0, 2, 0 }, { 0, 0, 2 } }, { 1, 1, 1 } };
    assert_non_null(world);
    assert_true(grid_init(&world->grid, (uint32_t[]){ SIDE, SIDE, SIDE }, &map, &err));
    assert_true(material_of_word("brain", &world->material, &err));
    world->source = (struct beam_source){ .name = "made", .n_cuts = 1, .radius_cm = radius_cm, .to_aperture_cm = 1 };
    world->source.neutrons =
        (struct beam_spectrum){ 1, { energy_ev * 1.0001, energy_ev }, { 1 }, { { 1 } }, 1e6, true };
    assert_true(phase_space_of_source(&world->beam, &world->source, n_list, 0, seed, 2, NULL, &err));
    world->input = (struct transport_input){ .grid = &world->grid,
                                             .voxels = world->voxels,
                                             .materials = &world->material,
                                             .n_materials = 1,
                                             .beam = &world->beam,
                                             .aperture_lps_mm = { 40, 40, -30 },
                                             .direction_lps = { 0, 0, 1 },
                                             .n_histories = n_list,
                                             .seed = seed,
                                             .cell_mm = 10,
                                             .n_threads = 2 };
    return world;
}

static inline void drop(struct world_made *world)
{
    phase_space_finish(&world->beam);
    free(world);
}

static inline void fill(struct world_made *world, bool (*is_inside)(double x_mm, double y_mm, double z_mm))
{
    for (int i = 0; i < SIDE * SIDE * SIDE; i++)
        world->voxels[i] =
            !is_inside || is_inside(2 * (i % SIDE) + 1, 2 * (i / SIDE % SIDE) + 1, 2 * (i / SIDE / SIDE) + 1);
}

/* Nothing but boron: absorbs and does not scatter. */
static inline void make_absorber(struct world_made *world, double per_cm_2200)
{
    world->material = (struct material){ "boron", 1, { 0 }, per_cm_2200 / (.602214 * 3835) * 10.0129 * 1e6 };
}

static inline struct transport_result run(const struct world_made *world)
{
    struct transport_result result;
    struct error err = { 0 };
    if (!transport_run(&world->input, &result, &err))
        fail_msg("%s", err.text);
    return result;
}

static inline bool in_sphere(double x_mm, double y_mm, double z_mm)
{
    return pow(x_mm - 40, 2) + pow(y_mm - 40, 2) + pow(z_mm - 40, 2) < 900;
}

static inline struct transport_run *begin(const struct world_made *world)
{
    struct error err = { 0 };
    struct transport_run *run = transport_run_create(&world->input, &err);
    if (!run)
        fail_msg("%s", err.text);
    return run;
}

static inline void step(struct transport_run *run, uint64_t n_histories)
{
    struct error err = { 0 };
    if (!transport_run_step(run, n_histories, &err))
        fail_msg("%s", err.text);
}

static inline struct transport_result look(const struct transport_run *run)
{
    struct transport_result result;
    struct error err = { 0 };
    if (!transport_run_read(run, &result, &err))
        fail_msg("%s", err.text);
    return result;
}

static inline void assert_same_bytes(const struct transport_result *a, const struct transport_result *b)
{
    size_t size = grid_n_voxels(&a->mask->grid) * sizeof(float);
    assert_int_equal(grid_n_voxels(&b->mask->grid) * sizeof(float), size);
    for (int i = 0; i < TRANSPORT_N_QUANTITIES; i++) {
        assert_memory_equal(a->values[i]->voxels, b->values[i]->voxels, size);
        assert_memory_equal(a->errors[i]->voxels, b->errors[i]->voxels, size);
    }
    assert_memory_equal(&a->balance, &b->balance, sizeof a->balance);
    assert_true(a->n_histories == b->n_histories);
}

static inline bool in_odd_shape(double x_mm, double y_mm, double z_mm)
{
    return in_sphere(x_mm, y_mm, z_mm) && !(x_mm > 44 && y_mm > 30 && z_mm < 50);
}

struct cancelling {
    atomic_bool cancel;
    bool is_spent; /* cancels no more */
    double at;     /* share of the step */
    int64_t cancelled_us;
};
static inline void cancel_there(void *context, double share)
{
    struct cancelling *cancelling = context;
    if (share > cancelling->at && !cancelling->is_spent && !atomic_exchange(&cancelling->cancel, true))
        cancelling->cancelled_us = clock_now_us();
}

/* Smoothing within matter: which fields it leaves as they are; and how far air reaches. */
#include "core/transport/smooth.h"
#include "tests/check.h"

enum { SIDE = 60 }; /* voxels of 2 mm */

struct made {
    struct grid grid;
    uint8_t voxels[SIDE * SIDE * SIDE];
    struct geometry geometry;
    struct smooth_cells cells;
    struct smoothing smoothing;
    smooth_lanes *values, *room;
};

/* A ball of 55 mm with a cavity near its side. */
static struct made *make(double sigma_cm)
{
    struct made *made = calloc(1, sizeof *made);
    struct error err = { 0 };
    struct affine map = { { { 2, 0, 0 }, { 0, 2, 0 }, { 0, 0, 2 } }, { -59, -59, -59 } };
    assert_non_null(made);
    assert_true(grid_init(&made->grid, (uint32_t[]){ SIDE, SIDE, SIDE }, &map, &err));
    for (int i = 0; i < SIDE * SIDE * SIDE; i++) {
        struct vec3 at = affine_point(&map, vec3(i % SIDE, i / SIDE % SIDE, (double)(i / SIDE / SIDE)));
        made->voxels[i] = vec3_length(at) < 55 && vec3_length(vec3_sub(at, vec3(10, 25, 0))) > 12;
    }
    assert_true(geometry_init(&made->geometry, &made->grid, made->voxels, NULL, 5, NULL, &err));
    assert_true(smooth_cells_init(&made->cells, &made->geometry, &err));
    assert_true(smoothing_init(&made->smoothing, &made->cells, sigma_cm, &err));
    made->values = calloc(made->cells.n_cells, sizeof *made->values);
    made->room = calloc(made->cells.n_cells, sizeof *made->room);
    assert_true(made->values && made->room);
    return made;
}

static void drop(struct made *made)
{
    free(made->values);
    free(made->room);
    smoothing_finish(&made->smoothing);
    smooth_cells_finish(&made->cells);
    geometry_finish(&made->geometry);
    free(made);
}

/* A place from the ball's middle, cm, of an index and a way from that cell's middle, of cells of a width. */
static double place(const struct made *made, int axis, double index, double width)
{
    return (index + .5) * width - .5 * (double)made->geometry.size_cm[axis];
}

/* Smooths a field's sums over the matter of each wider cell, from points in voxels. */
static void smooth_of(struct made *made, double (*field)(double x, double y, double z))
{
    for (int i = 0; i < SIDE * SIDE * SIDE; i++) {
        if (!made->voxels[i])
            continue;
        struct vec3 lps =
            affine_point(&made->grid.lps_mm_from_ijk, vec3(i % SIDE, i / SIDE % SIDE, (double)(i / SIDE / SIDE)));
        double at[3];
        geometry_place(&made->geometry, lps, at);
        const float position[3] = { (float)at[0], (float)at[1], (float)at[2] };
        float *sum = made->values[smooth_cell(&made->geometry, position)];
        double half[3];
        for (int axis = 0; axis < 3; axis++)
            half[axis] = at[axis] - .5 * (double)made->geometry.size_cm[axis];
        for (int lane = 0; lane < PHASE_SPACE_LANES; lane++)
            sum[lane] += (float)((lane + 1) * field(half[0], half[1], half[2]) * .008);
    }
    smooth_field(&made->cells, &made->smoothing, made->values, made->room);
}

/* Largest difference of the smoothed field from the field at the middles of blocks that hold some matter, within a
 * radius. */
static double most_apart(const struct made *made, double (*field)(double x, double y, double z), float least_matter,
                         double within_cm)
{
    const struct geometry *geometry = &made->geometry;
    double most = 0;
    size_t block = 0;
    for (int32_t k = 0; k < geometry->n_blocks[2]; k++)
        for (int32_t j = 0; j < geometry->n_blocks[1]; j++)
            for (int32_t i = 0; i < geometry->n_blocks[0]; i++, block++) {
                float at[PHASE_SPACE_LANES];
                double x = place(made, 0, i, .5), y = place(made, 1, j, .5), z = place(made, 2, k, .5);
                if (geometry->matter[block] < least_matter || x * x + y * y + z * z > within_cm * within_cm)
                    continue;
                smooth_at(&made->cells, made->values, (const int32_t[]){ i, j, k }, at);
                double expected = field(x, y, z);
                for (int lane = 0; lane < PHASE_SPACE_LANES; lane += 5)
                    most = fmax(most, fabs((double)at[lane] / (lane + 1) - expected));
            }
    return most;
}

static double one(double x, double y, double z)
{
    return x == y && y == z ? 1 : 1;
}
static double slope(double x, double y, double z)
{
    return 10 + .5 * x - .3 * y + .8 * z; /* 1 a cm */
}
static double bell(double x, double y, double z)
{
    return exp(-(x * x + y * y + z * z) / (2 * 3 * 3)); /* of 3 cm */
}

static void a_constant_stays_up_to_the_surface(void **state)
{
    (void)state;
    struct made *made = make(1.4);
    smooth_of(made, one);
    assert_close(most_apart(made, one, .06F, 9), 0, 2e-3);
    drop(made);
}

/* A slope of 1 a cm: cells that the surface cuts hold its mean over their matter, not at their middle. */
static void a_slope_stays_up_to_the_surface(void **state)
{
    (void)state;
    struct made *made = make(1.0);
    smooth_of(made, slope);
    double most = most_apart(made, slope, .5F, 9);
    print_message("  at most %.3f\n", most);
    assert_close(most, 0, .15);
    drop(made);
}

static void a_bell_of_3_cm_stays(void **state)
{
    (void)state;
    struct made *made = make(1.0);
    smooth_of(made, bell);
    double middle = most_apart(made, bell, .999F, .8), most = most_apart(made, bell, .999F, 9);
    print_message("  %.4f of its height in the middle, at most %.4f\n", middle, most);
    assert_close(middle, 0, .01);
    assert_close(most, 0, .03);
    drop(made);
}

/* Noise that cells do not share falls to about a third. */
static void noise_falls(void **state)
{
    (void)state;
    struct made *made = make(1.0);
    uint32_t random = 1;
    for (size_t i = 0; i < made->cells.n_held; i++)
        for (int lane = 0; lane < PHASE_SPACE_LANES; lane++) {
            random = random * 1664525U + 1013904223U;
            made->values[made->cells.held[i]][lane] =
                made->cells.volume[made->cells.held[i]] * ((float)(random >> 8) / 16777216.F - .5F);
        }
    smooth_field(&made->cells, &made->smoothing, made->values, made->room);
    double squares = 0, n = 0;
    for (size_t i = 0; i < made->cells.n_held; i++)
        for (int lane = 0; lane < PHASE_SPACE_LANES && made->cells.volume[made->cells.held[i]] > .999F; lane++, n++)
            squares += pow((double)made->values[made->cells.held[i]][lane], 2);
    double left = sqrt(squares / n) / sqrt(1 / 12.);
    print_message("  %.2f of it is left\n", left);
    assert_true(left < .5 && left > .2);
    drop(made);
}

/* Nothing but air as far as a block says, all round it; and it says as much as it can. */
static void air_reaches_as_far_as_blocks_say(void **state)
{
    (void)state;
    struct made *made = make(1);
    const struct geometry *geometry = &made->geometry;
    const int32_t *n = geometry->n_blocks;
    size_t block = 0;
    for (int32_t k = 0; k < n[2]; k++)
        for (int32_t j = 0; j < n[1]; j++)
            for (int32_t i = 0; i < n[0]; i++, block++) {
                int32_t nearest = 255;
                for (int32_t c = 0; c < n[2]; c++)
                    for (int32_t b = 0; b < n[1]; b++)
                        for (int32_t a = 0; a < n[0]; a++) {
                            int32_t far = abs(a - i) > abs(b - j) ? abs(a - i) : abs(b - j);
                            far = abs(c - k) > far ? abs(c - k) : far;
                            if (far < nearest &&
                                geometry->blocks[((size_t)c * (size_t)n[1] + (size_t)b) * (size_t)n[0] + (size_t)a])
                                nearest = far;
                        }
                assert_int_equal(geometry->clear[block], nearest > 0 ? nearest - 1 : 0);
            }
    drop(made);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_constant_stays_up_to_the_surface),
        cmocka_unit_test(a_slope_stays_up_to_the_surface),
        cmocka_unit_test(a_bell_of_3_cm_stays),
        cmocka_unit_test(noise_falls),
        cmocka_unit_test(air_reaches_as_far_as_blocks_say),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* The way of a beam: bands along its axis, univels in its aperture. */
#include "core/beam/sera_angles.h"
#include "core/region/cylinder.h"
#include "core/region/ray.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/made_mask.h"
#include "tests/unit/oracle.h"
#include "tests/unit/sera_head.h"

static double random_part(uint64_t *seed)
{
    return (double)next_random(seed) / 4294967296.0;
}

static struct vec3 random_direction(uint64_t *seed)
{
    for (;;) {
        struct vec3 v = vec3(2 * random_part(seed) - 1, 2 * random_part(seed) - 1, 2 * random_part(seed) - 1);
        double length = vec3_length(v);
        if (length > 0.1 && length < 1)
            return vec3_scale(v, 1 / length);
    }
}

/* ---- along the axis --------------------------------------------------------------------------------------------------- */
static void no_region_on_the_line_gives_no_bands(void **state)
{
    (void)state;
    struct region_set none = { 0 };
    struct ray_band *bands;
    size_t n = 7;
    struct error err = { 0 };
    assert_true(ray_bands_all(&none, vec3(0, 0, 0), vec3(0, 0, 1), &bands, &n, &err));
    assert_int_equal(n, 0);
    free(bands);
}

/* Two layers on turned grids of their own: in the first a large box, in the second a smaller one within it, which the
 * hierarchy puts inside. */
struct two_layers {
    struct region regions[2];
    struct region_set set;
    struct vec3 axes[2][3], centre[2];
    double half_mm[2][3];
};

static void fill_box(struct two_layers *two, int layer, uint64_t *seed)
{
    struct vec3 a = random_direction(seed), b = vec3_normalize(vec3_cross(a, random_direction(seed))),
                c = vec3_cross(a, b);
    const double spacing[] = { 0.8 + random_part(seed), 0.8 + random_part(seed), 2 + random_part(seed) };
    const uint32_t margin = 3, n[] = { layer ? 12u : 60u, layer ? 14u : 64u, layer ? 6u : 30u };
    struct affine map = { { vec3_scale(a, spacing[0]), vec3_scale(b, spacing[1]), vec3_scale(c, spacing[2]) },
                          { 0, 0, 0 } };
    struct vec3 middle = vec3(margin + (n[0] - 1) / 2.0, margin + (n[1] - 1) / 2.0, margin + (n[2] - 1) / 2.0);
    two->centre[layer] = vec3_scale(random_direction(seed), 3);
    map.origin = vec3_sub(two->centre[layer], affine_vector(&map, middle));
    struct volume *volume =
        layer_make(n[0] + 2 * margin, n[1] + 2 * margin, n[2] + 2 * margin, layer ? VOXEL_U16 : VOXEL_U8, &map);
    for (uint32_t k = margin; k < margin + n[2]; k++)
        for (uint32_t j = margin; j < margin + n[1]; j++)
            for (uint32_t i = margin; i < margin + n[0]; i++) {
                size_t at = i + volume->grid.size[0] * (j + (size_t)volume->grid.size[1] * k);
                if (layer)
                    ((uint16_t *)volume->voxels)[at] = 700;
                else
                    ((uint8_t *)volume->voxels)[at] = 9;
            }
    two->set.layers[layer] = volume;
    two->regions[layer] = (struct region){ .layer = (uint32_t)layer, .label = layer ? 700 : 9, .parent = layer - 1 };
    two->axes[layer][0] = a;
    two->axes[layer][1] = b;
    two->axes[layer][2] = c;
    for (int axis = 0; axis < 3; axis++)
        two->half_mm[layer][axis] = n[axis] * spacing[axis] / 2;
}

static void two_layers_make(struct two_layers *two, uint64_t *seed)
{
    *two = (struct two_layers){ 0 };
    fill_box(two, 0, seed);
    fill_box(two, 1, seed);
    two->set.n_layers = two->set.n_regions = 2;
    two->set.regions = two->regions;
    region_set_measure(&two->set);
}

static void two_layers_finish(struct two_layers *two)
{
    volume_unref(two->set.layers[0]);
    volume_unref(two->set.layers[1]);
}

/* Where a line is inside a turned box. */
static void box_depths(const struct two_layers *two, int layer, struct vec3 from, struct vec3 direction,
                       double depths[2])
{
    depths[0] = -INFINITY;
    depths[1] = INFINITY;
    for (int axis = 0; axis < 3; axis++) {
        double at = vec3_dot(vec3_sub(from, two->centre[layer]), two->axes[layer][axis]),
               step = vec3_dot(direction, two->axes[layer][axis]), half = two->half_mm[layer][axis];
        depths[0] = fmax(depths[0], fmin((-half - at) / step, (half - at) / step));
        depths[1] = fmin(depths[1], fmax((-half - at) / step, (half - at) / step));
    }
}

static void a_line_through_two_turned_boxes_is_in_each_from_face_to_face(void **state)
{
    (void)state;
    uint64_t seed = 12;
    for (int trial = 0; trial < 40; trial++) {
        struct two_layers two;
        struct ray_band *bands;
        struct error err = { 0 };
        size_t n;
        double outer[2], inner[2];
        two_layers_make(&two, &seed);
        struct vec3 direction = random_direction(&seed), through = vec3_scale(random_direction(&seed), 4);
        double back = trial % 2 ? 500 : 2; /* the line's point lies outside, or within both: the whole line counts */
        struct vec3 from = vec3_sub(through, vec3_scale(direction, back));
        box_depths(&two, 0, from, direction, outer);
        box_depths(&two, 1, from, direction, inner);
        assert_true(ray_bands_all(&two.set, from, direction, &bands, &n, &err));
        assert_true(inner[0] > outer[0] && inner[1] < outer[1]);
        bool has_inner = inner[0] < inner[1];
        assert_int_equal(n, has_inner ? 3 : 1);
        assert_close(bands[0].from_mm, outer[0], 1e-9);
        assert_close(bands[n - 1].to_mm, outer[1], 1e-9);
        for (size_t i = 0; has_inner && i < 3; i++)
            assert_int_equal(bands[i].region, i == 1);
        if (has_inner) {
            assert_close(bands[1].from_mm, inner[0], 1e-9);
            assert_close(bands[1].to_mm, inner[1], 1e-9);
        }
        free(bands);
        two_layers_finish(&two);
    }
}

/* ---- in the aperture -------------------------------------------------------------------------------------------------- */
static void univels_in_a_cylinder_are_those_whose_centres_are(void **state)
{
    (void)state;
    uint64_t seed = 5;
    for (int trial = 0; trial < 12; trial++) {
        struct two_layers two;
        struct region_in_cylinder found[2];
        struct error err = { 0 };
        two_layers_make(&two, &seed);
        struct vec3 from = vec3_scale(random_direction(&seed), 30), direction = random_direction(&seed);
        if (trial % 3 == 0)
            direction = two.axes[0][0]; /* along the rows */
        double radius = 1 + 40 * random_part(&seed);
        assert_true(regions_in_cylinder(&two.set, from, direction, radius, found, &err));
        for (size_t layer = 0; layer < 2; layer++) {
            const struct volume *volume = two.set.layers[layer];
            uint64_t n = 0;
            double first = INFINITY;
            for (uint32_t k = 0; k < volume->grid.size[2]; k++)
                for (uint32_t j = 0; j < volume->grid.size[1]; j++)
                    for (uint32_t i = 0; i < volume->grid.size[0]; i++) {
                        if (volume_label(volume, i, j, k) == 0)
                            continue;
                        struct vec3 p = vec3_sub(affine_point(&volume->grid.lps_mm_from_ijk, vec3(i, j, k)), from);
                        double along = vec3_dot(p, direction);
                        if (vec3_length(vec3_sub(p, vec3_scale(direction, along))) > radius)
                            continue;
                        n++;
                        first = fmin(first, along);
                    }
            assert_int_equal(found[layer].n_voxels, n);
            if (n > 0)
                assert_close(found[layer].first_along_mm, first, 1e-9);
            else
                assert_true(isinf(found[layer].first_along_mm));
        }
        two_layers_finish(&two);
    }
}

/* A triangle and, apart from it, an L. */
static const float opening_mm[][2] = { { -20, -5 }, { -3, -12 }, { -8, 15 }, { 2, -20 }, { 25, -20 },
                                       { 25, -10 }, { 12, -10 }, { 12, 18 }, { 2, 18 } };
static const uint16_t opening_ends[] = { 3, 9 };

/* Whether the L, two rectangles, or the triangle, three half planes, has the place. */
static bool opening_has(double u, double v)
{
    bool is_in_l = (u > 2 && u < 25 && v > -20 && v < -10) || (u > 2 && u < 12 && v > -20 && v < 18);
    double sides[3];
    for (int i = 0; i < 3; i++) {
        const float *p = opening_mm[i], *q = opening_mm[(i + 1) % 3];
        sides[i] =
            ((double)q[0] - (double)p[0]) * (v - (double)p[1]) - ((double)q[1] - (double)p[1]) * (u - (double)p[0]);
    }
    return is_in_l || (sides[0] > 0 && sides[1] > 0 && sides[2] > 0);
}

static void univels_in_an_opening_are_those_whose_centres_are(void **state)
{
    (void)state;
    uint64_t seed = 7, n_inside = 0;
    for (int trial = 0; trial < 12; trial++) {
        struct two_layers two;
        struct region_in_cylinder found[2];
        struct error err = { 0 };
        two_layers_make(&two, &seed);
        struct vec3 from = vec3_scale(random_direction(&seed), 30), direction = random_direction(&seed);
        if (trial % 3 == 0)
            direction = two.axes[0][0]; /* along the rows */
        struct vec3 x = vec3_normalize(vec3_cross(direction, random_direction(&seed)));
        const struct region_prism prism = { .x_lps = x,
                                            .y_lps = vec3_cross(direction, x),
                                            .points_mm = opening_mm,
                                            .ends = opening_ends,
                                            .n_polygons = 2 };
        assert_true(regions_in_prism(&two.set, from, direction, &prism, found, &err));
        for (size_t layer = 0; layer < 2; layer++) {
            const struct volume *volume = two.set.layers[layer];
            uint64_t n = 0;
            double first = INFINITY;
            for (uint32_t k = 0; k < volume->grid.size[2]; k++)
                for (uint32_t j = 0; j < volume->grid.size[1]; j++)
                    for (uint32_t i = 0; i < volume->grid.size[0]; i++) {
                        struct vec3 p = vec3_sub(affine_point(&volume->grid.lps_mm_from_ijk, vec3(i, j, k)), from);
                        if (volume_label(volume, i, j, k) == 0 ||
                            !opening_has(vec3_dot(p, prism.x_lps), vec3_dot(p, prism.y_lps)))
                            continue;
                        n++;
                        first = fmin(first, vec3_dot(p, direction));
                    }
            assert_int_equal(found[layer].n_voxels, n);
            n_inside += n;
            if (n > 0)
                assert_close(found[layer].first_along_mm, first, 1e-9);
            else
                assert_true(isinf(found[layer].first_along_mm));
        }
        two_layers_finish(&two);
    }
    assert_true(n_inside > 0);
}

static void a_cylinder_through_a_large_box_holds_its_cross_section_times_the_length(void **state)
{
    (void)state;
    struct affine map = { { { 0.5, 0, 0 }, { 0, 0.5, 0 }, { 0, 0, 1 } }, { -50, -50, -20 } };
    struct volume *volume = layer_make(200, 200, 40, VOXEL_U8, &map);
    memset(volume->voxels, 3, 200 * 200 * 40);
    struct region box = { .label = 3, .parent = -1 };
    struct region_set set = { .layers = { volume }, .n_layers = 1, .regions = &box, .n_regions = 1 };
    struct region_in_cylinder found;
    struct error err = { 0 };
    region_set_measure(&set);
    assert_true(regions_in_cylinder(&set, vec3(1, 2, -100), vec3(0, 0, 1), 30, &found, &err));
    /* a pixel's half diagonal on either side of the wall, at random: about 2 sqrt(perimeter / pixel) of 11310 pixels */
    assert_near((double)found.n_voxels * 0.25, MATH_PI * 900 * 40, 0.005);
    assert_close(found.first_along_mm, 80, 1e-12); /* the first layer's centres */
    volume_unref(volume);
}

/* The field of SERA's sample head, as seraMC wrote it into head1.rst (cm; PA, RL, IS). */
static const struct sera_angles head_field = { { -3.84, 2.49, -6.49 }, 10.45, 55, -140 };
static const struct vec3 head_entry_lps_mm = { 52.81099, 61.82010, -39.38779 };

/* ---- SERA's head ------------------------------------------------------------------------------------------------------ */
struct head_beam {
    struct vec3 from, direction;
    double radius;
};
enum { N_BEAMS = 24 };

static void make_beams(struct head_beam beams[N_BEAMS])
{
    static const struct vec3 axes[] = { { 1, 0, 0 }, { 0, -1, 0 }, { 0, 0, -1 }, { 0, 0, 1 } };
    uint64_t seed = 77;
    struct vec3 target = sera_angles_target_lps_mm(&head_field);
    for (int i = 0; i < N_BEAMS; i++) {
        struct vec3 aim = vec3_add(target, vec3_scale(random_direction(&seed), 40 * random_part(&seed)));
        beams[i].direction = i < 4 ? axes[i] : random_direction(&seed);
        beams[i].from = vec3_sub(aim, vec3_scale(beams[i].direction, 400 * random_part(&seed)));
        beams[i].radius = 5 + 70 * random_part(&seed);
    }
    beams[4] = (struct head_beam){ sera_angles_entry_lps_mm(&head_field), vec3(0, 0, 0), 60 }; /* SERA's own field */
    beams[4].direction = vec3_normalize(vec3_sub(target, beams[4].from));
}

static double next_value(char **rest)
{
    char *end;
    double value = strtod(*rest, &end);
    assert_true(end > *rest);
    *rest = end;
    return value;
}

static void compare_region(const struct region_in_cylinder *in, const struct ray_band *bands, size_t n, size_t region,
                           char **rest)
{
    double first = NAN, last = NAN, length = 0;
    for (size_t i = 0; i < n; i++)
        if (bands[i].region == region) {
            first = isnan(first) ? bands[i].from_mm : first;
            last = bands[i].to_mm;
            length += bands[i].to_mm - bands[i].from_mm;
        }
    double expected_first = next_value(rest), expected_last = next_value(rest), expected_length = next_value(rest),
           n_inside = next_value(rest), least_along = next_value(rest);
    assert_int_equal(isnan(first), isnan(expected_first));
    if (!isnan(first)) {
        assert_close(first, expected_first, 1e-6);
        assert_close(last, expected_last, 1e-6);
    }
    assert_close(length, expected_length, 1e-6);
    assert_close((double)in->n_voxels, n_inside, 0);
    if (in->n_voxels > 0)
        assert_close(in->first_along_mm, least_along, 1e-6);
}

static void beams_through_seras_head_are_those_of_ray_casting_in_numpy(void **state)
{
    (void)state;
    static char out[1 << 16];
    char path[1024], folder[256], beams_path[300];
    struct head_beam beams[N_BEAMS];
    struct volume *layer = sera_head_read();
    if (!layer || !data_path("sera-head/generated/head.uv.gz", path, sizeof path)) {
        skip();
        return;
    }
    struct region_set *set = sera_head_regions(layer);
    make_beams(beams);
    folder_make(folder);
    (void)snprintf(beams_path, sizeof beams_path, "%s/beams", folder);
    FILE *text = fopen(beams_path, "w");
    assert_non_null(text);
    for (int i = 0; i < N_BEAMS; i++)
        fprintf(text, "%.17g %.17g %.17g %.17g %.17g %.17g %.17g\n", beams[i].from.x, beams[i].from.y, beams[i].from.z,
                beams[i].direction.x, beams[i].direction.y, beams[i].direction.z, beams[i].radius);
    assert_int_equal(fclose(text), 0);
    int status = oracle_run((char *[]){ oracle_python(), "tests/oracle/head_beams.py", path, beams_path, NULL }, out,
                            sizeof out);
    folder_remove(folder);
    char *rest = out;
    for (int i = 0; status == 0 && i < N_BEAMS; i++) {
        struct region_in_cylinder in[3];
        struct ray_band *bands;
        size_t n;
        struct error err = { 0 };
        assert_true(ray_bands_all(set, beams[i].from, beams[i].direction, &bands, &n, &err));
        assert_true(regions_in_cylinder(set, beams[i].from, beams[i].direction, beams[i].radius, in, &err));
        for (size_t region = 0; region < 3; region++)
            compare_region(&in[region], bands, n, region, &rest);
        free(bands);
    }
    sera_head_destroy(set);
    if (status == ORACLE_MISSING)
        skip();
    assert_int_equal(status, 0);
}

static void the_axis_of_seras_field_meets_the_skin_where_seramc_found_it(void **state)
{
    (void)state;
    struct volume *layer = sera_head_read();
    if (!layer) {
        skip();
        return;
    }
    struct region_set *set = sera_head_regions(layer);
    struct vec3 from = sera_angles_entry_lps_mm(&head_field),
                direction = vec3_normalize(vec3_sub(sera_angles_target_lps_mm(&head_field), from));
    struct ray_band *bands;
    size_t n;
    struct error err = { 0 };
    assert_true(ray_bands_all(set, from, direction, &bands, &n, &err));
    assert_true(n > 0);
    struct vec3 skin = vec3_add(from, vec3_scale(direction, bands[0].from_mm));
    /* seraMC counts univels from -130, in single precision and scaled integers: 0.004 mm to our first centre, and 2^-30
     */
    assert_point(skin, head_entry_lps_mm.x, head_entry_lps_mm.y, head_entry_lps_mm.z, 0.005);
    free(bands);
    sera_head_destroy(set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_region_on_the_line_gives_no_bands),
        cmocka_unit_test(a_line_through_two_turned_boxes_is_in_each_from_face_to_face),
        cmocka_unit_test(univels_in_a_cylinder_are_those_whose_centres_are),
        cmocka_unit_test(univels_in_an_opening_are_those_whose_centres_are),
        cmocka_unit_test(a_cylinder_through_a_large_box_holds_its_cross_section_times_the_length),
        cmocka_unit_test(beams_through_seras_head_are_those_of_ray_casting_in_numpy),
        cmocka_unit_test(the_axis_of_seras_field_meets_the_skin_where_seramc_found_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

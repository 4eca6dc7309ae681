/* The shortest way to a target, and the ways of placing a beam. */
#define _GNU_SOURCE /* sched_setaffinity */
#include "core/scene/beam_place.h"

#include <sched.h>

#include "core/beam/sera_angles.h"
#include "core/region/ray.h"
#include "core/region/shortest.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/made_mask.h"
#include "tests/unit/oracle.h"
#include "tests/unit/sera_head.h"

/* A grid turned about all axes, its middle in the origin. */
static struct affine turned_map(uint32_t n, double spacing_mm)
{
    const double turn = 0.4, tilt = -0.7;
    struct vec3 a = vec3(cos(turn), sin(turn), 0), b = vec3(-sin(turn) * cos(tilt), cos(turn) * cos(tilt), sin(tilt)),
                c = vec3_cross(a, b);
    struct affine map = { { vec3_scale(a, spacing_mm), vec3_scale(b, spacing_mm), vec3_scale(c, spacing_mm) },
                          { 0, 0, 0 } };
    map.origin = vec3_scale(affine_vector(&map, vec3(n - 1.0, n - 1.0, n - 1.0)), -0.5);
    return map;
}

enum { SIDE = 80, MARGIN = 4 };

/* A plan of one region, SIDE^3 univels of 1.5 mm on a turned grid, where is_inside says so of its indices from 0 to
 * SIDE - 1. */
static struct plan *make_plan(bool (*is_inside)(int i, int j, int k))
{
    struct affine map = turned_map(SIDE + 2 * MARGIN, 1.5);
    struct volume *volume = layer_make(SIDE + 2 * MARGIN, SIDE + 2 * MARGIN, SIDE + 2 * MARGIN, VOXEL_U8, &map);
    size_t n = SIDE + 2 * MARGIN;
    for (int k = 0; k < SIDE; k++)
        for (int j = 0; j < SIDE; j++)
            for (int i = 0; i < SIDE; i++)
                ((uint8_t *)
                     volume->voxels)[(size_t)(i + MARGIN) + n * ((size_t)(j + MARGIN) + n * (size_t)(k + MARGIN))] =
                    is_inside(i, j, k);
    struct plan *plan = plan_create("made");
    plan->regions.layers[0] = volume;
    plan->regions.n_layers = plan->regions.n_regions = 1;
    plan->regions.regions = calloc(1, sizeof *plan->regions.regions);
    assert_non_null(plan->regions.regions);
    plan->regions.regions[0] = (struct region){ .id = "body", .label = 1, .parent = -1 };
    region_set_measure(&plan->regions);
    return plan;
}

/* The patient point at fractional indices of the region. */
static struct vec3 point_at(double i, double j, double k)
{
    struct affine map = turned_map(SIDE + 2 * MARGIN, 1.5);
    return affine_point(&map, vec3(i + MARGIN, j + MARGIN, k + MARGIN));
}

static struct vec3 along_axis(int axis)
{
    struct affine map = turned_map(SIDE, 1.5);
    return vec3_normalize(map.columns[axis]);
}

static bool everywhere(int i, int j, int k)
{
    (void)i, (void)j, (void)k;
    return true;
}

static bool all_but_a_channel(int i, int j, int k)
{
    return !(i >= 40 && i < 42 && j >= 40 && j < 42 && k >= 30);
}

static bool in_a_ball(int i, int j, int k)
{
    double x = i - 39.5, y = j - 39.5, z = k - 39.5;
    return x * x + y * y + z * z <= 39.5 * 39.5;
}

static bool all_but_a_cavity(int i, int j, int k)
{
    double x = i - 39.5, y = j - 39.5, z = k - 60;
    return x * x + y * y + z * z > 12 * 12;
}

static struct shortest_way shortest_of(const struct plan *plan, struct vec3 point)
{
    struct shortest_way way;
    struct error err = { 0 };
    if (!regions_shortest_way(&plan->regions, point, &way, &err))
        fail_msg("%s", err.text);
    return way;
}

static void the_shortest_way_out_of_a_box_is_square_to_its_nearest_face(void **state)
{
    (void)state;
    struct plan *plan = make_plan(everywhere);
    struct shortest_way way = shortest_of(plan, point_at(50, 20.3, 44)); /* j: 20.8 univels from the face */
    assert_close(way.depth_mm, 20.8 * 1.5, 1e-3);
    assert_close(vec3_dot(way.outwards, along_axis(1)), -1, 1e-4);
    plan_destroy(plan);
}

static void a_channel_two_univels_wide_is_found_and_taken(void **state)
{
    (void)state;
    struct plan *plan = make_plan(all_but_a_channel);
    /* 5 univels below the channel's bottom, 50 below the surface; the nearest face is 35 away */
    struct shortest_way way = shortest_of(plan, point_at(40.6, 40.4, 24.5));
    assert_close(way.depth_mm, 5 * 1.5, 1e-3);
    assert_close(vec3_dot(way.outwards, along_axis(2)), 1, 1e-3);
    plan_destroy(plan);
}

static void the_shortest_way_out_of_a_ball_leads_away_from_its_centre(void **state)
{
    (void)state;
    struct plan *plan = make_plan(in_a_ball);
    struct shortest_way way = shortest_of(plan, point_at(39.5 + 9, 39.5 - 12, 39.5));
    /* 15 of 39.5 univels from the centre; the wall is a staircase of whole univels */
    assert_close(way.depth_mm, (39.5 - 15) * 1.5, 1.5);
    struct vec3 away = vec3_normalize(vec3_sub(vec3_scale(along_axis(0), 9), vec3_scale(along_axis(1), 12)));
    assert_true(vec3_dot(way.outwards, away) > cos(12 * MATH_PI / 180));
    plan_destroy(plan);
}

static void air_inside_the_patient_is_part_of_the_way(void **state)
{
    (void)state;
    struct plan *plan = make_plan(all_but_a_cavity);
    /* in the cavity, 19.5 univels below the face */
    struct shortest_way way = shortest_of(plan, point_at(39.5, 39.5, 60));
    assert_close(way.depth_mm, 19.5 * 1.5, 1e-3);
    way = shortest_of(plan, point_at(200, 39.5, 60)); /* outside of all */
    assert_close(way.depth_mm, 0, 0);
    plan_destroy(plan);
}

static void one_core_and_many_find_the_same_way(void **state)
{
    (void)state;
    cpu_set_t all, one;
    struct plan *plan = make_plan(in_a_ball);
    struct vec3 centre = point_at(39.5, 39.5, 39.5); /* many ways are equally short */
    struct shortest_way many = shortest_of(plan, centre);
    assert_int_equal(sched_getaffinity(0, sizeof all, &all), 0);
    CPU_ZERO(&one);
    for (size_t i = 0; i < CPU_SETSIZE && CPU_COUNT(&one) == 0; i++)
        if (CPU_ISSET(i, &all))
            CPU_SET(i, &one);
    assert_int_equal(sched_setaffinity(0, sizeof one, &one), 0);
    struct shortest_way alone = shortest_of(plan, centre);
    assert_int_equal(sched_setaffinity(0, sizeof all, &all), 0);
    assert_memory_equal(&many, &alone, sizeof many);
    plan_destroy(plan);
}

static void the_shortest_ways_out_of_seras_head_are_those_of_sampling_in_numpy(void **state)
{
    (void)state;
    char path[1024], out[256];
    static const struct vec3 points[] = { { 24.9, 38.4, -64.9 }, { 0, 0, -130 }, { 0, 20, -220 } };
    struct volume *layer = sera_head_read();
    if (!layer || !data_path("sera-head/generated/head.uv.gz", path, sizeof path)) {
        skip();
        return;
    }
    struct region_set *set = sera_head_regions(layer);
    int status = oracle_run((char *[]){ oracle_python(), "tests/oracle/head_shortest.py", path, "24.9", "38.4", "-64.9",
                                        "0", "0", "-130", "0", "20", "-220", NULL },
                            out, sizeof out);
    char *rest = out;
    for (size_t i = 0; status == 0 && i < sizeof points / sizeof *points; i++) {
        struct shortest_way way;
        struct ray_band *bands;
        size_t n;
        struct error err = { 0 };
        assert_true(regions_shortest_way(set, points[i], &way, &err));
        /* sampled every 0.25 mm: the face lies up to that beyond */
        assert_close(way.depth_mm, strtod(rest, &rest) + 0.125, 0.5);
        assert_true(ray_bands_all(set, points[i], vec3_scale(way.outwards, -1), &bands, &n, &err));
        assert_close(-bands[0].from_mm, way.depth_mm, 1e-6);
        free(bands);
    }
    sera_head_destroy(set);
    if (status == ORACLE_MISSING)
        skip();
    assert_int_equal(status, 0);
}

/* ---- placing ----------------------------------------------------------------------------------------------------------- */
static struct beam_shown beam_from_to(struct vec3 entry, struct vec3 target)
{
    struct vec3 line = vec3_sub(target, entry);
    return (struct beam_shown){ .entry_lps_mm = entry,
                                .target_lps_mm = target,
                                .direction = vec3_normalize(line),
                                .length_mm = vec3_length(line) };
}

/* In a box: 30 mm outside of its lower j face, square to it, to 40 mm inside. */
static struct beam_shown into_the_box(void)
{
    const double face = -0.5, mm = 1 / 1.5;
    return beam_from_to(point_at(40, face - 30 * mm, 40), point_at(40, face + 40 * mm, 40));
}

static void a_gap_moves_the_entry_along_the_axis(void **state)
{
    (void)state;
    struct plan *plan = make_plan(everywhere);
    struct beam_shown beam = into_the_box();
    struct beam_skin skin;
    struct vec3 entry;
    struct error err = { 0 };
    assert_true(beam_skin_of(&plan->regions, beam.entry_lps_mm, beam.target_lps_mm, &skin, &err));
    assert_close(skin.gap_mm, 30, 1e-9);
    assert_close(skin.depth_mm, 40, 1e-9);
    for (double gap = 0; gap <= 200; gap += 50) {
        assert_true(beam_place_gap(&plan->regions, &beam, gap, &entry, &err));
        struct vec3 expected = point_at(40, -0.5 - gap / 1.5, 40);
        assert_point(entry, expected.x, expected.y, expected.z, 1e-9);
    }
    /* an entry inside comes out */
    struct beam_shown inside = beam_from_to(point_at(40, 10, 40), point_at(40, 30, 40));
    assert_true(beam_skin_of(&plan->regions, inside.entry_lps_mm, inside.target_lps_mm, &skin, &err));
    assert_close(skin.gap_mm, -10.5 * 1.5, 1e-9);
    assert_true(beam_place_gap(&plan->regions, &inside, 12, &entry, &err));
    struct vec3 expected = point_at(40, -0.5 - 8, 40);
    assert_point(entry, expected.x, expected.y, expected.z, 1e-9);
    plan_destroy(plan);
}

static void a_beam_through_a_point_comes_from_its_side_and_keeps_the_gap(void **state)
{
    (void)state;
    struct plan *plan = make_plan(everywhere);
    struct beam_shown beam = into_the_box();
    struct beam_skin skin;
    struct vec3 entry, point = point_at(46, 5, 34);
    struct error err = { 0 };
    assert_true(beam_place_through(&plan->regions, &beam, point, NAN, &entry, &err));
    assert_true(beam_skin_of(&plan->regions, entry, beam.target_lps_mm, &skin, &err));
    assert_close(skin.gap_mm, 30, 1e-9);
    struct vec3 direction = vec3_normalize(vec3_sub(beam.target_lps_mm, entry)), way = vec3_sub(point, entry);
    assert_close(vec3_length(vec3_cross(way, direction)), 0, 1e-9);
    assert_true(vec3_dot(way, direction) > 0 &&
                vec3_dot(way, direction) < vec3_length(vec3_sub(beam.target_lps_mm, entry)));
    assert_true(beam_place_through(&plan->regions, &beam, point, 5, &entry, &err));
    assert_true(beam_skin_of(&plan->regions, entry, beam.target_lps_mm, &skin, &err));
    assert_close(skin.gap_mm, 5, 1e-9);
    assert_false(beam_place_through(&plan->regions, &beam, beam.target_lps_mm, NAN, &entry, &err));
    assert_non_null(strstr(err.text, "the target itself"));
    plan_destroy(plan);
}

static void seras_angles_keep_target_and_length(void **state)
{
    (void)state;
    struct beam_shown beam = beam_from_to(vec3(10, -200, 3), vec3(10, 20, 3));
    struct vec3 entry;
    struct error err = { 0 };
    assert_true(beam_place_angles(&beam, 90, 180, &entry, &err)); /* from the left */
    assert_point(entry, 230, 20, 3, 1e-9);
    assert_true(beam_place_angles(&beam, 0, 77, &entry, &err)); /* from above, whatever theta is */
    assert_point(entry, 10, 20, 223, 1e-9);
    struct beam_shown far = beam_from_to(vec3(0, 0, -200000), vec3(0, 0, 0));
    assert_false(beam_place_angles(&far, 90, 0, &entry, &err));
    assert_int_equal(err.code, ERROR_RANGE);
}

static void the_shortest_beam_has_the_least_depth_and_its_gap(void **state)
{
    (void)state;
    struct plan *plan = make_plan(everywhere);
    struct beam_shown beam = beam_from_to(point_at(-60, 20, 44), point_at(50, 20.3, 44));
    struct beam_skin skin;
    struct vec3 entry;
    struct error err = { 0 };
    assert_true(beam_place_shortest(&plan->regions, &beam, 25, &entry, &err));
    assert_true(beam_skin_of(&plan->regions, entry, beam.target_lps_mm, &skin, &err));
    assert_close(skin.gap_mm, 25, 1e-9);
    assert_close(skin.depth_mm, 20.8 * 1.5, 1e-3);
    plan_destroy(plan);
}

static void what_cannot_be_done_is_said(void **state)
{
    (void)state;
    struct plan *plan = make_plan(everywhere), *empty = plan_create("empty");
    struct beam_shown inside = into_the_box(), beside = beam_from_to(point_at(-30, -30, 40), point_at(-30, 90, 40)),
                      before = beam_from_to(point_at(40, -90, 40), point_at(40, -20.5, 40));
    struct vec3 entry;
    struct error err = { 0 };
    assert_false(beam_place_gap(&plan->regions, &beside, 10, &entry, &err));
    assert_string_equal(err.text, "The beam's axis meets no region, so there is no skin to keep a gap to.");
    assert_false(beam_place_gap(&empty->regions, &inside, 10, &entry, &err));
    assert_false(beam_place_shortest(&empty->regions, &inside, 10, &entry, &err));
    assert_string_equal(err.text, "The plan has no regions, so there is no skin to start from.");
    assert_false(beam_place_shortest(&plan->regions, &beside, 10, &entry, &err));
    assert_string_equal(err.text, "The target lies outside of every region, with a free way to it.");
    assert_false(beam_place_gap(&plan->regions, &before, 29, &entry, &err)); /* the target is 30 mm before the face */
    assert_non_null(strstr(err.text, "30.0 mm before the skin: with a gap of 29.0 mm"));
    assert_true(beam_place_gap(&plan->regions, &before, 31, &entry, &err));
    struct vec3 expected = point_at(40, -0.5 - 31 / 1.5, 40);
    assert_point(entry, expected.x, expected.y, expected.z, 1e-9);
    /* a beam that meets nothing keeps its length through a point */
    assert_true(beam_place_through(&plan->regions, &beside, point_at(-50, 90, 40), NAN, &entry, &err));
    assert_close(vec3_length(vec3_sub(entry, beside.target_lps_mm)), 180, 1e-9);
    plan_destroy(empty);
    plan_destroy(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_shortest_way_out_of_a_box_is_square_to_its_nearest_face),
        cmocka_unit_test(a_channel_two_univels_wide_is_found_and_taken),
        cmocka_unit_test(the_shortest_way_out_of_a_ball_leads_away_from_its_centre),
        cmocka_unit_test(air_inside_the_patient_is_part_of_the_way),
        cmocka_unit_test(one_core_and_many_find_the_same_way),
        cmocka_unit_test(the_shortest_ways_out_of_seras_head_are_those_of_sampling_in_numpy),
        cmocka_unit_test(a_gap_moves_the_entry_along_the_axis),
        cmocka_unit_test(a_beam_through_a_point_comes_from_its_side_and_keeps_the_gap),
        cmocka_unit_test(seras_angles_keep_target_and_length),
        cmocka_unit_test(the_shortest_beam_has_the_least_depth_and_its_gap),
        cmocka_unit_test(what_cannot_be_done_is_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

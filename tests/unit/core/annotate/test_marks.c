/* Measures and patient axes on annotated pictures: where they are, and what they say. */
#include "core/annotate/describe.h"
#include "core/annotate/label_places.h"
#include "core/annotate/marks.h"
#include "core/scene/axes.h"
#include "tests/check.h"
#include "tests/derived_of.h"
#include "tests/made_plan.h"

enum { WIDTH = 400, HEIGHT = 300 };

static double ramp(struct vec3 p)
{
    return 100 + 2 * p.x;
}
static double nothing(struct vec3 p)
{
    return 0 * p.x;
}

/* Voxels of 1 x 2 x 3 mm around the origin, 60 mm a side; the image rises by 2 per mm towards L. */
static struct plan *ramp_plan(void)
{
    const uint32_t size[3] = { 60, 30, 20 };
    struct grid grid = made_grid(size[0], size[1], size[2],
                                 made_affine(vec3(1, 0, 0), vec3(0, 2, 0), vec3(0, 0, 3), size, vec3(0, 0, 0)));
    struct plan *plan = made_plan(&grid, nothing, NULL, 0);
    made_plan_add_image(plan, &grid, VOXEL_F32, ramp);
    (void)snprintf(plan->images[0].unit, sizeof plan->images[0].unit, "HU");
    return plan;
}

/* Adds a measure; points: n of them. */
static void add_measure(struct scene *scene, enum scene_measure_kind kind, const char *name, const struct vec3 *points,
                        size_t n)
{
    struct scene_measure_entry *entry = &scene->measures[scene->n_measures++];
    *entry = (struct scene_measure_entry){ .value = scene_measure_default };
    (void)snprintf(entry->id, sizeof entry->id, "m%zu", scene->n_measures);
    (void)snprintf(entry->value.name, sizeof entry->value.name, "%s", name);
    entry->value.kind = kind;
    entry->value.n_points = n;
    entry->value.points = mem_new(n * sizeof *entry->value.points);
    for (size_t i = 0; i < n; i++)
        entry->value.points[i].at_mm = points[i];
}

static struct scene scene_of(const struct plan *plan)
{
    struct scene scene;
    scene_for_plan(plan, &scene);
    scene.image.slices.axial.position_mm = scene.image.slices.coronal.position_mm =
        scene.image.slices.sagittal.position_mm = 0;
    scene.measures = mem_new(8 * sizeof *scene.measures);
    return scene;
}

/* 4 pixels per mm, the origin in the middle: 3-D from the front, or a slice pane. */
static struct annotations describe_with(struct plan *plan, struct scene scene, enum scene_kind kind, bool is_crossed)
{
    struct view view = view_default;
    struct error err = { 0 };
    char field[128];
    view.kind = kind;
    view.size_px[0] = WIDTH;
    view.size_px[1] = HEIGHT;
    view.camera.projection = SCENE_PROJECTION_PARALLEL;
    view.camera.has_position_mm = view.camera.has_target_mm = view.camera.has_up = view.camera.has_height_mm = true;
    view.camera.position_mm = vec3(0, -500, 0);
    view.camera.target_mm = vec3(0, 0, 0);
    view.camera.up = vec3(0, 0, 1);
    view.camera.height_mm = HEIGHT / 4.0;
    struct snapshot *snapshot = snapshot_create(derived_of(plan), &scene, &view, 1, field, &err);
    assert_string_equal(err.text, "");
    struct annotations annotations;
    assert_true(annotations_describe(&annotations, snapshot, WIDTH, "", &err));
    if (is_crossed)
        marks_add_crosshair(&annotations, snapshot);
    snapshot_unref(snapshot);
    return annotations;
}

static struct annotations describe(struct plan *plan, struct scene scene, enum scene_kind kind)
{
    return describe_with(plan, scene, kind, false);
}

static struct annotations describe_crossed(struct plan *plan, struct scene scene, enum scene_kind kind)
{
    return describe_with(plan, scene, kind, true);
}

static void expect_place(const double place[2], double right_mm, double up_mm)
{
    assert_close(place[0] * WIDTH, WIDTH / 2.0 + 4 * right_mm, 1e-6);
    assert_close(place[1] * HEIGHT, HEIGHT / 2.0 - 4 * up_mm, 1e-6);
}

static void a_measure_says_its_value_with_name_and_unit(void **state)
{
    (void)state;
    struct plan *plan = ramp_plan();
    struct scene scene = scene_of(plan);
    add_measure(&scene, SCENE_MEASURE_KIND_DISTANCE, "", (struct vec3[]){ { -3, 0, 0 }, { 0, 0, 4 } }, 2);
    add_measure(&scene, SCENE_MEASURE_KIND_ANGLE, "Tilt", (struct vec3[]){ { 9, 0, 0 }, { 0, 0, 0 }, { 5, 0, 5 } }, 3);
    add_measure(&scene, SCENE_MEASURE_KIND_POLYLINE, "",
                (struct vec3[]){ { 0, 0, 0 }, { 10, 0, 0 }, { 10, 0, 5.25 }, { 10, 0, 0 } }, 4);
    /* half axes of 12 and 10 mm: 376.99 mm2; the mean is 100 + 2 x 2, the deviation 2 x 12 / 2 */
    add_measure(&scene, SCENE_MEASURE_KIND_ELLIPSE, "", (struct vec3[]){ { 2, 0, 0 }, { 14, 0, 0 }, { 2, 0, 10 } }, 3);
    struct annotations annotations = describe(plan, scene, SCENE_KIND_3D);
    assert_int_equal(annotations.n_labels, 4);
    assert_string_equal(annotations.labels[0].text, "5.0 mm");
    expect_place(annotations.labels[0].at, -1.5, 2);
    assert_string_equal(annotations.labels[1].text, "Tilt 45.0\u00b0");
    expect_place(annotations.labels[1].at, 0, 0);
    assert_string_equal(annotations.labels[2].text, "20.5 mm");
    expect_place(annotations.labels[2].at, 10, 0);
    double deviation;
    assert_int_equal(sscanf(annotations.labels[3].text, "3.77 cm\u00b2, 104 \u00b1 %lf HU", &deviation), 1);
    assert_near(deviation, 12, 0.02); /* the lattice of 1 mm counts the rim in or out */
    expect_place(annotations.labels[3].at, 14, 0);
    assert_int_equal(annotations.n_lines, 1 + 2 + 3 + 72);
    expect_place(annotations.lines[0].from, -3, 0);
    expect_place(annotations.lines[0].to, 0, 4);
    expect_place(annotations.lines[6].from, 14, 0);
    for (size_t i = 6; i < annotations.n_lines; i++) { /* on the ellipse */
        double x = (annotations.lines[i].to[0] * WIDTH - WIDTH / 2.0) / 4 - 2,
               y = (HEIGHT / 2.0 - annotations.lines[i].to[1] * HEIGHT) / 4;
        assert_close(x * x / 144 + y * y / 100, 1, 1e-6);
    }
    annotations_finish(&annotations);
    plan_and_derived_destroy(plan);
}

/* Voxels are 2 mm thick across a coronal slice: points up to 1 mm from it are shown. */
static void a_slice_pane_shows_the_measures_that_lie_in_it(void **state)
{
    (void)state;
    struct plan *plan = ramp_plan();
    for (int step = 0; step < 4; step++) {
        static const double off_mm[] = { 0, 0.99, 1.02, -1.02 };
        struct scene scene = scene_of(plan);
        add_measure(&scene, SCENE_MEASURE_KIND_DISTANCE, "", (struct vec3[]){ { -3, 0, 0 }, { 0, off_mm[step], 4 } },
                    2);
        struct annotations annotations = describe(plan, scene, SCENE_KIND_CORONAL);
        assert_int_equal(annotations.n_labels, step < 2);
        assert_int_equal(annotations.n_lines, step < 2);
        annotations_finish(&annotations);
    }
    struct scene scene = scene_of(plan);
    add_measure(&scene, SCENE_MEASURE_KIND_DISTANCE, "", (struct vec3[]){ { -3, 0, 0 }, { 0, 0, 4 } }, 2);
    add_measure(&scene, SCENE_MEASURE_KIND_ANGLE, "", (struct vec3[]){ { -3, 0, 0 }, { 0, 0, 4 } }, 2); /* not done */
    scene.measures[0].value.visible = false;
    struct annotations annotations = describe(plan, scene, SCENE_KIND_CORONAL);
    assert_int_equal(annotations.n_labels + annotations.n_lines, 0);
    annotations_finish(&annotations);
    plan_and_derived_destroy(plan);
}

/* 4 pixels per mm: the picture of 100 x 75 mm is free at 6 % of each edge, and 2.5 % of its height around the middle.
 */
static void the_crosshair_is_drawn_on_a_slice_from_edge_to_edge_free_around_its_middle(void **state)
{
    (void)state;
    struct plan *plan = ramp_plan();
    struct scene scene = scene_of(plan);
    scene.image.slices.sagittal.position_mm = 10;
    scene.image.slices.axial.position_mm = -20;
    const double edge[2] = { 50 * 0.88, 37.5 * 0.88 }, gap = 75 * 0.025;
    const double arms[4][4] = { { -edge[0], -20, 10 - gap, -20 },
                                { 10 + gap, -20, edge[0], -20 },
                                { 10, -edge[1], 10, -20 - gap },
                                { 10, -20 + gap, 10, edge[1] } };
    struct annotations annotations = describe_crossed(plan, scene, SCENE_KIND_CORONAL);
    assert_int_equal(annotations.n_lines, 4);
    for (size_t i = 0; i < 4; i++) {
        bool is_found = false;
        for (size_t j = 0; j < 4; j++) {
            double found[4] = { (annotations.lines[j].from[0] * WIDTH - WIDTH / 2.0) / 4,
                                (HEIGHT / 2.0 - annotations.lines[j].from[1] * HEIGHT) / 4,
                                (annotations.lines[j].to[0] * WIDTH - WIDTH / 2.0) / 4,
                                (HEIGHT / 2.0 - annotations.lines[j].to[1] * HEIGHT) / 4 };
            double off = 0;
            for (int k = 0; k < 4; k++)
                off = fmax(off, fabs(found[k] - arms[i][k]));
            is_found = is_found || off < 1e-6;
        }
        assert_true(is_found);
    }
    annotations_finish(&annotations);
    annotations = describe_crossed(plan, scene_of(plan), SCENE_KIND_3D);
    assert_int_equal(annotations.n_lines, 0);
    annotations_finish(&annotations);
    plan_and_derived_destroy(plan);
}

static void a_crosshair_beside_the_picture_leaves_the_lines_that_cross_it(void **state)
{
    (void)state;
    struct plan *plan = ramp_plan();
    struct scene scene = scene_of(plan);
    scene.image.slices.sagittal.position_mm = 500; /* the line along z is beside the picture, that along x crosses it */
    struct annotations annotations = describe_crossed(plan, scene, SCENE_KIND_CORONAL);
    assert_int_equal(annotations.n_lines, 1);
    expect_place(annotations.lines[0].from, -44, 0);
    expect_place(annotations.lines[0].to, 44, 0);
    annotations_finish(&annotations);
    scene = scene_of(plan);
    scene.image.slices.sagittal.position_mm = scene.image.slices.axial.position_mm = NAN;
    annotations = describe_crossed(plan, scene, SCENE_KIND_CORONAL);
    assert_int_equal(annotations.n_lines, 0);
    annotations_finish(&annotations);
    plan_and_derived_destroy(plan);
}

static void lines_are_painted_on_the_picture_and_nowhere_else(void **state)
{
    (void)state;
    struct plan *plan = ramp_plan();
    struct error err = { 0 };
    struct scene scene = scene_of(plan);
    /* far beyond the picture's left, right and lower edges */
    add_measure(&scene, SCENE_MEASURE_KIND_DISTANCE, "", (struct vec3[]){ { -900, 0, 10 }, { 900, 0, 10 } }, 2);
    add_measure(&scene, SCENE_MEASURE_KIND_DISTANCE, "", (struct vec3[]){ { 20, 0, 0 }, { 20, 0, -900 } }, 2);
    struct annotations annotations = describe(plan, scene, SCENE_KIND_CORONAL), plain = annotations;
    plain.n_lines = plain.n_labels = 0;
    struct image *image = image_create(WIDTH, HEIGHT, &err);
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        memcpy(image->rgba + 4 * i, (uint8_t[4]){ 40, 50, 60, 255 }, 4);
    struct image *with = annotate_image(image, &annotations, &err), *without = annotate_image(image, &plain, &err);
    assert_int_equal(with->height_px, without->height_px);
    for (int y = 0; y < with->height_px; y++)
        for (int x = 0; x < WIDTH; x++) {
            const uint8_t *a = with->rgba + 4 * (y * WIDTH + x), *b = without->rgba + 4 * (y * WIDTH + x);
            bool is_near = y < HEIGHT && (abs(y - 110) <= 3 || (abs(x - 280) <= 3 && y > 145));
            bool is_label =
                y >= 85 && y <= 110 && x >= 195 && x < 290; /* of the first; the other's is off the picture */
            if (!is_near && !is_label)
                assert_memory_equal(a, b, 4);
        }
    /* 0xffd84d in the middle of the line: three quarters of rows 109 and 110 lie within half of 1.5 pixels of 110 */
    assert_true(with->rgba[4 * (110 * WIDTH + 30)] > 185 && with->rgba[4 * (110 * WIDTH + 30) + 2] < 100);
    assert_true(with->rgba[4 * (250 * WIDTH + 280)] > 185 && with->rgba[4 * (250 * WIDTH + 280) + 2] < 100);
    image_destroy(with);
    image_destroy(without);
    image_destroy(image);
    annotations_finish(&annotations);
    plan_and_derived_destroy(plan);
}

static size_t white_pixels(const struct annotations *annotations)
{
    struct error err = { 0 };
    struct image *black = image_create(1600, 1200, &err);
    for (size_t i = 0; i < (size_t)1600 * 1200; i++)
        black->rgba[4 * i + 3] = 255;
    struct image *image = annotate_image(black, annotations, &err);
    size_t n = 0;
    for (size_t i = 0; i < (size_t)1600 * 1200; i++)
        n += image->rgba[4 * i] == 255 && image->rgba[4 * i + 1] == 255 && image->rgba[4 * i + 2] == 255;
    image_destroy(image);
    image_destroy(black);
    return n;
}

/* Words that cover others leave fewer white pixels than each of them has alone. */
static void the_words_of_thirty_measures_cover_none_of_each_other(void **state)
{
    (void)state;
    struct annotation_label labels[30] = { 0 };
    struct annotations all = { .labels = labels, .n_labels = 30, .has_no_caption = true };
    size_t sum = 0, usual = 0;
    for (int i = 0; i < 30; i++) { /* within 80 x 60 of 1600 x 1200 pixels, in the upper right */
        labels[i].at[0] = 0.9 + 0.05 * (i % 6) / 5;
        labels[i].at[1] = 0.1 + 0.05 * (i / 6) / 4.0;
        (void)snprintf(labels[i].text, sizeof labels[i].text, "Margin %d  %d.%d mm", i + 1, 10 + i, i % 10);
    }
    for (int i = 0; i < 30; i++) {
        const struct annotations one = { .labels = &labels[i], .n_labels = 1, .has_no_caption = true };
        sum += white_pixels(&one);
    }
    assert_true(sum > 30 * 500);
    assert_int_equal(white_pixels(&all), sum);
    labels[0].at[0] = 0.1; /* one alone, and again with another far away: it stays */
    all.n_labels = 1;
    usual = white_pixels(&all);
    all.n_labels = 2;
    assert_true(white_pixels(&all) > usual);
}

static void words_beside_a_point_take_its_corners_then_the_nearest_free_place(void **state)
{
    (void)state;
    struct label_box taken[8] = { { 0, 0, 100, 20 } }, box = { .width = 40, .height = 10 };
    struct label_placing placing = { .width_px = 200,
                                     .height_px = 100,
                                     .aside_px = 5,
                                     .above_px = 5,
                                     .step_px = 10,
                                     .taken = taken,
                                     .n_taken = 1,
                                     .n_fixed = 1 };
    static const int corners[4][2] = { { 105, 40 }, { 55, 40 }, { 105, 50 }, { 55, 50 } };
    int end[2];
    for (int i = 0; i < 4; i++) {
        assert_true(label_place(&placing, 100, 50, &box));
        assert_int_equal(box.left, corners[i][0]);
        assert_int_equal(box.top, corners[i][1]);
        assert_false(label_is_far(&placing, 100, 50, &box, end));
    }
    assert_true(label_place(&placing, 100, 50, &box)); /* above or below the four, beside no taken one */
    assert_true(box.top + 10 <= 40 || box.top >= 60);
    assert_true(label_is_far(&placing, 100, 50, &box, end));
    assert_int_equal(end[1], box.top < 50 ? box.top + 10 : box.top);
    placing.n_taken = 1; /* what is fixed keeps words away from every place but the usual one */
    assert_true(label_place(&placing, 20, 15, &box));
    assert_int_equal(box.top, 5);
    assert_true(label_place(&placing, 20, 15, &box));
    assert_true(box.top >= 20);
    box.width = 400; /* wider than the picture: there is no place */
    assert_false(label_place(&placing, 20, 15, &box));
    assert_int_equal(placing.n_taken, 3);
}

static void the_axes_stand_a_tenth_out_of_the_plans_box_on_each_side(void **state)
{
    (void)state;
    struct plan *plan = plan_create("made");
    struct vec3 middle;
    struct axis_end ends[AXES_N_ENDS];
    plan->bounds_lps_mm = box3_empty();
    assert_false(axes_of_plan(plan, &middle, ends));
    plan->bounds_lps_mm = (struct box3){ vec3(-10, 20, -30), vec3(30, 40, 70) }; /* 40 x 20 x 100 mm */
    assert_true(axes_of_plan(plan, &middle, ends));
    assert_point(middle, 10, 30, 20, 1e-12);
    static const struct {
        char letter;
        double x, y, z;
    } expected[AXES_N_ENDS] = { { 'L', 34, 30, 20 }, { 'R', -14, 30, 20 }, { 'P', 10, 42, 20 },
                                { 'A', 10, 18, 20 }, { 'S', 10, 30, 80 },  { 'I', 10, 30, -40 } };
    for (int i = 0; i < AXES_N_ENDS; i++) {
        assert_int_equal(ends[i].letter, expected[i].letter);
        assert_point(ends[i].at_lps_mm, expected[i].x, expected[i].y, expected[i].z, 1e-12);
    }
    plan_destroy(plan);
}

static void letters_stand_at_the_ends_of_the_axes_in_3d_alone(void **state)
{
    (void)state;
    struct plan *plan = ramp_plan(); /* 60 mm a side: ends at 36 mm */
    for (int is_visible = 0; is_visible < 2; is_visible++)
        for (int is_pane = 0; is_pane < 2; is_pane++) {
            struct scene scene = scene_of(plan);
            scene.axes.visible = is_visible;
            struct annotations annotations = describe(plan, scene, is_pane ? SCENE_KIND_CORONAL : SCENE_KIND_3D);
            assert_int_equal(annotations.n_labels, is_visible && !is_pane ? 6 : 0);
            if (annotations.n_labels) {
                assert_string_equal(annotations.labels[0].text, "L"); /* from the front: on the right */
                expect_place(annotations.labels[0].at, 36, 0);
                assert_string_equal(annotations.labels[5].text, "I");
                expect_place(annotations.labels[5].at, 0, -36);
                assert_true(annotations.labels[0].is_centred);
            }
            annotations_finish(&annotations);
        }
    plan_and_derived_destroy(plan);
}

/* The box is 60 mm a side: ends at 36 mm. */
static void letters_stand_where_the_form_of_the_axes_has_its_ends(void **state)
{
    (void)state;
    struct plan *plan = ramp_plan();
    struct scene scene = scene_of(plan);
    scene.axes.visible = true;
    scene.axes.form = SCENE_AXES_FORM_CROSSHAIR;
    scene.image.slices.sagittal.position_mm = 10;
    scene.image.slices.axial.position_mm = -20;
    struct annotations annotations = describe(plan, scene, SCENE_KIND_3D);
    assert_int_equal(annotations.n_labels, 6);
    expect_place(annotations.labels[0].at, 36, -20); /* L */
    expect_place(annotations.labels[4].at, 10, 36);  /* S */
    annotations_finish(&annotations);
    scene = scene_of(plan);
    scene.axes.visible = true;
    scene.axes.form = SCENE_AXES_FORM_CORNER;
    annotations = describe(plan, scene, SCENE_KIND_3D);
    assert_int_equal(annotations.n_labels, 3);
    assert_string_equal(annotations.labels[0].text, "L");
    assert_string_equal(annotations.labels[2].text, "S");
    assert_true(annotations.labels[0].at[0] > annotations.labels[2].at[0]); /* to the right */
    assert_true(annotations.labels[2].at[1] < annotations.labels[0].at[1]); /* above */
    assert_true(annotations.labels[0].at[0] < 0.3 && annotations.labels[2].at[1] > 0.6);
    annotations_finish(&annotations);
    scene = scene_of(plan);
    scene.axes.visible = true;
    scene.axes.letters = false;
    annotations = describe(plan, scene, SCENE_KIND_3D);
    assert_int_equal(annotations.n_labels, 0);
    annotations_finish(&annotations);
    plan_and_derived_destroy(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_measure_says_its_value_with_name_and_unit),
        cmocka_unit_test(a_slice_pane_shows_the_measures_that_lie_in_it),
        cmocka_unit_test(the_crosshair_is_drawn_on_a_slice_from_edge_to_edge_free_around_its_middle),
        cmocka_unit_test(a_crosshair_beside_the_picture_leaves_the_lines_that_cross_it),
        cmocka_unit_test(lines_are_painted_on_the_picture_and_nowhere_else),
        cmocka_unit_test(the_words_of_thirty_measures_cover_none_of_each_other),
        cmocka_unit_test(words_beside_a_point_take_its_corners_then_the_nearest_free_place),
        cmocka_unit_test(the_axes_stand_a_tenth_out_of_the_plans_box_on_each_side),
        cmocka_unit_test(letters_stand_at_the_ends_of_the_axes_in_3d_alone),
        cmocka_unit_test(letters_stand_where_the_form_of_the_axes_has_its_ends),
    };
    return cmocka_run_group_tests_name("marks", tests, NULL, NULL);
}

/* Numbers at the ticks of the patient axes: where each stands follows from the length of the axes and the size of the
 * signs. */
#include "tests/render/shots.h"

static const struct vec3 centre = { 5, -7, 11 };
static const struct made_region one[] = { { "ball", -1, 0x20ff20 } };

static double ball(struct vec3 p)
{
    return vec3_length(vec3_sub(p, centre)) < 20;
}

/* Pixels by which two pictures differ, within half a width and half a height of a place in pixels right and down from
 * the middle. */
static size_t n_painted(const struct image *with, const struct image *without, double right, double down, double half_x,
                        double half_y)
{
    size_t n = 0;
    for (int y = 0; y < SHOTS_HEIGHT; y++)
        for (int x = 0; x < SHOTS_WIDTH; x++)
            n += fabs(x + 0.5 - SHOTS_WIDTH / 2.0 - right) < half_x &&
                 fabs(y + 0.5 - SHOTS_HEIGHT / 2.0 - down) < half_y &&
                 memcmp(shots_pixel(with, x, y), shots_pixel(without, x, y), 4) != 0;
    return n;
}

static struct image *with_axes(struct plan *plan, struct view view, enum scene_axes_form form, bool has_ticks,
                               bool has_numbers)
{
    struct scene scene = shots_scene(plan);
    scene.axes.visible = true;
    scene.axes.form = form;
    scene.axes.letters = false; /* the picture has none, but numbers keep away from their places */
    scene.axes.ticks = has_ticks;
    scene.axes.numbers = has_numbers;
    return shots_plain(plan, scene, view);
}

/* A box of 240 mm. */
static struct plan *large_plan(void)
{
    const uint32_t size[3] = { 20, 20, 20 };
    const struct affine map = made_affine(vec3(12, 0, 0), vec3(0, 12, 0), vec3(0, 0, 12), size, centre);
    const struct grid grid = made_grid(20, 20, 20, map);
    return made_plan(&grid, ball, one, 1);
}

/* Seen from the front at 1 pixel/mm the axes along L and S go 144 pixels from the middle, with long ticks of 6 pixels
 * to each side at 50 and 100. Numbers of 10 pixels stand 5 pixels below the ticks, or right of them, the last with its
 * unit; the axis towards the viewer has none. At 0.4 pixels/mm ticks at 50 mm are 20 pixels apart: too near for "50"
 * and "100". */
static void numbers_stand_at_the_longer_ticks_of_the_axes(void **state)
{
    (void)state;
    struct plan *plan = large_plan();
    for (int is_small = 0; is_small < 2; is_small++) {
        const double scale = is_small ? 0.4 : 1;
        const struct view view = shots_view_from(centre, vec3(0, -1, 0), vec3(0, 0, 1), scale);
        struct image *ticks = with_axes(plan, view, SCENE_AXES_FORM_MIDDLE, true, false),
                     *numbers = with_axes(plan, view, SCENE_AXES_FORM_MIDDLE, true, true);
        size_t n_there = 0;
        for (int way = -1; way <= 1; way += 2)
            for (int mm = is_small ? 100 : 50; mm <= 100; mm += 50) {
                const double half = mm == 100 ? 30 : 11, at = way * mm * scale;
                const size_t n_across = n_painted(numbers, ticks, at, 6 + 5 + 5, half, 7),
                             n_up = n_painted(numbers, ticks, 11 + (mm == 100 ? 28 : 9), at, half, 7);
                assert_true(n_across > 60 && n_up > 60);
                n_there += n_across + n_up;
            }
        assert_int_equal(n_painted(numbers, ticks, 0, 0, SHOTS_WIDTH, SHOTS_HEIGHT), n_there);
        image_destroy(ticks);
        image_destroy(numbers);
    }
    shots_forget(plan);
}

/* The box is 240 pixels wide and high: numbers stand outside it, at 50, 100, 150 and 200 mm from its right and lower
 * sides, in three of its edges at most. */
static void numbers_of_the_box_stand_outside_it(void **state)
{
    (void)state;
    struct plan *plan = large_plan();
    const struct view view = shots_view_from(centre, vec3(0, -1, 0), vec3(0, 0, 1), 1);
    struct image *ticks = with_axes(plan, view, SCENE_AXES_FORM_BOX, true, false),
                 *numbers = with_axes(plan, view, SCENE_AXES_FORM_BOX, true, true);
    assert_int_equal(n_painted(numbers, ticks, 0, 0, 120, 120), 0);
    for (int mm = 50; mm <= 200; mm += 50) { /* up from below, on one side */
        const size_t n_left = n_painted(numbers, ticks, -161, 120 - mm, 40, 8),
                     n_right = n_painted(numbers, ticks, 161, 120 - mm, 40, 8);
        assert_true((n_left > 60) != (n_right > 60));
    }
    image_destroy(ticks);
    image_destroy(numbers);
    shots_forget(plan);
}

static void numbers_need_ticks(void **state)
{
    (void)state;
    struct plan *plan = large_plan();
    const size_t n_bytes = 4 * (size_t)SHOTS_WIDTH * SHOTS_HEIGHT;
    for (int i = 0; i < 3; i++) { /* no ticks; in the corner, where there are none; a slice */
        const struct view view = i < 2 ? shots_view_from(centre, vec3(0.3, -1, 0.2), vec3(0, 0, 1), 1)
                                       : shots_view(SCENE_KIND_AXIAL, centre, 1);
        const enum scene_axes_form form = i == 1 ? SCENE_AXES_FORM_CORNER : SCENE_AXES_FORM_MIDDLE;
        struct image *with = with_axes(plan, view, form, i > 0, true),
                     *without = with_axes(plan, view, form, i > 0, false);
        assert_memory_equal(with->rgba, without->rgba, n_bytes);
        image_destroy(with);
        image_destroy(without);
    }
    shots_forget(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_stand_at_the_longer_ticks_of_the_axes),
        cmocka_unit_test(numbers_of_the_box_stand_outside_it),
        cmocka_unit_test(numbers_need_ticks),
    };
    return shots_run("numbers of axes", tests, sizeof tests / sizeof tests[0]);
}

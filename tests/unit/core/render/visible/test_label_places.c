/* Labels on lines: on their line, within the picture, none over another, by the pixels that they cover. */
#include "core/render/visible/label_places.h"

#include "core/math/vec.h"
#include "tests/check.h"

static double random_part(void) /* 0..1, from a fixed sequence */
{
    static uint64_t state = 88172645463325252u;
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return (double)(state >> 11) * 0x1p-53;
}

static bool holds(const struct label_place *place, double x, double y)
{
    double turn = place->angle_deg * MATH_PI / 180, dx = x - place->x_px, dy = y - place->y_px;
    return fabs(dx * cos(turn) + dy * sin(turn)) <= place->width_px / 2 &&
           fabs(-dx * sin(turn) + dy * cos(turn)) <= place->height_px / 2;
}

/* True if some sample lies in both, four samples to a pixel. */
static bool share_pixels(const struct label_place *a, const struct label_place *b)
{
    double reach = a->width_px + a->height_px;
    for (double y = a->y_px - reach; y <= a->y_px + reach; y += 0.5)
        for (double x = a->x_px - reach; x <= a->x_px + reach; x += 0.5)
            if (holds(a, x, y) && holds(b, x, y))
                return true;
    return false;
}

static void labels_lie_on_their_lines_in_the_picture_and_do_not_overlap(void **state)
{
    (void)state;
    enum { RINGS = 6, POINTS = 181 };
    static double points[RINGS][POINTS][2];
    static const int sizes[][2] = { { 320, 240 }, { 640, 480 }, { 1024, 768 }, { 400, 900 } };
    for (size_t s = 0; s < sizeof sizes / sizeof sizes[0]; s++)
        for (int squeeze = 1; squeeze <= 3; squeeze++) {
            struct label_line lines[RINGS];
            struct label_place places[32];
            struct error err = { 0 };
            double width = sizes[s][0], height = sizes[s][1];
            for (int ring = 0; ring < RINGS; ring++) {
                double radius = width / 2 * (1 - 0.12 * ring / squeeze);
                for (int i = 0; i < POINTS; i++) {
                    double turn = 2 * MATH_PI * (i % (POINTS - 1)) / (POINTS - 1);
                    points[ring][i][0] = width / 2 + radius * cos(turn) / squeeze;
                    points[ring][i][1] = height / 2 + radius * sin(turn);
                }
                lines[ring] = (struct label_line){ (const double(*)[2])points[ring], POINTS, ring, 34 };
            }
            const struct label_style style = { .height_px = 14, .is_upright = squeeze == 2 };
            int n = label_places_find(lines, RINGS, width, height, &style, places, 32, &err);
            assert_true(n >= 1 && n <= 32);
            for (int i = 0; i < n; i++) {
                double nearest = INFINITY, turn = places[i].angle_deg * MATH_PI / 180;
                for (int k = 0; k < POINTS; k++)
                    nearest = fmin(nearest, hypot(points[places[i].line][k][0] - places[i].x_px,
                                                  points[places[i].line][k][1] - places[i].y_px));
                assert_true(nearest < 14); /* points are 9 px apart at most, and the line bends under the label */
                double x = fabs(17 * cos(turn)) + fabs(7 * sin(turn)), y = fabs(17 * sin(turn)) + fabs(7 * cos(turn));
                assert_true(places[i].x_px - x >= 0 && places[i].x_px + x <= width && places[i].y_px - y >= 0 &&
                            places[i].y_px + y <= height);
                assert_true(places[i].angle_deg > -90 && places[i].angle_deg <= 90);
                for (int k = 0; k < i; k++) {
                    assert_false(share_pixels(&places[i], &places[k]));
                    assert_false(label_places_overlap(&places[i], &places[k]));
                }
            }
        }
}

static void overlapping_rectangles_are_told_from_others_as_their_pixels_say(void **state)
{
    (void)state;
    int n_over = 0;
    for (int trial = 0; trial < 400; trial++) {
        struct label_place a = { 0, 0, 0, 180 * random_part() - 90, 30, 12 }, b = { 0,
                                                                                    40 * random_part() - 20,
                                                                                    40 * random_part() - 20,
                                                                                    180 * random_part() - 90,
                                                                                    30,
                                                                                    12 },
                           larger = a;
        larger.width_px += 2;
        larger.height_px += 2;
        if (share_pixels(&a, &b))
            assert_true(label_places_overlap(&a, &b));
        else if (!share_pixels(&larger, &b))
            assert_false(label_places_overlap(&a, &b));
        n_over += label_places_overlap(&a, &b);
    }
    assert_true(n_over > 20 && n_over < 380);
}

static void places_to_choose_from_are_many_and_keep_off_what_is_kept_free(void **state)
{
    (void)state;
    enum { POINTS = 181 };
    static double ring[POINTS][2];
    /* a bar across the upper half of the ring, as two ends */
    static const double bar[2][2] = { { 0, 80 }, { 400, 80 } };
    for (int i = 0; i < POINTS; i++) {
        double turn = 2 * MATH_PI * (i % (POINTS - 1)) / (POINTS - 1);
        ring[i][0] = 200 + 130 * cos(turn);
        ring[i][1] = 200 + 130 * sin(turn);
    }
    const struct label_line lines[] = { { (const double(*)[2])ring, POINTS, 0, 34 }, { bar, 2, LABEL_KEPT_FREE, 0 } };
    struct error err = { 0 };
    int n_of[2];
    for (int is_choice = 0; is_choice < 2; is_choice++) {
        struct label_place places[32];
        const struct label_style style = { .height_px = 14, .is_choice = is_choice };
        n_of[is_choice] = label_places_find(lines, 2, 400, 400, &style, places, 32, &err);
        for (int i = 0; i < n_of[is_choice]; i++) {
            assert_int_equal(places[i].line, 0);
            for (double x = 0; x <= 400; x += 0.5)
                assert_false(holds(&places[i], x, 80));
        }
    }
    /* the ring is 817 px long: one label each 480 px; places do not overlap, 34 + 3 px wide, and the bar takes some */
    assert_int_equal(n_of[0], 1);
    assert_in_range(n_of[1], 5, 22);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(labels_lie_on_their_lines_in_the_picture_and_do_not_overlap),
        cmocka_unit_test(places_to_choose_from_are_many_and_keep_off_what_is_kept_free),
        cmocka_unit_test(overlapping_rectangles_are_told_from_others_as_their_pixels_say),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

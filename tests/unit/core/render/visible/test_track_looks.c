/* The looks of the classes of tracks: seen on the panes' background, and told apart also by people who do not see red
 * or green. */
#include <math.h>

#include "core/render/visible/visible.h"
#include "core/track/track.h"
#include "tests/check.h"

struct linear {
    double rgb[3];
};

/* IEC 61966-2-1 */
static struct linear linear_of(uint32_t rgb)
{
    struct linear out;
    for (int c = 0; c < 3; c++) {
        double v = (rgb >> (16 - 8 * c) & 255) / 255.0;
        out.rgb[c] = v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4);
    }
    return out;
}

static double luminance(const struct linear *l)
{
    return 0.2126 * l->rgb[0] + 0.7152 * l->rgb[1] + 0.0722 * l->rgb[2];
}

/* CIE 1976 L*a*b*, white D65. */
static void lab_of(const struct linear *l, double lab[3])
{
    static const double to_xyz[3][3] = { { 0.4124, 0.3576, 0.1805 },
                                         { 0.2126, 0.7152, 0.0722 },
                                         { 0.0193, 0.1192, 0.9505 } };
    static const double white[3] = { 0.9505, 1, 1.089 };
    double f[3];
    for (int row = 0; row < 3; row++) {
        double t = 0;
        for (int c = 0; c < 3; c++)
            t += to_xyz[row][c] * fmin(1, fmax(0, l->rgb[c])) / white[row];
        f[row] = t > 216.0 / 24389 ? cbrt(t) : (24389.0 / 27 * t + 16) / 116;
    }
    lab[0] = 116 * f[1] - 16;
    lab[1] = 500 * (f[0] - f[1]);
    lab[2] = 200 * (f[1] - f[2]);
}

/* Linear RGB as seen without red or without green cones.
 * Source: F. Vienot, H. Brettel, J. D. Mollon, Digital Video Colourmaps, Color Res. Appl. 1999 */
static const double seen_by[3][3][3] = {
    { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } },
    { { 0.11238, 0.88762, 0 }, { 0.11238, 0.88762, 0 }, { 0.00401, -0.00401, 1 } },
    { { 0.29275, 0.70725, 0 }, { 0.29275, 0.70725, 0 }, { -0.02234, 0.02234, 1 } },
};

static double difference(uint32_t a, uint32_t b, const double seen[3][3])
{
    double lab[2][3], sum = 0;
    for (int i = 0; i < 2; i++) {
        struct linear full = linear_of(i ? b : a), left = { { 0 } };
        for (int row = 0; row < 3; row++)
            for (int c = 0; c < 3; c++)
                left.rgb[row] += seen[row][c] * full.rgb[c];
        lab_of(&left, lab[i]);
    }
    for (int c = 0; c < 3; c++)
        sum += (lab[0][c] - lab[1][c]) * (lab[0][c] - lab[1][c]);
    return sqrt(sum);
}

static void every_class_has_the_contrast_of_text_on_the_panes_background(void **state)
{
    (void)state;
    struct linear pane =
        linear_of((uint32_t)visible_background[0] << 16 | (uint32_t)visible_background[1] << 8 | visible_background[2]);
    for (int class = 0; class < TRACK_N_CLASSES; class ++) {
        struct linear color = linear_of(track_class_look((enum track_class) class).color_rgb);
        double contrast = (luminance(&color) + 0.05) / (luminance(&pane) + 0.05); /* WCAG 2 */
        if (contrast < 4.5)
            fail_msg("%s has a contrast of %.1f", track_class_word((enum track_class) class), contrast);
    }
}

/* 10 is a difference seen at a glance, also in thin lines beside each other. */
static void classes_differ_by_more_than_colour_or_by_a_colour_that_everybody_sees(void **state)
{
    (void)state;
    for (int a = 0; a < TRACK_N_CLASSES; a++)
        for (int b = a + 1; b < TRACK_N_CLASSES; b++) {
            struct track_look one = track_class_look((enum track_class)a),
                              other = track_class_look((enum track_class)b);
            bool is_dash_alike = one.on_px == other.on_px && one.off_px == other.off_px;
            for (int eyes = 0; is_dash_alike && eyes < 3; eyes++) {
                double apart = difference(one.color_rgb, other.color_rgb, seen_by[eyes]);
                if (apart < 10)
                    fail_msg("%s and %s differ by %.1f", track_class_word((enum track_class)a),
                             track_class_word((enum track_class)b), apart);
            }
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_class_has_the_contrast_of_text_on_the_panes_background),
        cmocka_unit_test(classes_differ_by_more_than_colour_or_by_a_colour_that_everybody_sees),
    };
    return cmocka_run_group_tests_name("track looks", tests, NULL, NULL);
}

/* Reduced pictures against the mean of their blocks, taken pixel by pixel from the definition. */
#include "core/base/image_reduce.h"
#include "tests/check.h"

static struct image *noise(int width_px, int height_px)
{
    struct error err = { 0 };
    struct image *image = image_create(width_px, height_px, &err);
    assert_non_null(image);
    uint32_t state = 12345;
    for (size_t i = 0; i < (size_t)width_px * (size_t)height_px * 4; i++) {
        state = state * 1664525 + 1013904223; /* Numerical Recipes' generator */
        image->rgba[i] = (uint8_t)(state >> 24);
    }
    return image;
}

/* The mean of the pixels of a block that lie in the picture, rounded to the nearest, halves up. */
static int mean_of_block(const struct image *image, int divisor, int column, int row, int channel)
{
    double sum = 0;
    int n = 0;
    for (int y = row * divisor; y < (row + 1) * divisor && y < image->height_px; y++)
        for (int x = column * divisor; x < (column + 1) * divisor && x < image->width_px; x++, n++)
            sum += image->rgba[((size_t)y * (size_t)image->width_px + (size_t)x) * 4 + (size_t)channel];
    return (int)floor(sum / n + 0.5);
}

static void expect_means(int width_px, int height_px, int divisor)
{
    struct error err = { 0 };
    struct image *image = noise(width_px, height_px), *reduced = image_reduce(image, divisor, &err);
    assert_non_null(reduced);
    assert_int_equal(reduced->width_px, (int)ceil((double)width_px / divisor));
    assert_int_equal(reduced->height_px, (int)ceil((double)height_px / divisor));
    for (int y = 0; y < reduced->height_px; y++)
        for (int x = 0; x < reduced->width_px; x++)
            for (int c = 0; c < 4; c++) {
                int is = reduced->rgba[((size_t)y * (size_t)reduced->width_px + (size_t)x) * 4 + (size_t)c],
                    expected = mean_of_block(image, divisor, x, y, c);
                if (is != expected)
                    fail_msg("%d x %d by %d: channel %d of (%d, %d) is %d, not %d", width_px, height_px, divisor, c, x,
                             y, is, expected);
            }
    image_destroy(reduced);
    image_destroy(image);
}

static void each_pixel_is_the_mean_of_its_block_whatever_the_sides(void **state)
{
    (void)state;
    static const int sides[] = { 1, 2, 3, 4, 5, 6, 7, 8, 9, 33, 64 };
    const int n = sizeof sides / sizeof sides[0];
    for (int i = 0; i < n * n; i++)
        for (int divisor = 2; divisor <= 4; divisor += 2)
            expect_means(sides[i / n], sides[i % n], divisor);
    expect_means(1441, 7, 2);
    expect_means(1441, 7, 4);
}

/* Calculated by hand: (10 + 21) / 2 = 15.5 is 16; the block of four 0, 0, 1, 1 has 0.5, which is 1; 0, 0, 0, 1 has
 * 0.25: 0. */
static void halves_are_rounded_up(void **state)
{
    (void)state;
    static const uint8_t reds[2][5] = { { 0, 0, 0, 0, 10 }, { 1, 1, 0, 1, 21 } };
    struct error err = { 0 };
    struct image *image = image_create(5, 2, &err);
    for (int i = 0; i < 10; i++)
        image->rgba[4 * i] = reds[i / 5][i % 5];
    struct image *half = image_reduce(image, 2, &err);
    assert_int_equal(half->width_px, 3);
    assert_int_equal(half->height_px, 1);
    assert_int_equal(half->rgba[0], 1);
    assert_int_equal(half->rgba[4], 0);
    assert_int_equal(half->rgba[8], 16);
    image_destroy(half);
    image_destroy(image);
}

/* The largest sums: 16 pixels of 255. */
static void white_stays_white(void **state)
{
    (void)state;
    struct error err = { 0 };
    struct image *image = image_create(10, 6, &err);
    memset(image->rgba, 255, (size_t)10 * 6 * 4);
    for (int i = 0; i < IMAGE_N_REDUCED; i++) {
        struct image *reduced = image_reduce(image, image_divisor(i), &err);
        for (int at = 0; at < reduced->width_px * reduced->height_px * 4; at++)
            assert_int_equal(reduced->rgba[at], 255);
        image_destroy(reduced);
    }
    image_destroy(image);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_pixel_is_the_mean_of_its_block_whatever_the_sides),
        cmocka_unit_test(halves_are_rounded_up),
        cmocka_unit_test(white_stays_white),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

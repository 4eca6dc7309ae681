/* Images are decoded again by other decoders of the libraries, as a browser would. */
#include <spng.h>
#include <turbojpeg.h>

#include "core/encode/encode.h"
#include "tests/check.h"

enum { WIDTH = 67, HEIGHT = 45 }; /* not a multiple of a block, nor of two */

/* A smooth image, so that losses are small: gradients of red along x and green along y, constant blue. */
static struct image *smooth_image(void)
{
    struct error err = { 0 };
    struct image *image = image_create(WIDTH, HEIGHT, &err);
    assert_non_null(image);
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            uint8_t *p = &image->rgba[4 * (y * WIDTH + x)];
            p[0] = (uint8_t)(40 + 2 * x);
            p[1] = (uint8_t)(200 - 3 * y);
            p[2] = 90;
            p[3] = 255;
        }
    return image;
}

static struct encoded encode(const struct image *image, enum encode_codec codec, int quality, bool full_color)
{
    struct encoder *encoder = encoder_create();
    struct error err = { 0 };
    struct encoded out;
    struct encode_options options = { codec, quality, full_color };
    assert_true(encode_image(encoder, image, &options, &out, &err));
    assert_string_equal(err.text, "");
    encoder_destroy(encoder);
    return out;
}

static void expect_jpeg(const struct image *image, int quality, bool full_color, int tolerance)
{
    struct encoded jpeg = encode(image, ENCODE_JPEG, quality, full_color);
    tjhandle reader = tjInitDecompress();
    int width, height, sampling, space;
    assert_int_equal(tjDecompressHeader3(reader, jpeg.bytes, jpeg.n_bytes, &width, &height, &sampling, &space), 0);
    assert_int_equal(width, WIDTH);
    assert_int_equal(height, HEIGHT);
    assert_int_equal(sampling, full_color ? TJSAMP_444 : TJSAMP_420);
    static uint8_t back[WIDTH * HEIGHT * 4];
    assert_int_equal(tjDecompress2(reader, jpeg.bytes, jpeg.n_bytes, back, WIDTH, 0, HEIGHT, TJPF_RGBX,
                                   TJFLAG_ACCURATEDCT),
                     0);
    tjDestroy(reader);
    for (int i = 0; i < WIDTH * HEIGHT * 4; i++)
        if (i % 4 != 3)
            assert_close(back[i], image->rgba[i], tolerance);
    free(jpeg.bytes);
}

static void a_jpeg_shows_the_picture_again_the_same_way_up(void **state)
{
    (void)state;
    struct image *image = smooth_image();
    expect_jpeg(image, 95, true, 4);   /* one or two levels of quantisation, and colour conversion */
    expect_jpeg(image, 95, false, 8);  /* and colours of 2 x 2 pixels */
    expect_jpeg(image, 80, false, 14); /* the fast DCT */
    image_destroy(image);
}

static void lower_quality_takes_fewer_bytes(void **state)
{
    (void)state;
    struct image *image = smooth_image();
    for (size_t i = 0; i < (size_t)WIDTH * HEIGHT; i++)
        image->rgba[4 * i] = (uint8_t)(i * 2654435761u >> 13); /* noise */
    struct encoded high = encode(image, ENCODE_JPEG, 95, true), low = encode(image, ENCODE_JPEG, 40, true);
    assert_true(low.n_bytes * 2 < high.n_bytes);
    free(high.bytes);
    free(low.bytes);
    image_destroy(image);
}

static void a_png_is_the_picture_exactly(void **state)
{
    (void)state;
    struct image *image = smooth_image();
    struct encoded png = encode(image, ENCODE_PNG, 0, false);
    spng_ctx *reader = spng_ctx_new(0);
    assert_int_equal(spng_set_png_buffer(reader, png.bytes, png.n_bytes), 0);
    static uint8_t back[WIDTH * HEIGHT * 4];
    size_t n_back = 0;
    assert_int_equal(spng_decoded_image_size(reader, SPNG_FMT_RGBA8, &n_back), 0);
    assert_int_equal(n_back, sizeof back);
    assert_int_equal(spng_decode_image(reader, back, sizeof back, SPNG_FMT_RGBA8, 0), 0);
    assert_memory_equal(back, image->rgba, sizeof back);
    spng_ctx_free(reader);
    free(png.bytes);
    image_destroy(image);
}

static void one_compressor_serves_pictures_of_any_size(void **state)
{
    (void)state;
    struct encoder *encoder = encoder_create();
    for (int side = 1; side <= 4096; side *= 8) {
        struct error err = { 0 };
        struct image *image = image_create(side, 3, &err);
        struct encoded out;
        assert_true(encode_image(encoder, image, &(struct encode_options){ ENCODE_JPEG, 90, side > 64 }, &out, &err));
        assert_true(out.n_bytes > 100);
        free(out.bytes);
        image_destroy(image);
    }
    encoder_destroy(encoder);
}

static void what_cannot_be_encoded_is_refused(void **state)
{
    (void)state;
    struct image *image = smooth_image();
    struct encoder *encoder = encoder_create();
    static const struct encode_options bad[] = { { ENCODE_JPEG, 0, true },
                                                 { ENCODE_JPEG, 101, true },
                                                 { (enum encode_codec)9, 80, true } };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        struct error err = { 0 };
        struct encoded out = { image->rgba, 1 };
        assert_false(encode_image(encoder, image, &bad[i], &out, &err));
        assert_int_equal(err.code, ERROR_RANGE);
        assert_null(out.bytes);
    }
    struct image none = { 0, HEIGHT, image->rgba }, huge = { IMAGE_MAX_SIDE_PX + 1, 1, image->rgba };
    struct error err = { 0 };
    struct encoded out;
    assert_false(encode_image(encoder, &none, &(struct encode_options){ ENCODE_PNG, 0, false }, &out, &err));
    assert_false(encode_image(encoder, &huge, &(struct encode_options){ ENCODE_JPEG, 80, false }, &out, &err));
    assert_int_equal(err.code, ERROR_RANGE);
    encoder_destroy(encoder);
    image_destroy(image);
}

static void a_png_carries_a_text_that_is_compressed(void **state)
{
    (void)state;
    struct image *image = smooth_image();
    struct error err = { 0 };
    struct encoded png;
    static char text[100000];
    for (size_t i = 0; i + 1 < sizeof text; i++)
        text[i] = "{\"name\": \"\xc3\x84\"}"[i % 14];
    assert_true(encode_png_with_text(image, "beamroom", text, &png, &err));
    spng_ctx *reader = spng_ctx_new(0);
    struct spng_text found[1];
    uint32_t n = 0;
    assert_int_equal(spng_set_png_buffer(reader, png.bytes, png.n_bytes), 0);
    assert_int_equal(spng_get_text(reader, NULL, &n), 0);
    assert_int_equal(n, 1);
    assert_int_equal(spng_get_text(reader, found, &n), 0);
    assert_string_equal(found[0].keyword, "beamroom");
    assert_int_equal(found[0].type, SPNG_ITXT);
    assert_int_equal(found[0].compression_flag, 1);
    assert_int_equal(found[0].length, strlen(text));
    assert_string_equal(found[0].text, text);
    assert_true(png.n_bytes < sizeof text / 5); /* a pattern of 14 bytes */
    static uint8_t back[WIDTH * HEIGHT * 4];
    assert_int_equal(spng_decode_image(reader, back, sizeof back, SPNG_FMT_RGBA8, 0), 0);
    assert_memory_equal(back, image->rgba, sizeof back);
    spng_ctx_free(reader);
    free(png.bytes);
    image_destroy(image);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_jpeg_shows_the_picture_again_the_same_way_up),
        cmocka_unit_test(lower_quality_takes_fewer_bytes),
        cmocka_unit_test(a_png_is_the_picture_exactly),
        cmocka_unit_test(one_compressor_serves_pictures_of_any_size),
        cmocka_unit_test(what_cannot_be_encoded_is_refused),
        cmocka_unit_test(a_png_carries_a_text_that_is_compressed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

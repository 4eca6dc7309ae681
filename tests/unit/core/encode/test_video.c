/* Films: the elements of the file nest and are found by their cues (RFC 8794, RFC 9559), and libvpx's decoder gives
 * back the colours. */
#include <vpx/vp8dx.h>
#include <vpx/vpx_decoder.h>

#include "core/encode/film.h"
#include "tests/check.h"

enum { WIDTH = 64, HEIGHT = 48, FPS = 10, N = 45 };

/* The n-th picture: one colour, which goes round. */
static void color_of(int n, uint8_t rgb[3])
{
    static const uint8_t colors[][3] = { { 220, 40, 40 },   { 40, 220, 40 },   { 40, 40, 220 },
                                         { 128, 128, 128 }, { 255, 255, 255 }, { 0, 0, 0 } };
    memcpy(rgb, colors[n / 8 % 6], 3);
}

static struct encoded made(int quality)
{
    struct error err = { 0 };
    struct video *video = video_create(WIDTH, HEIGHT, FPS, quality, 0, &err);
    struct image *image = image_create(WIDTH, HEIGHT, &err);
    struct encoded film = { 0 };
    assert_non_null(video);
    for (int n = 0; n < N; n++) {
        uint8_t rgb[3];
        color_of(n, rgb);
        for (size_t i = 0; i < (size_t)WIDTH * HEIGHT; i++)
            memcpy(image->rgba + 4 * i, rgb, 3);
        assert_true(video_add(video, image, &err));
    }
    assert_true(video_finish(video, &film, &err));
    assert_false(video_add(video, image, &err));
    image_destroy(image);
    video_destroy(video);
    return film;
}

/* ---- the file --------------------------------------------------------------------------------------------------- */

struct element {
    uint32_t id;
    size_t at, end; /* of what it holds */
};

static uint64_t number_at(const struct encoded *film, size_t at, size_t n)
{
    uint64_t value = 0;
    for (size_t i = 0; i < n; i++)
        value = value << 8 | film->bytes[at + i];
    return value;
}

/* Reads an element by the rule of the leading one (RFC 8794, 4 and 5). */
static struct element element_at(const struct encoded *film, size_t at, size_t end)
{
    struct element element = { 0 };
    size_t n = 1;
    while (n <= 4 && !(film->bytes[at] & 0x80 >> (n - 1)))
        n++;
    assert_true(n <= 4 && at + n < end);
    element.id = (uint32_t)number_at(film, at, n);
    at += n;
    n = 1;
    while (n <= 8 && !(film->bytes[at] & 0x80 >> (n - 1)))
        n++;
    assert_true(n <= 8 && at + n <= end);
    element.at = at + n;
    element.end = element.at + (size_t)(number_at(film, at, n) & ~(UINT64_C(1) << 7 * n));
    assert_true(element.end <= end);
    return element;
}

/* The first child with this id from `from` on. */
static struct element child(const struct encoded *film, struct element in, uint32_t id, size_t from)
{
    for (size_t at = from ? from : in.at; at < in.end;) {
        struct element element = element_at(film, at, in.end);
        if (element.id == id)
            return element;
        at = element.end;
    }
    return (struct element){ 0 };
}

static struct element segment_of(const struct encoded *film)
{
    struct element head = element_at(film, 0, film->n_bytes);
    assert_int_equal(head.id, 0x1A45DFA3);
    struct element type = child(film, head, 0x4282, 0);
    assert_memory_equal(film->bytes + type.at, "webm", 4);
    struct element segment = element_at(film, head.end, film->n_bytes);
    assert_int_equal(segment.id, 0x18538067);
    assert_int_equal(segment.end, film->n_bytes);
    return segment;
}

static void cues_lead_to_clusters_that_begin_with_a_key_frame(void **state)
{
    (void)state;
    struct encoded film = made(90);
    struct element segment = segment_of(&film), cues = child(&film, segment, 0x1C53BB6B, 0), point = { 0 };
    size_t n_cues = 0, n_frames = 0;
    assert_true(cues.end > 0);
    while ((point = child(&film, cues, 0xBB, point.end)).end) {
        struct element time = child(&film, point, 0xB3, 0), positions = child(&film, point, 0xB7, 0),
                       at = child(&film, positions, 0xF1, 0);
        struct element cluster =
            element_at(&film, segment.at + (size_t)number_at(&film, at.at, at.end - at.at), segment.end);
        assert_int_equal(cluster.id, 0x1F43B675);
        struct element stamp = child(&film, cluster, 0xE7, 0), block = child(&film, cluster, 0xA3, 0);
        assert_int_equal(number_at(&film, stamp.at, 8), number_at(&film, time.at, 8));
        assert_int_equal(film.bytes[block.at + 3] & 0x80, 0x80);
        n_cues++;
    }
    struct element cluster = { 0 };
    while ((cluster = child(&film, segment, 0x1F43B675, cluster.end)).end) {
        struct element block = { 0 };
        const uint64_t start_ms = number_at(&film, child(&film, cluster, 0xE7, 0).at, 8);
        while ((block = child(&film, cluster, 0xA3, block.end)).end)
            assert_int_equal(start_ms + number_at(&film, block.at + 1, 2), n_frames++ * 1000 / FPS);
        n_cues--;
    }
    assert_int_equal(n_frames, N);
    assert_int_equal(n_cues, 0);
    free(film.bytes);
}

/* ---- colours ---------------------------------------------------------------------------------------------------- */

/* The middle pixel by BT.709-6, 8 bits, from 16 to 235 and 240. */
static void rgb_of(const vpx_image_t *picture, double rgb[3])
{
    const int x = WIDTH / 2, y = HEIGHT / 2;
    const double luma = (picture->planes[0][y * picture->stride[0] + x] - 16) / 219.0,
                 blue = (picture->planes[1][y / 2 * picture->stride[1] + x / 2] - 128) / 224.0,
                 red = (picture->planes[2][y / 2 * picture->stride[2] + x / 2] - 128) / 224.0;
    rgb[0] = luma + 1.5748 * red;
    rgb[2] = luma + 1.8556 * blue;
    rgb[1] = (luma - 0.2126 * rgb[0] - 0.0722 * rgb[2]) / 0.7152;
}

static void colors_come_back(void **state)
{
    (void)state;
    struct encoded film = made(100);
    struct element segment = segment_of(&film), cluster = { 0 };
    vpx_codec_ctx_t codec;
    int n = 0;
    assert_int_equal(vpx_codec_dec_init(&codec, vpx_codec_vp9_dx(), NULL, 0), VPX_CODEC_OK);
    while ((cluster = child(&film, segment, 0x1F43B675, cluster.end)).end) {
        struct element block = { 0 };
        while ((block = child(&film, cluster, 0xA3, block.end)).end) {
            vpx_codec_iter_t at = NULL;
            uint8_t expected[3];
            double rgb[3];
            assert_int_equal(vpx_codec_decode(&codec, film.bytes + block.at + 4, (unsigned)(block.end - block.at - 4),
                                              NULL, 0),
                             VPX_CODEC_OK);
            const vpx_image_t *picture = vpx_codec_get_frame(&codec, &at);
            assert_non_null(picture);
            assert_int_equal(picture->d_w, WIDTH);
            assert_int_equal(picture->cs, VPX_CS_BT_709);
            rgb_of(picture, rgb);
            color_of(n++, expected);
            for (int c = 0; c < 3; c++) /* two steps of 8 bits in each of luma and chroma */
                assert_near(255 * rgb[c], expected[c], 6);
        }
    }
    assert_int_equal(n, N);
    assert_int_equal(vpx_codec_destroy(&codec), VPX_CODEC_OK);
    free(film.bytes);
}

/* ---- refusals --------------------------------------------------------------------------------------------------- */

static void what_no_film_can_be_is_refused(void **state)
{
    (void)state;
    static const struct {
        int width, height, fps, quality;
    } wrong[] = { { 63, 48, 10, 90 }, { 64, 47, 10, 90 }, { 14, 48, 10, 90 }, { 64, 4098, 10, 90 },
                  { 64, 48, 0, 90 },  { 64, 48, 61, 90 }, { 64, 48, 10, 0 },  { 64, 48, 10, 101 } };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        struct error err = { 0 };
        assert_null(video_create(wrong[i].width, wrong[i].height, wrong[i].fps, wrong[i].quality, 0, &err));
        assert_int_equal(err.code, ERROR_RANGE);
    }
    struct error err = { 0 };
    struct encoded film;
    struct video *video = video_create(WIDTH, HEIGHT, FPS, 90, 0, &err);
    struct image *other = image_create(WIDTH, HEIGHT + 2, &err);
    assert_false(video_finish(video, &film, &err));
    assert_int_equal(err.code, ERROR_STATE);
    err = (struct error){ 0 };
    assert_false(video_add(video, other, &err));
    assert_int_equal(err.code, ERROR_RANGE);
    image_destroy(other);
    video_destroy(video);
}

/* ---- films that grow -------------------------------------------------------------------------------------------- */

static struct image *grey(int width_px, int height_px)
{
    struct error err = { 0 };
    struct image *image = image_create(width_px, height_px, &err);
    assert_non_null(image);
    memset(image->rgba, 90, (size_t)width_px * (size_t)height_px * 4);
    return image;
}

static size_t n_frames_of(const struct encoded *film)
{
    struct element segment = segment_of(film), cluster = { 0 };
    size_t n = 0;
    while ((cluster = child(film, segment, 0x1F43B675, cluster.end)).end) {
        struct element block = { 0 };
        while ((block = child(film, cluster, 0xA3, block.end)).end)
            n++;
    }
    return n;
}

static void a_film_has_the_first_pictures_size_and_spare_rows_and_refuses_a_larger_one(void **state)
{
    (void)state;
    struct error err = { 0 };
    struct encoded encoded = { 0 };
    const struct film_options options = { .fps = FPS, .quality = 90, .n_threads = 1, .spare_px = 7 };
    struct film *film = film_create(&options, &err);
    struct image *first = grey(61, 40), *higher = grey(61, 47), *too_high = grey(61, 49), *too_wide = grey(63, 40);
    int size_px[2];
    assert_false(film_finish(film, &encoded, size_px, &err));
    assert_int_equal(err.code, ERROR_STATE);
    assert_true(film_add(film, first, 3, &err));
    assert_true(film_add(film, higher, 1, &err));
    assert_false(film_add(film, too_high, 1, &err));
    assert_int_equal(err.code, ERROR_RANGE);
    assert_false(film_add(film, too_wide, 1, &err));
    assert_int_equal(film_n_pictures(film), 2);
    struct film *other = film_ref(film);
    film_unref(film);
    assert_true(film_finish(other, &encoded, size_px, &err));
    assert_int_equal(size_px[0], 62);
    assert_int_equal(size_px[1], 48); /* 40 and 7, made even */
    assert_int_equal(n_frames_of(&encoded), 4);
    film_unref(other);
    image_destroy(first);
    image_destroy(higher);
    image_destroy(too_high);
    image_destroy(too_wide);
    free(encoded.bytes);
}

static void a_film_larger_than_allowed_is_refused(void **state)
{
    (void)state;
    struct error err = { 0 };
    const struct film_options options = { .fps = FPS, .quality = 100, .n_threads = 1, .max_bytes = 20 };
    struct film *film = film_create(&options, &err);
    struct image *image = grey(64, 48);
    assert_false(film_add(film, image, 1, &err));
    assert_int_equal(err.code, ERROR_LIMIT);
    image_destroy(image);
    film_unref(film);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cues_lead_to_clusters_that_begin_with_a_key_frame),
        cmocka_unit_test(colors_come_back),
        cmocka_unit_test(a_film_has_the_first_pictures_size_and_spare_rows_and_refuses_a_larger_one),
        cmocka_unit_test(a_film_larger_than_allowed_is_refused),
        cmocka_unit_test(what_no_film_can_be_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

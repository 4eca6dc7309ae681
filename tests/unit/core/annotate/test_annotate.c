/* Letters, scale bar and caption: where their pixels are, and that no other pixel of the picture changes. */
#include "core/annotate/annotate.h"

#include <sys/wait.h>
#include <unistd.h>

#include "core/annotate/describe.h"
#include "core/annotate/font.h"
#include "core/annotate/words.h"
#include "core/base/mem.h"
#include "server/wire/json.h"
#include "tests/check.h"
#include "tests/made_plan.h"
#include "tests/unit/oracle.h"

#define DROID "/usr/share/fonts/truetype/droid/DroidSansFallbackFull.ttf"
#define DROID_KOREAN "/usr/share/fonts-droid-fallback/truetype/DroidSansFallback.ttf"

enum { WIDTH = 700, HEIGHT = 500, GREY = 128, TEXT_PX = 12 };

static struct image *grey_image(int width, int height)
{
    struct error err = { 0 };
    struct image *image = image_create(width, height, &err);
    assert_non_null(image);
    for (size_t i = 0; i < 4 * (size_t)width * (size_t)height; i++)
        image->rgba[i] = i % 4 == 3 ? 255 : GREY;
    return image;
}

static struct annotation_item *items(size_t n)
{
    return mem_new(n * sizeof(struct annotation_item));
}

static struct image *annotated(const struct image *image, const struct annotations *annotations)
{
    struct error err = { 0 };
    struct image *out = annotate_image(image, annotations, &err);
    assert_string_equal(err.text, "");
    assert_non_null(out);
    return out;
}

static const uint8_t *pixel(const struct image *image, int x, int y)
{
    return &image->rgba[4 * (y * image->width_px + x)];
}

struct rectangle {
    int left, top, right, bottom; /* right and bottom are outside */
};

static size_t n_changed(const struct image *image, struct rectangle part)
{
    size_t n = 0;
    for (int y = part.top; y < part.bottom; y++)
        for (int x = part.left; x < part.right; x++)
            n += pixel(image, x, y)[0] != GREY || pixel(image, x, y)[1] != GREY || pixel(image, x, y)[2] != GREY;
    return n;
}

/* ---- letters ---------------------------------------------------------------------------------------------------- */

static double nothing(struct vec3 p)
{
    return 0 * p.x;
}

static cJSON *read_fixture(const char *path)
{
    static char text[16384];
    struct problem problem;
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    size_t n = fread(text, 1, sizeof text, file);
    fclose(file);
    cJSON *json = json_read(text, n, &problem);
    assert_non_null(json);
    return json;
}

static struct vec3 vector_of(const cJSON *list)
{
    return vec3(cJSON_GetArrayItem(list, 0)->valuedouble, cJSON_GetArrayItem(list, 1)->valuedouble,
                cJSON_GetArrayItem(list, 2)->valuedouble);
}

static void expect_letters(const struct edge_letters *letters, const cJSON *expected)
{
    const char *const found[4] = { letters->left, letters->right, letters->top, letters->bottom };
    for (int i = 0; i < 4; i++)
        assert_string_equal(found[i], cJSON_GetArrayItem(expected, i)->valuestring);
}

static void letters_are_those_of_the_planes_and_of_oblique_cameras(void **state)
{
    (void)state;
    static const struct {
        const char *word;
        enum scene_kind kind;
    } kinds[] = { { "axial", SCENE_KIND_AXIAL },
                  { "coronal", SCENE_KIND_CORONAL },
                  { "sagittal", SCENE_KIND_SAGITTAL } };
    cJSON *fixture = read_fixture("tests/data/edge_letters.json"), *item;
    int n = 0;
    cJSON_ArrayForEach(item, cJSON_GetObjectItem(fixture, "planes"))
    {
        for (size_t k = 0; k < 3; k++)
            if (strcmp(kinds[k].word, json_text(item, "kind")) == 0) {
                struct plane plane = plane_of_kind(kinds[k].kind, 10);
                struct edge_letters letters = letters_of_edges(plane.right, plane.up);
                expect_letters(&letters, cJSON_GetObjectItem(item, "letters"));
                n++;
            }
    }
    struct grid grid = made_cube_grid(8);
    struct plan *plan = made_plan(&grid, nothing, NULL, 0);
    cJSON_ArrayForEach(item, cJSON_GetObjectItem(fixture, "cameras"))
    {
        const cJSON *given = cJSON_GetObjectItem(item, "camera");
        struct view view = view_default;
        view.camera.has_position_mm = view.camera.has_target_mm = view.camera.has_up = true;
        view.camera.position_mm = vector_of(cJSON_GetArrayItem(given, 0));
        view.camera.target_mm = vector_of(cJSON_GetArrayItem(given, 1));
        view.camera.up = vector_of(cJSON_GetArrayItem(given, 2));
        struct camera camera;
        camera_of_view(plan, &view, NULL, NULL, &camera);
        struct edge_letters letters = letters_of_edges(camera.right, camera.up);
        expect_letters(&letters, cJSON_GetObjectItem(item, "letters"));
        n++;
    }
    assert_int_equal(n, 11);
    plan_destroy(plan);
    cJSON_Delete(fixture);
}

/* Text of 12 px: capitals are 0.73 of that high, and letters at most 1.2 of it wide; the halo adds 2 px. */
static void letters_stand_at_the_middle_of_their_edges_and_change_nothing_else(void **state)
{
    (void)state;
    struct image *image = grey_image(WIDTH, HEIGHT);
    struct annotations annotations = { .letters = { "R", "L", "A", "P" } };
    struct image *out = annotated(image, &annotations);
    assert_int_equal(annotate_text_px(WIDTH), TEXT_PX);
    const int half = 8, reach = 24;
    const struct rectangle edges[4] = {
        { 4, HEIGHT / 2 - half, reach, HEIGHT / 2 + half },
        { WIDTH - reach, HEIGHT / 2 - half, WIDTH - 4, HEIGHT / 2 + half },
        { WIDTH / 2 - 10, 4, WIDTH / 2 + 10, reach },
        { WIDTH / 2 - 10, HEIGHT - reach, WIDTH / 2 + 10, HEIGHT - 4 },
    };
    size_t n_inside = 0;
    for (int i = 0; i < 4; i++) {
        size_t n = n_changed(out, edges[i]);
        assert_in_range(n, 40, 250);
        n_inside += n;
    }
    assert_int_equal(n_changed(out, (struct rectangle){ 0, 0, WIDTH, HEIGHT }), n_inside);

    /* the capitals' own pixels, white, are 9 rows high and centred */
    int first = HEIGHT, last = 0;
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < reach; x++)
            if (pixel(out, x, y)[0] > 200) {
                first = y < first ? y : first;
                last = y > last ? y : last;
            }
    assert_close(last - first + 1, 0.73 * TEXT_PX, 1);
    assert_close((first + last) / 2.0, HEIGHT / 2.0, 1.5);
    image_destroy(out);
    image_destroy(image);
}

static void a_picture_too_small_for_letters_has_none(void **state)
{
    (void)state;
    struct image *image = grey_image(60, 60);
    struct annotations annotations = { .letters = { "R", "L", "A", "P" }, .pixels_per_mm = 1 };
    struct image *out = annotated(image, &annotations);
    assert_int_equal(out->width_px, ANNOTATE_MIN_WIDTH_PX);
    assert_int_equal(n_changed(out, (struct rectangle){ 0, 0, 60, 60 }), 0);
    image_destroy(out);
    image_destroy(image);
}

/* ---- scale bar -------------------------------------------------------------------------------------------------- */

static void the_scale_bar_is_as_long_as_it_says(void **state)
{
    (void)state;
    static const struct {
        int width, height;
        double pixels_per_mm;
    } cases[] = { { 700, 500, 2.345 }, { 700, 500, 0.4 }, { 1400, 900, 7.77 }, { 4096, 300, 31.1 }, { 400, 400, 1 } };
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        struct image *image = grey_image(cases[c].width, cases[c].height);
        struct annotations annotations = { .pixels_per_mm = cases[c].pixels_per_mm };
        struct image *out = annotated(image, &annotations);
        struct scale_bar bar = annotate_scale_bar(cases[c].width, cases[c].height, cases[c].pixels_per_mm);
        assert_true(bar.length_mm > 0);
        int first = cases[c].width, last = 0, row = bar.y_px;
        for (int x = 0; x < bar.x_px + bar.length_px + 2; x++) /* before its words */
            if (pixel(out, x, row)[0] > 250) {
                first = x < first ? x : first;
                last = x;
            }
        assert_close(last - first + 1, bar.length_mm * cases[c].pixels_per_mm, 1);
        assert_true(last < cases[c].width / 2);
        image_destroy(out);
        image_destroy(image);
    }
}

static void perspective_and_extreme_scales_have_no_bar(void **state)
{
    (void)state;
    static const double scales[] = { 0, 1e-5, 1e6 };
    struct image *image = grey_image(WIDTH, HEIGHT);
    for (int i = 0; i < 3; i++) {
        struct annotations annotations = { .pixels_per_mm = scales[i] };
        struct image *out = annotated(image, &annotations);
        assert_int_equal(n_changed(out, (struct rectangle){ 0, HEIGHT - 40, WIDTH / 3, HEIGHT }), 0);
        image_destroy(out);
    }
    image_destroy(image);
}

/* ---- caption ---------------------------------------------------------------------------------------------------- */

static void a_caption_is_below_the_picture_with_a_chip_of_each_colour(void **state)
{
    (void)state;
    struct image *image = grey_image(WIDTH, HEIGHT);
    struct annotations annotations = { .items = items(3), .n_items = 3 };
    for (int i = 0; i < 3; i++) {
        annotations.items[i] = (struct annotation_item){ ANNOTATION_REGIONS, true, { 0, 0, 0 }, "Region" };
        annotations.items[i].rgb[i] = 200;
    }
    struct image *out = annotated(image, &annotations);
    assert_int_equal(out->width_px, WIDTH);
    assert_in_range(out->height_px - HEIGHT, TEXT_PX, 4 * TEXT_PX);
    assert_int_equal(n_changed(out, (struct rectangle){ 0, 0, WIDTH, HEIGHT }), 0);
    /* chips: squares of 9 px with an edge of 1 px, one line, left to right */
    double at[3] = { 0 };
    for (int channel = 0; channel < 3; channel++) {
        size_t n = 0;
        for (int y = HEIGHT; y < out->height_px; y++)
            for (int x = 0; x < WIDTH; x++) {
                const uint8_t *p = pixel(out, x, y);
                bool is_chip = p[channel] == 200 && p[(channel + 1) % 3] == 0 && p[(channel + 2) % 3] == 0;
                n += is_chip;
                at[channel] += is_chip ? x : 0;
            }
        assert_int_equal(n, 7 * 7);
        at[channel] /= (double)n;
    }
    assert_true(at[0] < at[1] && at[1] < at[2]);
    assert_close(at[1] - at[0], at[2] - at[1], 1);
    image_destroy(out);
    image_destroy(image);
    annotations_finish(&annotations);
}

static void more_regions_than_fit_are_counted_and_the_caption_stays_bounded(void **state)
{
    (void)state;
    struct image *image = grey_image(100, 80);
    struct annotations annotations = { .items = items(1024), .n_items = 1024 };
    for (size_t i = 0; i < 1024; i++) {
        annotations.items[i] = (struct annotation_item){ ANNOTATION_REGIONS, true, { 1, 2, 3 }, "" };
        snprintf(annotations.items[i].text, ANNOTATION_TEXT_SIZE, "Region number %zu of many with a long name", i);
    }
    struct image *out = annotated(image, &annotations);
    assert_in_range(out->height_px - 80, ANNOTATE_MAX_LINES * TEXT_PX, ANNOTATE_MAX_LINES * 2 * TEXT_PX);
    image_destroy(out);
    image_destroy(image);
    annotations_finish(&annotations);
}

/* ---- text ------------------------------------------------------------------------------------------------------- */

static struct font_line lay_out(struct font *font, const char *text, int width)
{
    struct error err = { 0 };
    struct font_line line;
    assert_true(font_lay_out(font, text, width, &line, &err));
    return line;
}

static void a_long_name_gives_way_in_the_middle(void **state)
{
    (void)state;
    struct error err = { 0 };
    struct font *font = font_create(12, &err);
    struct font_line whole = lay_out(font, "Planning target volume 1, left frontal", 10000),
                     cut = lay_out(font, "Planning target volume 1, left frontal", 100);
    assert_int_equal(whole.n, 38);
    assert_true(cut.width_px <= 100 && cut.width_px > 80);
    assert_int_equal(cut.characters[0], 'P');
    assert_int_equal(cut.characters[cut.n - 1], 'l');
    int n_ellipses = 0, sum_px = 0;
    for (int i = 0; i < cut.n; i++) {
        n_ellipses += cut.characters[i] == 0x2026;
        sum_px += cut.advance_px[i];
    }
    assert_int_equal(n_ellipses, 1);
    assert_int_equal(sum_px, cut.width_px);
    /* no room at all: the ellipsis alone */
    assert_int_equal(lay_out(font, "abc", 1).n, 1);
    assert_int_equal(lay_out(font, "", 100).n, 0);
    font_destroy(font);
}

/* In a process of its own, as the fallback font is opened once: 腫 with the given font is drawn as its number. */
static void expect_number(const char *fallback)
{
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        struct error err = { 0 };
        (void)setenv("BEAMROOM_FALLBACK_FONT", fallback, 1);
        struct font *font = font_create(12, &err);
        struct font_line line, expected;
        bool is_number = font && font_lay_out(font, "GTV 腫", 10000, &line, &err) &&
                         font_lay_out(font, "GTV <U+816B>", 10000, &expected, &err) && line.n == expected.n &&
                         memcmp(line.characters, expected.characters, (size_t)line.n * sizeof line.characters[0]) == 0;
        font_destroy(font);
        _exit(is_number ? 0 : 1);
    }
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_int_equal(status, 0);
}

static void letters_that_no_font_has_are_drawn_as_numbers(void **state)
{
    (void)state;
    expect_number("/nonexistent.ttf");
    expect_number("/");
    expect_number("/dev/zero");
    expect_number("tests/data/edge_letters.json");
    /* a font with damaged tables, and cut off */
    FILE *font = fopen(DROID, "rb");
    if (!font)
        return;
    static char bytes[400000];
    size_t n = fread(bytes, 1, sizeof bytes, font);
    fclose(font);
    char path[] = "/tmp/beamroom-font-XXXXXX";
    int file = mkstemp(path);
    assert_true(file >= 0);
    for (size_t i = 64; i < 4096; i += 7)
        bytes[i] = (char)(bytes[i] ^ 0x55);
    assert_int_equal(write(file, bytes, n), n);
    close(file);
    expect_number(path);
    (void)unlink(path);
}

static void letters_of_chinese_japanese_and_korean_are_drawn_as_freetype_draws_them(void **state)
{
    (void)state;
    enum { GLYPHS_WIDTH = 140, GLYPHS_HEIGHT = 24, SIZE = 16, BASELINE = 18 };
    static const char text[] = "腫瘍肿瘤종양";
    static char answer[2 * GLYPHS_WIDTH * GLYPHS_HEIGHT + 64];
    char *arguments[] = { oracle_python(),
                          "tests/oracle/font_glyphs.py",
                          DROID ":" DROID_KOREAN,
                          "16",
                          (char *)(uintptr_t)text,
                          "140",
                          "24",
                          "2",
                          "18",
                          NULL };
    int status = oracle_run(arguments, answer, sizeof answer);
    if (status == ORACLE_MISSING)
        skip();
    assert_int_equal(status, 0);
    struct error err = { 0 };
    struct font *font = font_create(SIZE, &err);
    struct font_line line = lay_out(font, text, 10000);
    static uint8_t pixels[GLYPHS_WIDTH * GLYPHS_HEIGHT];
    struct coverage coverage = { pixels, GLYPHS_WIDTH, GLYPHS_HEIGHT };
    assert_int_equal(line.n, 6);
    assert_true(font_draw(font, &line, 2, BASELINE, &coverage, &err));
    int n_inked = 0;
    for (int i = 0; i < GLYPHS_WIDTH * GLYPHS_HEIGHT; i++) {
        char hex[3];
        (void)snprintf(hex, sizeof hex, "%02x", (unsigned)pixels[i]);
        assert_memory_equal(hex, answer + 2 * i, 2);
        n_inked += pixels[i] > 128;
    }
    assert_true(n_inked > 6 * 30);
    font_destroy(font);
}

static void characters_that_do_not_show_are_drawn_as_the_page_shows_them(void **state)
{
    (void)state;
    struct error err = { 0 };
    struct font *font = font_create(12, &err);
    cJSON *fixture = read_fixture("tests/data/invisible_characters.json");
    const cJSON *pair;
    int n = 0;
    cJSON_ArrayForEach(pair, cJSON_GetObjectItem(fixture, "cases"))
    {
        struct font_line line = lay_out(font, cJSON_GetArrayItem(pair, 0)->valuestring, 10000),
                         expected = lay_out(font, cJSON_GetArrayItem(pair, 1)->valuestring, 10000);
        assert_int_equal(line.n, expected.n);
        assert_memory_equal(line.characters, expected.characters, (size_t)line.n * sizeof line.characters[0]);
        n++;
    }
    assert_int_equal(n, 35);
    struct font_line line = lay_out(font, "\xe2\x80\xae", 10000);
    const uint32_t tag[] = { 0xab, 'R', 'L', 'O', 0xbb };
    assert_int_equal(line.n, 5);
    assert_memory_equal(line.characters, tag, sizeof tag);
    cJSON_Delete(fixture);
    font_destroy(font);
}

static void units_are_the_words_of_the_page(void **state)
{
    (void)state;
    cJSON *fixture = read_fixture("tests/data/unit_words.json");
    const cJSON *pair;
    int n = 0;
    cJSON_ArrayForEach(pair, cJSON_GetObjectItem(fixture, "cases"))
    {
        char quoted[WORDS_UNIT_SIZE];
        const char *unit = cJSON_GetArrayItem(pair, 0)->valuestring;
        assert_string_equal(words_unit(unit, quoted), cJSON_GetArrayItem(pair, 1)->valuestring);
        n++;
    }
    assert_int_equal(n, 30);
    cJSON_Delete(fixture);
}

static void hostile_text_is_drawn_as_replacements(void **state)
{
    (void)state;
    struct error err = { 0 };
    struct font *font = font_create(12, &err);
    /* two controls, an overlong slash, a lone continuation, a surrogate, a cut character */
    struct font_line line = lay_out(font, "\x01\x7f\xc0\xaf\x80\xed\xa0\x80\xe2\x82", 10000);
    assert_true(line.n >= 7);
    for (int i = 0; i < line.n; i++)
        assert_int_equal(line.characters[i], 0xfffd);
    struct font_line word =
        lay_out(font, "\xc3\x84\xce\xb2\xd0\x96\xf0\x9f\x98\x80", 10000); /* A umlaut, beta, Zhe, a smiley */
    assert_int_equal(word.n, 4);
    assert_int_equal(word.characters[0], 0xc4);
    assert_int_equal(word.characters[3], 0x1f600);

    static char huge[10240];
    for (size_t i = 0; i + 1 < sizeof huge; i++)
        huge[i] = (char)(i * 37 % 255 + 1);
    assert_true(lay_out(font, huge, 500).width_px <= 500);
    memset(huge, 'i', sizeof huge - 1);
    struct font_line cut = lay_out(font, huge, 1000000);
    assert_int_equal(cut.n, FONT_MAX_CHARACTERS);
    assert_int_equal(cut.characters[FONT_MAX_CHARACTERS / 2], 0x2026);
    font_destroy(font);

    struct image *image = grey_image(WIDTH, HEIGHT);
    struct annotations annotations = { .items = items(1), .n_items = 1 };
    annotations.items[0] = (struct annotation_item){ .row = ANNOTATION_TITLE };
    memset(annotations.items[0].text, '\n', ANNOTATION_TEXT_SIZE - 1);
    image_destroy(annotated(image, &annotations));
    image_destroy(image);
    annotations_finish(&annotations);
}

static void a_mark_is_amber_at_the_top_left_and_changes_nothing_else(void **state)
{
    (void)state;
    struct error err = { 0 };
    struct image *image = grey_image(WIDTH, HEIGHT);
    assert_true(annotate_mark(image, "Draft beam", &err));
    const struct rectangle corner = { 0, 0, 150, 40 }, all = { 0, 0, WIDTH, HEIGHT };
    size_t n_amber = 0;
    for (int y = corner.top; y < corner.bottom; y++)
        for (int x = corner.left; x < corner.right; x++)
            n_amber += pixel(image, x, y)[0] > 240 && pixel(image, x, y)[2] < 100;
    assert_true(n_amber > 100); /* ten letters of 18 px, a stroke of 1.5 px and more each */
    assert_int_equal(n_changed(image, all), n_changed(image, corner));
    image_destroy(image);
    image = grey_image(20, 10); /* as small as a picture can be */
    assert_true(annotate_mark(image, "Draft beam", &err));
    image_destroy(image);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(letters_that_no_font_has_are_drawn_as_numbers),
        cmocka_unit_test(letters_of_chinese_japanese_and_korean_are_drawn_as_freetype_draws_them),
        cmocka_unit_test(a_mark_is_amber_at_the_top_left_and_changes_nothing_else),
        cmocka_unit_test(letters_are_those_of_the_planes_and_of_oblique_cameras),
        cmocka_unit_test(letters_stand_at_the_middle_of_their_edges_and_change_nothing_else),
        cmocka_unit_test(a_picture_too_small_for_letters_has_none),
        cmocka_unit_test(the_scale_bar_is_as_long_as_it_says),
        cmocka_unit_test(perspective_and_extreme_scales_have_no_bar),
        cmocka_unit_test(a_caption_is_below_the_picture_with_a_chip_of_each_colour),
        cmocka_unit_test(more_regions_than_fit_are_counted_and_the_caption_stays_bounded),
        cmocka_unit_test(a_long_name_gives_way_in_the_middle),
        cmocka_unit_test(characters_that_do_not_show_are_drawn_as_the_page_shows_them),
        cmocka_unit_test(units_are_the_words_of_the_page),
        cmocka_unit_test(hostile_text_is_drawn_as_replacements),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

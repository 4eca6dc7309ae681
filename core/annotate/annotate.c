/* Letters, scale bar and caption as pixels. */
#include "core/annotate/annotate.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/annotate/font.h"
#include "core/annotate/label_places.h"
#include "core/base/mem.h"
#include "core/render/visible/paint.h"

#define LINE_PX 1.5
enum { MIN_TEXT_PX = 12, MAX_TEXT_PX = 24, COLUMNS = 70, HALO_PX = 2 };
static const uint8_t ink[3] = { 255, 255, 255 }, halo[3] = { 0, 0, 0 }, print[3] = { 24, 28, 33 },
                     print_pale[3] = { 92, 99, 106 }, chip_edge[3] = { 120, 126, 133 }, amber[3] = { 255, 191, 71 };

struct annotation_item *annotation_add(struct annotations *annotations, enum annotation_row row)
{
    struct annotation_item *item = &annotations->items[annotations->n_items++];
    item->row = row;
    return item;
}

/* Bytes of the first clause: up to and with its ':', '.' or ',' before a space. */
static size_t first_clause(const char *text)
{
    for (size_t i = 0; text[i]; i++)
        if (strchr(":.,", text[i]) && text[i + 1] == ' ')
            return i + 1;
    return strlen(text);
}

void annotation_add_sentence(struct annotations *annotations, enum annotation_row row, const char *sentence)
{
    for (int i = 1; *sentence; i++) {
        size_t n = i < ANNOTATION_MAX_CLAUSES ? first_clause(sentence) : strlen(sentence);
        struct annotation_item *item = annotation_add(annotations, row);
        (void)snprintf(item->text, sizeof item->text, "%.*s", (int)n, sentence);
        sentence += n + (sentence[n] == ' ');
    }
}

void annotations_finish(struct annotations *annotations)
{
    free(annotations->items);
    free(annotations->lines);
    free(annotations->labels);
    *annotations = (struct annotations){ .n_items = 0 };
}

int annotate_text_px(int width_px)
{
    int size = (width_px + COLUMNS / 2) / COLUMNS;
    return size < MIN_TEXT_PX ? MIN_TEXT_PX : size > MAX_TEXT_PX ? MAX_TEXT_PX : size;
}

/* ---- on the picture --------------------------------------------------------------------------------------------- */

static void blend(uint8_t *pixel, const uint8_t rgb[3], int coverage)
{
    for (int channel = 0; channel < 3; channel++)
        pixel[channel] = (uint8_t)((pixel[channel] * (255 - coverage) + rgb[channel] * coverage + 127) / 255);
}

/* The part of an image that shows the picture: its top left. */
struct canvas {
    struct image *image;
    int width_px, height_px;
    const uint8_t *ink, *halo; /* of words and lines, and of their rims */
};

/* Paints the coverage, whose top left is at (left, top), with a rim of HALO_PX around it. */
static void paint_with_halo(const struct canvas *canvas, const struct coverage *coverage, int left, int top)
{
    int width = coverage->width_px, height = coverage->height_px;
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            int px = left + x, py = top + y, around = 0;
            if (px < 0 || py < 0 || px >= canvas->width_px || py >= canvas->height_px)
                continue;
            for (int dy = -HALO_PX; dy <= HALO_PX; dy++)
                for (int dx = -HALO_PX; dx <= HALO_PX; dx++) {
                    if (x + dx < 0 || y + dy < 0 || x + dx >= width || y + dy >= height ||
                        dx * dx + dy * dy > HALO_PX * HALO_PX + 1)
                        continue;
                    int there = coverage->pixels[(size_t)(y + dy) * (size_t)width + (size_t)(x + dx)];
                    around = there > around ? there : around;
                }
            uint8_t *pixel = &canvas->image->rgba[4 * ((size_t)py * (size_t)canvas->image->width_px + (size_t)px)];
            blend(pixel, canvas->halo, around * 3 / 4);
            blend(pixel, canvas->ink, coverage->pixels[(size_t)y * (size_t)width + (size_t)x]);
        }
}

static bool coverage_create(struct coverage *coverage, int width_px, int height_px, struct error *err)
{
    coverage->width_px = width_px;
    coverage->height_px = height_px;
    coverage->pixels = mem_array((size_t)width_px * (size_t)height_px, 1, UINT64_MAX, err);
    return coverage->pixels != NULL;
}

/* The words of a line: they begin at left, and the middle of their capitals is at y. */
static bool paint_line_of_text(const struct canvas *canvas, struct font *font, const struct font_line *line, int left,
                               int y, struct error *err)
{
    struct coverage coverage = { 0 };
    int top = y - font_size_px(font) / 2 - HALO_PX,
        baseline = y + (font_size_px(font) * 73 / 100 + 1) / 2; /* capitals are 0.73 of the font's size high */
    bool is_drawn =
        coverage_create(&coverage, line->width_px + 2 * HALO_PX, font_size_px(font) * 4 / 3 + 2 * HALO_PX, err) &&
        font_draw(font, line, HALO_PX, baseline - top, &coverage, err);
    if (is_drawn)
        paint_with_halo(canvas, &coverage, left - HALO_PX, top);
    free(coverage.pixels);
    return is_drawn;
}

/* A word on the picture: x + align * width / 2 is its middle, and the middle of its capitals is at y. */
static bool paint_word(const struct canvas *canvas, struct font *font, const char *word, int x, int align, int y,
                       struct error *err)
{
    struct font_line line;
    return font_lay_out(font, word, canvas->width_px, &line, err) &&
           paint_line_of_text(canvas, font, &line, x + (align - 1) * line.width_px / 2, y, err);
}

static bool paint_letters(const struct canvas *canvas, struct font *font, const struct edge_letters *letters,
                          struct error *err)
{
    int text = font_size_px(font), width = canvas->width_px, height = canvas->height_px;
    if (width < 6 * text || height < 6 * text)
        return true; /* they would cover the picture */
    int margin = text / 2 + HALO_PX;
    return paint_word(canvas, font, letters->left, margin, 1, height / 2, err) &&
           paint_word(canvas, font, letters->right, width - margin, -1, height / 2, err) &&
           paint_word(canvas, font, letters->top, width / 2, 0, text, err) &&
           paint_word(canvas, font, letters->bottom, width / 2, 0, height - text, err);
}

struct scale_bar annotate_scale_bar(int width_px, int height_px, double pixels_per_mm)
{
    static const double lengths_mm[] = { 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000 };
    int text = annotate_text_px(width_px);
    struct scale_bar bar = { .x_px = text, .y_px = height_px - text };
    /* the bar and its words, of up to seven characters, end before the letter in the middle */
    double longest_px = fmin(9.0 * text, width_px / 2.0 - 7.0 * text);
    if (height_px < 6 * text)
        return bar;
    for (size_t i = 0; i < sizeof lengths_mm / sizeof *lengths_mm; i++)
        if (lengths_mm[i] * pixels_per_mm <= longest_px && lengths_mm[i] * pixels_per_mm >= text / 2.0) {
            bar.length_mm = lengths_mm[i];
            bar.length_px = (int)lround(lengths_mm[i] * pixels_per_mm);
        }
    return bar;
}

static bool paint_scale_bar(const struct canvas *canvas, struct font *font, double pixels_per_mm, struct error *err)
{
    struct scale_bar bar = annotate_scale_bar(canvas->width_px, canvas->height_px, pixels_per_mm);
    if (!(bar.length_mm > 0))
        return true;
    struct coverage coverage = { 0 };
    int tick = font_size_px(font) / 3, thick = font_size_px(font) >= 18 ? 3 : 2;
    if (!coverage_create(&coverage, bar.length_px + 2 * HALO_PX, 2 * tick + thick + 2 * HALO_PX, err))
        return false;
    for (int y = 0; y < 2 * tick + thick; y++)
        for (int x = 0; x < bar.length_px; x++)
            if ((y >= tick && y < tick + thick) || x < thick || x >= bar.length_px - thick)
                coverage.pixels[(y + HALO_PX) * coverage.width_px + x + HALO_PX] = 255;
    paint_with_halo(canvas, &coverage, bar.x_px - HALO_PX, bar.y_px - tick - HALO_PX);
    free(coverage.pixels);
    char words[32];
    (void)snprintf(words, sizeof words, "%g mm", bar.length_mm);
    return paint_word(canvas, font, words, bar.x_px + bar.length_px + font_size_px(font) / 2, 1, bar.y_px + thick / 2,
                      err);
}

/* ---- the caption ------------------------------------------------------------------------------------------------ */

/* The place where the next item of a caption goes. */
struct caption {
    struct font *fonts[2]; /* of the text, of the title */
    int margin_px, width_px;
    struct coverage *ink, *pale; /* NULL: it is only measured */
    struct image *image;         /* takes the chips */
    int image_top_px;
    int x_px, y_px; /* y: the top of the line */
};

static int line_height_px(struct font *font)
{
    return font_ascent_px(font) + font_descent_px(font) + font_size_px(font) / 4;
}

static void paint_chip(struct caption *caption, const uint8_t rgb[3], int side)
{
    struct image *image = caption->image;
    int top = caption->image_top_px + caption->y_px + font_ascent_px(caption->fonts[0]) - side;
    for (int y = top; y < top + side && y < image->height_px; y++)
        for (int x = caption->x_px; x < caption->x_px + side; x++) {
            bool is_edge = x == caption->x_px || y == top || x == caption->x_px + side - 1 || y == top + side - 1;
            memcpy(&image->rgba[4 * ((size_t)y * (size_t)image->width_px + (size_t)x)], is_edge ? chip_edge : rgb, 3);
        }
}

static bool put_text(struct caption *caption, struct font *font, const struct font_line *line, bool is_pale,
                     struct error *err)
{
    struct coverage *coverage = is_pale ? caption->pale : caption->ink;
    return !coverage || font_draw(font, line, caption->x_px, caption->y_px + font_ascent_px(font), coverage, err);
}

/* One row: items[0..n), of n_lines lines at most. */
static bool put_row(struct caption *caption, const struct annotation_item *items, size_t n, struct error *err)
{
    struct font *font = caption->fonts[items[0].row == ANNOTATION_TITLE];
    bool is_pale = items[0].row == ANNOTATION_ORIGIN || items[0].row == ANNOTATION_USE;
    int gap = font_size_px(font), chip = font_size_px(font) * 3 / 4, n_lines = 1,
        right = caption->width_px - caption->margin_px, room = right - caption->margin_px;
    caption->x_px = caption->margin_px;
    for (size_t i = 0; i < n; i++) {
        struct font_line line, more;
        char words[40];
        int before = items[i].has_chip ? chip + gap / 3 : 0;
        bool is_last = i + 1 == n;
        (void)snprintf(words, sizeof words, "and %zu more", n - i);
        if (!font_lay_out(font, items[i].text, room - before, &line, err) ||
            !font_lay_out(font, words, room, &more, err))
            return false;
        /* on the last line there must be room for "and n more", unless it is the last item */
        int behind = n_lines == ANNOTATE_MAX_LINES && !is_last ? gap + more.width_px : 0;
        if (caption->x_px > caption->margin_px && caption->x_px + before + line.width_px + behind > right) {
            if (n_lines == ANNOTATE_MAX_LINES)
                return put_text(caption, font, &more, is_pale, err);
            n_lines++;
            caption->x_px = caption->margin_px;
            caption->y_px += line_height_px(font);
        }
        if (items[i].has_chip && caption->image)
            paint_chip(caption, items[i].rgb, chip);
        caption->x_px += before;
        if (!put_text(caption, font, &line, is_pale, err))
            return false;
        caption->x_px += line.width_px + gap;
    }
    return true;
}

static bool put_caption(struct caption *caption, const struct annotations *annotations, struct error *err)
{
    caption->y_px = caption->margin_px;
    for (size_t i = 0, end; i < annotations->n_items; i = end) {
        const struct annotation_item *item = &annotations->items[i];
        for (end = i + 1; end < annotations->n_items && annotations->items[end].row == item->row;)
            end++;
        if (!put_row(caption, item, end - i, err))
            return false;
        caption->y_px += line_height_px(caption->fonts[item->row == ANNOTATION_TITLE]);
    }
    caption->y_px += caption->margin_px;
    return true;
}

static void paint_plain(struct image *image, const struct coverage *coverage, int top, const uint8_t rgb[3])
{
    for (int y = 0; y < coverage->height_px; y++)
        for (int x = 0; x < coverage->width_px; x++) {
            int there = coverage->pixels[(size_t)y * (size_t)coverage->width_px + (size_t)x];
            if (there)
                blend(&image->rgba[4 * ((size_t)(top + y) * (size_t)image->width_px + (size_t)x)], rgb, there);
        }
}

static bool paint_caption(struct caption *caption, const struct annotations *annotations, int height_px,
                          struct image *image, int top, struct error *err)
{
    struct coverage dark = { 0 }, pale = { 0 };
    bool is_done = coverage_create(&dark, image->width_px, height_px, err) &&
                   coverage_create(&pale, image->width_px, height_px, err);
    caption->ink = &dark;
    caption->pale = &pale;
    caption->image = image;
    caption->image_top_px = top;
    is_done = is_done && put_caption(caption, annotations, err);
    if (is_done) {
        paint_plain(image, &dark, top, print);
        paint_plain(image, &pale, top, print_pale);
    }
    free(dark.pixels);
    free(pale.pixels);
    return is_done;
}

/* A white picture with this one at its top left. */
static struct image *copy_onto_white(const struct image *image, int width_px, int height_px, struct error *err)
{
    struct image *copy = image_create(width_px, height_px, err);
    if (!copy)
        return NULL;
    memset(copy->rgba, 255, (size_t)width_px * (size_t)height_px * 4);
    for (int y = 0; y < image->height_px; y++)
        memcpy(copy->rgba + 4 * (size_t)y * (size_t)width_px, image->rgba + 4 * (size_t)y * (size_t)image->width_px,
               4 * (size_t)image->width_px);
    return copy;
}

/* A line's part within the picture, in pixels; false: none of it. Source: Y.-D. Liang, B. A. Barsky, A New Concept and
 * Method for Line Clipping, ACM TOG 1984. */
static bool clip_line(const struct annotation_line *line, const struct canvas *canvas, struct paint_point *from,
                      struct paint_point *to)
{
    const double size[2] = { canvas->width_px, canvas->height_px };
    double a[2], along[2], first = 0, last = 1;
    for (int i = 0; i < 2; i++) {
        a[i] = line->from[i] * size[i];
        along[i] = line->to[i] * size[i] - a[i];
        for (int side = 0; side < 2; side++) {
            double speed = side ? along[i] : -along[i], room = side ? size[i] - a[i] : a[i];
            if (speed > 0)
                last = fmin(last, room / speed);
            else if (speed < 0)
                first = fmax(first, room / speed);
            else if (!(room >= 0)) /* NaN too */
                return false;
        }
    }
    *from = (struct paint_point){ a[0] + first * along[0], a[1] + first * along[1] };
    *to = (struct paint_point){ a[0] + last * along[0], a[1] + last * along[1] };
    return first <= last;
}

/* Onto a copy of the picture's part of the canvas, so that nothing is painted beside it. */
static bool paint_lines(const struct canvas *canvas, const struct annotations *annotations, struct error *err)
{
    if (annotations->n_lines == 0)
        return true;
    size_t row = 4 * (size_t)canvas->width_px, stride = 4 * (size_t)canvas->image->width_px;
    struct image *copy = image_create(canvas->width_px, canvas->height_px, err);
    struct paint *paint = copy ? paint_create(copy, err) : NULL;
    for (size_t y = 0; paint && y < (size_t)canvas->height_px; y++)
        memcpy(copy->rgba + y * row, canvas->image->rgba + y * stride, row);
    for (int layer = 0; paint && layer < 2; layer++)
        for (size_t i = 0; i < annotations->n_lines; i++) {
            struct paint_point from, to;
            if (clip_line(&annotations->lines[i], canvas, &from, &to))
                paint_line(paint, from, to, layer == 0 ? LINE_PX + 2 : LINE_PX);
            bool is_last = i + 1 == annotations->n_lines || annotations->lines[i + 1].rgb != annotations->lines[i].rgb;
            if (is_last)
                paint_flush(paint, layer == 0 ? 0x000000 : annotations->lines[i].rgb, layer == 0 ? 0.6 : 1);
        }
    for (size_t y = 0; paint && y < (size_t)canvas->height_px; y++)
        memcpy(canvas->image->rgba + y * stride, copy->rgba + y * row, row);
    bool is_done = paint != NULL;
    paint_destroy(paint);
    image_destroy(copy);
    return is_done;
}

enum { NARROW_EM = 12, LETTERS = 4 }; /* longer words give way in the middle where there is no free place for them */
static const uint32_t joint_rgb = 0xffd84d;

/* The boxes of the letters at the edges and of the scale bar. */
static void take_fixed(const struct canvas *canvas, struct font *font, const struct annotations *annotations,
                       struct label_placing *placing)
{
    const int side = 2 * font_size_px(font), width = canvas->width_px, height = canvas->height_px;
    const struct scale_bar bar = annotate_scale_bar(width, height, annotations->pixels_per_mm);
    const struct label_box boxes[LETTERS + 1] = { { 0, (height - side) / 2, side, side },
                                                  { width - side, (height - side) / 2, side, side },
                                                  { (width - side) / 2, 0, side, side },
                                                  { (width - side) / 2, height - side, side, side },
                                                  { 0, height - side, bar.x_px + bar.length_px + 3 * side, side } };
    placing->n_fixed = annotations->pixels_per_mm > 0 ? LETTERS + 1 : LETTERS;
    memcpy(placing->taken, boxes, placing->n_fixed * sizeof boxes[0]);
    placing->n_taken = placing->n_fixed;
}

/* Painting labels: what has its place, and the lines from words to their points. */
struct labelling {
    const struct canvas *canvas;
    struct font *font;
    struct label_placing placing;
    struct annotations joints; /* lines alone */
    struct label_box *boxes;   /* [n_labels]; width 0: it is not in the picture */
};

/* Letters of axes and numbers of a ruler stay where they are. */
static bool place_centred(struct labelling *labelling, const struct annotation_label *label, int x, int y,
                          struct label_box *box, struct error *err)
{
    struct font_line line;
    const int size = font_size_px(labelling->font);
    if (!font_lay_out(labelling->font, label->text, labelling->canvas->width_px, &line, err))
        return false;
    *box = (struct label_box){ x - line.width_px / 2 - labelling->placing.rim_px, y - labelling->placing.above_px,
                               line.width_px + 2 * labelling->placing.rim_px, size * 4 / 3 + 2 * HALO_PX };
    labelling->placing.taken[labelling->placing.n_taken++] = *box;
    return true;
}

static bool place_beside(struct labelling *labelling, const struct annotation_label *label, int x, int y,
                         struct label_box *box, struct error *err)
{
    struct font_line line;
    const int size = font_size_px(labelling->font), most[2] = { labelling->canvas->width_px, NARROW_EM * size };
    bool is_found = false;
    for (int i = 0; !is_found && i < 2; i++) {
        if (!font_lay_out(labelling->font, label->text, most[i], &line, err))
            return false;
        *box = (struct label_box){ .width = line.width_px + 2 * labelling->placing.rim_px,
                                   .height = size * 4 / 3 + 2 * HALO_PX };
        is_found = label_place(&labelling->placing, x, y, box);
    }
    struct annotation_line joint = { .rgb = joint_rgb };
    int end[2];
    if (is_found && label_is_far(&labelling->placing, x, y, box, end)) {
        joint.from[0] = (double)x / labelling->canvas->width_px;
        joint.from[1] = (double)y / labelling->canvas->height_px;
        joint.to[0] = (double)end[0] / labelling->canvas->width_px;
        joint.to[1] = (double)end[1] / labelling->canvas->height_px;
        labelling->joints.lines[labelling->joints.n_lines++] = joint;
    }
    return true;
}

/* Those that stay come first, so that the others keep away from them. */
static bool place_labels(struct labelling *labelling, const struct annotations *annotations, struct error *err)
{
    const struct canvas *canvas = labelling->canvas;
    for (int pass = 0; pass < 2; pass++)
        for (size_t i = 0; i < annotations->n_labels; i++) {
            const struct annotation_label *label = &annotations->labels[i];
            const double x = label->at[0] * canvas->width_px, y = label->at[1] * canvas->height_px;
            if (label->is_centred != (pass == 0) ||
                !(x >= 0 && x <= canvas->width_px && y >= 0 && y <= canvas->height_px))
                continue;
            if (!(pass == 0 ? place_centred : place_beside)(labelling, label, (int)x, (int)y, &labelling->boxes[i],
                                                            err))
                return false;
        }
    return true;
}

static bool paint_placed(const struct labelling *labelling, const struct annotations *annotations, struct error *err)
{
    for (size_t i = 0; i < annotations->n_labels; i++) {
        const struct label_box *box = &labelling->boxes[i];
        struct font_line line;
        if (box->width > 0 &&
            (!font_lay_out(labelling->font, annotations->labels[i].text, box->width - 2 * labelling->placing.rim_px,
                           &line, err) ||
             !paint_line_of_text(labelling->canvas, labelling->font, &line, box->left + labelling->placing.rim_px,
                                 box->top + labelling->placing.above_px, err)))
            return false;
    }
    return true;
}

/* Labels laid apart: words that would cover others stand at another corner of their point, or where there is room, with
 * a line to it. */
static bool paint_labels(const struct canvas *canvas, struct font *font, const struct annotations *annotations,
                         struct error *err)
{
    const size_t n = annotations->n_labels;
    const int size = font_size_px(font);
    struct labelling labelling = { .canvas = canvas,
                                   .font = font,
                                   .placing = { .width_px = canvas->width_px,
                                                .height_px = canvas->height_px,
                                                .aside_px = size * 2 / 3,
                                                .rim_px = HALO_PX + size / 4,
                                                .above_px = size / 2 + HALO_PX,
                                                .step_px = size } };
    if (!n)
        return true;
    labelling.boxes = mem_array(n, sizeof *labelling.boxes, UINT64_MAX, err);
    labelling.placing.taken =
        labelling.boxes ? mem_array(n + LETTERS + 1, sizeof *labelling.boxes, UINT64_MAX, err) : NULL;
    labelling.joints.lines =
        labelling.placing.taken ? mem_array(n, sizeof *labelling.joints.lines, UINT64_MAX, err) : NULL;
    bool is_done = labelling.joints.lines != NULL;
    if (is_done) {
        take_fixed(canvas, font, annotations, &labelling.placing);
        is_done = place_labels(&labelling, annotations, err) && paint_lines(canvas, &labelling.joints, err) &&
                  paint_placed(&labelling, annotations, err);
    }
    free(labelling.boxes);
    free(labelling.placing.taken);
    free(labelling.joints.lines);
    return is_done;
}

static bool paint_on_picture(const struct canvas *canvas, struct font *font, const struct annotations *annotations,
                             struct error *err)
{
    return paint_lines(canvas, annotations, err) && paint_labels(canvas, font, annotations, err) &&
           paint_letters(canvas, font, &annotations->letters, err) &&
           (!(annotations->pixels_per_mm > 0) || paint_scale_bar(canvas, font, annotations->pixels_per_mm, err));
}

struct image *annotate_image(const struct image *image, const struct annotations *annotations, struct error *err)
{
    int text_px = annotate_text_px(image->width_px),
        width_px = image->width_px < ANNOTATE_MIN_WIDTH_PX ? ANNOTATE_MIN_WIDTH_PX : image->width_px;
    struct caption caption = { .margin_px = text_px * 3 / 4, .width_px = width_px };
    struct image *out = NULL;
    bool is_done = false;
    const int on_picture_px = annotations->has_no_caption ? text_px * 3 / 2 : text_px; /* printed at half a page, too */
    if (!(caption.fonts[0] = font_create(on_picture_px, err)) ||
        !(caption.fonts[1] = font_create(text_px * 5 / 4, err)) ||
        (!annotations->has_no_caption && !put_caption(&caption, annotations, err)))
        goto done;
    int caption_px = caption.y_px < ANNOTATE_MAX_CAPTION_PX ? caption.y_px : ANNOTATE_MAX_CAPTION_PX;
    if (!(out = copy_onto_white(image, width_px, image->height_px + caption_px, err)))
        goto done;
    const bool is_on_light = annotations->is_on_light;
    const struct canvas canvas = { out, image->width_px, image->height_px, is_on_light ? print : ink,
                                   is_on_light ? ink : halo };
    is_done =
        paint_on_picture(&canvas, caption.fonts[0], annotations, err) &&
        (annotations->has_no_caption || paint_caption(&caption, annotations, caption_px, out, image->height_px, err));
done:
    font_destroy(caption.fonts[0]);
    font_destroy(caption.fonts[1]);
    if (is_done)
        return out;
    image_destroy(out);
    return NULL;
}

bool annotate_mark(struct image *image, const char *words, struct error *err)
{
    const int size_px = annotate_text_px(image->width_px) * 3 / 2;
    const struct canvas canvas = { image, image->width_px, image->height_px, amber, halo };
    struct font *font = font_create(size_px, err);
    bool is_done = font && paint_word(&canvas, font, words, size_px / 2 + HALO_PX, 1, size_px, err);
    font_destroy(font);
    return is_done;
}

/* Places the numbers of the patient axes, and paints them stroke by stroke. */
#include "core/render/visible/axes_numbers.h"

#include <math.h>
#include <stdio.h>

/* ---- the signs ---------------------------------------------------------------------------------------------------- */

/* Lines through points of a grid of 4 x 6, y down, each "xy"; between two points a slash lifts the pen. */
enum { CELL = 4, CELL_HEIGHT = 6 };
static const double advance = 5.6; /* from sign to sign; in cells of the grid, as all below */
static const char *const digit_strokes[10] = {
    "10 30 41 45 36 16 05 01 10",       "11 20 26",    "01 10 30 41 42 06 46",
    "00 40 22 32 43 45 36 16 05",       "36 30 04 44", "40 00 02 32 43 45 36 16 05",
    "30 10 02 05 16 36 45 44 33 13 04", "00 40 16",    "10 30 41 42 33 13 02 01 10/13 04 05 16 36 45 44 33",
    "16 36 44 41 30 10 01 02 13 33 42",
};
static const char *const m_strokes = "06 02/03 12 23 26/23 32 43 46";

static const char *strokes_of(char sign)
{
    return sign >= '0' && sign <= '9' ? digit_strokes[sign - '0'] : sign == 'm' ? m_strokes : "";
}

/* Queues the strokes of a sign whose upper left corner is `at`, in cells of cell_px. */
static void paint_sign(struct paint *paint, char sign, struct paint_point at, double cell_px, double width_px)
{
    struct paint_point last = { 0, 0 };
    bool is_down = false;
    for (const char *c = strokes_of(sign); c[0] && c[1];) {
        struct paint_point next = { at.x + (c[0] - '0') * cell_px, at.y + (c[1] - '0') * cell_px };
        if (is_down)
            paint_line(paint, last, next, width_px);
        last = next;
        is_down = c[2] == ' ';
        c += c[2] ? 3 : 2;
    }
}

/* ---- places ------------------------------------------------------------------------------------------------------- */

/* Pixels of the full picture in the unit of line widths. */
static const double text_px = 10, stroke_px = 1.4, halo_px = 1, tick_px = 6, gap_px = 5, edge_px = 24, letter_px = 13;
enum { MOST_LABELS = 64, TEXT = 12 };

struct label {
    char text[TEXT];
    double x, y, half_width, half_height; /* its middle and half its size, px */
};

struct labels {
    struct label list[MOST_LABELS];
    size_t n;
};

static bool touch(const struct label *a, const struct label *b, double apart_px)
{
    return fabs(a->x - b->x) < a->half_width + b->half_width + apart_px &&
           fabs(a->y - b->y) < a->half_height + b->half_height + apart_px;
}

static size_t length_of(const char *text)
{
    size_t n = 0;
    while (text[n])
        n++;
    return n;
}

/* Beside the line at `mm`, square to it in the picture. False: there is no place to read it. */
static bool place(const struct space_pen *pen, const struct axes_numbers_line *line, double mm, bool has_unit,
                  struct label *label)
{
    const double length_mm = vec3_length(vec3_sub(line->to_lps_mm, line->from_lps_mm)), scale = pen->scale;
    const struct vec3 along = vec3_scale(vec3_sub(line->to_lps_mm, line->from_lps_mm), 1 / length_mm);
    struct paint_point at, next;
    if (!space_pen_place(pen, vec3_add(line->from_lps_mm, vec3_scale(along, mm)), &at) ||
        !space_pen_place(pen, vec3_add(line->from_lps_mm, vec3_scale(along, mm + 1)), &next))
        return false;
    const double dx = next.x - at.x, dy = next.y - at.y, run = hypot(dx, dy);
    if (!(run > 0.05 * scale)) /* the line is seen from its end */
        return false;
    double across[2] = { -dy / run, dx / run };
    const double side = line->away_px ? across[0] * (at.x - line->away_px[0]) + across[1] * (at.y - line->away_px[1])
                                      : across[0] + 2 * across[1];
    (void)snprintf(label->text, sizeof label->text, has_unit ? "%.0f mm" : "%.0f", mm);
    label->half_width = ((double)(length_of(label->text) - 1) * advance + CELL) / 2 * text_px / CELL_HEIGHT * scale;
    label->half_height = text_px / 2 * scale;
    const double far =
        (tick_px + gap_px) * scale + fabs(across[0]) * label->half_width + fabs(across[1]) * label->half_height;
    label->x = at.x + (side < 0 ? -far : far) * across[0];
    label->y = at.y + (side < 0 ? -far : far) * across[1];
    const double free_px = edge_px * scale;
    return label->x - label->half_width > free_px && label->x + label->half_width < pen->width_px - free_px &&
           label->y - label->half_height > free_px && label->y + label->half_height < pen->height_px - free_px;
}

static bool is_taken(const struct labels *labels, size_t from, size_t to, const struct label *label, double apart_px)
{
    for (size_t i = from; i < to; i++)
        if (touch(&labels->list[i], label, apart_px))
            return true;
    return false;
}

static bool is_at_letter(const struct space_pen *pen, const struct axes_numbers_line *line, const struct label *label)
{
    struct paint_point end;
    if (!line->has_letter || !space_pen_place(pen, line->to_lps_mm, &end))
        return false;
    const double half_px = letter_px * pen->scale;
    return touch(label, &(struct label){ .x = end.x, .y = end.y, .half_width = half_px, .half_height = half_px }, 0);
}

/* Adds the numbers of a line in steps of step_mm. False, and none is added: they touch each other. */
static bool add_in_steps(const struct space_pen *pen, const struct axes_numbers_line *line, double step_mm,
                         struct labels *labels)
{
    const double length_mm = vec3_length(vec3_sub(line->to_lps_mm, line->from_lps_mm)), apart_px = gap_px * pen->scale;
    const size_t first = labels->n;
    size_t last = first;
    double last_mm = 0;
    for (double mm = step_mm; mm <= length_mm && last < MOST_LABELS; mm += step_mm) {
        struct label *label = &labels->list[last];
        if (!place(pen, line, mm, false, label) || is_taken(labels, 0, first, label, apart_px) ||
            is_at_letter(pen, line, label))
            continue;
        if (is_taken(labels, first, last, label, 2 * apart_px))
            return false;
        last_mm = mm;
        last++;
    }
    struct label with_unit;
    if (last > first && place(pen, line, last_mm, true, &with_unit) &&
        !is_taken(labels, 0, last - 1, &with_unit, apart_px) && !is_at_letter(pen, line, &with_unit))
        labels->list[last - 1] = with_unit;
    labels->n = last;
    return true;
}

static void add_line(const struct space_pen *pen, const struct axes_numbers_line *line, struct labels *labels)
{
    static const double steps_mm[] = { 50, 100, 200, 500, 1000 };
    for (size_t i = 0; i < sizeof steps_mm / sizeof steps_mm[0]; i++)
        if (add_in_steps(pen, line, steps_mm[i], labels))
            return;
}

static void queue(const struct space_pen *pen, const struct labels *labels, double width_px)
{
    const double cell_px = text_px / CELL_HEIGHT * pen->scale;
    for (size_t i = 0; i < labels->n; i++) {
        const struct label *label = &labels->list[i];
        struct paint_point at = { label->x - label->half_width, label->y - label->half_height };
        for (const char *sign = label->text; *sign; sign++) {
            paint_sign(pen->paint, *sign, at, cell_px, fmax(1, width_px * pen->scale));
            at.x += advance * cell_px;
        }
    }
}

void axes_numbers_paint(const struct space_pen *pen, const struct axes_numbers_line *lines, size_t n, uint32_t rgb,
                        uint32_t halo_rgb, double opacity)
{
    struct labels labels = { .n = 0 };
    for (size_t i = 0; i < n; i++)
        if (vec3_length(vec3_sub(lines[i].to_lps_mm, lines[i].from_lps_mm)) > 0)
            add_line(pen, &lines[i], &labels);
    queue(pen, &labels, stroke_px + 2 * halo_px);
    paint_flush(pen->paint, halo_rgb, opacity);
    queue(pen, &labels, stroke_px);
    paint_flush(pen->paint, rgb, opacity);
}

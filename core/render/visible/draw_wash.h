#pragma once
/* Colourwash: a dose, or another map of real numbers, as colour over what a picture shows. The rule for both back ends,
 * and the wash of a snapshot. Knows no pixels and no GL. */
#include "core/derive/dose_field.h"
#include "core/render/visible/draw.h"

/* The wash at a patient point p:
 *
 * Row: tissue's value in the voxel that holds p (volume_voxel_at); with tissue NULL 0. Outside its grid or
 * DOSE_NO_ROW: nothing is drawn.
 *
 * Value: that of rows[row] at p as volume_sample gives it: outside the outer faces none, else tri-linear with indices
 * clamped to the outermost centres. is_per_slice: the third index is first rounded to the nearest slice, halves up. A
 * corner that is not finite and has a part > 0 makes it no value.
 *
 * Colour: of the last knot i with knots[i] <= value: colors[i] + (value - knots[i]) rises[i], as red, green, blue and
 * opacity, 0..1. Below knots[0] nothing is drawn.
 *
 * Result, in each channel of the picture: (1 - opacity) under + opacity colour, where under is the finished colour of
 * what is there: the image with its blend and after visible_background's least grey; a cap with image, tint and dark; a
 * shaded surface; the lit sample of a volume. Alpha and depth stay. */
enum { DRAW_WASH_MAX_KNOTS = 40 };
struct draw_wash {
    const struct volume *rows[DOSE_MAX_ROWS]; /* F32, slope 1, offset 0, all on one grid */
    size_t n_rows;
    /* Needs a call of dose_field_need_... before rows are read; NULL: the rows are complete, as they always are for a
     * back end without reads_dose_in_parts */
    const struct dose_field *field;
    const struct volume *tissue; /* U8, on its own grid; or NULL */
    bool is_per_slice;
    int n_knots; /* at least 1 */
    float knots[DRAW_WASH_MAX_KNOTS];
    float colors[DRAW_WASH_MAX_KNOTS][4];
    float rises[DRAW_WASH_MAX_KNOTS][4]; /* per unit of the value; bands: 0 */
    /* A reference to what rows and tissue belong to, dropped with the wash. NULL: the list's dose holds them */
    struct derive_result *source;
};

/* The list's wash of its snapshot, made at the first call; NULL: none is shown. It is kept until the list is destroyed.
 */
const struct draw_wash *draw_wash_shown(struct draw_list *list, const struct snapshot *snapshot);
/* The wash of a region's surface, which runs along the borders of its univels: it has the region's own row everywhere.
 * NULL: none is shown, or no weights hold in the region. */
const struct draw_wash *draw_wash_of_region(struct draw_list *list, const struct snapshot *snapshot, size_t region);
void draw_wash_release(struct draw_list *list);

/* Appends a wash on a slice pane that has no image, over what was drawn before. errors ERROR_MEMORY */
NODISCARD bool draw_wash_on_pane(struct draw_list *list, const struct draw_scope *scope, struct error *err);

/* A level of a wash: from this value on. */
struct draw_wash_level {
    double value;
    uint32_t color_rgb;
};
/* Fills knots, colours and rises. Values under `below` and under the lowest level are not drawn; -INFINITY: only those
 * under the lowest level. levels: in any order, finite; sorted here; at most DRAW_WASH_MAX_KNOTS. is_smooth: mixed
 * between two levels; else one colour from each level up to the next. */
void draw_wash_colors(struct draw_wash *wash, struct draw_wash_level *levels, size_t n, bool is_smooth, double below,
                      double opacity);

/* The rule above at one point, for one sample; false: nothing is drawn. Back ends agree with it to float precision. */
bool draw_wash_at(const struct draw_wash *wash, struct vec3 point_lps_mm, float color[4]);

/* Chooses places for labels: rates a place every few pixels of a line, takes the best one that is free. */
#include "core/render/visible/label_places.h"

#include <math.h>
#include <stdlib.h>

#include "core/base/mem.h"

#define PI 3.14159265358979323846
/* All in pixels. */
static const double stride_px = 6;     /* between the places that are rated */
static const double margin_px = 3;     /* around labels, and to the picture's edges */
static const double apart_px = 480;    /* along a line, from label to label */
static const double choice_px = 24;    /* the same of places to choose from */
static const double least_chord = 0.9; /* of the line's length under the label */
static const double most_bend = 0.6;   /* of the label's height */
enum { CELL_PX = 4, MAX_ON_LINE = 4, MAX_CHOICE = 24 };
static const uint64_t kept_free = UINT64_C(1) << 32; /* the bit of LABEL_KEPT_FREE, beside those of 32 groups */

/* Which groups have lines in each cell of the picture. */
struct occupancy {
    uint64_t *groups;
    int width, height;
};

/* The style that all labels share. */
struct style {
    double size_px[2]; /* of the picture */
    struct label_style label;
};

struct walk {
    const struct label_line *line;
    double *length_px; /* [n_points] from the first point */
    bool is_closed;
};

static uint64_t bit_of(int group)
{
    return group == LABEL_KEPT_FREE ? kept_free : UINT64_C(1) << (group & 31);
}

static void mark(struct occupancy *cells, double x, double y, int group)
{
    int i = (int)floor(x / CELL_PX), j = (int)floor(y / CELL_PX);
    if (i >= 0 && j >= 0 && i < cells->width && j < cells->height)
        cells->groups[(size_t)j * (size_t)cells->width + (size_t)i] |= bit_of(group);
}

static void mark_line(struct occupancy *cells, const struct label_line *line)
{
    const size_t step_points = line->group == LABEL_KEPT_FREE ? 2 : 1;
    for (size_t i = 1; i < line->n_points; i += step_points) {
        const double *a = line->points_px[i - 1], *b = line->points_px[i];
        int n = (int)fmin(ceil(hypot(b[0] - a[0], b[1] - a[1]) / CELL_PX), 4096);
        for (int step = 0; step <= n; step++) {
            double t = n ? (double)step / n : 0;
            mark(cells, a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), line->group);
        }
    }
}

/* The point at a length from the line's beginning. */
static void point_at(const struct walk *walk, double at, double point[2])
{
    size_t n = walk->line->n_points, low = 0, high = n - 1;
    double whole = walk->length_px[n - 1];
    if (walk->is_closed)
        at -= whole * floor(at / whole);
    while (high - low > 1) {
        size_t middle = (low + high) / 2;
        if (walk->length_px[middle] <= at)
            low = middle;
        else
            high = middle;
    }
    double step = walk->length_px[high] - walk->length_px[low], t = step > 0 ? (at - walk->length_px[low]) / step : 0;
    for (int i = 0; i < 2; i++)
        point[i] = walk->line->points_px[low][i] + t * (walk->line->points_px[high][i] - walk->line->points_px[low][i]);
}

/* The largest distance of the line from its chord within half_px of a place. */
static double bend_px(const struct walk *walk, double at, double half_px)
{
    enum { POINTS = 8 };
    double a[2], b[2], p[2], most = 0;
    point_at(walk, at - half_px, a);
    point_at(walk, at + half_px, b);
    double dx = b[0] - a[0], dy = b[1] - a[1], chord = hypot(dx, dy);
    for (int i = 1; i < POINTS; i++) {
        point_at(walk, at - half_px + 2 * half_px * i / POINTS, p);
        most = fmax(most, chord > 0 ? fabs(dx * (p[1] - a[1]) - dy * (p[0] - a[0])) / chord : half_px);
    }
    return most;
}

static void corners_of(const struct label_place *place, double margin, double corners[4][2])
{
    double turn = place->angle_deg * PI / 180, along[2] = { cos(turn), sin(turn) };
    for (int i = 0; i < 4; i++) {
        double x = (i & 1 ? 1 : -1) * (place->width_px / 2 + margin),
               y = (i & 2 ? 1 : -1) * (place->height_px / 2 + margin);
        corners[i][0] = place->x_px + x * along[0] - y * along[1];
        corners[i][1] = place->y_px + x * along[1] + y * along[0];
    }
}

/* True if a line along one of a's sides parts the rectangles. */
static bool is_parted(const struct label_place *a, double p[4][2], double q[4][2])
{
    double turn = a->angle_deg * PI / 180;
    const double axes[2][2] = { { cos(turn), sin(turn) }, { -sin(turn), cos(turn) } };
    for (int axis = 0; axis < 2; axis++) {
        double low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY };
        for (int i = 0; i < 8; i++) {
            const double *corner = i < 4 ? p[i] : q[i - 4];
            double at = corner[0] * axes[axis][0] + corner[1] * axes[axis][1];
            low[i / 4] = fmin(low[i / 4], at);
            high[i / 4] = fmax(high[i / 4], at);
        }
        if (high[0] < low[1] || high[1] < low[0])
            return true;
    }
    return false;
}

static bool overlap(const struct label_place *a, const struct label_place *b, double margin)
{
    double p[4][2], q[4][2];
    corners_of(a, margin, p);
    corners_of(b, 0, q);
    return !is_parted(a, p, q) && !is_parted(b, p, q);
}

bool label_places_overlap(const struct label_place *a, const struct label_place *b)
{
    return overlap(a, b, 0);
}

/* How many of some points of the label lie near lines of other groups; -1: one lies near a line that is kept free. */
static int n_crossed(const struct occupancy *cells, const struct label_place *place, int group)
{
    double corners[4][2];
    int n = 0;
    corners_of(place, 1, corners);
    for (int i = 0; i <= 6; i++)
        for (int j = 0; j <= 2; j++) {
            double s = i / 6.0, t = j / 2.0, at[2];
            for (int axis = 0; axis < 2; axis++)
                at[axis] = corners[0][axis] + s * (corners[1][axis] - corners[0][axis]) +
                           t * (corners[2][axis] - corners[0][axis]);
            int x = (int)floor(at[0] / CELL_PX), y = (int)floor(at[1] / CELL_PX);
            if (x < 0 || y < 0 || x >= cells->width || y >= cells->height)
                continue;
            uint64_t here = cells->groups[(size_t)y * (size_t)cells->width + (size_t)x];
            if (here & kept_free)
                return -1;
            n += (here & ~bit_of(group)) != 0;
        }
    return n;
}

/* The label at a place of the line; false: the line bends there, or the label is not within the picture. */
static bool make_place(const struct walk *walk, const struct occupancy *cells, double at, const struct style *style,
                       struct label_place *place, double *cost)
{
    double a[2], b[2], corners[4][2], half = walk->line->width_px / 2 + margin_px;
    point_at(walk, at - half, a);
    point_at(walk, at + half, b);
    double dx = b[0] - a[0], dy = b[1] - a[1], bend;
    if (hypot(dx, dy) < least_chord * 2 * half)
        return false;
    place->x_px = (a[0] + b[0]) / 2;
    place->y_px = (a[1] + b[1]) / 2;
    place->width_px = walk->line->width_px;
    place->height_px = style->label.height_px;
    place->angle_deg = style->label.is_upright ? 0 : atan2(dy, dx) * 180 / PI;
    place->angle_deg -= place->angle_deg > 90 ? 180 : place->angle_deg <= -90 ? -180 : 0;
    corners_of(place, margin_px, corners);
    for (int i = 0; i < 4; i++)
        if (!(corners[i][0] >= 0 && corners[i][1] >= 0 && corners[i][0] <= style->size_px[0] &&
              corners[i][1] <= style->size_px[1]))
            return false;
    if ((bend = bend_px(walk, at, half)) > most_bend * style->label.height_px)
        return false;
    int crossed = n_crossed(cells, place, walk->line->group);
    if (crossed < 0)
        return false;
    double far = walk->is_closed ? 2 * half : fmin(fmin(2 * half, at), walk->length_px[walk->line->n_points - 1] - at);
    *cost = (bend + 0.3 * bend_px(walk, at, fmax(far, half))) / style->label.height_px +
            0.1 * fabs(dy) / hypot(dx, dy) + 0.2 * crossed;
    return true;
}

static bool is_free(const struct label_place *place, const struct label_place *places, int n)
{
    for (int i = 0; i < n; i++)
        if (overlap(place, &places[i], margin_px))
            return false;
    return true;
}

/* Adds the best free places of a line. Returns the new number of places. */
static int place_on(const struct walk *walk, const struct occupancy *cells, const struct style *style,
                    struct label_place *places, int n, int max)
{
    double whole = walk->length_px[walk->line->n_points - 1], half = walk->line->width_px / 2 + margin_px,
           first = walk->is_closed ? 0 : half, last = walk->is_closed ? whole : whole - half, taken[MAX_CHOICE],
           apart = style->label.is_choice ? choice_px : apart_px;
    const int most = style->label.is_choice ? MAX_CHOICE : MAX_ON_LINE, others = style->label.is_choice ? n : 0;
    int n_wanted = (int)fmin(fmax(1, floor(whole / apart)), most), n_taken = 0;
    while (whole >= LABEL_LENGTHS * walk->line->width_px && n_taken < n_wanted && n < max) {
        struct label_place best = { 0 };
        double least = INFINITY, best_at = 0;
        for (double at = first; at <= last; at += stride_px) {
            struct label_place place = { 0 };
            double cost;
            bool is_near = false;
            for (int i = 0; i < n_taken; i++) {
                double gap = fabs(at - taken[i]);
                is_near |= fmin(gap, walk->is_closed ? whole - gap : gap) < apart / 2;
            }
            if (is_near || !make_place(walk, cells, at, style, &place, &cost) || cost >= least ||
                !is_free(&place, places + others, n - others))
                continue;
            least = cost;
            best = place;
            best_at = at;
        }
        if (!(least < INFINITY))
            break;
        places[n++] = best;
        taken[n_taken++] = best_at;
    }
    return n;
}

int label_places_find(const struct label_line *lines, size_t n_lines, double width_px, double picture_height_px,
                      const struct label_style *label, struct label_place *places, int max, struct error *err)
{
    const struct style style = { { width_px, picture_height_px }, *label };
    struct occupancy cells = { .width = (int)ceil(width_px / CELL_PX),
                               .height = (int)ceil(picture_height_px / CELL_PX) };
    size_t most = 0;
    for (size_t i = 0; i < n_lines; i++)
        most = lines[i].n_points > most ? lines[i].n_points : most;
    cells.groups = mem_array((size_t)cells.width * (size_t)cells.height, sizeof *cells.groups, UINT64_MAX, err);
    double *length_px = cells.groups ? mem_array(most, sizeof *length_px, UINT64_MAX, err) : NULL;
    int n = length_px ? 0 : -1;
    for (size_t i = 0; n >= 0 && i < n_lines; i++)
        mark_line(&cells, &lines[i]);
    for (size_t l = 0; n >= 0 && l < n_lines; l++) {
        const struct label_line *line = &lines[l];
        struct walk walk = { line, length_px, false };
        if (line->n_points < 2 || line->group == LABEL_KEPT_FREE)
            continue;
        for (size_t i = 1; i < line->n_points; i++)
            length_px[i] = length_px[i - 1] + hypot(line->points_px[i][0] - line->points_px[i - 1][0],
                                                    line->points_px[i][1] - line->points_px[i - 1][1]);
        const double *begin = line->points_px[0], *end = line->points_px[line->n_points - 1];
        walk.is_closed = line->n_points > 2 && begin[0] == end[0] && begin[1] == end[1];
        int before = n;
        n = place_on(&walk, &cells, &style, places, n, max);
        for (int i = before; i < n; i++)
            places[i].line = l;
    }
    free(length_px);
    free(cells.groups);
    return n;
}

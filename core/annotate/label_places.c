/* Tries the corners of the point first, then every place of a lattice. */
#include "core/annotate/label_places.h"

#include <stdint.h>

static bool covers(const struct label_box *a, const struct label_box *b)
{
    return a->left < b->left + b->width && b->left < a->left + a->width && a->top < b->top + b->height &&
           b->top < a->top + a->height;
}

static bool is_free(const struct label_placing *placing, const struct label_box *box, size_t first)
{
    if (box->left < 0 || box->top < 0 || box->left + box->width > placing->width_px ||
        box->top + box->height > placing->height_px)
        return false;
    for (size_t i = first; i < placing->n_taken; i++)
        if (covers(box, &placing->taken[i]))
            return false;
    return true;
}

/* A coordinate's distance from a range; 0 within. */
static int64_t apart(int at, int from, int size)
{
    return at < from ? (int64_t)from - at : at > from + size ? (int64_t)at - from - size : 0;
}

static int64_t square_apart(int x, int y, const struct label_box *box)
{
    const int64_t across = apart(x, box->left, box->width), down = apart(y, box->top, box->height);
    return across * across + down * down;
}

static bool find_nearest(const struct label_placing *placing, int x, int y, struct label_box *box)
{
    struct label_box at = *box, best = *box;
    int64_t nearest = INT64_MAX;
    for (at.top = placing->step_px / 2; at.top + at.height <= placing->height_px; at.top += placing->step_px)
        for (at.left = placing->step_px / 2; at.left + at.width <= placing->width_px; at.left += placing->step_px) {
            const int64_t distance = square_apart(x, y, &at);
            if (distance < nearest && distance > 0 && is_free(placing, &at, 0)) {
                nearest = distance;
                best = at;
            }
        }
    *box = best;
    return nearest < INT64_MAX;
}

static void put_at_corner(const struct label_placing *placing, int x, int y, int corner, struct label_box *box)
{
    const int aside = placing->aside_px, rim = placing->rim_px;
    box->left = corner & 1 ? x - aside - box->width + rim : x + aside - rim;
    box->top = (corner & 2 ? y + aside : y - aside) - placing->above_px;
}

bool label_place(struct label_placing *placing, int x, int y, struct label_box *box)
{
    bool is_found = false;
    for (int corner = 0; !is_found && corner < 4; corner++) {
        put_at_corner(placing, x, y, corner, box);
        is_found = is_free(placing, box, corner ? 0 : placing->n_fixed);
    }
    is_found = is_found || find_nearest(placing, x, y, box);
    if (is_found)
        placing->taken[placing->n_taken++] = *box;
    else
        put_at_corner(placing, x, y, 0, box);
    return is_found;
}

bool label_is_far(const struct label_placing *placing, int x, int y, const struct label_box *box, int end[2])
{
    const int64_t near_px = 2 * placing->aside_px;
    end[0] = x < box->left ? box->left : x > box->left + box->width ? box->left + box->width : x;
    end[1] = y < box->top ? box->top : y > box->top + box->height ? box->top + box->height : y;
    return square_apart(x, y, box) > near_px * near_px;
}

/* Finds, for each outline of a slice, the outline of the next slice that continues it, by counting shared pixels. */
#include "core/surface/nurbs_pieces.h"

#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"

/* Pixels first .. end - 1 of a row are inside a line and inside no other line nested in it. */
struct run {
    int32_t row, first, end;
    uint32_t line;
};

struct runs {
    struct run *at;
    size_t n;
};

/* Crossing of a line and a row, between two pixels. */
struct crossing {
    int32_t row, pixel; /* the pixel to the right of it */
    uint32_t line;
};

struct shared {
    uint32_t low, high; /* a line of this slice and one of the next */
    uint64_t n_pixels;
};

double nurbs_pieces_twice_area(const struct outline_set *set, uint32_t line, int axis)
{
    int u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
    double twice = 0;
    for (uint32_t at = set->line[line]; at < set->line[line + 1]; at++) {
        uint32_t next = at + 1 < set->line[line + 1] ? at + 1 : set->line[line];
        const float *a = set->points_ijk + 3 * (size_t)set->walk[at],
                    *b = set->points_ijk + 3 * (size_t)set->walk[next];
        twice += (double)a[u] * (double)b[v] - (double)a[v] * (double)b[u];
    }
    return twice;
}

/* ---- runs of pixels by line ------------------------------------------------------------------------------------- */

static int compare_crossings(const void *a, const void *b)
{
    const struct crossing *x = a, *y = b;
    return x->row != y->row ? (x->row < y->row ? -1 : 1) : x->pixel < y->pixel ? -1 : x->pixel > y->pixel;
}

static size_t find_crossings(const struct outline_set *set, uint32_t slice, int axis, struct crossing *out)
{
    int u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
    size_t n = 0;
    for (uint32_t line = set->slice[slice]; line < set->slice[slice + 1]; line++)
        for (uint32_t at = set->line[line]; at < set->line[line + 1]; at++) {
            const float *p = set->points_ijk + 3 * (size_t)set->walk[at];
            if (p[v] == floorf(p[v])) /* otherwise the point is between two rows */
                out[n++] = (struct crossing){ (int32_t)p[v], (int32_t)ceilf(p[u]), line };
        }
    return n;
}

/* Makes the runs of all lines of a slice. Lines are nested and never cross, so along a row the line entered last is
 * left first. */
static bool runs_make(const struct outline_set *set, uint32_t slice, int axis, struct runs *runs, struct error *err)
{
    size_t n_points = set->line[set->slice[slice + 1]] - set->line[set->slice[slice]];
    struct crossing *crossings = mem_array(n_points, sizeof *crossings, UINT64_MAX, err);
    uint32_t *open = crossings ? mem_array(n_points, sizeof *open, UINT64_MAX, err) : NULL;
    runs->n = 0;
    runs->at = open ? mem_array(n_points, sizeof *runs->at, UINT64_MAX, err) : NULL;
    if (runs->at) {
        size_t n = find_crossings(set, slice, axis, crossings), n_open = 0;
        qsort(crossings, n, sizeof *crossings, compare_crossings);
        for (size_t c = 0; c < n; c++) {
            const struct crossing *here = &crossings[c];
            if (n_open > 0 && crossings[c - 1].pixel < here->pixel)
                runs->at[runs->n++] = (struct run){ here->row, crossings[c - 1].pixel, here->pixel, open[n_open - 1] };
            if (n_open > 0 && open[n_open - 1] == here->line)
                n_open--;
            else
                open[n_open++] = here->line;
        }
    }
    free(crossings);
    free(open);
    return runs->at != NULL;
}

/* ---- pixels shared by two slices -------------------------------------------------------------------------------- */

static int compare_shared(const void *a, const void *b)
{
    const struct shared *x = a, *y = b;
    return x->low != y->low ? (x->low < y->low ? -1 : 1) : x->high < y->high ? -1 : x->high > y->high;
}

/* Lists every pair of runs of the same kind that share pixels, sorted by pair of lines; the caller frees it. */
static struct shared *find_shared(const struct runs *low, const struct runs *high, const bool *is_hole, size_t *n,
                                  struct error *err)
{
    /* sufficient: two sorted lists of runs have no more overlaps */
    struct shared *shared = mem_array(low->n + high->n, sizeof *shared, UINT64_MAX, err);
    if (!shared)
        return NULL;
    *n = 0;
    for (size_t a = 0, b = 0; a < low->n && b < high->n;) {
        const struct run *x = &low->at[a], *y = &high->at[b];
        int32_t first = x->first > y->first ? x->first : y->first, end = x->end < y->end ? x->end : y->end;
        if (x->row == y->row && first < end && is_hole[x->line] == is_hole[y->line])
            shared[(*n)++] = (struct shared){ x->line, y->line, (uint64_t)(end - first) };
        if (x->row != y->row ? x->row < y->row : x->end < y->end)
            a++;
        else
            b++;
    }
    qsort(shared, *n, sizeof *shared, compare_shared);
    size_t kept = 0;
    for (size_t at = 0; at < *n; at++)
        if (kept > 0 && compare_shared(&shared[kept - 1], &shared[at]) == 0)
            shared[kept - 1].n_pixels += shared[at].n_pixels;
        else
            shared[kept++] = shared[at];
    *n = kept;
    return shared;
}

struct best {
    uint32_t line;
    uint64_t n_pixels;
};

static void consider(struct best *best, uint32_t line, uint64_t n_pixels)
{
    if (n_pixels > best->n_pixels)
        *best = (struct best){ line, n_pixels }; /* the first of equals is kept */
}

uint32_t *nurbs_pieces_link(const struct outline_set *set, int axis, struct error *err)
{
    struct runs low = { NULL, 0 }, high = { NULL, 0 };
    uint32_t *next = mem_array(set->n_lines, sizeof *next, UINT64_MAX, err);
    bool *is_hole = next ? mem_array(set->n_lines, sizeof *is_hole, UINT64_MAX, err) : NULL;
    struct best *up =
        is_hole ? mem_array(set->n_lines, sizeof *up, UINT64_MAX, err) : NULL; /* of each line, in the next slice */
    struct best *down = up ? mem_array(set->n_lines, sizeof *down, UINT64_MAX, err) : NULL;
    bool good = down != NULL;
    for (uint32_t line = 0; good && line < set->n_lines; line++)
        is_hole[line] = nurbs_pieces_twice_area(set, line, axis) < 0;
    for (uint32_t slice = 0; good && slice < set->n_slices; slice++) {
        size_t n = 0;
        struct shared *shared = NULL;
        good = runs_make(set, slice, axis, &high, err);
        if (good && slice > 0) {
            shared = find_shared(&low, &high, is_hole, &n, err);
            good = shared != NULL;
        }
        for (size_t at = 0; at < n; at++) {
            consider(&up[shared[at].low], shared[at].high, shared[at].n_pixels);
            consider(&down[shared[at].high], shared[at].low, shared[at].n_pixels);
        }
        free(shared);
        free(low.at);
        low = high;
        high = (struct runs){ NULL, 0 };
    }
    for (uint32_t line = 0; good && line < set->n_lines; line++)
        next[line] = up[line].n_pixels > 0 && down[up[line].line].line == line ? up[line].line : UINT32_MAX;
    free(low.at);
    free(high.at);
    free(is_hole);
    free(up);
    free(down);
    if (good)
        return next;
    free(next);
    return NULL;
}

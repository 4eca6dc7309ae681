/* Makes line segments in space from the outlines of all slices. */
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/surface/shape_make.h"
#include "core/surface/shape_parts.h"

/* Half the width, in pixels, of the mark for a single pixel, whose line has no length. */
#define MARK_HALF 0.25

static bool is_alone(const struct outline_set *set, size_t line)
{
    return set->line[line + 1] - set->line[line] == 1;
}

static size_t count_alone(const struct outline_set *set)
{
    size_t n = 0;
    for (size_t l = 0; l < set->n_lines; l++)
        n += is_alone(set, l);
    return n;
}

static struct line_set *lines_create(size_t n_vertices, size_t n_segments, size_t n_lines, struct error *err)
{
    if (n_segments > SHAPE_MAX_SEGMENTS) {
        error_set(err, ERROR_LIMIT, "outlines of %zu segments: at most %d are allowed", n_segments, SHAPE_MAX_SEGMENTS);
        return NULL;
    }
    struct line_set *lines = mem_new(sizeof *lines);
    *lines = (struct line_set){ .n_vertices = n_vertices, .n_segments = n_segments, .n_lines = n_lines };
    lines->positions_lps_mm = mem_array(n_vertices, 3 * sizeof *lines->positions_lps_mm, UINT64_MAX, err);
    lines->indices =
        lines->positions_lps_mm ? mem_array(n_segments, 2 * sizeof *lines->indices, UINT64_MAX, err) : NULL;
    if (!lines->indices) {
        free(lines->positions_lps_mm);
        free(lines);
        return NULL;
    }
    return lines;
}

static void put_vertex(struct line_set *lines, size_t at, const struct affine *map, struct vec3 ijk)
{
    struct vec3 p = affine_point(map, ijk);
    lines->positions_lps_mm[3 * at] = (float)p.x;
    lines->positions_lps_mm[3 * at + 1] = (float)p.y;
    lines->positions_lps_mm[3 * at + 2] = (float)p.z;
}

/* Writes a diamond around a point: four vertices from `vertex` on. */
static void put_mark(struct line_set *lines, size_t vertex, const struct affine *map, const float *ijk, int axis)
{
    int u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
    for (size_t corner = 0; corner < 4; corner++) {
        double at[3] = { (double)ijk[0], (double)ijk[1], (double)ijk[2] };
        at[corner % 2 ? v : u] += corner < 2 ? MARK_HALF : -MARK_HALF;
        put_vertex(lines, vertex + corner, map, vec3(at[0], at[1], at[2]));
    }
}

static void put_segments(uint32_t **out, uint32_t first, uint32_t n, const uint32_t *vertices)
{
    for (uint32_t at = 0; at < n; at++) {
        uint32_t next = at + 1 < n ? at + 1 : 0;
        *(*out)++ = vertices ? vertices[at] : first + at;
        *(*out)++ = vertices ? vertices[next] : first + next;
    }
}

struct line_set *shape_outline(const struct mask *mask, enum outline_method method, int n_threads, struct error *err)
{
    struct grid grid;
    if (!grid_init(&grid, mask->size, &mask->lps_mm_from_ijk, err))
        return NULL;
    int axis = grid_index_axis(&grid, 2, NULL);
    struct outline_set *set = outline_stack(mask, axis, method, n_threads, err);
    if (!set)
        return NULL;
    size_t n_alone = count_alone(set);
    struct line_set *lines = lines_create(set->n_points + 4 * n_alone, set->n_walk + 3 * n_alone, set->n_lines, err);
    if (lines) {
        uint32_t *out = lines->indices;
        size_t mark = set->n_points;
        for (size_t p = 0; p < set->n_points; p++) {
            const float *ijk = set->points_ijk + 3 * p;
            put_vertex(lines, p, &mask->lps_mm_from_ijk, vec3((double)ijk[0], (double)ijk[1], (double)ijk[2]));
        }
        for (size_t l = 0; l < set->n_lines; l++) {
            const uint32_t *walk = set->walk + set->line[l];
            if (is_alone(set, l)) {
                put_mark(lines, mark, &mask->lps_mm_from_ijk, set->points_ijk + 3 * (size_t)walk[0], axis);
                put_segments(&out, (uint32_t)mark, 4, NULL);
                mark += 4;
            } else {
                put_segments(&out, 0, set->line[l + 1] - set->line[l], walk);
            }
        }
    }
    outline_set_destroy(set);
    return lines;
}

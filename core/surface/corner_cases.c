/* Generates the triangles of the 8-cell algorithm for each case of a cell.
 *
 * Within a cell, the region is the convex hull of the cell's inside corners; the surface is the boundary of all hulls
 * together. A side of a hull on a face of its cell is no boundary, because the cell behind that face has the same
 * inside corners there and its hull continues. The exception: if that hull is flat and lies in the face, its cell draws
 * the side, towards its own interior. A hull that is flat within the cell is drawn on both sides. So every edge is used
 * equally often in both directions: the surface is closed, and where it is two sheets back to back, they are the same
 * triangles. Fewer than three corners have no area and give no triangle. */
#include "core/surface/corner_cases.h"

#include <assert.h>
#include <string.h>

static int coordinate(int corner, int axis)
{
    return corner >> axis & 1;
}

static int along(const int direction[3], int corner)
{
    return direction[0] * coordinate(corner, 0) + direction[1] * coordinate(corner, 1) +
           direction[2] * coordinate(corner, 2);
}

/* Positive if a, b, c are counter-clockwise as seen against the direction. */
static int turn(const int direction[3], int a, int b, int c)
{
    int u[3], v[3], sum = 0;
    for (int axis = 0; axis < 3; axis++) {
        u[axis] = coordinate(b, axis) - coordinate(a, axis);
        v[axis] = coordinate(c, axis) - coordinate(a, axis);
    }
    for (int axis = 0; axis < 3; axis++) {
        int next = (axis + 1) % 3, last = (axis + 2) % 3;
        sum += direction[axis] * (u[next] * v[last] - u[last] * v[next]);
    }
    return sum;
}

static void add_triangle(struct corner_case *out, const int direction[3], int a, int b, int c)
{
    assert(out->n_triangles < CORNER_MAX_TRIANGLES);
    uint8_t *corners = out->corners + 3 * out->n_triangles++;
    bool is_turned = turn(direction, a, b, c) > 0;
    corners[0] = (uint8_t)a;
    corners[1] = (uint8_t)(is_turned ? b : c);
    corners[2] = (uint8_t)(is_turned ? c : b);
    out->used = (uint8_t)(out->used | 1 << a | 1 << b | 1 << c);
}

/* Adds the side of the hull that faces a direction: the corners farthest along it, if they are three or four. */
static void add_side(struct corner_case *out, int inside, const int direction[3])
{
    int farthest = -3, side[8], n = 0;
    for (int corner = 0; corner < 8; corner++)
        if (inside >> corner & 1 && along(direction, corner) > farthest)
            farthest = along(direction, corner);
    for (int corner = 0; corner < 8; corner++)
        if (inside >> corner & 1 && along(direction, corner) == farthest)
            side[n++] = corner;
    bool is_axis = direction[0] * direction[0] + direction[1] * direction[1] + direction[2] * direction[2] == 1;
    bool faces_out = is_axis && farthest == (direction[0] + direction[1] + direction[2] > 0 ? 1 : 0);
    if (n < 3 || faces_out)
        return;
    /* four corners are a rectangle with opposite first and last: both cells at a face cut it along the same diagonal */
    add_triangle(out, direction, side[0], side[1], side[n - 1]);
    if (n == 4)
        add_triangle(out, direction, side[0], side[2], side[3]);
}

void corner_cases_make(struct corner_case cases[256], bool is_mirrored)
{
    memset(cases, 0, 256 * sizeof *cases);
    for (int inside = 0; inside < 256; inside++) {
        struct corner_case *out = &cases[inside];
        /* a plane through three corners of a cube is perpendicular to an axis, a face diagonal or a space diagonal */
        for (int way = 0; way < 27; way++) {
            const int direction[3] = { way % 3 - 1, way / 3 % 3 - 1, way / 9 - 1 };
            if (way != 13) /* 13: the zero vector */
                add_side(out, inside, direction);
        }
        for (int t = 0; is_mirrored && t < out->n_triangles; t++) {
            uint8_t swapped = out->corners[3 * t + 1];
            out->corners[3 * t + 1] = out->corners[3 * t + 2];
            out->corners[3 * t + 2] = swapped;
        }
    }
}

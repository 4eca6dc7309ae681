/* Makes lines and walls of beams. */
#include "core/render/visible/beam_shape.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

#include "core/base/mem.h"

/* A dash and the gap after it, in parts of the beam's size_mm; the dash is the first part of it. */
static const double dash_period = 1.5, dash_part = 0.55;
/* Dashes around an opening. */
enum { ROUND_DASHES = 16 };
/* Outlines of more corners have no edges between their ends. */
enum { MAX_EDGED_CORNERS = 8 };
/* Parts of a wall along its length. */
enum { WALL_STEPS = 24 };

/* ---- lines ------------------------------------------------------------------------------------------------------- */

static bool add_dashed(struct cut_lines *lines, struct vec3 a, struct vec3 b, double period_mm, struct error *err)
{
    struct vec3 along = vec3_sub(b, a);
    double length_mm = vec3_length(along), dash_mm = dash_part * period_mm;
    bool is_good = true;
    for (double at = 0; is_good && at < length_mm; at += period_mm)
        is_good = cut_lines_add(lines, vec3_add(a, vec3_scale(along, at / length_mm)),
                                vec3_add(a, vec3_scale(along, fmin(at + dash_mm, length_mm) / length_mm)), err);
    return is_good;
}

static bool add_line(const struct beam_drawn *beam, struct vec3 a, struct vec3 b, struct cut_lines *lines,
                     struct error *err)
{
    return beam->shown.is_draft ? add_dashed(lines, a, b, dash_period * beam->size_mm, err)
                                : cut_lines_add(lines, a, b, err);
}

static bool add_head(const struct beam_drawn *beam, struct cut_lines *lines, struct error *err)
{
    static const double ways[4][2] = { { 1, 0 }, { -1, 0 }, { 0, 1 }, { 0, -1 } };
    struct plane back = beam_plane(&beam->shown, beam->mark_mm - beam->size_mm);
    struct vec3 tip = beam_point(&beam->shown, beam->mark_mm);
    double aside_mm = 0.4 * beam->size_mm;
    bool is_good = true;
    for (int i = 0; is_good && i < 4; i++)
        is_good = cut_lines_add(lines, plane_point(&back, ways[i][0] * aside_mm, ways[i][1] * aside_mm), tip, err);
    return is_good;
}

static bool add_cross(const struct beam_drawn *beam, struct cut_lines *lines, struct error *err)
{
    struct plane plane = beam_plane(&beam->shown, beam->shown.length_mm);
    double half_mm = 0.5 * beam->size_mm;
    return beam->shown.length_mm > beam->last_mm ||
           (cut_lines_add(lines, plane_point(&plane, -half_mm, 0), plane_point(&plane, half_mm, 0), err) &&
            cut_lines_add(lines, plane_point(&plane, 0, -half_mm), plane_point(&plane, 0, half_mm), err));
}

/* The edge where the opening begins or ends. A draft's circle, or outline of many corners, is dashed by leaving out
 * sides. */
static bool add_rim(const struct beam_drawn *beam, const struct beam_opening *opening, double along_mm,
                    struct cut_lines *lines, struct error *err)
{
    const size_t per_dash = BEAM_ROUND_SIDES / ROUND_DASHES;
    bool is_good = true;
    for (size_t i = 0; is_good && i < opening->n; i++) {
        struct vec3 a = beam_opening_point(&beam->shown, opening, i, along_mm),
                    b = beam_opening_point(&beam->shown, opening, opening->next[i], along_mm);
        if (opening->n > MAX_EDGED_CORNERS)
            is_good = (beam->shown.is_draft && i % per_dash >= per_dash / 2) || cut_lines_add(lines, a, b, err);
        else
            is_good = add_line(beam, a, b, lines, err);
    }
    return is_good;
}

static bool add_edges(const struct beam_drawn *beam, const struct beam_opening *opening, struct cut_lines *lines,
                      struct error *err)
{
    bool is_good = add_rim(beam, opening, beam->opening_first_mm, lines, err) &&
                   add_rim(beam, opening, beam->opening_last_mm, lines, err);
    for (size_t i = 0; is_good && opening->n <= MAX_EDGED_CORNERS && i < opening->n; i++)
        is_good = add_line(beam, beam_opening_point(&beam->shown, opening, i, beam->opening_first_mm),
                           beam_opening_point(&beam->shown, opening, i, beam->opening_last_mm), lines, err);
    return is_good;
}

bool beam_add_lines(const struct beam_drawn *beam, const struct beam_parts *parts, struct cut_lines *lines,
                    struct error *err)
{
    struct vec3 first = beam_point(&beam->shown, beam->first_mm), last = beam_point(&beam->shown, beam->last_mm);
    if (parts->has_line &&
        !(add_line(beam, first, last, lines, err) && add_head(beam, lines, err) && add_cross(beam, lines, err)))
        return false;
    return !parts->opening || add_edges(beam, parts->opening, lines, err);
}

struct shape *beam_lines_shape(const struct cut_lines *lines, struct error *err)
{
    size_t n = 2 * lines->n;
    struct shape *shape = mem_new(sizeof *shape);
    *shape =
        (struct shape){ .kind = SHAPE_LINES, .lines = mem_new(sizeof *shape->lines), .bounds_lps_mm = box3_empty() };
    atomic_init(&shape->references, 1);
    struct line_set *set = shape->lines;
    set->positions_lps_mm = mem_array(n, 3 * sizeof *set->positions_lps_mm, UINT64_MAX, err);
    set->indices = set->positions_lps_mm ? mem_array(n, sizeof *set->indices, UINT64_MAX, err) : NULL;
    if (!set->indices) {
        shape_unref(shape);
        return NULL;
    }
    set->n_vertices = n;
    set->n_segments = lines->n;
    for (size_t i = 0; i < n; i++) {
        const double *p = lines->ends_lps_mm[i / 2][i % 2];
        for (size_t axis = 0; axis < 3; axis++)
            set->positions_lps_mm[3 * i + axis] = (float)p[axis];
        set->indices[i] = (uint32_t)i;
        box3_add(&shape->bounds_lps_mm, vec3(p[0], p[1], p[2]));
    }
    shape->n_bytes = sizeof *shape + n * (3 * sizeof(float) + sizeof(uint32_t));
    return shape;
}

/* ---- walls ------------------------------------------------------------------------------------------------------- */

static void put(struct mesh *mesh, size_t vertex, struct vec3 point)
{
    float *to = &mesh->positions_lps_mm[3 * vertex];
    to[0] = (float)point.x;
    to[1] = (float)point.y;
    to[2] = (float)point.z;
}

/* Rings of points, and two triangles for each side between two rings. Triangles wind outward. n_steps: from ring to
 * ring; a rasteriser looks at the box around a triangle, which is large around a long slanted one. */
static struct mesh *make_wall(const struct beam_shown *shown, const struct beam_opening *opening, double first_mm,
                              double last_mm, size_t n_steps, struct error *err)
{
    size_t n = opening->n;
    struct mesh *mesh = mesh_create((n_steps + 1) * n, 2 * n_steps * n, err);
    if (!mesh)
        return NULL;
    for (size_t ring = 0; ring <= n_steps; ring++)
        for (size_t i = 0; i < n; i++)
            put(mesh, ring * n + i,
                beam_opening_point(shown, opening, i,
                                   first_mm + (last_mm - first_mm) * (double)ring / (double)n_steps));
    for (size_t step = 0; step < n_steps; step++)
        for (size_t i = 0; i < n; i++) {
            uint32_t a = (uint32_t)(step * n + i), b = (uint32_t)(step * n + opening->next[i]), c = (uint32_t)(a + n),
                     d = (uint32_t)(b + n);
            const uint32_t corners[6] = { a, b, c, b, d, c };
            memcpy(&mesh->indices[6 * (step * n + i)], corners, sizeof corners);
        }
    mesh_measure_bounds(mesh);
    return mesh;
}

struct shape *beam_wall_shape(const struct beam_drawn *beam, const struct beam_opening *opening, struct error *err)
{
    struct mesh *mesh =
        make_wall(&beam->shown, opening, beam->opening_first_mm, beam->opening_last_mm, WALL_STEPS, err);
    if (!mesh || !mesh_make_normals(mesh, 1, err)) {
        mesh_unref(mesh);
        return NULL;
    }
    struct shape *shape = mem_new(sizeof *shape);
    *shape = (struct shape){ .kind = SHAPE_TRIANGLES,
                             .is_faceted = !opening->is_round,
                             .mesh = mesh,
                             .bounds_lps_mm = mesh->bounds_lps_mm,
                             .n_bytes = sizeof *shape + mesh->n_vertices * 6 * sizeof(float) +
                                        mesh->n_triangles * 3 * sizeof(uint32_t) };
    atomic_init(&shape->references, 1);
    return shape;
}

/* ---- on a plane -------------------------------------------------------------------------------------------------- */

/* True if a dashed section shows this point: dashes go around the beam, or along it on a plane that runs along it. */
static bool is_in_dash(const struct beam_drawn *beam, const struct plane *plane, struct vec3 point)
{
    const double steep = 0.3; /* sine of the angle between plane and beam */
    struct plane across = beam_plane(&beam->shown, 0);
    struct vec3 p = vec3_sub(point, across.origin_lps_mm);
    double phase = fabs(vec3_dot(beam->shown.direction, plane->normal)) > steep
                       ? atan2(vec3_dot(p, across.up), vec3_dot(p, across.right)) / (2 * MATH_PI) * ROUND_DASHES
                       : vec3_dot(p, beam->shown.direction) / (dash_period * beam->size_mm);
    return phase - floor(phase) < dash_part;
}

static bool add_dashes(const struct beam_drawn *beam, const struct plane *plane, struct vec3 a, struct vec3 b,
                       struct cut_lines *lines, struct error *err)
{
    struct vec3 along = vec3_sub(b, a);
    int n = (int)ceil(vec3_length(along) / (0.1 * dash_period * beam->size_mm));
    bool is_good = true;
    for (int i = 0; is_good && i < n; i++) {
        struct vec3 from = vec3_add(a, vec3_scale(along, (double)i / n)),
                    to = vec3_add(a, vec3_scale(along, (i + 1.0) / n));
        if (is_in_dash(beam, plane, vec3_scale(vec3_add(from, to), 0.5)))
            is_good = cut_lines_add(lines, from, to, err);
    }
    return is_good;
}

bool beam_add_section(const struct beam_drawn *beam, const struct beam_opening *opening, const struct plane *plane,
                      struct cut_lines *lines, struct error *err)
{
    const double slack_mm = 0.05; /* a plane through the entry itself cuts too */
    struct cut_lines whole = { 0 };
    struct mesh *mesh =
        make_wall(&beam->shown, opening, beam->opening_first_mm - slack_mm, beam->opening_last_mm + slack_mm, 1, err);
    bool is_good = mesh && cut_mesh(mesh, NULL, plane, &whole, err);
    for (size_t i = 0; is_good && i < whole.n; i++) {
        double(*ends)[3] = whole.ends_lps_mm[i];
        struct vec3 a = vec3(ends[0][0], ends[0][1], ends[0][2]), b = vec3(ends[1][0], ends[1][1], ends[1][2]);
        is_good = beam->shown.is_draft ? add_dashes(beam, plane, a, b, lines, err) : cut_lines_add(lines, a, b, err);
    }
    cut_lines_finish(&whole);
    mesh_unref(mesh);
    return is_good;
}

/* Where along a..b, 0 to 1, its height above the plane is this; not-a-number or beyond: nowhere. */
static double share_at(double height_a_mm, double height_b_mm, double height_mm)
{
    return (height_mm - height_a_mm) / (height_b_mm - height_a_mm);
}

static bool project_segment(struct vec3 a, struct vec3 b, const struct plane *plane, double reach_mm,
                            struct cut_lines *near, struct cut_lines *far, struct error *err)
{
    double ha = plane_height_mm(plane, a), hb = plane_height_mm(plane, b),
           t0 = share_at(ha, hb, ha < hb ? -reach_mm : reach_mm), t1 = share_at(ha, hb, ha < hb ? reach_mm : -reach_mm);
    struct vec3 p = plane_nearest(plane, a), along = vec3_sub(plane_nearest(plane, b), p);
    if (fabs(hb - ha) < 1e-9) {
        t0 = fabs(ha) <= reach_mm ? 0 : 1;
        t1 = 1;
    }
    t0 = fmin(fmax(t0, 0), 1);
    t1 = fmin(fmax(t1, 0), 1);
    const double stops[4] = { 0, t0, t1, 1 };
    bool is_good = true;
    for (int i = 0; is_good && i < 3; i++)
        if (stops[i] < stops[i + 1])
            is_good = cut_lines_add(i == 1 ? near : far, vec3_add(p, vec3_scale(along, stops[i])),
                                    vec3_add(p, vec3_scale(along, stops[i + 1])), err);
    return is_good;
}

bool beam_project(const struct cut_lines *lines, const struct plane *plane, double reach_mm, struct cut_lines *near,
                  struct cut_lines *far, struct error *err)
{
    bool is_good = true;
    for (size_t i = 0; is_good && i < lines->n; i++) {
        double(*ends)[3] = lines->ends_lps_mm[i];
        is_good = project_segment(vec3(ends[0][0], ends[0][1], ends[0][2]), vec3(ends[1][0], ends[1][1], ends[1][2]),
                                  plane, reach_mm, near, far, err);
    }
    return is_good;
}

bool beam_add_crossing(const struct beam_drawn *beam, const struct plane *plane, double radius_mm,
                       struct cut_lines *lines, struct error *err)
{
    enum { N_SIDES = 24 };
    double across = vec3_dot(beam->shown.direction, plane->normal),
           along_mm = -plane_height_mm(plane, beam->shown.entry_lps_mm) / across;
    if (fabs(across) < BEAM_ALONG || along_mm < beam->first_mm || along_mm > beam->last_mm)
        return true;
    struct plane at = *plane;
    at.origin_lps_mm = beam_point(&beam->shown, along_mm);
    bool is_good = true;
    for (int i = 0; is_good && i < N_SIDES; i++) {
        double from = 2 * MATH_PI * i / N_SIDES, to = 2 * MATH_PI * (i + 1) / N_SIDES;
        is_good = cut_lines_add(lines, plane_point(&at, radius_mm * cos(from), radius_mm * sin(from)),
                                plane_point(&at, radius_mm * cos(to), radius_mm * sin(to)), err);
    }
    return is_good;
}

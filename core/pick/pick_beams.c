/* Finds the lines of beams near a pixel. */
#include "core/pick/pick_beams.h"

#include <math.h>
#include <string.h>

/* Homogeneous clip coordinates. */
struct clip_point {
    double x, y, z, w;
};

static struct clip_point clip_point(const struct mat4 *m, struct vec3 p)
{
    const double *a = m->m;
    return (struct clip_point){ a[0] * p.x + a[4] * p.y + a[8] * p.z + a[12],
                                a[1] * p.x + a[5] * p.y + a[9] * p.z + a[13],
                                a[2] * p.x + a[6] * p.y + a[10] * p.z + a[14],
                                a[3] * p.x + a[7] * p.y + a[11] * p.z + a[15] };
}

/* Shortens a line to its part beyond the near plane; false: none of it is. */
static bool cut_near(const struct mat4 *m, struct vec3 *a, struct vec3 *b)
{
    struct clip_point ca = clip_point(m, *a), cb = clip_point(m, *b);
    double da = ca.z + ca.w, db = cb.z + cb.w;
    if (da < 0 && db < 0)
        return false;
    if (da >= 0 && db >= 0)
        return true;
    struct vec3 cut = vec3_add(*a, vec3_scale(vec3_sub(*b, *a), da / (da - db)));
    *(da < 0 ? a : b) = cut;
    return true;
}

/* The point of a line, wholly before the eye, that is nearest to a place in the picture, and how far it is. */
static double nearest_px(const struct snapshot *snapshot, const struct camera *camera, struct vec3 a, struct vec3 b,
                         double px, double py, struct vec3 *point)
{
    const double half_width = snapshot->view.size_px[0] / 2.0, half_height = snapshot->view.size_px[1] / 2.0;
    struct clip_point ca = clip_point(&camera->clip_from_lps_mm, a), cb = clip_point(&camera->clip_from_lps_mm, b);
    double ax = (ca.x / ca.w + 1) * half_width, ay = (1 - ca.y / ca.w) * half_height,
           bx = (cb.x / cb.w + 1) * half_width, by = (1 - cb.y / cb.w) * half_height, dx = bx - ax, dy = by - ay,
           length2 = dx * dx + dy * dy, s = length2 > 0 ? ((px - ax) * dx + (py - ay) * dy) / length2 : 0;
    s = fmin(fmax(s, 0), 1);
    *point = vec3_add(a, vec3_scale(vec3_sub(b, a), s * ca.w / ((1 - s) * cb.w + s * ca.w)));
    return hypot(ax + s * dx - px, ay + s * dy - py);
}

static size_t add(struct pick_beam_hit hits[BEAMS_DRAWN_MAX], size_t n, struct pick_beam_hit hit)
{
    size_t at = n;
    while (at > 0 && hits[at - 1].px > hit.px)
        at--;
    memmove(&hits[at + 1], &hits[at], (n - at) * sizeof hits[0]);
    hits[at] = hit;
    return n + 1;
}

size_t pick_beams(const struct snapshot *snapshot, const struct camera *camera, double px, double py,
                  struct pick_beam_hit hits[BEAMS_DRAWN_MAX])
{
    struct beam_drawn drawn[BEAMS_DRAWN_MAX];
    size_t n_drawn = beams_drawn(snapshot->plan, &snapshot->scene, &snapshot->fits, drawn), n = 0;
    for (size_t i = 0; i < n_drawn; i++) {
        struct vec3 a = beam_point(&drawn[i].shown, drawn[i].first_mm),
                    b = beam_point(&drawn[i].shown, drawn[i].last_mm);
        struct pick_beam_hit hit = { .subject = drawn[i].subject };
        if (!beam_line_is_drawn(&drawn[i], &snapshot->view) ||
            (!snapshot_is_pane(snapshot) && !cut_near(&camera->clip_from_lps_mm, &a, &b)))
            continue;
        hit.px = nearest_px(snapshot, camera, a, b, px, py, &hit.point_lps_mm);
        if (hit.px <= PICK_BEAM_PX)
            n = add(hits, n, hit);
    }
    return n;
}

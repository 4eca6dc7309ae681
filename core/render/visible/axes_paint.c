/* The patient axes as lines over the picture. They are not hidden by what lies before them, so how strong they are says
 * where they run: faint inside the plan's box, and weaker where they point away from the viewer. */
#include "core/render/visible/axes_paint.h"

#include <math.h>

#include "core/render/visible/axes_numbers.h"
#include "core/render/visible/visible.h"
#include "core/scene/axes.h"

static const uint32_t halo_rgb = 0x07080a, halo_on_light_rgb = 0xf4f6f8;
static const double halo_px = 1, faint = 0.3, plain = 0.95, away = 0.55;

/* A stroke of width_px pixels of the full picture, and its rim. */
struct stroke {
    double width_px, rim_px;
};
static struct stroke stroke_of(const struct space_pen *pen, double width_px)
{
    const double width = fmax(1, width_px * pen->scale);
    return (struct stroke){ width, width + 2 * halo_px * pen->scale };
}

static uint32_t halo_of(const struct space_pen *pen)
{
    return visible_ground_is_light(pen->snapshot) ? halo_on_light_rgb : halo_rgb;
}

/* Part of an axis from where the axes meet, 0 .. 1. */
static void add_part(const struct space_pen *pen, struct vec3 meet, struct vec3 end, double from, double to,
                     double width_px)
{
    struct vec3 along = vec3_sub(end, meet);
    space_pen_line(pen, vec3_add(meet, vec3_scale(along, from)), vec3_add(meet, vec3_scale(along, to)), width_px);
}

/* Ticks each cm from the first end of a line, square to it in the picture. */
static void add_ticks(const struct space_pen *pen, struct vec3 from, struct vec3 to, double width_px)
{
    enum { LONG_EVERY = 5, MOST = 400 };
    static const double step_mm = 10, short_px = 3, long_px = 6;
    struct vec3 along = vec3_sub(to, from);
    const double length_mm = vec3_length(along);
    for (int i = 1; i <= MOST && i * step_mm <= length_mm; i++) {
        struct vec3 at = vec3_add(from, vec3_scale(along, i * step_mm / length_mm));
        struct paint_point a, b;
        if (!space_pen_place(pen, at, &a) || !space_pen_place(pen, vec3_add(at, vec3_scale(along, 1 / length_mm)), &b))
            continue;
        const double dx = b.x - a.x, dy = b.y - a.y, run = hypot(dx, dy),
                     half = (i % LONG_EVERY ? short_px : long_px) * pen->scale;
        if (!(run > 0.05 * pen->scale)) /* the line is seen from its end */
            continue;
        paint_line(pen->paint, (struct paint_point){ a.x - half * dy / run, a.y + half * dx / run },
                   (struct paint_point){ a.x + half * dy / run, a.y - half * dx / run }, width_px);
    }
}

static void paint_lines(const struct space_pen *pen, uint32_t rgb, struct stroke stroke)
{
    const struct scene *scene = &pen->snapshot->scene;
    struct vec3 meet;
    struct axis_end ends[AXES_N_ENDS];
    if (!axes_of_scene(pen->snapshot->plan, scene, &meet, ends))
        return;
    for (int i = 0; i < AXES_N_ENDS; i++) {
        struct vec3 end = ends[i].at_lps_mm;
        double strength = vec3_dot(vec3_sub(end, meet), pen->camera->forward) > 0 ? away : 1;
        add_part(pen, meet, end, 0, ends[i].in_box, stroke.width_px);
        paint_flush(pen->paint, rgb, faint * strength);
        add_part(pen, meet, end, ends[i].in_box, 1, stroke.rim_px);
        paint_flush(pen->paint, halo_of(pen), plain * strength);
        add_part(pen, meet, end, ends[i].in_box, 1, stroke.width_px);
        if (scene->axes.ticks)
            add_ticks(pen, meet, end, stroke.width_px);
        paint_flush(pen->paint, rgb, plain * strength);
    }
}

static bool has_numbers(const struct scene *scene)
{
    return scene->axes.ticks && scene->axes.numbers;
}

/* Numbers the axes from where they meet to their ends. */
static void number_lines(const struct space_pen *pen, uint32_t rgb)
{
    const struct scene *scene = &pen->snapshot->scene;
    struct vec3 meet;
    struct axis_end ends[AXES_N_ENDS];
    struct axes_numbers_line lines[AXES_N_ENDS];
    if (!axes_of_scene(pen->snapshot->plan, scene, &meet, ends))
        return;
    for (int i = 0; i < AXES_N_ENDS; i++)
        lines[i] = (struct axes_numbers_line){ meet, ends[i].at_lps_mm, scene->axes.letters, NULL };
    axes_numbers_paint(pen, lines, AXES_N_ENDS, rgb, halo_of(pen), plain);
}

static struct vec3 corner_of(const struct box3 *box, int corner)
{
    return vec3(corner & 1 ? box->high.x : box->low.x, corner & 2 ? box->high.y : box->low.y,
                corner & 4 ? box->high.z : box->low.z);
}

/* The edges of the plan's box; those that meet in the corner farthest from the viewer are weaker. */
static void paint_box(const struct space_pen *pen, uint32_t rgb, struct stroke stroke)
{
    const struct box3 *box = &pen->snapshot->plan->bounds_lps_mm;
    const struct vec3 f = pen->camera->forward;
    const int farthest = (f.x > 0 ? 1 : 0) + (f.y > 0 ? 2 : 0) + (f.z > 0 ? 4 : 0);
    if (box3_is_empty(box) || !vec3_is_finite(box->low) || !vec3_is_finite(box->high))
        return;
    for (int corner = 0; corner < 8; corner++)
        for (int axis = 1; axis < 8; axis *= 2) {
            const int other = corner | axis;
            if (other == corner)
                continue;
            space_pen_line(pen, corner_of(box, corner), corner_of(box, other), stroke.width_px);
            if (pen->snapshot->scene.axes.ticks)
                add_ticks(pen, corner_of(box, corner), corner_of(box, other), stroke.width_px);
            paint_flush(pen->paint, rgb, plain * (corner == farthest || other == farthest ? away : 1));
        }
}

/* Along three edges of the box, of those along each axis the one that lies farthest out in the picture, away from the
 * box. */
static void number_box(const struct space_pen *pen, uint32_t rgb)
{
    const struct box3 *box = &pen->snapshot->plan->bounds_lps_mm;
    struct axes_numbers_line lines[3];
    struct paint_point middle;
    size_t n = 0;
    if (box3_is_empty(box) || !vec3_is_finite(box->low) || !vec3_is_finite(box->high) ||
        !space_pen_place(pen, vec3_scale(vec3_add(box->low, box->high), 0.5), &middle))
        return;
    const double away_px[2] = { middle.x, middle.y };
    for (int axis = 1; axis < 8; axis *= 2) {
        double farthest_px = -1;
        for (int corner = 0; corner < 8; corner++) {
            const struct vec3 from = corner_of(box, corner), to = corner_of(box, corner | axis);
            struct paint_point at;
            if (corner & axis || !space_pen_place(pen, vec3_scale(vec3_add(from, to), 0.5), &at))
                continue;
            const double px = hypot(at.x - middle.x, at.y - middle.y);
            if (px > farthest_px + 0.5 * pen->scale) /* of edges as far, the first */
                lines[n] = (struct axes_numbers_line){ from, to, false, away_px };
            farthest_px = fmax(farthest_px, px);
        }
        n += farthest_px >= 0;
    }
    axes_numbers_paint(pen, lines, n, rgb, halo_of(pen), plain);
}

static void paint_corner(const struct space_pen *pen, uint32_t rgb, struct stroke stroke)
{
    struct axes_corner corner;
    axes_in_corner(pen->camera, pen->width_px, pen->height_px, &corner);
    for (int i = 0; i < AXES_N_ARMS; i++) {
        const struct paint_point from = { corner.at[0], corner.at[1] },
                                 to = { corner.at[0] + corner.arm[i][0], corner.at[1] + corner.arm[i][1] };
        const double strength = plain * (corner.away[i] > 0 ? away : 1);
        paint_line(pen->paint, from, to, stroke.rim_px);
        paint_flush(pen->paint, halo_of(pen), strength);
        paint_line(pen->paint, from, to, stroke.width_px);
        paint_flush(pen->paint, rgb, strength);
    }
}

void axes_paint(const struct space_pen *pen, uint32_t rgb, double width_px)
{
    const struct stroke stroke = stroke_of(pen, width_px);
    switch (pen->snapshot->scene.axes.form) {
    case SCENE_AXES_FORM_MIDDLE:
    case SCENE_AXES_FORM_CROSSHAIR:
        paint_lines(pen, rgb, stroke);
        if (has_numbers(&pen->snapshot->scene))
            number_lines(pen, rgb);
        break;
    case SCENE_AXES_FORM_BOX:
        paint_box(pen, rgb, stroke);
        if (has_numbers(&pen->snapshot->scene))
            number_box(pen, rgb);
        break;
    case SCENE_AXES_FORM_CORNER: paint_corner(pen, rgb, stroke); break;
    }
}

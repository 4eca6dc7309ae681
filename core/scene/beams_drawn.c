/* The beams that a scene draws: which, how far they reach, and their openings. */
#include "core/scene/beams_drawn.h"

#include <math.h>
#include <string.h>

static const uint32_t beside_draft_rgb = 0x8b939b;

/* ---- how far they reach ------------------------------------------------------------------------------------------ */

/* Narrows t0..t1 to the part of a line along one axis that lies within low..high. */
static void narrow(double origin, double direction, double low, double high, double *t0, double *t1)
{
    if (fabs(direction) < 1e-12) {
        if (origin < low || origin > high)
            *t1 = -INFINITY;
        return;
    }
    double a = (low - origin) / direction, b = (high - origin) / direction;
    *t0 = fmax(*t0, fmin(a, b));
    *t1 = fmin(*t1, fmax(a, b));
}

/* False: the line passes the plan too far away to be drawn. */
static bool set_reach(const struct plan *plan, struct beam_drawn *beam)
{
    const struct beam_shown *shown = &beam->shown;
    const struct box3 *box = &plan->bounds_lps_mm;
    struct vec3 e = shown->entry_lps_mm, d = shown->direction;
    if (box3_is_empty(box) || !vec3_is_finite(box->low) || !vec3_is_finite(box->high))
        return false;
    struct vec3 middle = vec3_scale(vec3_add(box->low, box->high), 0.5);
    double diagonal = vec3_length(vec3_sub(box->high, box->low)), nearest = vec3_dot(vec3_sub(middle, e), d);
    double t0 = -INFINITY, t1 = INFINITY;
    if (!(vec3_length(vec3_sub(beam_point(shown, nearest), middle)) <= BEAMS_FARTHEST * diagonal))
        return false;
    narrow(e.x, d.x, box->low.x, box->high.x, &t0, &t1);
    narrow(e.y, d.y, box->low.y, box->high.y, &t0, &t1);
    narrow(e.z, d.z, box->low.z, box->high.z, &t0, &t1);
    if (!(t0 <= t1))
        t0 = t1 = nearest;
    double margin = BEAMS_MARGIN * diagonal, lead = BEAMS_LEAD * diagonal;
    double first = fmax(fmin(0, t0 - margin), t0 - lead);
    beam->size_mm = 0.03 * diagonal;
    beam->last_mm = fmin(fmax(shown->length_mm, t1) + margin, t1 + lead);
    beam->mark_mm = fmin(fmax(first, 0), beam->last_mm);
    beam->first_mm = fmin(first, beam->mark_mm - 1.5 * beam->size_mm);
    beam->opening_first_mm = beam->mark_mm;
    beam->opening_last_mm = fmax(beam->opening_first_mm, beam->last_mm - margin);
    return true;
}

/* ---- which ------------------------------------------------------------------------------------------------------- */

static struct scene_beam_look look_of(const struct scene *scene, const char *id)
{
    for (size_t i = 0; i < scene->beam.n_looks; i++)
        if (strcmp(scene->beam.looks[i].id, id) == 0)
            return scene->beam.looks[i].value;
    return scene_beam_look_default;
}

static bool knows_opening(const struct plan *plan, const struct beam_shown *shown)
{
    struct beam_opening opening;
    return beam_opening_of(plan, shown, &opening);
}

size_t beams_drawn(const struct plan *plan, const struct scene *scene, const struct scene_fits *fits,
                   struct beam_drawn drawn[BEAMS_DRAWN_MAX])
{
    struct beam_shown chosen;
    bool has_chosen = beam_shown_of(plan, scene, "", fits, &chosen), has_draft = has_chosen && chosen.is_draft;
    size_t n = 0;
    if (scene->beam.n_looks == 0 && !has_draft)
        return 0;
    for (size_t i = 0; i < plan->n_beams && n < BEAMS_DRAWN_MAX - 1; i++) {
        struct scene_beam_look look = look_of(scene, plan->beams[i].id);
        bool is_chosen = has_chosen && chosen.beam == (int)i;
        struct beam_drawn *beam = &drawn[n];
        if ((!look.visible && !(is_chosen && has_draft)) || (fits && !fit_is_used(&fits->beams[i])))
            continue;
        *beam = (struct beam_drawn){ .shown = beam_planned(plan, i),
                                     .subject = { SUBJECT_BEAM, i, 0 },
                                     .is_chosen = is_chosen && !has_draft,
                                     .is_beside_draft = is_chosen && has_draft,
                                     .color_rgb = is_chosen && has_draft ? beside_draft_rgb : look.color_rgb };
        beam->has_opening = look.opening && knows_opening(plan, &beam->shown);
        n += set_reach(plan, beam);
    }
    if (has_draft) {
        struct scene_beam_look look = look_of(scene, chosen.beam >= 0 ? plan->beams[chosen.beam].id : "");
        struct beam_drawn *beam = &drawn[n];
        *beam = (struct beam_drawn){
            .shown = chosen, .subject = { SUBJECT_BEAM, 0, 1 }, .is_chosen = true, .color_rgb = look.color_rgb
        };
        beam->has_opening = look.opening && knows_opening(plan, &chosen);
        n += set_reach(plan, beam);
    }
    return n;
}

bool beam_line_is_drawn(const struct beam_drawn *beam, const struct view *view)
{
    return !(view->kind == SCENE_KIND_BEAM && beam->is_chosen);
}

bool beam_opening_is_drawn(const struct beam_drawn *beam, const struct view *view)
{
    return beam->has_opening && !(view->kind == SCENE_KIND_BEAM && beam->is_chosen && view->beam.has_aperture_mm);
}

size_t beams_n_translucent(const struct plan *plan, const struct scene *scene, const struct scene_fits *fits)
{
    struct beam_drawn drawn[BEAMS_DRAWN_MAX];
    size_t n = beams_drawn(plan, scene, fits, drawn), n_openings = 0;
    for (size_t i = 0; i < n; i++)
        n_openings += drawn[i].has_opening;
    return scene->beam.opacity > 0 && scene->beam.opacity < 1 ? n_openings : 0;
}

struct box3 beams_box(const struct plan *plan, const struct scene *scene, const struct scene_fits *fits)
{
    struct beam_drawn drawn[BEAMS_DRAWN_MAX];
    struct beam_opening opening;
    struct box3 box = box3_empty();
    size_t n = beams_drawn(plan, scene, fits, drawn);
    for (size_t i = 0; i < n; i++) {
        const struct beam_drawn *beam = &drawn[i];
        box3_add(&box, beam_point(&beam->shown, beam->first_mm));
        box3_add(&box, beam_point(&beam->shown, beam->last_mm));
        size_t n_points = beam->has_opening && beam_opening_of(plan, &beam->shown, &opening) ? opening.n : 0;
        for (size_t p = 0; p < n_points; p++) {
            box3_add(&box, beam_opening_point(&beam->shown, &opening, p, beam->opening_first_mm));
            box3_add(&box, beam_opening_point(&beam->shown, &opening, p, beam->opening_last_mm));
        }
    }
    return box;
}

struct vec3 beam_label_lps_mm(const struct beam_drawn *beam)
{
    return beam_point(&beam->shown, beam->first_mm);
}

/* ---- openings ---------------------------------------------------------------------------------------------------- */

/* Makes the points from first on a polygon. */
static void close_polygon(struct beam_opening *opening, size_t first)
{
    for (size_t i = first; i < opening->n; i++)
        opening->next[i] = (uint16_t)(i + 1 < opening->n ? i + 1 : first);
}

static void make_round(const struct beam_shown *shown, struct beam_opening *opening)
{
    struct plane plane = beam_plane(shown, shown->length_mm);
    double radius_mm = shown->aperture_mm / 2;
    opening->is_round = true;
    opening->n = BEAM_ROUND_SIDES;
    for (size_t i = 0; i < opening->n; i++) {
        double angle = 2 * MATH_PI * (double)i / BEAM_ROUND_SIDES;
        opening->points_lps_mm[i] = plane_point(&plane, radius_mm * cos(angle), radius_mm * sin(angle));
    }
    close_polygon(opening, 0);
}

/* Maps the collimator's axes of a planned beam to the plane across the beam shown, which may be its draft. */
struct placing {
    struct plane from, to; /* beam_plane of both */
    const struct beam_delivery *delivery;
};

static void add_point(const struct placing *placing, double x_mm, double y_mm, struct beam_opening *opening)
{
    struct vec3 p = vec3_add(vec3_scale(placing->delivery->collimator_x_lps, x_mm),
                             vec3_scale(placing->delivery->collimator_y_lps, y_mm));
    opening->points_lps_mm[opening->n++] =
        plane_point(&placing->to, vec3_dot(p, placing->from.right), vec3_dot(p, placing->from.up));
}

static void place_outline(const struct placing *placing, struct beam_opening *opening)
{
    const struct beam_delivery *delivery = placing->delivery;
    const struct beam_outline *outline = &delivery->outline;
    const double *x = delivery->opening_x_mm, *y = delivery->opening_y_mm;
    for (size_t polygon = 0; polygon < outline->n_polygons; polygon++) {
        size_t first = opening->n;
        for (size_t i = beam_outline_begin(outline, polygon); i < outline->ends[polygon]; i++)
            add_point(placing, outline->points_mm[i][0], outline->points_mm[i][1], opening);
        close_polygon(opening, first);
    }
    if (opening->n > 0 || !(x[0] < x[1]) || !(y[0] < y[1]))
        return;
    for (int i = 0; i < 4; i++)
        add_point(placing, x[i == 1 || i == 2], y[i >= 2], opening);
    close_polygon(opening, 0);
}

bool beam_opening_of(const struct plan *plan, const struct beam_shown *shown, struct beam_opening *opening)
{
    opening->n = 0;
    opening->is_round = opening->is_from_source = false;
    if (shown->aperture_mm > 0)
        make_round(shown, opening);
    else if (shown->beam >= 0 && plan->beams[shown->beam].has_delivery) {
        struct beam_shown planned = beam_planned(plan, (size_t)shown->beam);
        const struct placing placing = { beam_plane(&planned, 0), beam_plane(shown, shown->length_mm),
                                         &plan->beams[shown->beam].delivery };
        opening->is_from_source = true;
        place_outline(&placing, opening);
    }
    return opening->n > 0;
}

struct vec3 beam_opening_point(const struct beam_shown *shown, const struct beam_opening *opening, size_t i,
                               double along_mm)
{
    struct vec3 point = opening->points_lps_mm[i];
    if (!opening->is_from_source)
        return vec3_add(point, vec3_scale(shown->direction, along_mm - shown->length_mm));
    return vec3_add(shown->entry_lps_mm, vec3_scale(vec3_sub(point, shown->entry_lps_mm), along_mm / shown->length_mm));
}

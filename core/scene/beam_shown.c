/* The beam that a scene shows, and planes across it. */
#include "core/scene/beam_shown.h"

#include <math.h>
#include <string.h>

static bool is_used(const struct scene_fits *fits, size_t beam)
{
    return !fits || fit_is_used(&fits->beams[beam]);
}

static int beam_index(const struct plan *plan, const char *id, const struct scene_fits *fits)
{
    for (size_t i = 0; i < plan->n_beams; i++)
        if (id[0] == 0 ? is_used(fits, i) : strcmp(plan->beams[i].id, id) == 0)
            return (int)i;
    return -1;
}

static void set_line(struct beam_shown *shown, struct vec3 entry_lps_mm, struct vec3 target_lps_mm)
{
    struct vec3 line = vec3_sub(target_lps_mm, entry_lps_mm);
    shown->entry_lps_mm = entry_lps_mm;
    shown->target_lps_mm = target_lps_mm;
    shown->length_mm = vec3_length(line);
    shown->direction = vec3_normalize(line);
}

struct beam_shown beam_planned(const struct plan *plan, size_t beam)
{
    const struct beam *planned = &plan->beams[beam];
    struct beam_shown shown = { .beam = (int)beam, .aperture_mm = planned->aperture_mm };
    set_line(&shown, planned->entry_lps_mm, planned->target_lps_mm);
    return shown;
}

bool beam_shown_of(const struct plan *plan, const struct scene *scene, const char *id, const struct scene_fits *fits,
                   struct beam_shown *shown)
{
    const struct scene_beam_draft *draft = &scene->beam.draft;
    int beam = beam_index(plan, id[0] ? id : scene->beam.id, fits);
    bool is_draft = !id[0] && draft->enabled && !(draft->shows_planned && beam >= 0) &&
                    vec3_length(vec3_sub(draft->line.target_mm, draft->line.entry_mm)) >= BEAM_SHOWN_MIN_LENGTH_MM;
    if ((beam < 0 && (!is_draft || scene->beam.id[0])) || (beam >= 0 && !is_draft && !is_used(fits, (size_t)beam)))
        return false;
    if (beam >= 0 && !is_used(fits, (size_t)beam))
        beam = -1; /* the draft of a beam that is not used takes nothing from it */
    *shown = beam >= 0 ? beam_planned(plan, (size_t)beam) : (struct beam_shown){ .beam = -1, .aperture_mm = NAN };
    if (is_draft) {
        shown->is_draft = true;
        set_line(shown, draft->line.entry_mm, draft->line.target_mm);
        if (draft->line.has_aperture_mm)
            shown->aperture_mm = draft->line.aperture_mm;
    }
    return true;
}

struct vec3 beam_point(const struct beam_shown *beam, double along_mm)
{
    return vec3_add(beam->entry_lps_mm, vec3_scale(beam->direction, along_mm));
}

struct plane beam_plane(const struct beam_shown *beam, double along_mm)
{
    const struct vec3 d = beam->direction;
    struct vec3 towards = vec3(0, 0, 1);
    if (hypot(d.x, d.y) < BEAM_POLE)
        towards = vec3(0, -1, 0);
    struct vec3 up = vec3_normalize(vec3_sub(towards, vec3_scale(d, vec3_dot(towards, d))));
    return (struct plane){ beam_point(beam, along_mm), vec3_cross(d, up), up, vec3_scale(d, -1) };
}

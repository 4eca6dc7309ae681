/* Lists the isodose surfaces that a snapshot shows. */
#include "core/scene/isodoses.h"

#include <math.h>
#include <string.h>

static enum surface_algorithm algorithm_of(const struct snapshot *snapshot)
{
    switch (snapshot->scene.surface.algorithm) {
    case SCENE_ALGORITHM_EIGHT_CELL: return SURFACE_EIGHT_CELL;
    case SCENE_ALGORITHM_MARCHING_CUBES:
    case SCENE_ALGORITHM_SMOOTH: break;
    }
    return SURFACE_MARCHING_CUBES; /* smooth is the same, of a field */
}

bool isodose_of_level(const struct snapshot *snapshot, const struct dose_scale *scale, size_t level,
                      struct isodose *isodose, struct error *why)
{
    const struct scene_dose_level *wanted = &snapshot->scene.dose.levels[level].value;
    memset(isodose, 0, sizeof *isodose);
    isodose->subject = (struct subject){ SUBJECT_ISODOSE, level, 0 };
    isodose->choice.dose = snapshot->dose_choice;
    isodose->choice.grid =
        snapshot->scene.dose.surfaces.grid == SCENE_ISODOSE_GRID_UNIVELS ? ISODOSE_ON_UNIVELS : ISODOSE_ON_DOSE;
    isodose->choice.algorithm = algorithm_of(snapshot);
    isodose->choice.value = dose_level_value(scale, wanted->unit, wanted->value);
    isodose->color_rgb = wanted->color_rgb;
    isodose->opacity = wanted->opacity;
    if (!isfinite(isodose->choice.value)) {
        *why = scale->why_no_reference;
        return false;
    }
    return true;
}

static bool is_shown(const struct snapshot *snapshot, size_t level)
{
    const struct scene_dose_level *wanted = &snapshot->scene.dose.levels[level].value;
    return wanted->visible && wanted->surface && wanted->opacity > 0;
}

/* True if surfaces are drawn in this view at all. */
static bool has_surfaces(const struct snapshot *snapshot)
{
    return snapshot->scene.dose.surfaces.visible && snapshot->has_dose_choice && !snapshot_is_pane(snapshot);
}

bool isodoses_are_shown(const struct snapshot *snapshot)
{
    bool is_any = false;
    for (size_t i = 0; has_surfaces(snapshot) && i < snapshot->scene.dose.n_levels; i++)
        is_any |= is_shown(snapshot, i);
    return is_any;
}

size_t isodoses_shown(const struct snapshot *snapshot, const struct dose_scale *scale,
                      struct isodose isodoses[ISODOSES_MAX])
{
    size_t n = 0;
    struct error why;
    for (size_t i = 0; has_surfaces(snapshot) && n < ISODOSES_MAX && i < snapshot->scene.dose.n_levels; i++)
        n += is_shown(snapshot, i) && isodose_of_level(snapshot, scale, i, &isodoses[n], &why);
    return n;
}

size_t isodoses_n_translucent(const struct snapshot *snapshot)
{
    size_t n = 0;
    for (size_t i = 0; has_surfaces(snapshot) && i < snapshot->scene.dose.n_levels; i++)
        n += is_shown(snapshot, i) && snapshot->scene.dose.levels[i].value.opacity < 1;
    return n;
}

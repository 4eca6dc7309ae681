/* Places beams. */
#include "core/scene/beam_place.h"

#include <stdlib.h>

#include "core/beam/sera_angles.h"
#include "core/region/ray.h"
#include "core/region/shortest.h"

#define FARTHEST_MM 100000.0 /* a draft's limit on any coordinate (proto/scene.json) */

/* The distance along a line at which it enters the first region; NaN: none. */
static bool find_skin(const struct region_set *regions, struct vec3 from_lps_mm, struct vec3 direction,
                      double *along_mm, struct error *err)
{
    struct ray_band *bands;
    size_t n;
    if (!ray_bands_all(regions, from_lps_mm, direction, &bands, &n, err))
        return false;
    *along_mm = n > 0 ? bands[0].from_mm : NAN;
    free(bands);
    return true;
}

bool beam_skin_of(const struct region_set *regions, struct vec3 entry_lps_mm, struct vec3 target_lps_mm,
                  struct beam_skin *skin, struct error *err)
{
    struct vec3 line = vec3_sub(target_lps_mm, entry_lps_mm);
    if (!find_skin(regions, entry_lps_mm, vec3_normalize(line), &skin->gap_mm, err))
        return false;
    skin->depth_mm = vec3_length(line) - skin->gap_mm;
    return true;
}

static bool put_entry(const struct beam_shown *beam, struct vec3 towards_source, double length_mm,
                      struct vec3 *entry_lps_mm, struct error *err)
{
    struct vec3 entry = vec3_add(beam->target_lps_mm, vec3_scale(towards_source, length_mm));
    if (!(fabs(entry.x) <= FARTHEST_MM && fabs(entry.y) <= FARTHEST_MM && fabs(entry.z) <= FARTHEST_MM))
        return error_set(err, ERROR_RANGE, "The beam would begin more than %g mm from the origin.", FARTHEST_MM);
    *entry_lps_mm = entry;
    return true;
}

/* needs_skin: the line must meet a region. */
static bool put_before_skin(const struct region_set *regions, const struct beam_shown *beam, struct vec3 towards_source,
                            double gap_mm, bool needs_skin, struct vec3 *entry_lps_mm, struct error *err)
{
    double skin_mm; /* from the target */
    if (isnan(gap_mm)) {
        struct beam_skin skin;
        if (!beam_skin_of(regions, beam->entry_lps_mm, beam->target_lps_mm, &skin, err))
            return false;
        gap_mm = skin.gap_mm < 0 ? 0 : skin.gap_mm;
    }
    if (!find_skin(regions, beam->target_lps_mm, vec3_scale(towards_source, -1), &skin_mm, err))
        return false;
    if (isnan(skin_mm) && needs_skin)
        return error_set(err, ERROR_RANGE, "The beam's axis meets no region, so there is no skin to keep a gap to.");
    if (isnan(skin_mm) || isnan(gap_mm))
        return put_entry(beam, towards_source, beam->length_mm, entry_lps_mm, err);
    double length_mm = gap_mm - skin_mm;
    if (length_mm < BEAM_SHOWN_MIN_LENGTH_MM)
        return error_set(err, ERROR_RANGE,
                         "The target lies outside of the patient, %.1f mm before the skin: with a gap of %.1f mm the "
                         "beam would begin behind its target.",
                         skin_mm, gap_mm);
    return put_entry(beam, towards_source, length_mm, entry_lps_mm, err);
}

bool beam_place_angles(const struct beam_shown *beam, double phi_deg, double theta_deg, struct vec3 *entry_lps_mm,
                       struct error *err)
{
    return put_entry(beam, sera_angles_towards_source(phi_deg, theta_deg), beam->length_mm, entry_lps_mm, err);
}

bool beam_place_gap(const struct region_set *regions, const struct beam_shown *beam, double gap_mm,
                    struct vec3 *entry_lps_mm, struct error *err)
{
    return put_before_skin(regions, beam, vec3_scale(beam->direction, -1), gap_mm, true, entry_lps_mm, err);
}

bool beam_place_through(const struct region_set *regions, const struct beam_shown *beam, struct vec3 point_lps_mm,
                        double gap_mm, struct vec3 *entry_lps_mm, struct error *err)
{
    struct vec3 way = vec3_sub(point_lps_mm, beam->target_lps_mm);
    if (vec3_length(way) < BEAM_SHOWN_MIN_LENGTH_MM)
        return error_set(err, ERROR_RANGE, "The point is the target itself: any beam runs through it.");
    return put_before_skin(regions, beam, vec3_normalize(way), gap_mm, false, entry_lps_mm, err);
}

bool beam_place_shortest(const struct region_set *regions, const struct beam_shown *beam, double gap_mm,
                         struct vec3 *entry_lps_mm, struct error *err)
{
    struct shortest_way way;
    struct error why = { 0 };
    if (!regions_shortest_way(regions, beam->target_lps_mm, &way, &why)) {
        if (why.code == ERROR_NOT_FOUND)
            return error_set(err, ERROR_RANGE, "The plan has no regions, so there is no skin to start from.");
        return error_set(err, why.code, "%s", why.text);
    }
    if (!(way.depth_mm > 0))
        return error_set(err, ERROR_RANGE, "The target lies outside of every region, with a free way to it.");
    return put_before_skin(regions, beam, way.outwards, gap_mm, true, entry_lps_mm, err);
}

/* The clip planes of a scene. */
#include "core/scene/clip.h"

#include <math.h>

#include "core/scene/beam_shown.h"

/* The plane with its normal towards what is cut off. */
static struct plane facing(struct plane plane, struct vec3 cut_off)
{
    if (vec3_dot(plane.normal, cut_off) < 0)
        plane.normal = vec3_sub(vec3(0, 0, 0), plane.normal);
    return plane;
}

static bool across_beam(const struct plan *plan, const struct scene *scene, const struct scene_fits *fits,
                        struct plane *plane)
{
    struct beam_shown beam;
    if (!beam_shown_of(plan, scene, scene->clip.beam.id, fits, &beam))
        return false;
    *plane = facing(plane_of_normal(beam_point(&beam, scene->clip.beam.along_mm), beam.direction),
                    vec3_scale(beam.direction, -1));
    return true;
}

size_t clip_planes(const struct plan *plan, const struct scene *scene, const struct scene_fits *fits,
                   struct clip_plane planes[CLIP_MAX])
{
    const struct scene_clip_style *clip = &scene->clip;
    const struct {
        enum clip_name name;
        enum scene_kind kind;
        const struct scene_clip_axis *axis;
    } axes[] = { { CLIP_AXIAL_LOW, SCENE_KIND_AXIAL, &clip->axial_low },
                 { CLIP_AXIAL_HIGH, SCENE_KIND_AXIAL, &clip->axial_high },
                 { CLIP_CORONAL_LOW, SCENE_KIND_CORONAL, &clip->coronal_low },
                 { CLIP_CORONAL_HIGH, SCENE_KIND_CORONAL, &clip->coronal_high },
                 { CLIP_SAGITTAL_LOW, SCENE_KIND_SAGITTAL, &clip->sagittal_low },
                 { CLIP_SAGITTAL_HIGH, SCENE_KIND_SAGITTAL, &clip->sagittal_high } };
    size_t n = 0;
    for (size_t i = 0; i < sizeof axes / sizeof axes[0]; i++) {
        if (!axes[i].axis->enabled)
            continue;
        struct plane plane = plane_of_kind(axes[i].kind, axes[i].axis->position_mm);
        bool is_low = axes[i].name % 2 == 0; /* cuts off what lies below its position */
        planes[n++] = (struct clip_plane){ axes[i].name, facing(plane, vec3_scale(plane.normal, is_low ? -1 : 1)),
                                           axes[i].axis->cap };
    }
    struct plane plane;
    if (clip->beam.enabled && across_beam(plan, scene, fits, &plane))
        planes[n++] = (struct clip_plane){ CLIP_BEAM, plane, clip->beam.cap };
    if (clip->free.enabled)
        planes[n++] =
            (struct clip_plane){ CLIP_FREE,
                                 facing(plane_of_normal(clip->free.origin_mm, clip->free.normal), clip->free.normal),
                                 clip->free.cap };
    return n;
}

bool clip_cuts(const struct clip_plane *planes, size_t n, struct vec3 point_lps_mm)
{
    for (size_t i = 0; i < n; i++)
        if (plane_height_mm(&planes[i].plane, point_lps_mm) > CLIP_SLACK_MM)
            return true;
    return false;
}

struct clip_range clip_ray(const struct clip_plane *planes, size_t n, struct vec3 origin_lps_mm, struct vec3 direction)
{
    struct clip_range range = { 0, INFINITY, -1, -1 };
    for (size_t i = 0; i < n; i++) {
        const struct plane *plane = &planes[i].plane;
        double rise = vec3_dot(direction, plane->normal), height_mm = plane_height_mm(plane, origin_lps_mm);
        if (fabs(rise) < 1e-12) {
            if (height_mm > CLIP_SLACK_MM)
                return (struct clip_range){ 0, 0, -1, -1 };
            continue;
        }
        double at_mm = -height_mm / rise;
        if (rise < 0 && at_mm > range.from_mm) {
            range.from_mm = at_mm;
            range.from = (int)i;
        } else if (rise > 0 && at_mm < range.to_mm) {
            range.to_mm = fmax(at_mm, 0);
            range.to = (int)i;
        }
    }
    return range;
}

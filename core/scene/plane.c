/* Planes in the patient: those of a scene, and their geometry. */
#include "core/scene/plane.h"

#include <string.h>

#include "core/scene/beam_shown.h"

struct plane plane_of_kind(enum scene_kind kind, double position_mm)
{
    double p = position_mm;
    switch (kind) {
    case SCENE_KIND_AXIAL: return (struct plane){ vec3(0, 0, p), vec3(1, 0, 0), vec3(0, -1, 0), vec3(0, 0, 1) };
    case SCENE_KIND_SAGITTAL: return (struct plane){ vec3(p, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1), vec3(1, 0, 0) };
    case SCENE_KIND_CORONAL:
    case SCENE_KIND_OBLIQUE:
    case SCENE_KIND_BEAM:
    case SCENE_KIND_BEAM_SLICE:
    case SCENE_KIND_3D: break;
    }
    return (struct plane){ vec3(0, p, 0), vec3(1, 0, 0), vec3(0, 0, 1), vec3(0, 1, 0) };
}

/* The kind of slice whose normal is nearest to a direction; of equally near ones the first of axial, coronal,
 * sagittal. */
static enum scene_kind nearest_kind(struct vec3 direction)
{
    double x = fabs(direction.x), y = fabs(direction.y), z = fabs(direction.z);
    return z >= x && z >= y ? SCENE_KIND_AXIAL : y >= x ? SCENE_KIND_CORONAL : SCENE_KIND_SAGITTAL;
}

struct plane plane_of_normal(struct vec3 origin_lps_mm, struct vec3 normal)
{
    normal = vec3_normalize(normal);
    enum scene_kind kind = nearest_kind(normal);
    struct plane nearest = plane_of_kind(kind, 0);
    double cosine = vec3_dot(normal, nearest.normal);
    if (cosine < 0)
        normal = vec3_scale(normal, -1);
    if (fabs(cosine) >= 1) {
        nearest.origin_lps_mm = vec3_scale(nearest.normal, vec3_dot(origin_lps_mm, nearest.normal));
        return nearest;
    }
    struct vec3 up = vec3_normalize(vec3_sub(nearest.up, vec3_scale(normal, vec3_dot(nearest.up, normal))));
    double side = vec3_dot(vec3_cross(nearest.right, nearest.up), nearest.normal); /* 1 or -1 */
    struct vec3 right = vec3_scale(vec3_cross(up, normal), side);
    return (struct plane){ origin_lps_mm, right, up, normal };
}

struct plane plane_of_view(const struct plan *plan, const struct scene *scene, const struct scene_fits *fits,
                           const struct view *view)
{
    const struct scene_slices *slices = &scene->image.slices;
    struct beam_shown beam;
    switch (view->kind) {
    case SCENE_KIND_CORONAL: return plane_of_kind(SCENE_KIND_CORONAL, slices->coronal.position_mm);
    case SCENE_KIND_SAGITTAL: return plane_of_kind(SCENE_KIND_SAGITTAL, slices->sagittal.position_mm);
    case SCENE_KIND_OBLIQUE:
        for (size_t i = 0; i < scene->image.n_obliques; i++)
            if (strcmp(scene->image.obliques[i].id, view->plane) == 0)
                return plane_of_normal(scene->image.obliques[i].value.origin_mm, scene->image.obliques[i].value.normal);
        break;
    case SCENE_KIND_BEAM:
        if (beam_shown_of(plan, scene, "", fits, &beam))
            return beam_plane(&beam, beam.length_mm);
        break;
    case SCENE_KIND_BEAM_SLICE:
        if (beam_shown_of(plan, scene, "", fits, &beam))
            return beam_plane(&beam, scene->beam.slice.along_mm);
        break;
    case SCENE_KIND_AXIAL:
    case SCENE_KIND_3D: break;
    }
    return plane_of_kind(SCENE_KIND_AXIAL, slices->axial.position_mm);
}

size_t planes_of_slices(const struct plan *plan, const struct scene *scene, const struct scene_fits *fits,
                        struct plane slices[PLANE_MAX_SLICES])
{
    const struct {
        enum scene_kind kind;
        const struct scene_slice *slice;
    } all[] = { { SCENE_KIND_AXIAL, &scene->image.slices.axial },
                { SCENE_KIND_CORONAL, &scene->image.slices.coronal },
                { SCENE_KIND_SAGITTAL, &scene->image.slices.sagittal } };
    size_t n = 0;
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++)
        if (all[i].slice->visible)
            slices[n++] = plane_of_kind(all[i].kind, all[i].slice->position_mm);
    for (size_t i = 0; i < scene->image.n_obliques && n + 1 < PLANE_MAX_SLICES; i++) {
        const struct scene_oblique *oblique = &scene->image.obliques[i].value;
        if (oblique->visible)
            slices[n++] = plane_of_normal(oblique->origin_mm, oblique->normal);
    }
    struct beam_shown beam;
    if (scene->beam.slice.visible && beam_shown_of(plan, scene, "", fits, &beam))
        slices[n++] = beam_plane(&beam, scene->beam.slice.along_mm);
    return n;
}

/* ---- geometry --------------------------------------------------------------------------------------------------- */

static bool vec3_equal(struct vec3 a, struct vec3 b)
{
    return !(a.x < b.x) && !(a.x > b.x) && !(a.y < b.y) && !(a.y > b.y) && !(a.z < b.z) && !(a.z > b.z);
}

bool plane_equal(const struct plane *a, const struct plane *b)
{
    return vec3_equal(a->origin_lps_mm, b->origin_lps_mm) && vec3_equal(a->right, b->right) &&
           vec3_equal(a->up, b->up) && vec3_equal(a->normal, b->normal);
}

struct plane plane_moved(const struct plane *plane, double distance_mm)
{
    struct plane moved = *plane;
    moved.origin_lps_mm = vec3_add(moved.origin_lps_mm, vec3_scale(moved.normal, distance_mm));
    return moved;
}

struct vec3 plane_forward(const struct plane *plane)
{
    return vec3_add(vec3_cross(plane->up, plane->right), vec3(0, 0, 0)); /* the sum makes every -0 a 0 */
}

struct vec3 plane_point(const struct plane *plane, double right_mm, double up_mm)
{
    return vec3_add(plane->origin_lps_mm, vec3_add(vec3_scale(plane->right, right_mm), vec3_scale(plane->up, up_mm)));
}

struct vec3 plane_nearest(const struct plane *plane, struct vec3 point_lps_mm)
{
    struct vec3 from_origin = vec3_sub(point_lps_mm, plane->origin_lps_mm);
    return plane_point(plane, vec3_dot(from_origin, plane->right), vec3_dot(from_origin, plane->up));
}

struct plane_reach plane_reach(const struct plane *plane, const struct box3 *box)
{
    struct plane_reach reach = { INFINITY, -INFINITY, INFINITY, -INFINITY, INFINITY, -INFINITY };
    for (int corner = 0; corner < 8; corner++) {
        struct vec3 p = vec3(corner & 1 ? box->high.x : box->low.x, corner & 2 ? box->high.y : box->low.y,
                             corner & 4 ? box->high.z : box->low.z);
        struct vec3 from_origin = vec3_sub(p, plane->origin_lps_mm);
        double right_mm = vec3_dot(from_origin, plane->right), up_mm = vec3_dot(from_origin, plane->up),
               height_mm = vec3_dot(from_origin, plane->normal);
        reach.low_right_mm = fmin(reach.low_right_mm, right_mm);
        reach.high_right_mm = fmax(reach.high_right_mm, right_mm);
        reach.low_up_mm = fmin(reach.low_up_mm, up_mm);
        reach.high_up_mm = fmax(reach.high_up_mm, up_mm);
        reach.low_mm = fmin(reach.low_mm, height_mm);
        reach.high_mm = fmax(reach.high_mm, height_mm);
    }
    return reach;
}

/* The axis or its opposite: the one whose largest component is positive. */
static struct vec3 towards_positive(struct vec3 axis)
{
    double x = fabs(axis.x), y = fabs(axis.y), z = fabs(axis.z);
    double largest = x >= y && x >= z ? axis.x : y >= z ? axis.y : axis.z;
    return largest < 0 ? vec3_sub(vec3(0, 0, 0), axis) : axis;
}

struct plane plane_upright(const struct plane *plane)
{
    struct plane upright = *plane;
    upright.right = towards_positive(plane->right);
    upright.up = towards_positive(plane->up);
    return upright;
}

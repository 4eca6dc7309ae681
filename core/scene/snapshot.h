#pragma once
/* A snapshot: plan, scene and view, frozen. A picture is a pure function of it. Also cameras and picking. Knows no JSON
 * and no GL. */
#include "core/derive/derive.h"
#include "core/math/vec.h"
#include "core/plan/plan.h"
#include "core/scene/plane.h"
#include "scene.h" /* generated from proto/scene.json */

struct snapshot {
    const struct plan *plan; /* borrowed; outlives every snapshot */
    struct derive *derived;  /* borrowed: the store of results computed from the plan; outlives every snapshot */
    struct scene scene;      /* owned */
    struct view view;        /* owned */
    uint32_t scene_revision;
    struct scene_region_style *styles;     /* owned; [n_regions] of the plan */
    int image;                             /* index of the image shown; -1: the plan has none */
    int dose;                              /* index of the dose shown; -1: the plan has none */
    struct plane pane;                     /* the plane of a slice pane; else unused */
    struct plane slices[PLANE_MAX_SLICES]; /* image slices shown in space, in the order of drawing */
    size_t n_slices;
    _Atomic int references;
};

/* A snapshot of derived's plan. Consumes scene and view, also on failure (their structs are emptied). Checks that the
 * plan has every region, image and dose that the scene names, and that the camera can be used: position != target, up
 * not along the line of sight.
 *   field   on failure the JSON pointer of the wrong field, "/regions/foo"
 *   errors  ERROR_NOT_FOUND, ERROR_RANGE */
NODISCARD struct snapshot *snapshot_create(struct derive *derived, struct scene *scene, struct view *view,
                                           uint32_t scene_revision, char field[128], struct error *err);
struct snapshot *snapshot_ref(const struct snapshot *snapshot);
void snapshot_unref(const struct snapshot *snapshot);

/* The scene a new room starts with. Every region is visible in its own colour; regions that contain others are
 * translucent (opacity 0.35 if outermost, else 0.45), the others opaque. The window is that of the first image. Slices
 * go through the centre of the innermost region, else of the plan; the axial one is visible if there is an image. Fills
 * scene, which scene_finish frees. */
void scene_for_plan(const struct plan *plan, struct scene *scene);

/* Index of the image that a scene shows; -1 if the plan has no image, or none of that id. */
int scene_image_index(const struct plan *plan, const struct scene *scene);
/* True if low values of the image shown are white: as the scene says, else as the image asks. Only if image >= 0. */
bool snapshot_is_low_white(const struct snapshot *snapshot);
/* True if the picture is a slice pane: a parallel view of the plane `pane`. Else it is a view into space. */
static inline bool snapshot_is_pane(const struct snapshot *snapshot)
{
    return snapshot->view.kind != SCENE_KIND_3D;
}

/* The camera that shows the whole plan. 3-D: all regions from the front, superior up; the image instead if the regions'
 * box is less than half as long. Slice panes: the whole first image, without one all regions. */
void camera_home(const struct plan *plan, enum scene_kind kind, struct scene_camera *camera);

/* A view's camera, resolved: unit axes in patient space and the projection. */
struct camera {
    struct vec3 eye_lps_mm, target_lps_mm;
    struct vec3 right, up, forward; /* axes of the picture; orthonormal, right = forward x up */
    bool is_parallel;
    double pixels_per_mm;   /* of the full-size view, in parallel projection; 0 in perspective */
    double near_mm, far_mm; /* from the eye along forward; they enclose the plan's bounds */
    struct mat4 clip_from_lps_mm, lps_mm_from_clip;
};
/* The camera of a snapshot. A slice pane's has the axes of its plane, and its target on the plane. */
void camera_resolve(const struct snapshot *snapshot, struct camera *camera);

/* What lies under a pixel of the full-size view. Computed from univels and slices, not from the picture. */
struct pick_hit {
    struct vec3 point_lps_mm;
    int region; /* index; -1: an image slice */
    double distance_mm;
};
enum { PICK_MAX_HITS = 32 };
/* Fills hits front to back, returns how many. Hits every region that the scene shows (visible, opacity > 0) as if it
 * were solid, whatever it is drawn as. On a slice pane: the point on the plane with the regions there, innermost first,
 * then the image. px, py: pixel centres are at + 0.5. */
size_t snapshot_pick(const struct snapshot *snapshot, double px, double py, struct pick_hit hits[PICK_MAX_HITS]);

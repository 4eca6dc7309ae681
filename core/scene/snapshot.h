#pragma once
/* What is asked to be seen, frozen: a plan, a scene and a view. A picture is a pure function of it. No JSON, no GL. */
#include "core/derive/derive.h"
#include "core/math/vec.h"
#include "core/plan/plan.h"
#include "core/scene/plane.h"
#include "scene.h" /* generated from proto/scene.json */

struct snapshot {
    const struct plan *plan; /* borrowed; outlives every snapshot */
    struct derive *derived;  /* borrowed, of the plan: what is computed from it on demand; outlives every snapshot */
    struct scene scene;      /* owned */
    struct view view;        /* owned */
    uint32_t scene_revision;
    struct scene_region_style *styles;     /* owned; by region index of the plan */
    int image;                             /* index of the image shown, or -1 when the plan has none */
    int dose;                              /* the same of the dose */
    struct plane pane;                     /* of a slice pane: the plane it shows */
    struct plane slices[PLANE_MAX_SLICES]; /* of the image, shown in space; in the order of drawing */
    size_t n_slices;
    _Atomic int references;
};

/* A snapshot of the plan that derived is of. Takes scene and view, on failure too (their structs are emptied). Checks
 * them against the plan: every region id known, the image's and the dose's known (or empty), a camera that can be used
 * (position != target, up not along the line of sight). errors ERROR_NOT_FOUND, ERROR_RANGE; field names the place as a
 * JSON pointer, "/regions/foo" */
NODISCARD struct snapshot *snapshot_create(struct derive *derived, struct scene *scene, struct view *view,
                                           uint32_t scene_revision, char field[128], struct error *err);
struct snapshot *snapshot_ref(const struct snapshot *snapshot);
void snapshot_unref(const struct snapshot *snapshot);

/* The scene a new room starts with: every region visible in its own colour, those that contain others translucent
 * (outermost 0.35, inner ones 0.45), innermost opaque; the first image's window; slices through the centre of the
 * innermost region (else of the plan), axial visible when there is an image. Fills scene, which scene_finish frees. */
void scene_for_plan(const struct plan *plan, struct scene *scene);

/* The image a scene shows: its index, or -1 when the plan has none or none of that id. */
int scene_image_index(const struct plan *plan, const struct scene *scene);
/* Whether low values of the image shown are white: as the scene says, else as the image asks. image >= 0 */
bool snapshot_is_low_white(const struct snapshot *snapshot);
/* Whether the picture is a slice pane: parallel, looking at the snapshot's pane. Else it looks into space. */
static inline bool snapshot_is_pane(const struct snapshot *snapshot)
{
    return snapshot->view.kind != SCENE_KIND_3D;
}

/* The home camera of a kind: all regions (the image where they are less than half as long), from the front, superior
 * up; slice panes the whole image or regions. */
void camera_home(const struct plan *plan, enum scene_kind kind, struct scene_camera *camera);

/* A view's camera worked out: unit axes in patient space and the projection. */
struct camera {
    struct vec3 eye_lps_mm, target_lps_mm;
    struct vec3 right, up, forward; /* of the picture, orthonormal, right = forward x up */
    bool is_parallel;
    double pixels_per_mm;   /* parallel: of the full-size view; 0 in perspective */
    double near_mm, far_mm; /* along forward from the eye, around the plan's bounds */
    struct mat4 clip_from_lps_mm, lps_mm_from_clip;
};
/* A slice pane's camera looks at its plane: right and up are the plane's, the target is on it. */
void camera_resolve(const struct snapshot *snapshot, struct camera *camera);

/* What lies under a pixel of the full-size view, front to back, worked out on univels and slices, not on the picture.
 */
struct pick_hit {
    struct vec3 point_lps_mm;
    int region; /* index, or -1 for an image slice */
    double distance_mm;
};
enum { PICK_MAX_HITS = 32 };
/* Fills hits, returns how many. Only what the scene shows (visible, opacity > 0),
 * whatever it is drawn as: between lines or points too. Slice panes: the point on the slice with the
 * regions there, innermost first. px, py: pixel centres are at + 0.5. */
size_t snapshot_pick(const struct snapshot *snapshot, double px, double py, struct pick_hit hits[PICK_MAX_HITS]);

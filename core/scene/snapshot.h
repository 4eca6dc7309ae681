#pragma once
/* A snapshot: plan, scene and view, frozen. A picture is a pure function of it. Also the scene a new room starts with.
 * Knows no JSON and no GL. */
#include "core/derive/derive.h"
#include "core/math/vec.h"
#include "core/plan/plan.h"
#include "core/scene/beam_shown.h"
#include "core/scene/camera.h"
#include "core/scene/clip.h"
#include "core/scene/dose_choice.h"
#include "core/scene/fit_use.h"
#include "core/scene/plane.h"
#include "scene.h" /* generated from proto/scene.json */

struct snapshot {
    const struct plan *plan; /* borrowed; outlives every snapshot */
    struct derive *derived;  /* borrowed: the store of results computed from the plan; outlives every snapshot */
    struct scene scene;      /* owned */
    struct view view;        /* owned */
    uint32_t scene_revision;
    struct scene_region_style *styles;     /* owned; [n_regions] of the plan */
    struct scene_fits fits;                /* owned: which parts are used; decides all that follows */
    int image;                             /* index of the image shown; -1: the plan has none that is used */
    int blend;                             /* index of the image that is blended over it; -1: none that is used */
    int dose;                              /* index of the dose that is named, used or not; -1: the plan has none */
    bool has_dose_choice;                  /* the dose can be shown: dose_choice is valid, and it is used */
    struct dose_choice dose_choice;        /* the field shown */
    struct error dose_why;                 /* unless has_dose_choice: why nothing is shown */
    bool has_beam;                         /* beam is valid */
    struct beam_shown beam;                /* the chosen beam, or its draft */
    struct box3 beyond_lps_mm;             /* encloses the beams that a view into space draws; empty: none */
    struct plane pane;                     /* the plane of a slice pane; else unused */
    struct plane slices[PLANE_MAX_SLICES]; /* image slices shown in space, in the order of drawing */
    size_t n_slices;
    struct clip_plane clips[CLIP_MAX]; /* enabled clip planes; a slice pane has none */
    size_t n_clips;
    _Atomic int references;
};

/* A snapshot of derived's plan. Consumes scene and view, also on failure (their structs are emptied). Checks that the
 * plan has every region, image and dose that the scene names, and that the camera can be used: position != target, up
 * not along the line of sight.
 *   field   on failure the JSON pointer of the wrong field, "/regions/foo"
 *   errors  ERROR_NOT_FOUND, ERROR_RANGE */
NODISCARD struct snapshot *snapshot_create(struct derive *derived, struct scene *scene, struct view *view,
                                           uint32_t scene_revision, char field[128], struct error *err);
/* Like snapshot_create, with parts that people accepted (copied; NULL: none). Regions that are not used are not
 * visible. */
NODISCARD struct snapshot *snapshot_create_accepted(struct derive *derived, struct scene *scene, struct view *view,
                                                    const struct acceptances *acceptances, uint32_t scene_revision,
                                                    char field[128], struct error *err);
/* Width of the full picture in the unit of width_px and of sizes of points: its pixels, unless the view has a
 * pixel_ratio. */
static inline double snapshot_line_width(const struct snapshot *snapshot)
{
    return snapshot->view.size_px[0] / snapshot->view.pixel_ratio;
}
struct snapshot *snapshot_ref(const struct snapshot *snapshot);
void snapshot_unref(const struct snapshot *snapshot);

/* The scene a new room starts with. Every region is visible in its own colour; regions that contain others are
 * translucent (opacity 0.35 if outermost, else 0.45), the others opaque. The first image is the first that is not of
 * another patient, the first target one that is used with it. The window is that of the first image. Slices
 * go through the middle of the first target (core/region/target.h), else of the first image, else of the plan, and
 * through the centre of the first image's voxel there. If there is an image the axial slice is visible in space, and
 * all three are in a plan without regions. Fills scene, which scene_finish frees. */
void scene_for_plan(const struct plan *plan, struct scene *scene);

/* Index of the image that a scene shows; -1 if the plan has no image, or none of that id. */
int scene_image_index(const struct plan *plan, const struct scene *scene);
/* True if low values of the image shown are white: as the scene says, else as the image asks. Only if image >= 0. */
bool snapshot_is_low_white(const struct snapshot *snapshot);
/* Window and colours of an image that is not the one shown: as the scene's looks say, else its own first window, grey.
 */
struct scene_image_look snapshot_look_of(const struct snapshot *snapshot, size_t image);
/* The beam that a beam's-eye view or a beam slice is of; NULL: the view is of another kind, or there is no beam. */
static inline const struct beam_shown *snapshot_beam(const struct snapshot *snapshot)
{
    bool is_of_beam = snapshot->view.kind == SCENE_KIND_BEAM || snapshot->view.kind == SCENE_KIND_BEAM_SLICE;
    return is_of_beam && snapshot->has_beam ? &snapshot->beam : NULL;
}
/* The snapshot's camera, resolved. */
static inline void camera_resolve(const struct snapshot *snapshot, struct camera *camera)
{
    camera_of_view_beyond(snapshot->plan, &snapshot->view, &snapshot->pane, snapshot_beam(snapshot),
                          &snapshot->beyond_lps_mm, camera);
}
/* True if the picture is a slice pane: a parallel view of the plane `pane`. Else it is a view into space. */
static inline bool snapshot_is_pane(const struct snapshot *snapshot)
{
    return camera_is_of_pane(snapshot->view.kind);
}

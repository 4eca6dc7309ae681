#pragma once
/* The patient axes in a 3-D view, in each form of axes_form (proto/scene.json), and where their letters stand. The page
 * places the letters itself (web/js/pane/orientation.js). */
#include "core/plan/plan.h"
#include "core/scene/camera.h"

/* Half the length of an axis, in sizes of the box along it: the ends stand out of the box. */
#define AXES_REACH 0.6

enum { AXES_N_ENDS = 6 };
struct axis_end {
    char letter; /* L R P A S I */
    struct vec3 at_lps_mm;
    double in_box; /* part of the axis from where the axes meet that lies within the box, 0..1 */
};
/* The middle of the plan's bounds, and the ends in the order of the letters: middle +- AXES_REACH times the box's size
 * along L, P and S. Returns false, and fills nothing, if the bounds are empty. */
bool axes_of_plan(const struct plan *plan, struct vec3 *middle_lps_mm, struct axis_end ends[AXES_N_ENDS]);
/* Fills in the same of the scene's form: through the crosshair they meet there and end at the same heights. */
bool axes_of_scene(const struct plan *plan, const struct scene *scene, struct vec3 *meet_lps_mm,
                   struct axis_end ends[AXES_N_ENDS]);

/* The form corner: three arms L, P and S of equal length in the patient, in the lower left corner of the picture. */
enum { AXES_N_ARMS = 3 };
struct axes_corner {
    double at[2];                  /* where the arms meet, pixels, y down */
    double arm[AXES_N_ARMS][2];    /* from there to the ends */
    double letter[AXES_N_ARMS][2]; /* the same to the middles of the letters L, P, S */
    double away[AXES_N_ARMS];      /* -1..1: how far an arm points away from the viewer */
};
void axes_in_corner(const struct camera *camera, double width_px, double height_px, struct axes_corner *corner);

#pragma once
/* A beam as a scene shows it, the plan's or its draft, and the axes of pictures along it. Any thread. */
#include "core/plan/plan.h"
#include "core/scene/fit_use.h"
#include "core/scene/plane.h"

#define BEAM_SHOWN_MIN_LENGTH_MM 1e-3 /* of a draft; a shorter one is none */

struct beam_shown {
    int beam;      /* index in the plan; -1: a draft in a plan without beams */
    bool is_draft; /* the line is the scene's draft, not the plan's beam */
    struct vec3 entry_lps_mm, target_lps_mm;
    struct vec3 direction; /* from entry to target; of unit length */
    double length_mm;      /* from entry to target */
    double aperture_mm;    /* diameter; NaN: unknown or not round */
};

/* The beam of this id; "": the one that the scene chooses, else the first that is used, as its draft if that is enabled
 * and not put aside to show the planned beam. fits: beams that are not used are none, but their drafts, which a person
 * made, are; NULL: all are used. False: there is none. */
bool beam_shown_of(const struct plan *plan, const struct scene *scene, const char *id, const struct scene_fits *fits,
                   struct beam_shown *shown);
/* The plan's beam itself, whatever is drafted. */
struct beam_shown beam_planned(const struct plan *plan, size_t beam);

/* A point of the beam's line; 0: the entry, positive towards the target and beyond. */
struct vec3 beam_point(const struct beam_shown *beam, double along_mm);

/* The plane across a beam at a point of its line, as the beam's-eye view sees it: its picture looks along the beam.
 * up is patient superior, as far as it lies in the plane; where the beam runs within BEAM_POLE of the patient's axis,
 * patient anterior. The normal points against the beam. */
#define BEAM_POLE 0.01 /* sine of the angle */
struct plane beam_plane(const struct beam_shown *beam, double along_mm);

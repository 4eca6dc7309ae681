#pragma once
/* The beams that a scene draws, how far their lines and openings reach, and where their labels stand. Knows no pixels.
 * Any thread. */
#include "core/derive/subject.h"
#include "core/scene/beam_shown.h"

/* Distances along the line count from the entry towards the target. */
struct beam_drawn {
    struct beam_shown shown;
    struct subject subject; /* SUBJECT_BEAM; key 1: the draft */
    bool is_chosen;         /* the beam that views along a beam are of */
    bool is_beside_draft;   /* the planned beam of the draft: drawn grey */
    bool has_opening;       /* its aperture is wanted and known */
    uint32_t color_rgb;
    double first_mm, last_mm; /* ends of the line: outside the patient */
    double opening_first_mm,
        opening_last_mm; /* ends of the aperture: from the entry to the far side of the plan's box */
    double mark_mm;      /* the arrow head's tip: the entry, or first_mm if that lies beyond it */
    double size_mm;      /* of arrow heads, crosses and dashes: in proportion to the plan's box */
};

/* A line starts at the entry, but at least BEAMS_MARGIN before the plan's box (plan.h) and at most BEAMS_LEAD before
 * it, with a shaft for its arrow head, and ends BEAMS_MARGIN behind it or behind the target. All are parts of the box's
 * diagonal. A line that passes the box's middle farther than BEAMS_FARTHEST is not drawn. */
#define BEAMS_MARGIN 0.1
#define BEAMS_LEAD 0.5
#define BEAMS_FARTHEST 2.0

/* Room for the beams of all looks, a draft and its planned beam. */
enum { BEAMS_DRAWN_MAX = 64 + 2 };
/* Fills the beams in the order of the plan, then a draft; returns how many. Kind and ring of the view count: its own
 * beam's line and opening are left out by the caller (beam_line_is_drawn, beam_opening_is_drawn). */
size_t beams_drawn(const struct plan *plan, const struct scene *scene, const struct scene_fits *fits,
                   struct beam_drawn drawn[BEAMS_DRAWN_MAX]);
/* A beam's-eye view does not draw the line of its own beam, which would be a dot; with the aperture ring it does not
 * draw its opening either. */
bool beam_line_is_drawn(const struct beam_drawn *beam, const struct view *view);
bool beam_opening_is_drawn(const struct beam_drawn *beam, const struct view *view);
/* How many openings are translucent, whatever the view is. */
size_t beams_n_translucent(const struct plan *plan, const struct scene *scene, const struct scene_fits *fits);

/* Encloses lines and openings of all beams that the scene draws; empty: it draws none. */
struct box3 beams_box(const struct plan *plan, const struct scene *scene, const struct scene_fits *fits);

/* Where a beam's label stands: the end of its line before the patient. */
struct vec3 beam_label_lps_mm(const struct beam_drawn *beam);

/* ---- openings ---------------------------------------------------------------------------------------------------- */

/* The outline of a beam's opening in the plane across the beam through its target: closed polygons. A round aperture is
 * one of BEAM_ROUND_SIDES points on its circle. */
enum { BEAM_ROUND_SIDES = 128, BEAM_OPENING_MAX = BEAM_OUTLINE_MAX_POINTS };
struct beam_opening {
    struct vec3 points_lps_mm[BEAM_OPENING_MAX];
    uint16_t next[BEAM_OPENING_MAX]; /* the point that follows in the polygon of each */
    size_t n;
    bool is_round;
    bool is_from_source; /* widens in proportion to the distance from the entry; else it is a cylinder */
};
/* False: neither is known. A diameter comes first; else the outline of the planned beam (struct beam_outline), else
 * the hull of its opening; a draft takes these along in the axes of beam_plane. */
bool beam_opening_of(const struct plan *plan, const struct beam_shown *shown, struct beam_opening *opening);
/* A point of the opening's wall: of the outline's point i, at a distance along the line. */
struct vec3 beam_opening_point(const struct beam_shown *shown, const struct beam_opening *opening, size_t i,
                               double along_mm);

#pragma once
/* The crosshair and the aperture ring over pictures along a beam: beam's-eye views and panes of the beam slice. The
 * same places and rules hold for the picture (overlay.h), the numbers in annotated snapshots and those of the page. */
#include "core/render/visible/paint.h"
#include "core/scene/snapshot.h"

/* Widths, lengths and gaps in pixels of the full-size view. */
#define BEAM_EYE_RING_PX 2.2
#define BEAM_EYE_LINE_PX 1.2
/* The crosshair leaves its middle free, where there is a dot, and a margin for the letters at the picture's edges: this
 * much, and no more than a tenth of that side. */
#define BEAM_EYE_GAP_PX 8.0
#define BEAM_EYE_MARGIN_PX 36.0
/* Ticks are left out where those of their kind would be closer together than this. */
#define BEAM_EYE_LEAST_STEP_PX 4.0

/* Places are in pixels of the full-size view, y down. */
struct beam_eye_marks {
    struct paint_point middle; /* of crosshair and ring: where the beam's axis meets the target's depth, or the slice */
    double pixels_per_mm;      /* there; 0: that lies behind the eye, and the crosshair has no ticks */
    double size_px[2];
    bool has_crosshair;
    double ring_mm; /* diameter; 0: none */
    /* For a beam's-eye view of a draft: the planned beam's entry, and the diameter of its aperture's ring: ring_mm if
     * that aperture is not round. 0: no ring */
    bool has_planned;
    double planned_mm;
    struct paint_point planned_entry;
    struct plane planned_plane; /* across the planned beam at its entry */
};

/* False: the snapshot's picture has neither crosshair nor ring. camera: the snapshot's, resolved. */
bool beam_eye_marks_of(const struct snapshot *snapshot, const struct camera *camera, struct beam_eye_marks *marks);

/* Half the length of the n-th tick, n times 5 mm from the middle: 9 px each 50 mm, 6 px each 10 mm, else 3 px; 0:
 * none, because such ticks would be too close together. */
double beam_eye_tick_px(const struct beam_eye_marks *marks, int64_t fives);

/* A number beside the crosshair. */
struct beam_eye_number {
    struct paint_point at; /* its middle */
    int mm;
};
enum { BEAM_EYE_MAX_NUMBERS = 12 };
/* The numbers 20, 40 and 80 on all four arms, below and to the right, where these reach so far and neighbours are at
 * least twice text_px apart. Returns how many. */
size_t beam_eye_numbers(const struct beam_eye_marks *marks, double text_px,
                        struct beam_eye_number numbers[BEAM_EYE_MAX_NUMBERS]);

/* Paints the marks over a picture that has `scale` pixels for one of the full-size view. */
void beam_eye_paint(const struct beam_eye_marks *marks, const struct camera *camera, double scale, struct paint *paint);

#pragma once
/* Isodose lines of a snapshot: of which doses and values, and the lattices that they are found on. Any thread. */
#include "core/derive/dose_plane.h"
#include "core/scene/dose_scale.h"

enum { ISOLINE_MAX_LEVELS = 32 };

struct isoline_level {
    size_t index; /* in the scene's dose.levels */
    double value; /* in the fields' unit */
    uint32_t color_rgb;
};

/* A dose whose lines are drawn. */
struct isoline_dose {
    struct dose_field *field; /* one reference; NULL: there is none */
    struct dose_choice choice;
};

struct isoline_scene {
    struct isoline_dose doses[2]; /* the one shown, and the one that it is compared with: its lines are dashed */
    bool is_drawn[2];
    struct isoline_level levels[ISOLINE_MAX_LEVELS]; /* the lowest value first: higher ones are drawn over it */
    size_t n_levels;
    double reference;     /* 100 %, in the fields' unit; NAN: unknown */
    struct error failure; /* ERROR_MEMORY: memory ran out, and lines are missing that could be there. Kept by finish */
};
/* Both have the levels of the dose shown, at the same values in Gy. Returns false if the snapshot's picture has no
 * isodose lines: they are not wanted, or there is nothing to show. A comparison by lines draws both doses' lines, one
 * by differences the second's, also without dose.lines.visible. May build fields. Finish it, on false it is empty. */
bool isoline_scene_init(struct isoline_scene *lines, const struct snapshot *snapshot);
void isoline_scene_finish(struct isoline_scene *lines);

/* A lattice in a plane without an end: sample (u, v) is at map(u, v, 0), for whole numbers first .. last. Where the
 * plane is parallel to slices of the dose's grid its samples are among the grid's, or the grid's among its samples. */
struct isoline_lattice {
    struct affine lps_mm_from_uv;
    int32_t first[2], last[2];
    bool is_by_slice;
};
/* A rectangle of a plane, in its coordinates along right and up. */
struct isoline_window {
    double low_mm[2], high_mm[2];
};
/* The window that a pane's picture shows of its plane. */
struct isoline_window isoline_window_of_pane(const struct plane *plane, const struct camera *camera);
/* All of the plane. */
struct isoline_window isoline_window_of_plane(void);

/* The lattice of steps of at most ISOLINE_STEP_PX pixels, for what the window shows of the grid. Planes and pixel sizes
 * have lattices that lie on each other wherever their windows are. Returns false if the plane misses the grid there. */
#define ISOLINE_STEP_PX 2.0
bool isoline_lattice_of(const struct grid *grid, const struct plane *plane, const struct isoline_window *window,
                        double mm_per_px, struct isoline_lattice *lattice);
/* True if a has the points of b, and more. */
bool isoline_lattice_holds(const struct isoline_lattice *a, const struct isoline_lattice *b);
struct dose_lattice isoline_lattice_samples(const struct isoline_lattice *lattice);

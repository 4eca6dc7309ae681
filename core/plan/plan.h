#pragma once
/* One opened plan: images, regions, doses, beams, tracks, and the report of what was noticed. Plain data, frozen after
 * loading and const from then on; what is computed from it is kept in core/derive. Knows no files, sockets, scene, GL.
 */
#include "core/beam/beam.h"
#include "core/dose/curve.h"
#include "core/dose/dose.h"
#include "core/region/region.h"
#include "core/report/report.h"
#include "core/track/track.h"
#include "core/volume/volume.h"

enum {
    PLAN_MAX_IMAGES = 16,
    PLAN_MAX_DOSES = 16,
    PLAN_MAX_BEAMS = 64,
    PLAN_MAX_CURVES = 16,
    PLAN_MAX_LEVELS = 32,
    PLAN_MAX_COLORS = 256
};

struct plan_image {
    char id[64];
    char name[128];    /* for people; "" when the files give none */
    char modality[16]; /* "CT", "MR", ...; "" unknown */
    char unit[8];      /* "HU" for CT, "" else */
    struct volume *volume;
    double window_center, window_width; /* a first window that suits the values; within the limits above */
    bool is_inverted; /* low values are meant to be white (DICOM's MONOCHROME1); the values are as in the file */
};

/* How the program the plan comes from showed doses; nothing here is the patient's. */
struct plan_level {
    double percent;
    uint8_t rgb[3];
};
struct plan_preferences {
    struct plan_level levels[PLAN_MAX_LEVELS]; /* isodose levels, in the file's order */
    size_t n_levels;
    uint8_t colors[PLAN_MAX_COLORS][3]; /* a colour map, lowest first */
    size_t n_colors;
};

struct plan {
    char id[64], name[128], note[512];
    bool is_phantom;
    struct plan_image images[PLAN_MAX_IMAGES];
    size_t n_images;
    struct region_set regions;
    struct dose doses[PLAN_MAX_DOSES];
    size_t n_doses;
    struct beam beams[PLAN_MAX_BEAMS];
    size_t n_beams;
    struct track_set tracks;
    struct dose_curve curves[PLAN_MAX_CURVES];
    size_t n_curves;
    struct plan_preferences preferences;
    struct report report;
    struct box3 bounds_lps_mm; /* of all regions, else of all images and doses, else around the beams' targets */
    int64_t load_us;
    bool is_from_cache; /* the folder's files were not read this time */
};

/* An empty plan of this id, to be filled: by core/load, or by a test. */
struct plan *plan_create(const char *id);
void plan_destroy(struct plan *plan);

/* What lies at a patient point. */
struct probe_dose {
    size_t dose, component;
    double value; /* in the dose's unit */
};
struct plan_probe {
    struct vec3 point_lps_mm;
    size_t regions[32]; /* every region that holds the point, innermost first */
    size_t n_regions;
    bool has_image[PLAN_MAX_IMAGES];
    double image_value[PLAN_MAX_IMAGES];
    struct probe_dose doses[PLAN_MAX_DOSES * DOSE_N_QUANTITIES];
    size_t n_doses;
};
void plan_probe(const struct plan *plan, struct vec3 point_lps_mm, struct plan_probe *probe);

#pragma once
/* One opened plan: images, regions, doses, beams, tracks, and the report of what was noticed. Plain data, frozen after
 * loading and const from then on; what is computed from it is kept in core/derive. Knows no files, sockets, scene, GL.
 */
#include "core/beam/beam.h"
#include "core/dose/curve.h"
#include "core/dose/dose.h"
#include "core/plan/origin.h"
#include "core/plan/statement.h"
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
    double window_center, window_width; /* the window shown first; within the limits of core/volume/window.h */
    bool is_inverted; /* low values are shown white (DICOM's MONOCHROME1); the voxels are as in the file */
};

/* How the planning program showed doses: preferences of its user, not data of the patient. */
struct plan_level {
    double percent;
    uint8_t rgb[3];
};
struct plan_preferences {
    struct plan_level levels[PLAN_MAX_LEVELS]; /* isodose levels in the file's order */
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
    struct part_origin image_origins[PLAN_MAX_IMAGES], dose_origins[PLAN_MAX_DOSES], beam_origins[PLAN_MAX_BEAMS];
    struct part_origin *region_origins; /* [n_region_origins], owned; of a region: [region.origin - 1] */
    size_t n_region_origins;
    struct part_origin tracks_origin;
    struct plan_patient patients[ORIGIN_MAX_PATIENTS];
    size_t n_patients;
    struct plan_statement statement; /* of a person, of whom the plan is; of the kind STATEMENT_NONE: there is none */
    struct treatment_plan treatment_plans[ORIGIN_MAX_TREATMENT_PLANS];
    size_t n_treatment_plans;
    struct plan_registration registrations[ORIGIN_MAX_REGISTRATIONS];
    size_t n_registrations;
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
    /* The body, which slices show at first; empty, with finite ends: all of the image. */
    struct box3 body_lps_mm;
    int64_t load_us;
    bool is_from_cache; /* read from the cache instead of the folder's files */
};

/* An empty plan with this id, for core/load or a test to fill. */
struct plan *plan_create(const char *id);
/* After every store (core/derive) of the plan is destroyed. */
void plan_destroy(struct plan *plan);

/* The regions, image values and doses at a patient point. A region, image or dose is named by its index in the plan. */
struct probe_dose {
    size_t dose, component;
    double value; /* in the dose's unit */
};
struct plan_probe {
    struct vec3 point_lps_mm;
    size_t regions[32]; /* the regions that hold the point, innermost first; further ones are left out */
    size_t n_regions;
    bool has_image[PLAN_MAX_IMAGES]; /* the point lies within the image; by image */
    double image_value[PLAN_MAX_IMAGES];
    struct probe_dose doses[PLAN_MAX_DOSES * DOSE_N_QUANTITIES];
    size_t n_doses;
};
/* Images and doses are interpolated linearly; a dose with a mask has no value where the mask is 0. Fills nothing but
 * the point if it is not finite. Any thread. */
void plan_probe(const struct plan *plan, struct vec3 point_lps_mm, struct plan_probe *probe);

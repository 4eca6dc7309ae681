#pragma once
/* One opened plan: images, regions, doses, beams, tracks, and the report of what was noticed. Frozen after loading.
 * Builds shapes of its regions on demand and keeps them. Knows no files, no sockets, no scene, no GL. */
#include <stdatomic.h>

#include "core/beam/beam.h"
#include "core/dose/curve.h"
#include "core/dose/dose.h"
#include "core/region/region.h"
#include "core/report/report.h"
#include "core/surface/shape.h"
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
    bool is_from_cache;         /* the folder's files were not read this time */
    struct plan_shapes *shapes; /* kept ones; see plan_shape */
};

/* An empty plan of this id, for who fills it: the loader, or a test. */
struct plan *plan_create(const char *id);
void plan_destroy(struct plan *plan);

/* Detail of a surface: FULL is every univel; LIGHT is for moving pictures: the mask reduced until all surfaces of the
 * plan by the same algorithm stay together under PLAN_LIGHT_TRIANGLES (or the reduction reaches 8): so many univels
 * become one along their shortest edge, along longer ones as many as make it no longer (mask_reduce). */
enum surface_detail { SURFACE_FULL, SURFACE_LIGHT };
enum { PLAN_LIGHT_TRIANGLES = 80000, PLAN_MAX_REFUSALS = 1024 };

/* What was built, for people to read. */
struct surface_facts {
    size_t n_triangles, n_vertices; /* vertices of triangles or of lines */
    size_t n_lines, n_points;       /* closed outlines; points */
    double area_mm2, volume_mm3; /* of triangles; volume: enclosed, not-a-number for a fan, whose triangles overlap */
    double univel_volume_mm3;    /* of the mask the shape is made from, descendants included */
    uint64_t n_univels;
    double distance_mean_mm, distance_max_mm; /* by plan_shape_distance; not-a-number: not measured */
    double build_ms;
    uint64_t n_bytes;   /* of memory */
    uint32_t reduction; /* univels in one, along their shortest edge: 1 for FULL, and for a LIGHT one that any reduction
                           would empty */
};

/* The shape of a region, built on first use and kept; triangles of a surface have vertex normals. Any thread; the first
 * caller builds, others wait. What was not used for longest is dropped when all that is kept exceeds the budget;
 * whoever holds a reference keeps it. Only surfaces have a LIGHT shape of their own, others are always FULL. By
 * SURFACE_EIGHT_CELL there may be no triangle.
 *
 *   key      what is wanted; need not be normalised
 *   facts    NULL: not wanted
 *   returns  one reference, the caller's; NULL on failure
 *   errors   ERROR_RANGE no such region, or one without a voxel; those of surface_make and shape_make */
NODISCARD struct shape *plan_shape(struct plan *plan, size_t region, const struct shape_key *key,
                                   enum surface_detail detail, struct surface_facts *facts, struct error *err);
/* Fills the distances of facts: of the shape's vertices from the border of the univels it was made from. Takes its
 * time, so it is asked for apart. errors those of shape_distance */
NODISCARD bool plan_shape_distance(const struct plan *plan, size_t region, const struct shape_key *key,
                                   const struct shape *shape, struct surface_facts *facts, struct error *err);
/* Whether a shape that failed with this code fails each time: because of what the region is, or by a written limit. */
bool plan_is_refusal(enum error_code code);
/* Whether it was tried before and cannot be had (PLAN_MAX_REFUSALS are remembered); fills why. Builds nothing. */
struct plan_want;
bool plan_shape_refused(struct plan *plan, const struct plan_want *want, struct error *why);
/* The same for surfaces, as their mesh. */
NODISCARD struct mesh *plan_surface(struct plan *plan, size_t region, enum surface_algorithm algorithm,
                                    enum surface_detail detail, struct surface_facts *facts, struct error *err);

/* Builds the shapes of several regions side by side, a thread each, in this order, for who asks for them later; what
 * fails is logged. go_on is asked at the beginning and before each that the calling thread takes, false ends the rest;
 * NULL: always. */
struct plan_want {
    size_t region;
    struct shape_key key;
    enum surface_detail detail;
};
void plan_build_shapes(struct plan *plan, const struct plan_want *wants, size_t n, bool (*go_on)(void *context),
                       void *context);
/* The same for surfaces, the largest region first. */
void plan_build_surfaces(struct plan *plan, const size_t *regions, size_t n, enum surface_algorithm algorithm,
                         enum surface_detail detail, bool (*go_on)(void *context), void *context);

/* Memory that kept shapes may take. */
#define PLAN_SHAPE_BUDGET_BYTES ((uint64_t)1 << 30) /* unless set otherwise */
struct plan_shape_usage {
    size_t n_shapes;
    uint64_t n_bytes, budget_bytes;
};
void plan_set_shape_budget(struct plan *plan, uint64_t n_bytes);
void plan_shape_usage(struct plan *plan, struct plan_shape_usage *usage);

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

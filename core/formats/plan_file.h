#pragma once
/* The content of plan.json and of lists of label names, as plain structs with their limits. Paths are relative to the
 * plan's folder and checked for form alone; "" and 0 stand for missing values. */
#include "core/beam/beam.h"
#include "core/dose/dose.h"
#include "core/formats/folder.h"
#include "core/region/region.h"

enum {
    PLAN_FILE_MAX_BYTES = 4 << 20,
    PLAN_FILE_MAX_IMAGES = 16,
    PLAN_FILE_MAX_DOSES = 16,
    PLAN_FILE_MAX_BEAMS = 64,
    PLAN_FILE_MAX_CURVES = 16,
    PLAN_FILE_MAX_PARTS = REGION_MAX, /* entries of "regions" */
    PLAN_FILE_MAX_TRACKS = 16,
    PLAN_FILE_MAX_PREFERENCES = 16,
    PLAN_FILE_MAX_BEAM_FILES = 16,
    PLAN_FILE_MAX_PAIRS = 1024, /* of the hierarchy */
    PLAN_FILE_MAX_LABELS = 65536
};

struct plan_file_image {
    char id[64];
    char path[FOLDER_NAME_SIZE];
    char header[FOLDER_NAME_SIZE]; /* the .qhd of a .qim; "" none */
    char modality[16];
    char name[128];                     /* for people; "" none */
    char value_unit[8];                 /* unit of the voxels' values, "HU"; "" none */
    bool is_inverted;                   /* low values are shown white */
    double window_center, window_width; /* first window, within the limits of window.h; width 0: none */
    double mm; /* length of one unit of a SERA header, instead of the header's own; 0: not given */
};
struct plan_file_region {
    char path[FOLDER_NAME_SIZE];
    char names[FOLDER_NAME_SIZE]; /* list of label names; "" none */
    char name[REGION_NAME_SIZE];  /* of a mask; "": the file holds labels, univels or contours */
    bool has_color;
    uint8_t rgb[3];
    double mm; /* as in struct plan_file_image */
};
#define PLAN_FILE_MAX_PPM 1e6 /* pure boron-10 */
struct plan_file_component {
    enum dose_quantity quantity;
    bool is_per_ppm, has_boron_ppm;
    double boron_ppm; /* boron-10 in blood that a total includes, 0 to PLAN_FILE_MAX_PPM */
    double reference; /* the value that counts as 100 %; 0: not given */
    char path[FOLDER_NAME_SIZE];
    char error[FOLDER_NAME_SIZE]; /* the statistical error, one standard deviation, in the unit of the values; "": none
                                   */
};
struct plan_file_dose {
    char id[64], name[64], unit[16], per[64];
    bool has_frame;
    enum dose_frame frame;
    char mask[FOLDER_NAME_SIZE];
    struct plan_file_component components[DOSE_N_QUANTITIES];
    size_t n_components;
};
struct plan_file_beams {
    char path[FOLDER_NAME_SIZE]; /* an RTPLAN, of which all beams are taken */
};
struct plan_file_tracks {
    char path[FOLDER_NAME_SIZE];
    double mm; /* length of one unit of the file; 0: not given */
};
struct plan_file_curve {
    char id[64], name[128], per[64];
    char path[FOLDER_NAME_SIZE];
};
/* The region inner lies directly inside the region outer. */
struct plan_file_pair {
    char outer[REGION_NAME_SIZE], inner[REGION_NAME_SIZE];
};

struct plan_file {
    char name[128], note[512];
    bool is_phantom;
    struct plan_file_image images[PLAN_FILE_MAX_IMAGES];
    size_t n_images;
    struct plan_file_region *regions;
    size_t n_regions;
    char hierarchy[FOLDER_NAME_SIZE]; /* a file; "" when pairs give the hierarchy, or nothing does */
    struct plan_file_pair *pairs;
    size_t n_pairs;
    struct plan_file_dose doses[PLAN_FILE_MAX_DOSES];
    size_t n_doses;
    struct beam beams[PLAN_FILE_MAX_BEAMS];
    size_t n_beams;
    struct plan_file_beams beam_files[PLAN_FILE_MAX_BEAM_FILES];
    size_t n_beam_files;
    struct plan_file_tracks tracks[PLAN_FILE_MAX_TRACKS];
    size_t n_tracks;
    struct plan_file_curve curves[PLAN_FILE_MAX_CURVES];
    size_t n_curves;
    char preferences[PLAN_FILE_MAX_PREFERENCES][FOLDER_NAME_SIZE];
    size_t n_preferences;
};
void plan_file_destroy(struct plan_file *file);

struct label_name {
    uint16_t value;
    bool has_color;
    uint8_t rgb[3];
    char name[REGION_NAME_SIZE];
    char parent[REGION_NAME_SIZE]; /* "" none */
    /* written by `beamroom convert`, so that a converted plan is the same when opened again */
    char id[REGION_ID_SIZE]; /* "" none; an entry with an id is a region even without a voxel */
    int place;               /* position among all regions of the plan, from 1; 0: none */
    double opacity;          /* above 0, up to 1; 0: none */
    bool is_target;          /* struct region's */
    bool has_tissue;
    struct label_tissue {
        double boron_ratio, cbe_boron, rbe_nitrogen, rbe_fast, rbe_gamma; /* not-a-number: not given */
    } tissue;
};
struct label_names {
    struct label_name *labels;
    size_t n;
    char file[FOLDER_NAME_SIZE]; /* name of the label map, in the same folder, that the list belongs to; "" not given */
};
void label_names_finish(struct label_names *names);

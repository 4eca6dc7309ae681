#pragma once
/* The particles a beam brings: spectrum and directions at a disk, and the delimiter between it and the patient. Plain
 * data; knows no file and no transport. */
#include <stdbool.h>
#include <stddef.h>

enum { SOURCE_MAX_GROUPS = 128, SOURCE_MAX_CUTS = 32 };
#define SOURCE_MAX_PER_CM2 1e30
#define SOURCE_MAX_CM 200.0

struct beam_spectrum {
    size_t n_groups;
    double bounds_ev[SOURCE_MAX_GROUPS + 1]; /* falling */
    double share[SOURCE_MAX_GROUPS];         /* of the current, by group; any sum above 0 */
    /* Lower ends of cosine intervals with equal current, falling from 1, by group. One cut at 1: all straight ahead. */
    double cuts[SOURCE_MAX_GROUPS][SOURCE_MAX_CUTS];
    double per_cm2;      /* particles through the disk for each cm2 and unit of the source; 0: none */
    bool is_by_lethargy; /* groups below 0.11 eV are flat in lethargy, not Maxwell's at 0.0253 eV */
};
/* A hole that narrows like a cone, through polyethylene with lithium. */
struct beam_delimiter {
    double length_cm; /* 0: none */
    double exit_radius_cm, entrance_radius_cm;
    double natural_lithium_from_cm; /* radius from which lithium is natural, not enriched in lithium-6 */
};
struct beam_source {
    char name[128];
    struct beam_spectrum neutrons, photons;
    size_t n_cuts;         /* of each group */
    double radius_cm;      /* of the disk */
    double to_aperture_cm; /* from the disk to the aperture plane, where the delimiter ends */
    struct beam_delimiter delimiter;
};

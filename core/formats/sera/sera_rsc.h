#pragma once
/* Reads the preferences of SERA's programs: Sera3d.rsc (colours and opacities of bodies, contour levels),
 * seradose_prefs.rsc (contour levels with colour names), colour maps .cmap, and body_data.txt (tissue data by the names
 * of bodies). Each fills its part of one struct; keys of the user interface are skipped. Works on bytes in memory. */
#include "core/region/region.h"
#include "core/report/report.h"

enum { RSC_MAX_BYTES = 1 << 20, RSC_MAX_BODIES = 256, RSC_MAX_LEVELS = 32, RSC_MAX_COLORS = 256 };

struct rsc_body {
    char name[REGION_NAME_SIZE];
    bool has_color;
    uint8_t rgb[3];
    double opacity; /* 0..1 */
    /* tissue data; not-a-number: not given */
    double boron_ratio, cbe_boron, rbe_nitrogen, rbe_fast, rbe_gamma;
};
struct rsc_level {
    double percent;
    uint8_t rgb[3];
};

struct rsc {
    struct rsc_body bodies[RSC_MAX_BODIES]; /* the body "Default" stands for all others */
    size_t n_bodies;
    struct rsc_level levels[RSC_MAX_LEVELS];
    size_t n_levels;
    uint8_t colors[RSC_MAX_COLORS][3]; /* the colour map, lowest value first */
    size_t n_colors;
};

/* Reads a file as its name says: .cmap, .txt (tissue data), else preferences. Invalid values are counted and reported.
 *   errors  ERROR_FORMAT nothing in the file is what its name says; ERROR_LIMIT too many entries; the text names the
 *           line */
NODISCARD bool rsc_parse(const uint8_t *data, size_t size, const char *name, struct rsc *rsc, struct report *report,
                         struct error *err);

/* Finds a body by name; case does not matter, and '-', '_' and blanks are equal. NULL when there is none. */
const struct rsc_body *rsc_find(const struct rsc *rsc, const char *name);

#pragma once
/* SERA's preferences: Sera3d.rsc (bodies' colours and opacities, contour levels), seradose_prefs.rsc (contour levels by
 * the names of colours), colour maps .cmap, and body_data.txt (tissue data by the bodies' names). Each fills its part
 * of one struct; keys about windows and mice are passed over. Works on bytes in memory. */
#include "core/region/region.h"
#include "core/report/report.h"

enum { RSC_MAX_BYTES = 1 << 20, RSC_MAX_BODIES = 256, RSC_MAX_LEVELS = 32, RSC_MAX_COLORS = 256 };

struct rsc_body {
    char name[REGION_NAME_SIZE];
    bool has_color;
    uint8_t rgb[3];
    double opacity; /* 0..1 */
    /* tissue data; not-a-number where there is none */
    double boron_ratio, cbe_boron, rbe_nitrogen, rbe_fast, rbe_gamma;
};
struct rsc_level {
    double percent;
    uint8_t rgb[3];
};

struct rsc {
    struct rsc_body bodies[RSC_MAX_BODIES]; /* "Default" stands for all others */
    size_t n_bodies;
    struct rsc_level levels[RSC_MAX_LEVELS];
    size_t n_levels;
    uint8_t colors[RSC_MAX_COLORS][3]; /* of a colour map, lowest first */
    size_t n_colors;
};

/* By the name's ending: .cmap, .txt (tissues), else preferences. Values that are none are counted and reported.
 *   errors  ERROR_FORMAT nothing in the file is what its name says, ERROR_LIMIT too many; line named */
NODISCARD bool rsc_parse(const uint8_t *data, size_t size, const char *name, struct rsc *rsc, struct report *report,
                         struct error *err);

/* Letters of either case; '-', '_' and blanks are the same. NULL when there is none. */
const struct rsc_body *rsc_find(const struct rsc *rsc, const char *name);

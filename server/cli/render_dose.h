#pragma once
/* The short options of `beamroom render` that say how dose is shown, as a merge patch on a scene. Knows no files and no
 * plan. */
#include "core/base/error.h"
#include "server/wire/json.h"

enum { RENDER_DOSE_MAX_LEVELS = 16 };

/* Borrowed words of the command line. All zero: nothing differs from the scene. */
struct render_dose {
    const char *dose;                           /* "ID" */
    const char *quantity;                       /* "weighted", "total", "boron", ... */
    const char *reference;                      /* "KIND" or "KIND=VALUE" */
    const char *tissue;                         /* "ID" of a region */
    const char *ppm;                            /* "NUMBER" */
    const char *wash;                           /* "bands" or "smooth", perhaps "=OPACITY" */
    const char *isodoses;                       /* "dose" or "univels": the grid of the surfaces */
    const char *texture;                        /* "none", "image", "dose": of the regions that are visible */
    const char *levels[RENDER_DOSE_MAX_LEVELS]; /* "VALUE", "VALUE%" or "VALUEGy", perhaps "=#rrggbb": these alone */
    int n_levels;
    bool has_lines;
};

/* scene: the document of a whole scene, after all other options. sum: its doses that are added to the one shown, unless
 * another one is chosen; NULL: none. The patch is the caller's. NULL with err: ERROR_RANGE an option that cannot be
 * read, with its name first. Words and ids that the scene does not know are left to the check of the patch. */
NODISCARD cJSON *render_dose_patch(const struct render_dose *dose, const cJSON *scene, const cJSON *sum,
                                   struct error *err);

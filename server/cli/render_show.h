#pragma once
/* The short options of `beamroom render` that say what is shown, as a merge patch on a scene. Knows no files and no
 * plan. */
#include "core/base/error.h"
#include "server/wire/json.h"

enum { RENDER_SHOW_MAX_CLIPS = 7 };
#define RENDER_SHOW_PLANE "plane" /* id of the scene's oblique plane that `plane` makes */

/* Borrowed words of the command line. All zero: nothing differs from the scene. */
struct render_show {
    const char *regions;                      /* "ID[=OPACITY],...": these alone, else opaque; "none" */
    const char *slices;                       /* "KIND[=MM],...": these slices alone; "none" */
    const char *volume;                       /* "METHOD[=VALUE]" */
    const char *window;                       /* "CENTRE/WIDTH[/GAMMA]" */
    const char *colors;                       /* a word of color_map */
    const char *light;                        /* "[patient:]AZIMUTH,ELEVATION[,INTENSITY]" */
    const char *ambient;                      /* a number */
    const char *background;                   /* "#RRGGBB", "white" or "black" */
    const char *plane;                        /* "NORMAL[@POINT]", each X,Y,Z: the oblique plane RENDER_SHOW_PLANE */
    const char *clips[RENDER_SHOW_MAX_CLIPS]; /* "axial-high=MM" and its like */
    int n_clips;
    bool is_uncapped;
};

/* scene: the document of a whole scene, whose regions are hidden unless they are named and whose image.cull_below is
 * the volume's where it says none. The patch is the caller's. NULL with err: ERROR_RANGE an option that cannot be read,
 * with its name first. Unknown regions are left to the check of the patch. */
NODISCARD cJSON *render_show_patch(const struct render_show *show, const cJSON *scene, struct error *err);

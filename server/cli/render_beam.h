#pragma once
/* The short options of `beamroom render` that say how beams and tracks are shown, as merge patches on scene and view.
 * Knows no files; of the plan its document. */
#include "core/base/error.h"
#include "server/wire/json.h"

enum { RENDER_BEAM_MAX = 16 };

/* Borrowed words of the command line. All zero: nothing differs from scene and view. */
struct render_beam {
    const char *beams[RENDER_BEAM_MAX]; /* "ID", "": the first; the first of these is the chosen beam */
    int n_beams;
    const char *draft;  /* "X,Y,Z:X,Y,Z": entry and target */
    const char *slice;  /* "MM" of the beam slice */
    const char *tracks; /* "CLASS,...": these classes alone; "": those of the scene */
    const char *kind;   /* of the view */
    const char *along;  /* "MM" of the eye in the beam's-eye view */
    const char *ring;   /* "MM": diameter of the aperture ring in it */
    bool has_clip;      /* a clip plane across a beam is wanted */
};

/* plan: the document of the plan (plan_document.h), or NULL, when only the words are to be checked. scene: that of a
 * whole scene, after all other options. The patch is the caller's. NULL with err: ERROR_RANGE an option that cannot be
 * read or that needs a beam or tracks which the plan does not have, with its name first. Words, ids and ranges that the
 * scene does not know are left to the check of the patch. */
NODISCARD cJSON *render_beam_patch(const struct render_beam *options, const cJSON *plan, const cJSON *scene,
                                   struct error *err);
/* Adds kind, eye and ring to a patch on a view. False with err: as above. */
NODISCARD bool render_beam_add_view(const struct render_beam *options, cJSON *patch, struct error *err);

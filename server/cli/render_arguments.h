#pragma once
/* The command line of `beamroom render`: its options, as a table, and its help. */
#include "core/encode/video.h"
#include "core/render/render.h"
#include "core/scene/fit_use.h"
#include "server/cli/render_beam.h"
#include "server/cli/render_dose.h"
#include "server/cli/render_show.h"

/* Borrowed words of the command line. */
struct render_arguments {
    const char *folder, *out;
    const char *scene, *view; /* a file's name, or JSON, which begins with "{" */
    struct render_show show;
    struct render_dose dose;
    struct render_beam beam;
    enum encode_codec codec;
    enum render_back_end back_end;
    int size_px[2]; /* 0: that of the view */
    bool has_from;  /* from_deg is given: towards the patient's left from the front; up from the horizontal */
    double from_deg[2];
    int quality;
    double orbit_s; /* a turn about the patient takes so long; 0: one picture */
    int fps;
    bool has_annotations;
    const char *accepted[ACCEPTANCES_MAX]; /* "THING=WITH" */
    size_t n_accepted;
};

/* False when there is nothing to draw; *code is then the exit code. */
NODISCARD bool render_arguments_parse(int argc, char **argv, struct render_arguments *arguments, int *code);

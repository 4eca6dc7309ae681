#pragma once
/* The words between render.h and its back ends: which they are, options and timing of a picture, pauses. */
#include "core/base/image.h"
#include "core/derive/shapes.h"
#include "core/scene/snapshot.h"

enum render_back_end {
    RENDER_AUTO,
    RENDER_EGL_DEVICE,
    RENDER_EGL_SURFACELESS,
    RENDER_OSMESA,
    RENDER_SOFT,
    RENDER_N_BACK_ENDS
};

struct render_facts {
    enum render_back_end back_end;
    char vendor[96], renderer[160], version[96];
    bool is_software; /* llvmpipe or the like: prefer coarse meshes and smaller moving pictures */
    int max_samples;
};

struct render_options {
    int width_px, height_px; /* of the picture; smaller than the view's size: the same view with fewer pixels */
    enum surface_detail detail;
    bool is_still; /* anti-aliased */
};

struct render_timing {
    int64_t draw_us, read_us;
    size_t n_triangles;
    bool is_coarse;                   /* some surface drawn was of reduced detail */
    size_t n_added_px, n_left_out_px; /* of the check of a segmentation: struct check_counts */
};

struct render_pause {
    bool (*is_due)(void *context); /* called between parts of a picture, by several threads at a time */
    void *context;
};
enum render_state { RENDER_FAILED, RENDER_PAUSED, RENDER_DONE };

#pragma once
/* The threads of a renderer that load the plan, build shapes ahead, and answer questions about plan and scene. */
#include "server/renderer/desk.h"
#include "server/wire/shape_query.h"

struct loader;

struct question {
    enum { QUESTION_SURFACE, QUESTION_PROBE, QUESTION_PICK } what;
    uint64_t id;
    struct subject subject;   /* surface: the region */
    struct shape_query shape; /* surface */
    struct vec3 point_lps_mm;
    struct snapshot *snapshot; /* pick: one reference, taken */
    double px, py;
};

/* Starts reading: notes PROGRESS, then LOADED and later BUILT (the surfaces a first picture needs), or FAILED. NULL: no
 * thread. */
struct loader_options {
    const char *folder, *plan_id;
    uint64_t max_bytes;       /* as plan_load */
    const char *cache_folder; /* as plan_load */
};
NODISCARD struct loader *loader_create(const struct loader_options *options, struct desk *desk, struct error *err);
/* After LOADED. Answered by a note with the same id. Takes what question owns. False: too many wait. */
NODISCARD bool loader_ask(struct loader *loader, const struct question *question);
/* Before a picture: builds its shapes, then a note SHAPES_BUILT. Takes waiting when it returns true. False: too many
 * wait. */
NODISCARD bool loader_build_shapes(struct loader *loader, struct waiting_request *waiting);
/* Cancels loading, drops questions and requests that wait, joins the threads. Before the plan and its store are
 * destroyed, which belong to the receiver of LOADED. */
void loader_destroy(struct loader *loader);

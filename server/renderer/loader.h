#pragma once
/* The threads of a renderer that load the plan, build shapes ahead, and answer questions about plan and scene. */
#include "server/renderer/inbox.h"
#include "server/renderer/question.h"

struct loader;

/* Starts reading: events PROGRESS, then LOADED and later BUILT (the surfaces a first picture needs), or LOAD_FAILED.
 * NULL: no thread. */
struct loader_options {
    const char *folder, *plan_id;
    uint64_t max_bytes;                       /* as plan_load */
    const char *cache_folder;                 /* as plan_load */
    bool hides_folder;                        /* a plan that is called by its folder is called by its id instead */
    const struct packet_statement *statement; /* NULL: nobody has stated whom the plan is of */
    int64_t worth_keeping_us; /* a plan that took longer to open is kept in the cache; 0: the default. For tests */
};
NODISCARD struct loader *loader_create(const struct loader_options *options, struct inbox *inbox, struct error *err);
/* After LOADED. Answered by an event ANSWER with the same id. Takes question. False: too many wait. */
NODISCARD bool loader_answer(struct loader *loader, struct question *question);
/* Before a picture: builds its shapes, then an event SHAPES_BUILT. Takes waiting when it returns true. False: too many
 * wait. */
NODISCARD bool loader_build_shapes(struct loader *loader, struct waiting_request *waiting);
/* Cancels loading, drops questions and requests that wait, joins the threads. Before the plan and its store are
 * destroyed, which belong to the receiver of LOADED. */
void loader_destroy(struct loader *loader);

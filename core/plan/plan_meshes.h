#pragma once
/* Inside core/plan: the surfaces that were built, kept for the plan's life. */
#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>

#include "core/plan/plan.h"

/* One region by one algorithm at one detail. Its lock is held while it is built, so that others wait and different regions go on. */
struct plan_mesh {
    pthread_mutex_t lock;
    struct mesh *mesh; /* NULL: not built yet */
    struct surface_facts facts;
};

/* What the light surfaces by one algorithm have in common. */
struct plan_lightness {
    pthread_mutex_t lock;
    uint32_t reduction; /* 0: not decided yet */
};

struct plan_meshes {
    size_t n_regions;
    struct plan_mesh (*of_region)[SURFACE_N_ALGORITHMS][2]; /* [n_regions][algorithm][detail] */
    struct plan_lightness light[SURFACE_N_ALGORITHMS];
};

struct plan_meshes *plan_meshes_create(size_t n_regions);
void plan_meshes_destroy(struct plan_meshes *meshes);

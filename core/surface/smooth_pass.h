#pragma once
/* Inside surface_smooth: passes over the vertices of the marching cubes graph, run by several threads. Any thread. */
#include "core/surface/smooth_job.h"

/* Terms of the recurrence that one pass adds to the sums while they are in the cache: the sums are loaded and stored
 * less often. */
enum { SMOOTH_MAX_TERMS = 3 };

/* One pass: computes something for every vertex from the result of the pass before, at the vertex and at its links. */
struct smooth_pass {
    void (*run)(const struct smooth_job *job, const struct smooth_pass *pass, size_t from, size_t end);
    /* for a step of the recurrence */
    const float4 *now; /* e_(n-1) */
    float4 *next;      /* holds e_(n-2), receives e_n */
    int n_terms;       /* number of terms, the last one e_n, that are added to the sums of the filters */
    bool has_gentle;
    float strong[SMOOTH_MAX_TERMS], gentle[SMOOTH_MAX_TERMS]; /* weights of e_n, e_(n-1), e_(n-2) */
    /* for a pass that spreads trust */
    const float *trust;
    float *next_trust;
};

/* Fills job->begin and job->n_slices from the graph; the caller frees begin. False without memory. */
NODISCARD bool smooth_find_slices(struct smooth_job *job, struct error *err);

/* Runs the passes in their sequence. The result does not depend on the number of threads. */
void smooth_run_passes(const struct smooth_job *job, const struct smooth_pass *all, size_t n);

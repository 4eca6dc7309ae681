/* Runs passes over the vertices of a surface, several of them slice by slice while their data is in the cache. */
#include "core/surface/smooth_pass.h"

#include "core/base/mem.h"
#include "core/base/parallel.h"

/* Vertices are in slice sequence and linked within three neighbouring slices. So a pass can follow the one before it
 * slice by slice while both find their data in the cache: BLOCK passes go through the slices together. When a pass
 * overwrites a slice, the passes before it have finished reading it. */
enum { BLOCK = 6 };

struct passes {
    const struct smooth_job *job;
    const struct smooth_pass *pass, *end;  /* the passes of the current block */
    int32_t tiles[SMOOTH_MAX_THREADS + 1]; /* first slice of each thread's share */
    int n_tiles;
};

/* Runs the passes over slices from..end; each further pass begins and ends `begins` and `ends` slices later. */
static void run_tile(const struct passes *passes, int32_t from, int32_t end, int begins, int ends)
{
    int32_t n = (int32_t)(passes->end - passes->pass);
    for (int32_t front = from - n; front < end + 2 * n; front++)
        for (int32_t i = 0; i < n; i++) {
            int32_t slice = front - i;
            if (slice >= from + i * begins && slice < end + i * ends)
                passes->pass[i].run(passes->job, &passes->pass[i], passes->job->begin[slice],
                                    passes->job->begin[slice + 1]);
        }
}

/* First a thread goes as far as it can without the slices of others: each pass covers one slice less at either end. */
static void run_own_slices(void *context, int part, int n_parts)
{
    const struct passes *passes = context;
    run_tile(passes, passes->tiles[part], passes->tiles[part + 1], part > 0, part + 1 < n_parts ? -1 : 0);
}

/* Then the gaps between two threads' slices are filled: each pass covers one slice more at either end. */
static void run_between(void *context, int part, int n_parts)
{
    const struct passes *passes = context;
    (void)n_parts;
    run_tile(passes, passes->tiles[part + 1], passes->tiles[part + 1], -1, 1);
}

static void run_share(void *context, int part, int n_parts)
{
    const struct passes *passes = context;
    size_t from, end;
    smooth_range(passes->job, part, n_parts, &from, &end);
    passes->pass->run(passes->job, passes->pass, from, end);
}

/* Divides the slices into shares with about equally many vertices; false if shares would be too thin for run_own_slices
 * and run_between. */
static bool share_slices(struct passes *passes)
{
    passes->n_tiles = passes->job->n_threads;
    passes->tiles[0] = 0;
    for (int tile = 1; tile <= passes->n_tiles; tile++) {
        size_t wanted = passes->job->n * (size_t)tile / (size_t)passes->n_tiles;
        int32_t slice = passes->tiles[tile - 1];
        while (slice < passes->job->n_slices && passes->job->begin[slice] < wanted)
            slice++;
        passes->tiles[tile] = tile < passes->n_tiles ? slice : passes->job->n_slices;
        if (passes->n_tiles > 1 && passes->tiles[tile] - passes->tiles[tile - 1] < 2 * BLOCK)
            return false;
    }
    return true;
}

bool smooth_find_slices(struct smooth_job *job, struct error *err)
{
    const struct marching_point *points = job->graph->points;
    job->n_slices = job->n ? points[job->n - 1].at2[2] / 2 + 1 : 0;
    job->begin = mem_array((size_t)job->n_slices + 1, sizeof *job->begin, UINT64_MAX, err);
    if (!job->begin)
        return false;
    size_t v = 0;
    for (int32_t slice = 0; slice <= job->n_slices; slice++) {
        while (v < job->n && points[v].at2[2] / 2 < slice)
            v++;
        job->begin[slice] = v;
    }
    return true;
}

void smooth_run_passes(const struct smooth_job *job, const struct smooth_pass *all, size_t n)
{
    struct passes passes = { .job = job };
    bool is_shared = share_slices(&passes);
    for (size_t at = 0, step = is_shared ? BLOCK : 1; at < n; at += step) {
        passes.pass = all + at;
        passes.end = all + (at + step < n ? at + step : n);
        parallel_run(is_shared ? passes.n_tiles : job->n_threads, is_shared ? run_own_slices : run_share, &passes);
        if (is_shared && passes.n_tiles > 1)
            parallel_run(passes.n_tiles - 1, run_between, &passes);
    }
}

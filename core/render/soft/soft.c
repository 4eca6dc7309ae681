/* The software back end: start and stop; a picture projected, sorted and drawn in bands by several threads. */
#include "core/render/soft/soft.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/render/soft/frame.h"
#include "core/render/soft/rows.h"
#include "core/render/visible/visible.h"
#include "core/scene/beams_drawn.h"
#include "core/scene/isodoses.h"

/* More threads than MAX_THREADS would wait for memory and for each other. */
enum { MAX_THREADS = 16, VERTEX_BLOCK = 8192 };
/* Begun pictures whose sorted triangles are kept. Those of further ones are sorted again when they go on. */
enum { MAX_SORTED = 2 };
/* A thread's memory for translucent layers, unless a single row of all layers takes more. */
enum { LAYER_BYTES = 1 << 20 };
_Static_assert(
    (int)SOFT_MAX_LAYERS >= (int)REGION_MAX + (int)ISODOSES_MAX + (int)BEAMS_DRAWN_MAX + 1,
    "every region of a plan, every isodose and every opening of a beam can be translucent, and a volume among them");

/* The buffers of one thread. */
struct scratch {
    uint32_t *band; /* [2][n_band] depth, colour */
    size_t n_band;
    uint32_t *layers;
    size_t n_layers; /* samples of all layers; layers is [2][n_layers] */
    struct soft_cap_scratch caps;
    struct soft_track_scratch *tracks; /* NULL: none were drawn yet */
};

/* A picture's triangles and tracks, projected and sorted into bands. */
struct soft_sorted {
    const struct soft_frame *owner; /* NULL: free */
    uint64_t used;                  /* value of n_uses at the last use */
    struct soft_vertex *vertices;
    size_t n_vertices;
    uint8_t *above; /* of the items that are cut */
    size_t n_above;
    struct soft_chunk *chunks;
    size_t n_chunks;
    struct soft_track_chunks tracks;
};

struct soft_renderer {
    struct render_facts facts;
    const struct soft_kernels *kernels;
    int n_threads;
    struct soft_frame *frames; /* pictures that are begun */
    uint64_t n_uses;
    /* kept from picture to picture */
    struct soft_sorted sorted[MAX_SORTED];
    struct scratch scratch[MAX_THREADS];
};

/* ---- start and stop --------------------------------------------------------------------------------------------- */

static void learn_facts(struct soft_renderer *renderer)
{
    struct render_facts *facts = &renderer->facts;
    *facts = (struct render_facts){ .back_end = RENDER_SOFT,
                                    .vendor = "Beamroom",
                                    .version = BEAMROOM_VERSION,
                                    .is_software = true,
                                    .max_samples = 4 };
    snprintf(facts->renderer, sizeof facts->renderer, "software rasteriser, %s (%d thread%s)", renderer->kernels->name,
             renderer->n_threads, renderer->n_threads == 1 ? "" : "s");
}

struct soft_renderer *soft_renderer_create(void)
{
    struct soft_renderer *renderer = mem_new(sizeof *renderer);
    soft_renderer_tune(renderer, parallel_cores(), false);
    return renderer;
}

void soft_renderer_tune(struct soft_renderer *renderer, int n_threads, bool is_portable)
{
    renderer->n_threads = n_threads < 1 ? 1 : n_threads > MAX_THREADS ? MAX_THREADS : n_threads;
    renderer->kernels = is_portable ? &soft_kernels_portable : soft_kernels_best();
    learn_facts(renderer);
}

/* Frees the buffers that grew with a plan. */
static void drop_buffers(struct soft_renderer *renderer)
{
    for (int i = 0; i < MAX_SORTED; i++) {
        struct soft_sorted *sorted = &renderer->sorted[i];
        for (size_t c = 0; c < sorted->n_chunks; c++)
            soft_chunk_finish(&sorted->chunks[c]);
        soft_track_chunks_finish(&sorted->tracks);
        free(sorted->chunks);
        free(sorted->above);
        free(sorted->vertices);
        *sorted = (struct soft_sorted){ 0 };
    }
    for (int i = 0; i < MAX_THREADS; i++) {
        free(renderer->scratch[i].band);
        free(renderer->scratch[i].layers);
        soft_cap_scratch_finish(&renderer->scratch[i].caps);
        if (renderer->scratch[i].tracks)
            soft_track_scratch_finish(renderer->scratch[i].tracks);
        free(renderer->scratch[i].tracks);
        renderer->scratch[i] = (struct scratch){ 0 };
    }
}

void soft_renderer_destroy(struct soft_renderer *renderer)
{
    if (!renderer)
        return;
    assert(!renderer->frames);
    drop_buffers(renderer);
    free(renderer);
}

const struct render_facts *soft_renderer_facts(const struct soft_renderer *renderer)
{
    return &renderer->facts;
}

struct drawable_maker soft_renderer_maker(void)
{
    return soft_drawable_maker();
}

void soft_renderer_forget(struct soft_renderer *renderer)
{
    assert(!renderer->frames);
    drop_buffers(renderer);
}

/* ---- memory ----------------------------------------------------------------------------------------------------- */

static bool make_scratch(struct soft_frame *frame, struct scratch *scratch, struct error *err)
{
    size_t row = (size_t)(frame->width + SOFT_PADDING), n_band = row * SOFT_BAND_ROWS;
    if (scratch->n_band < n_band) {
        free(scratch->band);
        scratch->band = mem_array(n_band, 2 * sizeof(uint32_t), UINT64_MAX, err);
        scratch->n_band = scratch->band ? n_band : 0;
        if (!scratch->band)
            return false;
    }
    if (frame->n_caps > 0 && !soft_cap_scratch_resize(&scratch->caps, frame->width, err))
        return false;
    if (frame->n_layers == 0)
        return true;
    size_t rows = LAYER_BYTES / (row * frame->n_layers * 2 * sizeof(uint32_t));
    rows = rows < 1 ? 1 : rows > SOFT_BAND_ROWS ? SOFT_BAND_ROWS : rows;
    size_t n_layers = row * rows * frame->n_layers;
    frame->layer_rows = (int)rows;
    if (scratch->n_layers < n_layers) {
        free(scratch->layers);
        scratch->layers = mem_array(n_layers, 2 * sizeof(uint32_t), UINT64_MAX, err);
        scratch->n_layers = scratch->layers ? n_layers : 0;
        if (!scratch->layers)
            return false;
        float *depth = (float *)(void *)scratch->layers;
        for (size_t i = 0; i < n_layers; i++)
            depth[i] = 1;
        memset(scratch->layers + n_layers, 0, n_layers * sizeof(uint32_t));
    }
    return true;
}

/* The slot of the frame's sorted triangles. is_lost: it has none, and takes over the least recently used slot. */
static struct soft_sorted *take_sorted(struct soft_frame *frame, bool *is_lost)
{
    struct soft_renderer *renderer = frame->renderer;
    struct soft_sorted *best = &renderer->sorted[0];
    for (int i = 0; i < MAX_SORTED; i++) {
        struct soft_sorted *sorted = &renderer->sorted[i];
        if (sorted->owner == frame) {
            best = sorted;
            break;
        }
        if (best->owner && (!sorted->owner || sorted->used < best->used))
            best = sorted;
    }
    *is_lost = best->owner != frame;
    best->owner = frame;
    best->used = ++renderer->n_uses;
    return best;
}

static bool make_room(struct soft_frame *frame, struct error *err)
{
    struct soft_sorted *sorted = frame->sorted;
    size_t n_vertices = 0, n_above = 0;
    frame->n_chunks = frame->n_blocks = 0;
    for (size_t i = 0; i < frame->n_items; i++) {
        struct soft_item *item = &frame->items[i];
        n_vertices += item->shape->n_vertices;
        n_above += item->cuts.n > 0 ? item->shape->n_vertices : 0;
        item->first_chunk = frame->n_chunks;
        item->n_chunks = (item->shape->n_primitives + SOFT_CHUNK_PRIMITIVES - 1) / SOFT_CHUNK_PRIMITIVES;
        frame->n_chunks += item->n_chunks;
        frame->n_blocks += (item->shape->n_vertices + VERTEX_BLOCK - 1) / VERTEX_BLOCK;
    }
    if (sorted->n_vertices < n_vertices) {
        free(sorted->vertices);
        sorted->vertices = mem_large_array(n_vertices, sizeof *sorted->vertices, UINT64_MAX, err);
        sorted->n_vertices = sorted->vertices ? n_vertices : 0;
        if (!sorted->vertices)
            return false;
    }
    if (sorted->n_above < n_above) {
        free(sorted->above);
        sorted->above = mem_large_array(n_above, 1, UINT64_MAX, err);
        sorted->n_above = sorted->above ? n_above : 0;
        if (!sorted->above)
            return false;
    }
    if (sorted->n_chunks < frame->n_chunks) {
        struct soft_chunk *grown = realloc(sorted->chunks, frame->n_chunks * sizeof *grown);
        if (!grown)
            return error_set(err, ERROR_MEMORY, "no memory for %zu pieces of surfaces", frame->n_chunks);
        memset(grown + sorted->n_chunks, 0, (frame->n_chunks - sorted->n_chunks) * sizeof *grown);
        sorted->chunks = grown;
        sorted->n_chunks = frame->n_chunks;
    }
    if (!soft_track_chunks_resize(&sorted->tracks, frame->n_track_chunks, err))
        return false;
    struct soft_vertex *vertices = sorted->vertices;
    uint8_t *above = sorted->above;
    for (size_t i = 0; i < frame->n_items; i++) {
        struct soft_item *item = &frame->items[i];
        item->vertices = vertices;
        vertices += item->shape->n_vertices;
        item->above = item->cuts.n > 0 ? above : NULL;
        above += item->cuts.n > 0 ? item->shape->n_vertices : 0;
        for (size_t c = 0; c < item->n_chunks; c++) {
            struct soft_chunk *chunk = &sorted->chunks[item->first_chunk + c];
            chunk->item = item;
            chunk->first = c * SOFT_CHUNK_PRIMITIVES;
            chunk->n = item->shape->n_primitives - chunk->first;
            chunk->n = chunk->n < SOFT_CHUNK_PRIMITIVES ? chunk->n : SOFT_CHUNK_PRIMITIVES;
        }
    }
    return true;
}

static bool make_scratches(struct soft_frame *frame, struct error *err)
{
    for (int i = 0; i < frame->renderer->n_threads; i++)
        if (!make_scratch(frame, &frame->renderer->scratch[i], err))
            return false;
    return true;
}

/* ---- drawing ---------------------------------------------------------------------------------------------------- */

static void shade_vertices(void *context, int part, int n_parts)
{
    struct soft_frame *frame = context;
    (void)part, (void)n_parts;
    for (size_t piece; (piece = atomic_fetch_add(&frame->next, 1)) < frame->n_blocks;) {
        struct soft_item *item = frame->items;
        size_t n_blocks;
        while (piece >= (n_blocks = (item->shape->n_vertices + VERTEX_BLOCK - 1) / VERTEX_BLOCK)) {
            piece -= n_blocks;
            item++;
        }
        const struct soft_kernels *kernels = frame->renderer->kernels;
        size_t first = piece * VERTEX_BLOCK, n = item->shape->n_vertices - first;
        n = n < VERTEX_BLOCK ? n : VERTEX_BLOCK;
        kernels->shade(&item->lighting, &item->shape->points, first, n, item->vertices + first);
        if (item->above)
            kernels->classify(&item->cuts, &item->shape->points, first, n, item->above, item->vertices);
    }
}

static void sort_triangles(void *context, int part, int n_parts)
{
    struct soft_frame *frame = context;
    (void)part, (void)n_parts;
    for (size_t piece; (piece = atomic_fetch_add(&frame->next, 1)) < frame->n_chunks;)
        if (!soft_chunk_sort(&frame->sorted->chunks[piece], frame->width, frame->height, frame->n_bands))
            atomic_store(&frame->is_out_of_memory, true);
}

static void sort_tracks(void *context, int part, int n_parts)
{
    struct soft_frame *frame = context;
    struct scratch *scratch = &frame->renderer->scratch[part];
    (void)n_parts;
    if (!scratch->tracks)
        scratch->tracks = mem_new(sizeof *scratch->tracks);
    const struct soft_track_kernels *kernels = soft_track_kernels_of(frame->renderer->kernels);
    for (size_t piece; (piece = atomic_fetch_add(&frame->next, 1)) < frame->n_track_chunks;)
        if (!soft_track_chunk_sort(&frame->sorted->tracks.chunks[piece], piece, frame->tracks, kernels,
                                   scratch->tracks))
            atomic_store(&frame->is_out_of_memory, true);
}

static void draw_item(const struct soft_frame *frame, const struct soft_item *item, const struct soft_band *band,
                      int index, int range[2])
{
    range[0] = band->width;
    range[1] = 0;
    for (size_t i = 0; i < item->n_chunks; i++) {
        const struct soft_chunk *chunk = &frame->sorted->chunks[item->first_chunk + i];
        const struct soft_triangles triangles = { chunk->refs + chunk->starts[index],
                                                  chunk->starts[index + 1] - chunk->starts[index], item->shape->indices,
                                                  item->vertices, chunk->extras };
        if (triangles.n_refs > 0)
            frame->renderer->kernels->raster(band, &triangles, range);
    }
}

static void draw_opaque(const struct soft_frame *frame, const struct soft_item *item, const struct soft_band *band,
                        int index)
{
    int range[2];
    draw_item(frame, item, band, index, range);
    if (item->paint)
        soft_volume_kernels_of(frame->renderer->kernels)->paint(item->paint, band, range, NULL);
}

/* Draws the nearest sheet of each item into a layer of its own, a few rows at a time, and composes the layers, with the
 * volume's rays if there is one. */
static void draw_layers(const struct soft_frame *frame, const struct soft_item *items, size_t n,
                        const struct soft_volume *volume, const struct scratch *scratch, const struct soft_band *band,
                        int index)
{
    struct soft_layer layers[SOFT_MAX_LAYERS];
    size_t n_layer = (size_t)band->stride * (size_t)frame->layer_rows;
    bool is_exact = frame->list->is_order_exact;
    for (int row = 0; row < band->n_rows; row += frame->layer_rows) {
        struct soft_band part = *band;
        part.first_row += row;
        part.n_rows = band->n_rows - row < frame->layer_rows ? band->n_rows - row : frame->layer_rows;
        for (size_t i = 0; i < n; i++) {
            struct soft_layer *layer = &layers[i];
            layer->depth = part.depth = (float *)(void *)scratch->layers + i * n_layer;
            layer->color = part.color = scratch->layers + scratch->n_layers + i * n_layer;
            draw_item(frame, &items[i], &part, index, layer->range);
            if (items[i].paint)
                soft_volume_kernels_of(frame->renderer->kernels)
                    ->paint(items[i].paint, &part, layer->range, band->depth + (size_t)row * (size_t)band->stride);
        }
        part.depth = band->depth + (size_t)row * (size_t)band->stride;
        part.color = band->color + (size_t)row * (size_t)band->stride;
        float rank_depth = is_exact ? (float)(2 * VISIBLE_RANK_DEPTH) : 0;
        if (volume)
            soft_volume_kernels_of(frame->renderer->kernels)->compose(volume, &part, layers, (int)n, rank_depth);
        else
            frame->renderer->kernels->compose(&part, layers, (int)n, rank_depth);
    }
}

/* Executes the list in its order, within a band. */
static void draw_all(const struct soft_frame *frame, const struct scratch *scratch, const struct soft_band *band,
                     int index)
{
    const struct draw_list *list = frame->list;
    const struct soft_item *item = frame->items;
    const struct soft_plane *plane = frame->planes;
    const struct soft_marks *marks = frame->marks;
    const struct soft_cap *cap = frame->caps;
    const struct soft_kernels *kernels = frame->renderer->kernels;
    enum draw_pass kept = DRAW_OPAQUE;
    for (size_t i = 0, n; i <= list->n_in_image; i += n) {
        enum draw_pass pass = i < list->n_in_image ? list->draws[i].pass : DRAW_OVERLAY;
        for (; list->depth && kept < DRAW_TRANSLUCENT && kept < pass; kept++)
            soft_rows_keep_depth(frame, band, kept == DRAW_PLANES);
        if (i == list->n_in_image)
            break;
        n = draw_list_n_layers(list, i);
        if (n > 0) {
            size_t n_volumes = list->draws[i].kind == DRAW_VOLUME;
            draw_layers(frame, item, n - n_volumes, n_volumes ? frame->volume : NULL, scratch, band, index);
            if (list->depth && n_volumes)
                soft_rows_keep_volume_depth(frame, kernels, band);
            item += n - n_volumes;
            continue;
        }
        n = 1;
        switch (list->draws[i].kind) {
        case DRAW_SHAPE:
        case DRAW_ISOLINES: draw_opaque(frame, item++, band, index); break;
        case DRAW_IMAGE:
        case DRAW_LABELS:
        case DRAW_WASH: soft_plane_draw(plane++, kernels, band); break;
        case DRAW_CAP:
            soft_cap_draw(cap++, kernels, band, index, &scratch->caps);
            for (size_t r = 0; list->draws[i].cap.outline_px > 0 && r < list->draws[i].cap.n_regions; r++)
                draw_opaque(frame, item++, band, index);
            break;
        case DRAW_TRACKS:
            soft_tracks_draw(frame->tracks, soft_track_kernels_of(kernels), &frame->sorted->tracks,
                             frame->n_track_chunks, band, index);
            break;
        case DRAW_MARKS: soft_marks_draw(marks++, band); break;
        case DRAW_VOLUME:
        case DRAW_OUTLINE:
        case DRAW_CHECK:
        case DRAW_GRID_CUT:
        case DRAW_GRID_BOX:
        case DRAW_STROKES:
        case DRAW_AXES:
        case DRAW_BEAM_EYE: break;
        }
    }
}

static bool pause_is_due(const struct soft_frame *frame)
{
    return frame->pause && frame->pause->is_due(frame->pause->context);
}

/* Draws at least one band in each call, so that a picture gets done however often it is paused. */
static void draw_bands(void *context, int part, int n_parts)
{
    struct soft_frame *frame = context;
    struct soft_renderer *renderer = frame->renderer;
    bool is_first = part == 0;
    (void)n_parts;
    uint8_t ground[3];
    visible_ground(frame->scope->snapshot, ground);
    for (size_t piece; (is_first || !pause_is_due(frame)) &&
                       (piece = atomic_fetch_add(&frame->next_band, 1)) < (size_t)frame->n_bands;) {
        is_first = false;
        int first = (int)piece * SOFT_BAND_ROWS, n = frame->height - first;
        const struct scratch *scratch = &renderer->scratch[part];
        struct soft_band band = { first,
                                  n < SOFT_BAND_ROWS ? n : SOFT_BAND_ROWS,
                                  frame->width,
                                  frame->width + SOFT_PADDING,
                                  (float *)(void *)scratch->band,
                                  scratch->band + scratch->n_band };
        soft_rows_clear(&band, ground);
        draw_all(frame, scratch, &band, (int)piece);
        soft_rows_write(frame, frame->renderer->kernels, &band);
    }
}

static void run(struct soft_frame *frame, void (*work)(void *context, int part, int n_parts))
{
    atomic_store(&frame->next, 0);
    parallel_run(frame->renderer->n_threads, work, frame);
}

static size_t n_primitives(const struct soft_frame *frame)
{
    size_t n = 0;
    for (size_t i = 0; i < frame->n_items; i++)
        n += frame->items[i].shape->n_primitives;
    return n;
}

static bool prepare(struct soft_frame *frame, struct error *err)
{
    frame->image = image_create(frame->options.width_px, frame->options.height_px, err);
    if (!frame->image)
        return false;
    frame->width = frame->options.width_px * frame->list->samples;
    frame->height = frame->options.height_px * frame->list->samples;
    frame->n_bands = (frame->height + SOFT_BAND_ROWS - 1) / SOFT_BAND_ROWS;
    return soft_frame_prepare(frame, err);
}

static bool sort(struct soft_frame *frame, struct error *err)
{
    bool is_lost;
    frame->sorted = take_sorted(frame, &is_lost);
    if (!is_lost)
        return true;
    if (!make_room(frame, err))
        return false;
    if (frame->n_items > 0) {
        run(frame, shade_vertices);
        run(frame, sort_triangles);
        if (atomic_load(&frame->is_out_of_memory))
            return error_set(err, ERROR_MEMORY, "no memory to sort %zu triangles, lines and points",
                             n_primitives(frame));
    }
    if (frame->tracks) {
        run(frame, sort_tracks);
        if (atomic_load(&frame->is_out_of_memory))
            return error_set(err, ERROR_MEMORY, "no memory to sort %zu segments of tracks",
                             frame->tracks->tracks->shown.end - frame->tracks->tracks->shown.first);
    }
    return true;
}

static bool draw(struct soft_frame *frame, struct error *err)
{
    if ((!frame->image && !prepare(frame, err)) || !sort(frame, err) || !make_scratches(frame, err))
        return false;
    parallel_run(frame->renderer->n_threads, draw_bands, frame);
    return true;
}

/* ---- pictures --------------------------------------------------------------------------------------------------- */

struct soft_frame *soft_picture_begin(struct soft_renderer *renderer, const struct draw_scope *scope,
                                      const struct draw_list *list, const struct render_options *options)
{
    struct soft_frame *frame = mem_new(sizeof *frame);
    frame->renderer = renderer;
    frame->scope = scope;
    frame->list = list;
    frame->options = *options;
    frame->next_frame = renderer->frames;
    renderer->frames = frame;
    return frame;
}

enum render_state soft_picture_go_on(struct soft_frame *frame, const struct render_pause *pause,
                                     struct render_timing *timing, struct error *err)
{
    int64_t start_us = clock_now_us();
    frame->pause = pause;
    bool is_good = draw(frame, err);
    timing->draw_us += clock_now_us() - start_us;
    if (!is_good)
        return RENDER_FAILED;
    return atomic_load(&frame->next_band) < (size_t)frame->n_bands ? RENDER_PAUSED : RENDER_DONE;
}

struct image *soft_picture_end(struct soft_frame *frame)
{
    struct soft_renderer *renderer = frame->renderer;
    struct image *image = frame->image;
    struct soft_frame **at = &renderer->frames;
    while (*at != frame)
        at = &(*at)->next_frame;
    *at = frame->next_frame;
    for (int i = 0; i < MAX_SORTED; i++)
        if (renderer->sorted[i].owner == frame)
            renderer->sorted[i].owner = NULL;
    if (image && atomic_load(&frame->next_band) < (size_t)frame->n_bands) {
        image_destroy(image);
        image = NULL;
    }
    soft_frame_finish(frame);
    free(frame);
    return image;
}

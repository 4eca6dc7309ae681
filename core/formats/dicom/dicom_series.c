/* Reads the slices of a stack into one volume: voxel type, rescale, interpolation, and the report. */
#include "core/formats/dicom/dicom_series.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/formats/dicom/dicom_codestreams.h"
#include "core/formats/dicom/dicom_mix.h"
#include "core/formats/dicom/dicom_padding.h"
#include "core/formats/dicom/dicom_slices.h"
#include "core/formats/dicom/dicom_tags.h"
#include "core/formats/dicom/dicom_unpack.h"

_Static_assert((int)DICOM_MAX_SIDE == (int)VOLUME_MAX_SIDE, "a picture that is read fits into a volume");

enum { MAX_THREADS = 8 };

/* Buffers that a thread keeps from one slice to the next, and its results. */
struct reader {
    struct dicom_file *file; /* the file that slices are decoded from */
    size_t object;           /* index of file's object; SIZE_MAX: none */
    struct bytes bytes;      /* the bytes of file, unless series->whole holds them */
    uint8_t *scratch;        /* one plane of stored values */
    struct dicom_codestreams coded;
    int32_t range[2];
    size_t n_padding;
};

/* A stack while it is read. */
struct series {
    const struct folder *folder;
    const struct dicom_index *index;
    const struct dicom_stack *stack;
    const struct dicom_progress *progress;
    struct dicom_slice *slices;
    size_t n_slices;
    struct dicom_plane plane;
    enum voxel_type type;
    bool is_uniform; /* all slices share one type and rescale, so cells are kept as stored */
    size_t plane_cells;
    uint8_t *cells;     /* cells of all slices, [n_slices][plane_cells] of type */
    struct bytes whole; /* the multi-frame file, when its frames must be decoded from memory */
    int32_t range[2];   /* smallest and largest integer cell */
    size_t n_padding;   /* cells without a value */
    struct dicom_codestreams coded;
    atomic_size_t next, n_done;
    size_t n_reported; /* slices reported to progress->step, by the calling thread alone */
    atomic_bool is_failed;
    struct error error;                 /* written by the thread that set is_failed */
    struct reader readers[MAX_THREADS]; /* one per part */
};

static const struct dicom_object *object_of(const struct series *series, const struct dicom_slice *slice)
{
    return &series->index->objects[slice->object];
}

static bool open_file(struct series *series, struct reader *reader, size_t object, struct error *err)
{
    if (reader->object == object)
        return true;
    dicom_file_destroy(reader->file);
    bytes_free(&reader->bytes);
    reader->file = NULL;
    reader->object = SIZE_MAX;
    const struct dicom_object *about = &series->index->objects[object];
    struct bytes bytes = series->whole;
    if (!bytes.data) {
        if (!folder_read(series->folder, about->path, (uint64_t)DICOM_MAX_FILE_MIB << 20, UINT64_MAX, &reader->bytes,
                         err))
            return false;
        bytes = reader->bytes;
    }
    reader->file = dicom_file_parse(bytes.data, bytes.size, about->path, DICOM_WHOLE, err);
    if (!reader->file)
        return false;
    reader->object = object;
    return true;
}

static bool same_pixels(const struct dicom_pixels *a, const struct dicom_pixels *b)
{
    return a->rows == b->rows && a->columns == b->columns && a->n_frames == b->n_frames &&
           a->bits_allocated == b->bits_allocated && a->bits_stored == b->bits_stored && a->high_bit == b->high_bit &&
           a->is_signed == b->is_signed;
}

/* Reads the stored values of a slice: native ones straight from the file, compressed ones by decoding. */
static bool read_stored(struct series *series, struct reader *reader, const struct dicom_slice *slice, void *out,
                        struct error *err)
{
    const struct dicom_object *object = object_of(series, slice);
    const struct dicom_image *image = object->image;
    size_t bytes = series->plane_cells * (image->pixels.bits_allocated / 8);
    if (!image->has_stored) {
        struct dicom_pixels now;
        if (!open_file(series, reader, slice->object, err) || !dicom_pixels_look(reader->file, &now, err))
            return false;
        if (!same_pixels(&now, &image->pixels))
            return error_set(err, ERROR_IO, "%s: the file changed while it was read", object->path);
        if (!dicom_pixels_read(reader->file, slice->frame, out, err))
            return false;
        dicom_codestreams_add(&reader->coded, dicom_pixels_decoded(reader->file), image);
        return true;
    }
    struct folder_part part;
    if (!folder_open_part(series->folder, object->path, &part, err))
        return false;
    bool is_read =
        part.n_bytes == object->n_bytes
            ? folder_read_part(&part, object->path, image->stored.at + (uint64_t)slice->frame * bytes, out, bytes, err)
            : error_set(err, ERROR_IO, "%s: the file changed while it was read: %llu bytes, %llu before", object->path,
                        (unsigned long long)part.n_bytes, (unsigned long long)object->n_bytes);
    folder_close_part(&part);
    if (is_read)
        dicom_pixels_unpack(&image->pixels, image->stored.is_swapped, out, series->plane_cells);
    return is_read;
}

static double stored_value(const struct dicom_pixels *pixels, const uint8_t *cells, size_t i)
{
    switch (pixels->bits_allocated) {
    case 8: return pixels->is_signed ? ((const int8_t *)cells)[i] : cells[i];
    case 16:
        return pixels->is_signed ? ((const int16_t *)(const void *)cells)[i]
                                 : ((const uint16_t *)(const void *)cells)[i];
    default:
        return pixels->is_signed ? (double)((const int32_t *)(const void *)cells)[i]
                                 : (double)((const uint32_t *)(const void *)cells)[i];
    }
}

static void convert(const struct series *series, const struct dicom_slice *slice, const uint8_t *stored, void *out)
{
    const struct dicom_pixels *pixels = &object_of(series, slice)->image->pixels;
    double slope = series->is_uniform ? 1 : slice->slope, offset = series->is_uniform ? 0 : slice->offset;
    if (series->type == VOXEL_I16) { /* 8 bits signed */
        int16_t *to = out;
        for (size_t i = 0; i < series->plane_cells; i++)
            to[i] = ((const int8_t *)stored)[i];
        return;
    }
    const struct dicom_padding *padding = &object_of(series, slice)->image->padding;
    float *to = out;
    for (size_t i = 0; i < series->plane_cells; i++) {
        double value = stored_value(pixels, stored, i);
        to[i] = dicom_is_padding(padding, value) ? NAN : (float)(value * slope + offset);
    }
}

static size_t count_padding(const struct series *series, const struct dicom_slice *slice, const uint8_t *cells)
{
    const struct dicom_padding *padding = &object_of(series, slice)->image->padding;
    if (series->type != VOXEL_F32)
        return dicom_padding_count(padding, series->type, cells, series->plane_cells);
    size_t n = 0;
    for (size_t i = 0; padding->is_given && i < series->plane_cells; i++)
        n += isnan(((const float *)(const void *)cells)[i]) ? 1 : 0;
    return n;
}

static bool is_kept_as_stored(const struct series *series, const struct dicom_pixels *pixels)
{
    return series->is_uniform && pixels->bits_allocated / 8 == voxel_size(series->type) && series->type != VOXEL_F32;
}

static bool read_slice(struct series *series, struct reader *reader, size_t at, struct error *err)
{
    const struct dicom_slice *slice = &series->slices[at];
    const struct dicom_pixels *pixels = &object_of(series, slice)->image->pixels;
    uint8_t *out = series->cells + at * series->plane_cells * voxel_size(series->type);
    bool is_direct = is_kept_as_stored(series, pixels);
    if (!is_direct && !reader->scratch) {
        reader->scratch = mem_array(series->plane_cells, 4, UINT32_MAX, err);
        if (!reader->scratch)
            return false;
    }
    if (!read_stored(series, reader, slice, is_direct ? out : reader->scratch, err))
        return false;
    if (!is_direct)
        convert(series, slice, reader->scratch, out);
    dicom_cells_measure(voxel_size(series->type), series->type == VOXEL_I16, out, series->plane_cells, reader->range);
    reader->n_padding += count_padding(series, slice, out);
    return true;
}

static void fail(struct series *series, const struct error *err)
{
    if (!atomic_exchange(&series->is_failed, true))
        series->error = *err;
}

/* Reports the slices done since the last call, one by one. On the calling thread alone. */
static void report_progress(struct series *series)
{
    size_t n_done = atomic_load(&series->n_done);
    while (series->n_reported < n_done) {
        series->n_reported++;
        if (series->progress->step)
            series->progress->step(series->progress->context, series->n_reported, series->n_slices);
    }
}

static void read_part(void *context, int part, int n_parts)
{
    struct series *series = context;
    struct reader *reader = &series->readers[part];
    *reader = (struct reader){ .object = SIZE_MAX, .range = { INT32_MAX, INT32_MIN } };
    (void)n_parts;
    for (size_t i; (i = atomic_fetch_add(&series->next, 1)) < series->n_slices && !atomic_load(&series->is_failed);) {
        struct error err = { 0 };
        bool is_cancelled = series->progress->cancel && atomic_load(series->progress->cancel);
        if (is_cancelled)
            error_set(&err, ERROR_CANCELLED, "reading the series was cancelled");
        size_t n_lacked = error_n_memory();
        bool is_read = !is_cancelled && read_slice(series, reader, i, &err);
        if (error_n_memory() != n_lacked && (is_read || err.code != ERROR_MEMORY)) /* counted for each thread alone */
            is_read = error_set(&err, ERROR_MEMORY, "%s: no memory to read a slice",
                                object_of(series, &series->slices[i])->path);
        if (!is_read) {
            fail(series, &err);
            break;
        }
        atomic_fetch_add(&series->n_done, 1);
        if (part == 0)
            report_progress(series);
    }
    dicom_file_destroy(reader->file);
    bytes_free(&reader->bytes);
    free(reader->scratch);
}

static void join_results(struct series *series, int n_parts)
{
    series->range[0] = INT32_MAX;
    series->range[1] = INT32_MIN;
    for (int part = 0; part < n_parts; part++) {
        const struct reader *reader = &series->readers[part];
        series->range[0] = reader->range[0] < series->range[0] ? reader->range[0] : series->range[0];
        series->range[1] = reader->range[1] > series->range[1] ? reader->range[1] : series->range[1];
        series->n_padding += reader->n_padding;
        dicom_codestreams_join(&series->coded, &reader->coded);
    }
}

/* Fills the slices of a stack of single-frame files, from the index alone. */
static void slices_of_files(struct series *series)
{
    for (size_t i = 0; i < series->stack->n_objects; i++) {
        const struct dicom_image *image = series->index->objects[series->stack->objects[i]].image;
        series->slices[i] = (struct dicom_slice){ .object = series->stack->objects[i],
                                                  .position_lps_mm = { image->position_mm[0], image->position_mm[1],
                                                                       image->position_mm[2] },
                                                  .slope = image->slope,
                                                  .offset = image->offset };
    }
    series->n_slices = series->stack->n_objects;
    const struct dicom_image *first = series->index->objects[series->stack->objects[0]].image;
    memcpy(series->plane.row, first->row, sizeof first->row);
    memcpy(series->plane.column, first->column, sizeof first->column);
    memcpy(series->plane.spacing_mm, first->spacing_mm, sizeof first->spacing_mm);
    series->plane.thickness_mm = first->thickness_mm;
    struct vec3 row = vec3(first->row[0], first->row[1], first->row[2]),
                column = vec3(first->column[0], first->column[1], first->column[2]);
    struct vec3 normal = vec3_normalize(vec3_cross(row, column));
    for (size_t i = 0; i < series->n_slices; i++)
        series->slices[i].along_mm = vec3_dot(normal, series->slices[i].position_lps_mm);
}

/* Opens the head of one object; NULL on failure. bytes holds the file's bytes; the caller frees it after the file. */
static struct dicom_file *open_head(const struct series *series, size_t object, struct bytes *bytes, struct error *err)
{
    const struct dicom_object *about = &series->index->objects[object];
    uint64_t most = about->image->has_stored ? about->image->stored.at : UINT64_MAX;
    if (!folder_read(series->folder, about->path, (uint64_t)DICOM_MAX_FILE_MIB << 20, most, bytes, err))
        return NULL;
    return dicom_file_parse(bytes->data, bytes->size, about->path, DICOM_HEAD, err);
}

static void facts_from(const struct dicom_item *item, struct dicom_series_facts *facts)
{
    double centers[DICOM_MAX_WINDOWS], widths[DICOM_MAX_WINDOWS];
    size_t n = dicom_numbers(item, TAG_WINDOW_CENTER, centers, DICOM_MAX_WINDOWS);
    size_t n_widths = dicom_numbers(item, TAG_WINDOW_WIDTH, widths, DICOM_MAX_WINDOWS);
    n = n < n_widths ? n : n_widths;
    for (size_t i = 0; i < n && i < DICOM_MAX_WINDOWS; i++) {
        if (!isfinite(centers[i]) || !(widths[i] > 0))
            continue;
        struct dicom_window *window = &facts->windows[facts->n_windows++];
        *window = (struct dicom_window){ .center = centers[i], .width = widths[i] };
        (void)dicom_text_at(item, TAG_WINDOW_NAME, i, window->name, sizeof window->name);
    }
}

static void read_facts(const struct series *series, const struct dicom_file *file, struct dicom_series_facts *facts)
{
    const struct dicom_item *root = dicom_root(file), *shared = dicom_item_at(root, TAG_SHARED_GROUPS, 0);
    const struct dicom_item *frame = dicom_item_at(root, TAG_FRAME_GROUPS, 0);
    *facts = (struct dicom_series_facts){ 0 };
    if (!dicom_text(root, TAG_RESCALE_TYPE, facts->unit, sizeof facts->unit))
        (void)dicom_text(root, TAG_UNITS, facts->unit, sizeof facts->unit);
    if (strcmp(facts->unit, "US") == 0) /* "US" is the standard's word for unspecified */
        facts->unit[0] = 0;
    if (!facts->unit[0] && strcmp(series->stack->modality, "CT") == 0)
        snprintf(facts->unit, sizeof facts->unit, "HU");
    facts_from(root, facts);
    if (facts->n_windows == 0 && frame && dicom_n_items(frame, TAG_FRAME_WINDOWS) > 0)
        facts_from(dicom_item_at(frame, TAG_FRAME_WINDOWS, 0), facts);
    else if (facts->n_windows == 0 && shared && dicom_n_items(shared, TAG_FRAME_WINDOWS) > 0)
        facts_from(dicom_item_at(shared, TAG_FRAME_WINDOWS, 0), facts);
}

/* Fills slices and facts from the index, or from the head of a multi-frame file. */
static bool find_slices(struct series *series, struct dicom_series_facts *facts, struct report *report,
                        struct error *err)
{
    const struct dicom_stack *stack = series->stack;
    const struct dicom_object *first = &series->index->objects[stack->objects[0]];
    if (stack->n_slices > DICOM_MAX_SLICES)
        return error_set(err, ERROR_LIMIT, "%s: %u frames; at most %d are read", first->path, stack->n_slices,
                         DICOM_MAX_SLICES);
    series->slices = mem_array(stack->n_slices, sizeof *series->slices, UINT32_MAX, err);
    if (!series->slices)
        return false;
    series->plane = (struct dicom_plane){ .rows = stack->rows, .columns = stack->columns };
    struct bytes bytes = { 0 };
    struct dicom_file *file = open_head(series, stack->objects[stack->n_objects / 2], &bytes, err);
    bool is_found = file != NULL;
    if (file && first->image->has_place)
        slices_of_files(series);
    else if (file)
        is_found = dicom_frames_find(file, first->path, stack->objects[0], first->image->pixels.n_frames,
                                     series->slices, &series->n_slices, &series->plane, report, err);
    if (is_found && facts)
        read_facts(series, file, facts);
    dicom_file_destroy(file);
    if (is_found && !first->image->has_place && !first->image->has_stored)
        series->whole = bytes; /* kept: frames are decoded from it */
    else
        bytes_free(&bytes);
    return is_found;
}

/* Reports impossible rescales: a slope of 0 makes all values equal. */
static void check_scales(struct series *series, struct report *report)
{
    size_t n = 0;
    for (size_t i = 0; i < series->n_slices; i++) {
        struct dicom_slice *slice = &series->slices[i];
        if (slice->slope != 0 && fabs(slice->slope) < 1e30 && fabs(slice->offset) < 1e30)
            continue;
        slice->slope = 1;
        slice->offset = 0;
        n++;
    }
    if (n > 0)
        report_add(report, REPORT_WARNING, "image.rescale", object_of(series, &series->slices[0])->path,
                   "%zu of %zu slices have a rescale slope "
                   "of 0 or beyond all use; their values were taken as stored.",
                   n, series->n_slices);
}

/* Chooses a voxel type that holds all slices, and finds out whether they share one rescale. */
static void choose_type(struct series *series, struct dicom_series_facts *facts, struct report *report)
{
    const struct dicom_slice *first = &series->slices[0];
    const struct dicom_pixels *pixels = &object_of(series, first)->image->pixels;
    size_t n_lossy = 0, n_inverted = 0, n_scales = 0;
    series->is_uniform = true;
    for (size_t i = 0; i < series->n_slices; i++) {
        const struct dicom_slice *slice = &series->slices[i];
        const struct dicom_image *image = object_of(series, slice)->image;
        bool is_same_scale = slice->slope == first->slope && slice->offset == first->offset;
        n_scales += !is_same_scale;
        n_lossy += image->is_lossy;
        n_inverted += image->pixels.is_monochrome1;
        series->is_uniform = series->is_uniform && is_same_scale &&
                             image->pixels.bits_allocated == pixels->bits_allocated &&
                             image->pixels.is_signed == pixels->is_signed;
    }
    if (!series->is_uniform || pixels->bits_allocated == 32)
        series->type = VOXEL_F32;
    else if (pixels->bits_allocated == 16)
        series->type = pixels->is_signed ? VOXEL_I16 : VOXEL_U16;
    else
        series->type = pixels->is_signed ? VOXEL_I16 : VOXEL_U8;
    const char *where = object_of(series, first)->path;
    if (n_scales > 0)
        report_add(report, REPORT_NOTE, "image.slopes-differ", where,
                   "%zu of %zu slices have another scale than the first; all were brought to "
                   "one unit.",
                   n_scales, series->n_slices);
    if (pixels->bits_allocated == 32 && pixels->bits_stored > 24)
        report_add(report, REPORT_NOTE, "image.precision", where, "Values of %u bits are kept with 24.",
                   pixels->bits_stored);
    if (n_lossy > 0)
        report_add(report, REPORT_NOTE, "image.lossy", where, "%zu of %zu slices were compressed with loss.", n_lossy,
                   series->n_slices);
    bool is_inverted = n_inverted > series->n_slices / 2;
    if (facts)
        facts->is_inverted = is_inverted;
    if (n_inverted > 0)
        report_add(
            report, n_inverted < series->n_slices ? REPORT_WARNING : REPORT_NOTE, "image.inverted", where,
            "%zu of %zu slices are "
            "MONOCHROME1: their low values are meant to be white. %s are drawn so; the values are as in the file.",
            n_inverted, series->n_slices,
            n_inverted == series->n_slices ? "They"
            : is_inverted                  ? "All slices"
                                           : "None");
}

static bool read_cells(struct series *series, struct error *err)
{
    int n_threads = series->progress->n_threads > 0 ? series->progress->n_threads : parallel_cores();
    n_threads = n_threads < MAX_THREADS ? n_threads : MAX_THREADS;
    n_threads = (size_t)n_threads < series->n_slices ? n_threads : (int)series->n_slices;
    parallel_run(n_threads, read_part, series);
    report_progress(series);
    join_results(series, n_threads);
    if (!atomic_load(&series->is_failed))
        return true;
    if (err)
        *err = series->error;
    return false;
}

static void interpolate(const struct series *series, const struct dicom_slice_layout *layout, struct volume *volume)
{
    size_t bytes = series->plane_cells * voxel_size(series->type);
    for (uint32_t k = 0; k < layout->grid.size[2]; k++) {
        const struct dicom_plane_source *plane = &layout->planes[k];
        uint8_t *out = (uint8_t *)volume->voxels + k * bytes;
        if (plane->a == plane->b)
            memcpy(out, series->cells + plane->a * bytes, bytes);
        else
            dicom_planes_mix(series->type, series->cells + plane->a * bytes, series->cells + plane->b * bytes,
                             plane->weight, out, series->plane_cells);
    }
}

static void measure(const struct series *series, struct volume *volume)
{
    if (series->type == VOXEL_F32) {
        volume_measure(volume);
        return;
    }
    double a = series->range[0] * volume->slope + volume->offset, b = series->range[1] * volume->slope + volume->offset;
    volume->low = fmin(a, b);
    volume->high = fmax(a, b);
}

/* Converts stored cells of all slices to values, with NaN for padding. */
static void cells_without_padding(const struct series *series, enum voxel_type type, const uint8_t *stored, float *out)
{
    size_t bytes = series->plane_cells * voxel_size(type);
    for (size_t i = 0; i < series->n_slices; i++) {
        const struct dicom_slice *slice = &series->slices[i];
        dicom_padding_convert(&object_of(series, slice)->image->padding, type, stored + i * bytes, series->plane_cells,
                              slice->slope, slice->offset, out + i * series->plane_cells);
    }
}

/* The cells of all slices while a volume is made of them. */
struct made_volume {
    struct volume *volume;
    uint8_t *own; /* cells of uneven slices; NULL: cells are the volume's */
};

static bool make_room(struct series *series, const struct dicom_slice_layout *layout, struct made_volume *made,
                      struct error *err)
{
    made->volume = volume_create_unset(&layout->grid, series->type, err);
    if (!made->volume)
        return false;
    series->cells = made->volume->voxels;
    if (!layout->is_exact) {
        made->own =
            mem_large_array(series->n_slices, series->plane_cells * voxel_size(series->type), VOLUME_MAX_BYTES, err);
        series->cells = made->own;
    }
    return series->cells != NULL;
}

/* Replaces whole numbers by values, as whole numbers have none for padding. */
static bool take_padding_out(struct series *series, const struct dicom_slice_layout *layout, struct made_volume *made,
                             struct error *err)
{
    struct made_volume before = *made;
    const enum voxel_type type = series->type;
    const uint8_t *stored = series->cells;
    *made = (struct made_volume){ NULL, NULL };
    series->type = VOXEL_F32;
    series->is_uniform = false;
    bool is_made = make_room(series, layout, made, err);
    if (is_made)
        cells_without_padding(series, type, stored, (float *)(void *)series->cells);
    volume_unref(before.volume);
    free(before.own);
    return is_made;
}

static struct volume *read_volume(struct series *series, const struct dicom_slice_layout *layout, struct report *report,
                                  struct error *err)
{
    struct made_volume made = { NULL, NULL };
    bool is_read = make_room(series, layout, &made, err) && read_cells(series, err);
    bool is_all = series->n_padding == series->n_slices * series->plane_cells;
    const struct dicom_object *first = object_of(series, &series->slices[0]);
    if (is_read && series->n_padding > 0)
        dicom_padding_report(&first->image->padding, series->n_padding, series->n_slices * series->plane_cells,
                             series->type == VOXEL_F32, first->path, report);
    if (is_read && series->n_padding > 0 && !is_all && series->type != VOXEL_F32)
        is_read = take_padding_out(series, layout, &made, err);
    if (!is_read) {
        free(made.own);
        volume_unref(made.volume);
        return NULL;
    }
    if (made.own)
        interpolate(series, layout, made.volume);
    free(made.own);
    if (series->is_uniform) {
        made.volume->slope = series->slices[0].slope;
        made.volume->offset = series->slices[0].offset;
    }
    measure(series, made.volume);
    return made.volume;
}

struct volume *dicom_series_read(const struct folder *folder, const struct dicom_index *index, size_t stack,
                                 const struct dicom_progress *progress, struct dicom_series_facts *facts,
                                 struct report *report, struct error *err)
{
    static const struct dicom_progress quiet;
    struct series series = {
        .folder = folder, .index = index, .stack = &index->stacks[stack], .progress = progress ? progress : &quiet
    };
    struct dicom_slice_layout layout = { 0 };
    struct volume *volume = NULL;
    series.plane_cells = (size_t)series.stack->rows * series.stack->columns;
    if (find_slices(&series, facts, report, err) &&
        dicom_slices_lay_out(series.slices, series.n_slices, &series.plane,
                             index->objects[series.stack->objects[0]].path, &layout, report, err)) {
        check_scales(&series, report);
        dicom_slices_compare(index, series.stack, report);
        choose_type(&series, facts, report);
        volume = read_volume(&series, &layout, report, err);
        dicom_codestreams_report(&series.coded, object_of(&series, &series.slices[0]), series.n_slices, report);
        dicom_slices_report_surplus(index, series.stack, report);
    }
    free(layout.planes);
    free(series.slices);
    bytes_free(&series.whole);
    return volume;
}

/* Reads DICOM Segmentation objects: segments, their frames, and the packing of overlapping segments into label
 * layers. */
#include "core/formats/dicom/dicom_seg.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/formats/dicom/dicom_coded.h"
#include "core/formats/dicom/dicom_numbers.h"
#include "core/formats/dicom/dicom_seg_grid.h"
#include "core/formats/text.h"
#include "core/region/contour/contour_layer.h"

#define SEG_CLASS "1.2.840.10008.5.1.4.1.1.66.4"

enum {
    SOP_CLASS = DICOM_TAG(0x0008, 0x0016),
    N_FRAMES = DICOM_TAG(0x0028, 0x0008),
    ROWS = DICOM_TAG(0x0028, 0x0010),
    COLUMNS = DICOM_TAG(0x0028, 0x0011),
    BITS_ALLOCATED = DICOM_TAG(0x0028, 0x0100),
    SEGMENTATION_TYPE = DICOM_TAG(0x0062, 0x0001),
    SEGMENT_SEQUENCE = DICOM_TAG(0x0062, 0x0002),
    SEGMENT_NUMBER = DICOM_TAG(0x0062, 0x0004),
    SEGMENT_LABEL = DICOM_TAG(0x0062, 0x0005),
    SEGMENT_COLOR = DICOM_TAG(0x0062, 0x000D),
    MOST_FRACTION = DICOM_TAG(0x0062, 0x000E),
    FRACTION_TYPE = DICOM_TAG(0x0062, 0x0010)
};

struct segment {
    int64_t number;
    struct label_name name; /* without its label value */
    size_t n_frames;
    uint32_t box; /* of the grid */
};

struct reading {
    const struct dicom_file *file;
    const struct dicom_item *root;
    const char *where;
    struct report *report;
    struct segment *segments;
    size_t n_segments;
    struct seg_grid grid;
    bool is_fractional;
    uint32_t threshold;  /* fractional: smallest value that counts as inside */
    const uint8_t *bits; /* binary: the bits of all frames, without gaps between them */
    bool is_swapped;
    uint8_t *cells;             /* fractional: one frame */
    struct dicom_pixels pixels; /* of a fractional segmentation */
    struct dicom_coded coded;
    size_t n_repeated;                       /* frames at a plane where their segment already has one */
    uint32_t layer_boxes[REGION_MAX_LAYERS]; /* the box of each layer */
    uint64_t layer_voxels;                   /* of all layers */
};

/* ---- segments --------------------------------------------------------------------------------------------------- */

static double linear_to_srgb(double c)
{
    c = fmin(1, fmax(0, c));
    return c <= 0.0031308 ? 12.92 * c : 1.055 * pow(c, 1 / 2.4) - 0.055;
}

static double lab_inverse(double t)
{
    return t > 6.0 / 29 ? t * t * t : 3 * (6.0 / 29) * (6.0 / 29) * (t - 4.0 / 29);
}

void dicom_seg_color(const uint16_t lab[3], uint8_t rgb[3])
{
    double l = lab[0] / 65535.0 * 100, a = lab[1] / 65535.0 * 255 - 128, b = lab[2] / 65535.0 * 255 - 128,
           y = (l + 16) / 116;
    double xyz[3] = { 0.96422 * lab_inverse(y + a / 500), lab_inverse(y),
                      0.82521 * lab_inverse(y - b / 200) }; /* white point D50 */
    static const double from_xyz[3][3] = { { 3.1338561, -1.6168667,
                                             -0.4906146 }, /* D50 to D65 and to linear sRGB in one matrix */
                                           { -0.9787684, 1.9161415, 0.0334540 },
                                           { 0.0719453, -0.2289914, 1.4052427 } };
    for (int i = 0; i < 3; i++) {
        double linear = from_xyz[i][0] * xyz[0] + from_xyz[i][1] * xyz[1] + from_xyz[i][2] * xyz[2];
        rgb[i] = (uint8_t)lround(255 * linear_to_srgb(linear));
    }
}

static void read_color(const struct reading *reading, const struct dicom_item *item, struct label_name *name)
{
    double values[3] = { 0, 0, 0 };
    uint16_t lab[3];
    size_t n = dicom_numbers(item, SEGMENT_COLOR, values, 3);
    if (n == 0)
        return;
    bool is_color = n == 3;
    for (int i = 0; i < 3; i++) {
        is_color = is_color && values[i] >= 0 && values[i] <= 65535;
        lab[i] = is_color ? (uint16_t)values[i] : 0;
    }
    if (!is_color) {
        report_add(reading->report, REPORT_WARNING, "dicom.bad-number", reading->where,
                   "\"%s\": its colour (0062,000D) has %zu values, expected three "
                   "from 0 to 65535; it has the palette's.",
                   name->name, n);
        return;
    }
    dicom_seg_color(lab, name->rgb);
    name->has_color = true;
}

static struct segment *find_segment(struct reading *reading, int64_t number)
{
    for (size_t i = 0; i < reading->n_segments; i++)
        if (reading->segments[i].number == number)
            return &reading->segments[i];
    return NULL;
}

static bool read_segments(struct reading *reading, struct error *err)
{
    size_t n = dicom_n_items(reading->root, SEGMENT_SEQUENCE);
    if (n == 0)
        return error_set(err, ERROR_FORMAT, "%s: no Segment Sequence (0062,0002)", reading->where);
    if (n > DICOM_SEG_MAX_DESCRIBED)
        return error_set(err, ERROR_LIMIT, "%s: %zu segments; at most %d are looked at", reading->where, n,
                         DICOM_SEG_MAX_DESCRIBED);
    reading->segments = mem_array(n, sizeof *reading->segments, UINT64_MAX, err);
    if (!reading->segments)
        return false;
    for (size_t i = 0; i < n; i++) {
        const struct dicom_item *item = dicom_item_at(reading->root, SEGMENT_SEQUENCE, i);
        int64_t number;
        if (!dicom_integer(item, SEGMENT_NUMBER, &number) || find_segment(reading, number)) {
            report_add(reading->report, REPORT_WARNING, "region.roi-number", reading->where,
                       "Item %zu of the segments (0062,0002) has no number "
                       "(0062,0004) of its own, so no frame can refer to it; it was left out.",
                       i + 1);
            continue;
        }
        struct segment *segment = &reading->segments[reading->n_segments++];
        segment->number = number;
        if (!dicom_text(item, SEGMENT_LABEL, segment->name.name, sizeof segment->name.name)) {
            snprintf(segment->name.name, sizeof segment->name.name, "Segment %lld", (long long)number);
            report_add(reading->report, REPORT_NOTE, "region.unnamed", reading->where,
                       "Segment %lld has no label; it is called \"%s\".", (long long)number, segment->name.name);
        }
        read_color(reading, item, &segment->name);
    }
    return true;
}

/* ---- pixels ----------------------------------------------------------------------------------------------------- */

static bool need_integer(const struct reading *reading, uint32_t tag, const char *name, int64_t low, int64_t high,
                         uint32_t *out, struct error *err)
{
    int64_t value;
    if (!dicom_integer(reading->root, tag, &value))
        return error_set(err, ERROR_FORMAT, "%s: element (%04X,%04X), %s: expected a whole number, found none",
                         reading->where, tag >> 16, tag & 0xFFFF, name);
    if (value < low || value > high)
        return error_set(err, ERROR_LIMIT, "%s: element (%04X,%04X), %s: found %lld, expected %lld to %lld",
                         reading->where, tag >> 16, tag & 0xFFFF, name, (long long)value, (long long)low,
                         (long long)high);
    *out = (uint32_t)value;
    return true;
}

static bool look_at_bits(struct reading *reading, struct error *err)
{
    const struct seg_grid *grid = &reading->grid;
    uint64_t needed = ((uint64_t)grid->rows * grid->columns * grid->n_frames + 7) / 8, size = 0;
    reading->bits = dicom_pixels_bytes(reading->file, &size, &reading->is_swapped);
    if (reading->is_swapped)
        needed += needed % 2; /* with words, the last byte may be in the upper half */
    if (!reading->bits)
        return error_set(err, ERROR_UNSUPPORTED,
                         "%s: its bits are compressed (%s, %s), or not there; only plain ones are read", reading->where,
                         dicom_uid_word(dicom_transfer_syntax(reading->file)), dicom_transfer_syntax(reading->file));
    if (size < needed)
        return error_set(err, ERROR_FORMAT, "%s: pixel data of %llu bytes; %u x %u x %u pixels of 1 bit need %llu",
                         reading->where, (unsigned long long)size, grid->columns, grid->rows, grid->n_frames,
                         (unsigned long long)needed);
    if (size > needed + needed % 2)
        report_add(reading->report, REPORT_WARNING, "dicom.surplus-pixels", reading->where,
                   "The pixel data hold %llu bytes more than the %u frames that the file declares; they are not shown.",
                   (unsigned long long)(size - needed), grid->n_frames);
    return true;
}

static bool look_at_fractions(struct reading *reading, struct error *err)
{
    struct dicom_pixels pixels;
    char type[20] = "";
    uint32_t most;
    if (!dicom_pixels_look(reading->file, &pixels, err) ||
        !need_integer(reading, MOST_FRACTION, "maximum fractional value", 1, 255, &most, err))
        return false;
    if (pixels.bits_allocated != 8 || pixels.is_signed)
        return error_set(err, ERROR_UNSUPPORTED,
                         "%s: a fractional segmentation of %u bits a pixel, expected 8 without a sign", reading->where,
                         pixels.bits_allocated);
    reading->pixels = pixels;
    reading->threshold = (most + 1) / 2;
    reading->cells = mem_array((size_t)pixels.rows * pixels.columns, 1, UINT32_MAX, err);
    dicom_text(reading->root, FRACTION_TYPE, type, sizeof type);
    report_add(reading->report, REPORT_NOTE, "mask.fractional", reading->where,
               "The segments are fractional (%s): voxels of %u of %u and more count "
               "as inside.",
               type[0] ? type : "of a kind not said", reading->threshold, most);
    return reading->cells != NULL;
}

static bool read_pixels_module(struct reading *reading, struct error *err)
{
    struct seg_grid *grid = &reading->grid;
    char type[20];
    uint32_t bits = 0;
    if (!need_integer(reading, ROWS, "rows", 1, DICOM_MAX_SIDE, &grid->rows, err) ||
        !need_integer(reading, COLUMNS, "columns", 1, DICOM_MAX_SIDE, &grid->columns, err) ||
        !need_integer(reading, N_FRAMES, "number of frames", 1, DICOM_SEG_MAX_FRAMES, &grid->n_frames, err) ||
        !need_integer(reading, BITS_ALLOCATED, "bits allocated", 1, 8, &bits, err))
        return false;
    dicom_text(reading->root, SEGMENTATION_TYPE, type, sizeof type);
    reading->is_fractional = strcmp(type, "FRACTIONAL") == 0;
    if ((!reading->is_fractional && strcmp(type, "BINARY") != 0) || bits != (reading->is_fractional ? 8 : 1))
        return error_set(
            err, ERROR_UNSUPPORTED,
            "%s: a segmentation of type (0062,0001) \"%s\" with %u bits a pixel; BINARY with 1 and FRACTIONAL "
            "with 8 are read",
            reading->where, type, bits);
    return reading->is_fractional ? look_at_fractions(reading, err) : look_at_bits(reading, err);
}

/* Adds a row of n bits to a row of a mask. at: index of its first pixel among all frames; the lowest bit of a byte
 * comes first (DICOM PS3.5 8.1.1). */
static void add_bits(const struct reading *reading, uint64_t at, uint32_t n, uint64_t *row)
{
    for (uint32_t i = 0; i < n;) {
        uint64_t byte = (at + i) / 8;
        uint32_t from = (uint32_t)((at + i) % 8), more = 8 - from < n - i ? 8 - from : n - i;
        uint64_t bits = (uint64_t)(reading->bits[reading->is_swapped ? byte ^ 1 : byte] >> from) & ((1u << more) - 1);
        row[i / 64] |= bits << i % 64;
        if (i % 64 + more > 64)
            row[i / 64 + 1] |= bits >> (64 - i % 64);
        i += more;
    }
}

static void add_cells(const struct reading *reading, const uint8_t *cells, uint32_t n, uint64_t *row)
{
    for (uint32_t i = 0; i < n; i++)
        row[i / 64] |= (uint64_t)(cells[i] >= reading->threshold) << i % 64;
}

static bool add_frame(struct reading *reading, uint32_t frame, struct mask *mask, struct error *err)
{
    const struct seg_grid *grid = &reading->grid;
    uint32_t k = grid->frames[frame].plane - grid->boxes[grid->frames[frame].box].low_k;
    if (reading->is_fractional && !dicom_pixels_read(reading->file, frame, reading->cells, err))
        return false;
    if (reading->is_fractional)
        dicom_coded_count(&reading->coded, reading->file, &reading->pixels);
    for (uint32_t y = 0; y < grid->rows; y++) {
        uint64_t *row = mask->bits + ((size_t)k * grid->rows + y) * mask->words;
        if (reading->is_fractional)
            add_cells(reading, reading->cells + (size_t)y * grid->columns, grid->columns, row);
        else
            add_bits(reading, ((uint64_t)frame * grid->rows + y) * grid->columns, grid->columns, row);
    }
    return true;
}

/* ---- layers ----------------------------------------------------------------------------------------------------- */

static struct mask *read_mask(struct reading *reading, const struct segment *segment, struct error *err)
{
    const struct seg_grid *grid = &reading->grid;
    const struct seg_box *box = &grid->boxes[segment->box];
    if (grid_n_voxels(&box->grid) > DICOM_SEG_MAX_VOXELS) {
        error_set(err, ERROR_LIMIT, "its planes take %u x %u x %u voxels; at most %llu are read", box->grid.size[0],
                  box->grid.size[1], box->grid.size[2], (unsigned long long)DICOM_SEG_MAX_VOXELS);
        return NULL;
    }
    struct mask *mask = mask_create_empty(box->grid.size, &box->grid.lps_mm_from_ijk, err);
    uint32_t low_k = box->grid.size[2], end_k = 0; /* extent of the segment; the rest of the mask is not looked at */
    bool *has_plane = mask ? mem_array(box->grid.size[2], sizeof *has_plane, UINT32_MAX, err) : NULL,
         is_read = has_plane != NULL;
    for (uint32_t f = 0; is_read && f < grid->n_frames; f++) {
        if (!grid->frames[f].is_used || grid->frames[f].segment != segment->number)
            continue;
        uint32_t k = grid->frames[f].plane - box->low_k;
        reading->n_repeated += has_plane[k];
        has_plane[k] = true;
        low_k = k < low_k ? k : low_k;
        end_k = k >= end_k ? k + 1 : end_k;
        is_read = add_frame(reading, f, mask, err);
    }
    free(has_plane);
    if (!is_read) {
        mask_destroy(mask);
        return NULL;
    }
    mask->low_k = low_k;
    mask->end_k = end_k;
    return mask;
}

static bool add_name(struct label_names *names, const struct label_name *name, uint16_t value, struct error *err)
{
    struct label_name *more = realloc(names->labels, (names->n + 1) * sizeof *more);
    if (!more)
        return error_set(err, ERROR_MEMORY, "no memory for the names of %zu segments", names->n + 1);
    names->labels = more;
    more[names->n] = *name;
    more[names->n++].value = value;
    return true;
}

/* Adds the mask to the first layer of its box that it does not overlap. */
static bool add_mask(struct reading *reading, const struct mask *mask, const struct segment *segment,
                     struct nrrd_layers *layers, struct error *err)
{
    const uint64_t n_voxels = grid_n_voxels(&reading->grid.boxes[segment->box].grid);
    size_t at = 0;
    while (at < layers->n && (reading->layer_boxes[at] != segment->box || layers->names[at].n >= UINT8_MAX ||
                              !mask_layer_is_free(mask, layers->volumes[at])))
        at++;
    if (at < layers->n) {
        uint16_t value = (uint16_t)(layers->names[at].n + 1);
        mask_layer_put(mask, layers->volumes[at], value);
        return add_name(&layers->names[at], &segment->name, value, err);
    }
    if (at == REGION_MAX_LAYERS || reading->layer_voxels + n_voxels > VOLUME_MAX_BYTES)
        return error_set(err, ERROR_LIMIT,
                         "its segments overlap so much that more than %zu layers of labels would be "
                         "needed",
                         at);
    layers->volumes[at] = mask_layer_create(mask, err);
    if (!layers->volumes[at])
        return false;
    reading->layer_boxes[at] = segment->box;
    reading->layer_voxels += n_voxels;
    layers->n++;
    return add_name(&layers->names[at], &segment->name, 1, err);
}

/* Names for a line of the report: as many as fit. */
struct names {
    char text[200];
    size_t n;
};

static void put_name(struct names *names, const char *name)
{
    size_t length = strlen(names->text);
    snprintf(names->text + length, sizeof names->text - length, "%s%s", names->n > 0 ? ", " : "", name);
    names->n++;
}

/* Reads a segment into the layers. One without a voxel is added to empty. */
static bool fill_segment(struct reading *reading, const struct segment *segment, struct nrrd_layers *layers,
                         struct names *empty, struct error *err)
{
    struct mask *mask = segment->n_frames > 0 ? read_mask(reading, segment, err) : NULL;
    if (segment->n_frames > 0 && !mask)
        return false;
    bool has_voxel = mask && mask_count(mask) > 0, is_filled = true;
    if (has_voxel)
        is_filled = add_mask(reading, mask, segment, layers, err);
    else
        put_name(empty, segment->name.name);
    mask_destroy(mask);
    return is_filled;
}

static void report_filled(const struct reading *reading, const struct names *empty, const struct names *left,
                          const char *why)
{
    if (empty->n > 0)
        report_add(reading->report, REPORT_WARNING, "region.unused-names", reading->where,
                   "%zu of %zu segments have no voxel and are not listed: %s.", empty->n, reading->n_segments,
                   empty->text);
    if (left->n > 0)
        report_add(reading->report, REPORT_ERROR, "region.too-many", reading->where,
                   "%zu of %zu segments were left out, as %s: %s.", left->n, reading->n_segments, why, left->text);
    if (reading->n_repeated > 0)
        report_add(reading->report, REPORT_WARNING, "image.slices-repeated", reading->where,
                   "%zu frames lie where another one of the same segment "
                   "does; both were taken together.",
                   reading->n_repeated);
}

/* Fills all wanted segments; those beyond a limit are left out and reported. */
static bool fill_layers(struct reading *reading, const char *only, struct nrrd_layers *layers, struct error *err)
{
    struct names empty = { "", 0 }, left = { "", 0 };
    struct error first = { 0 };
    size_t n_wanted = 0, n_filled = 0;
    for (size_t i = 0; i < reading->n_segments; i++) {
        const struct segment *segment = &reading->segments[i];
        struct error why = { 0 };
        if (only[0] && !text_equal(only, segment->name.name))
            continue;
        n_wanted++;
        bool has_room = n_filled < DICOM_SEG_MAX_SEGMENTS ||
                        error_set(&why, ERROR_LIMIT, "at most %d are read", DICOM_SEG_MAX_SEGMENTS);
        if (has_room && fill_segment(reading, segment, layers, &empty, &why)) {
            n_filled = 0;
            for (size_t l = 0; l < layers->n; l++)
                n_filled += layers->names[l].n;
            continue;
        }
        if (why.code != ERROR_LIMIT) {
            if (err)
                *err = why;
            return false;
        }
        if (left.n == 0)
            first = why;
        put_name(&left, segment->name.name);
    }
    report_filled(reading, &empty, &left, first.text);
    return !only[0] || n_wanted > 0 ||
           error_set(err, ERROR_NOT_FOUND, "%s: no segment is called \"%s\"", reading->where, only);
}

/* Counts the frames of each segment; frames of unknown segments are reported and not used. */
static void assign_frames(struct reading *reading)
{
    size_t n_unknown = 0;
    int64_t first_unknown = 0;
    for (uint32_t f = 0; f < reading->grid.n_frames; f++) {
        struct seg_frame *frame = &reading->grid.frames[f];
        struct segment *segment = frame->is_used ? find_segment(reading, frame->segment) : NULL;
        if (segment) {
            segment->n_frames++;
        } else if (frame->is_used) {
            first_unknown = n_unknown == 0 ? frame->segment : first_unknown;
            n_unknown++;
            frame->is_used = false;
        }
    }
    if (n_unknown > 0)
        report_add(reading->report, REPORT_WARNING, "region.roi-number", reading->where,
                   "%zu frames belong to segments (0062,000B) that the file "
                   "does not describe (the first: %lld); they were left out.",
                   n_unknown, (long long)first_unknown);
}

static void find_boxes(struct reading *reading)
{
    for (uint32_t f = 0; f < reading->grid.n_frames; f++) {
        const struct seg_frame *frame = &reading->grid.frames[f];
        struct segment *segment = frame->is_used ? find_segment(reading, frame->segment) : NULL;
        if (segment)
            segment->box = frame->box;
    }
}

bool dicom_seg_read(const struct dicom_file *file, const char *where, const char *only, struct nrrd_layers *layers,
                    struct report *report, struct error *err)
{
    struct reading reading = { .file = file, .root = dicom_root(file), .where = where, .report = report };
    char class[DICOM_UID_SIZE];
    *layers = (struct nrrd_layers){ 0 };
    dicom_text(reading.root, SOP_CLASS, class, sizeof class);
    if (strcmp(class, SEG_CLASS) != 0)
        return error_set(err, ERROR_UNSUPPORTED, "%s: a DICOM object of class %s, expected a segmentation", where,
                         class);
    dicom_numbers_report(file, 0, where, report);
    bool is_read = read_segments(&reading, err) && read_pixels_module(&reading, err) &&
                   seg_grid_find(&reading.grid, reading.root, where, report, err);
    if (is_read) {
        assign_frames(&reading);
        is_read = seg_grid_find_boxes(&reading.grid, err);
        find_boxes(&reading);
        is_read = is_read && fill_layers(&reading, only, layers, err);
    }
    if (is_read && reading.is_fractional)
        dicom_coded_report(&reading.coded, file, &reading.pixels, where, report);
    if (is_read) {
        const uint32_t *size = reading.grid.grid.size;
        report_add(report, REPORT_NOTE, "region.segments", where,
                   "%zu segments in %u frames (%s), on the frames' own grid of %u x %u x %u voxels; "
                   "%zu layers of labels in %zu boxes of it.",
                   reading.n_segments, reading.grid.n_frames, reading.is_fractional ? "FRACTIONAL" : "BINARY", size[0],
                   size[1], size[2], layers->n, reading.grid.n_boxes);
    } else {
        nrrd_layers_finish(layers);
    }
    free(reading.segments);
    free(reading.grid.frames);
    free(reading.cells);
    return is_read;
}

bool dicom_seg_measure(const struct dicom_file *file, uint64_t *n_voxels, size_t *n_segments)
{
    struct reading reading = { .file = file, .root = dicom_root(file), .where = "" };
    struct seg_grid *grid = &reading.grid;
    bool is_found =
        need_integer(&reading, ROWS, "rows", 1, DICOM_MAX_SIDE, &grid->rows, NULL) &&
        need_integer(&reading, COLUMNS, "columns", 1, DICOM_MAX_SIDE, &grid->columns, NULL) &&
        need_integer(&reading, N_FRAMES, "number of frames", 1, DICOM_SEG_MAX_FRAMES, &grid->n_frames, NULL) &&
        seg_grid_find(grid, reading.root, "", NULL, NULL) && seg_grid_find_boxes(grid, NULL);
    *n_voxels = 0;
    for (size_t i = 0; is_found && i < grid->n_boxes; i++)
        *n_voxels += grid_n_voxels(&grid->boxes[i].grid);
    *n_segments = dicom_n_items(reading.root, SEGMENT_SEQUENCE);
    free(grid->frames);
    return is_found;
}

/* Reads NRRD voxels into a volume, or label layers into several. */
#include "core/formats/nrrd.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/formats/gzip.h"

void nrrd_header_finish(struct nrrd_header *header)
{
    free(header->segments);
    header->segments = NULL;
    header->n_segments = 0;
}

/* Finds the offset of the voxels, or of their gzip stream, in the file. */
static bool find_start(const struct nrrd_header *header, const struct bytes *data, const char *name, size_t *start,
                       struct error *err)
{
    *start = header->data_file[0] ? 0 : header->head_bytes;
    if (*start > data->size)
        return error_set(err, ERROR_FORMAT, "%s: the file shrank while it was read", name);
    for (uint64_t i = 0; i < header->line_skip; i++) {
        const uint8_t *end = *start < data->size ? memchr(data->data + *start, '\n', data->size - *start) : NULL;
        if (!end)
            return error_set(err, ERROR_FORMAT, "%s: %llu lines before the end of the file, but \"line skip\" is %llu",
                             name, (unsigned long long)i, (unsigned long long)header->line_skip);
        *start = (size_t)(end - data->data) + 1;
    }
    return true;
}

static bool unpack(const struct nrrd_header *header, const struct bytes *data, const char *name,
                   struct raw_unpacked *unpacked, struct report *report, struct error *err)
{
    size_t start;
    if (!find_start(header, data, name, &start, err))
        return false;
    struct raw_place place = { .file = { data->data + start, data->size - start },
                               .is_packed = header->is_packed,
                               .is_swapped = header->is_swapped,
                               .data_bytes = header->data_bytes,
                               .voxel_bytes = header->voxel_bytes };
    if (header->byte_skip >= 0)
        place.data_at = (uint64_t)header->byte_skip;
    else if (place.file.size >= header->data_bytes)
        place.data_at = place.file.size - header->data_bytes;
    if (header->is_packed && !gzip_is(place.file.data, place.file.size))
        return error_set(err, ERROR_FORMAT, "%s: byte %zu: expected a gzip stream, which begins with 1f 8b%s", name,
                         start, place.file.size < 2 ? "; the file ends there" : "");
    return raw_unpack(&place, name, unpacked, report, err);
}

struct volume *nrrd_read(const struct nrrd_header *header, const struct bytes *data, const char *data_name,
                         enum raw_use use, struct report *report, struct error *err)
{
    struct raw_unpacked unpacked;
    if (header->n_layers != 1) {
        error_set(err, ERROR_UNSUPPORTED,
                  "%s: %u values a voxel (an axis of kind \"%s\"), which only label maps may have here; "
                  "one volume is read",
                  data_name, header->n_layers, header->list_kind);
        return NULL;
    }
    if (!unpack(header, data, data_name, &unpacked, report, err))
        return NULL;
    struct raw_voxels voxels = {
        unpacked.data, grid_n_voxels(&header->grid), header->type, &header->grid, 1, 0, data_name, &unpacked.owned
    };
    struct volume *volume = raw_read(&voxels, use, report, err);
    free(unpacked.owned);
    return volume;
}

/* Copies every n_layers-th value, from the first on: one layer of interleaved ones. */
static void pick_layer(const struct nrrd_header *header, const uint8_t *from, uint8_t *to, size_t n)
{
    size_t step = header->n_layers;
#define PICK(type) \
    do { \
        const type *in = (const void *)from; \
        type *out = (void *)to; \
        for (size_t i = 0; i < n; i++) \
            out[i] = in[i * step]; \
    } while (0)
    switch (header->voxel_bytes) {
    case 1: PICK(uint8_t); break;
    case 2: PICK(uint16_t); break;
    case 4: PICK(uint32_t); break;
    default: PICK(uint64_t); break;
    }
}

static void name_layer(const struct nrrd_header *header, uint32_t layer, struct label_names *names)
{
    *names = (struct label_names){ 0 };
    for (size_t i = 0; i < header->n_segments; i++)
        names->n += header->segments[i].is_present && header->segments[i].layer == layer;
    if (names->n == 0)
        return;
    names->labels = mem_new(names->n * sizeof *names->labels);
    struct label_name *label = names->labels;
    for (size_t i = 0; i < header->n_segments; i++) {
        const struct nrrd_segment *segment = &header->segments[i];
        if (!segment->is_present || segment->layer != layer)
            continue;
        label->value = segment->label;
        label->has_color = segment->has_color;
        memcpy(label->rgb, segment->rgb, 3);
        memcpy(label->name, segment->name, sizeof label->name);
        label++;
    }
}

static struct volume *read_layer(const struct nrrd_header *header, const uint8_t *voxels, uint32_t layer,
                                 uint8_t *picked, const char *name, struct error *err)
{
    size_t n = grid_n_voxels(&header->grid);
    const uint8_t *from = voxels + (header->is_layer_fastest ? 1 : n) * layer * header->voxel_bytes;
    if (picked)
        pick_layer(header, from, picked, n);
    struct raw_voxels raw = { picked ? picked : from, n, header->type, &header->grid, 1, 0, name, NULL };
    struct volume *volume = raw_read(&raw, RAW_LABELS, NULL, err);
    if (!volume && header->n_layers > 1 && err)
        error_prefix(err, "layer %u", layer);
    return volume;
}

bool nrrd_read_layers(const struct nrrd_header *header, const struct bytes *data, const char *data_name,
                      struct nrrd_layers *layers, struct report *report, struct error *err)
{
    struct raw_unpacked unpacked;
    layers->n = 0;
    if (header->n_layers > REGION_MAX_LAYERS)
        return error_set(err, ERROR_LIMIT, "%s: %u layers of labels; at most %d are read", data_name, header->n_layers,
                         REGION_MAX_LAYERS);
    if (!unpack(header, data, data_name, &unpacked, report, err))
        return false;
    uint8_t *picked = NULL;
    bool is_read = true;
    if (header->is_layer_fastest && header->n_layers > 1) {
        size_t bytes = (size_t)(header->data_bytes / header->n_layers);
        picked = malloc(bytes);
        is_read = picked || error_set(err, ERROR_MEMORY, "%s: no memory for %zu bytes", data_name, bytes);
    }
    for (uint32_t i = 0; is_read && i < header->n_layers; i++) {
        layers->volumes[i] = read_layer(header, unpacked.data, i, picked, data_name, err);
        is_read = layers->volumes[i] != NULL;
        if (is_read) {
            name_layer(header, i, &layers->names[i]);
            layers->n++;
        }
    }
    free(picked);
    free(unpacked.owned);
    if (!is_read)
        nrrd_layers_finish(layers);
    return is_read;
}

void nrrd_layers_finish(struct nrrd_layers *layers)
{
    for (size_t i = 0; i < layers->n; i++) {
        volume_unref(layers->volumes[i]);
        label_names_finish(&layers->names[i]);
    }
    layers->n = 0;
}

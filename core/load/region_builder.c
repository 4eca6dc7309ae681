/* Builds the plan's regions from the files that were read. */
#include "core/load/region_builder.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/formats/text.h"
#include "core/load/part_names.h"
#include "core/load/reader_table.h"
#include "core/region/contour/contour_layer.h"
#include "core/region/label_rows.h"

void region_builder_init(struct region_builder *builder, struct region_set *set, struct report *report)
{
    *builder = (struct region_builder){ .set = set, .report = report };
    builder->pairs = mem_new(PLAN_FILE_MAX_PAIRS * sizeof *builder->pairs);
    set->regions = mem_new(REGION_MAX * sizeof *set->regions);
}

void region_builder_finish(struct region_builder *builder)
{
    free(builder->pairs);
    builder->pairs = NULL;
}

static struct region *add_region(struct region_builder *builder, const char *name, uint32_t layer, uint16_t label,
                                 const char *where, struct error *err)
{
    struct region_set *set = builder->set;
    if (set->n_regions >= REGION_MAX) {
        error_set(err, ERROR_LIMIT, "%s: more than %d regions in the plan", where, REGION_MAX);
        return NULL;
    }
    struct region *region = &set->regions[set->n_regions];
    *region = (struct region){ .parent = -1,
                               .layer = layer,
                               .label = label,
                               .boron_ratio = NAN,
                               .cbe_boron = NAN,
                               .rbe_nitrogen = NAN,
                               .rbe_fast = NAN,
                               .rbe_gamma = NAN };
    for (size_t i = 0; i < set->n_regions; i++)
        if (text_equal(set->regions[i].name, name)) {
            report_add(builder->report, REPORT_NOTE, "region.renamed", where,
                       "The name \"%s\" is there more than once.", name);
            break;
        }
    region_make_id(set, name, region->id);
    snprintf(region->name, sizeof region->name, "%s", name);
    region_palette(set->n_regions, region->rgb);
    set->n_regions++;
    return region;
}

static bool is_free_id(const struct region_set *set, const char *id)
{
    return id[0] && strspn(id, "abcdefghijklmnopqrstuvwxyz0123456789-") == strlen(id) && !region_find(set, id);
}

/* Takes colour, id, tissue data and place from an entry of a list of names. */
static void apply_label(struct region_builder *builder, struct region *region, const struct label_name *label)
{
    struct region_set *set = builder->set;
    if (label->has_color) {
        region->has_file_color = true;
        memcpy(region->rgb, label->rgb, 3);
    }
    region->file_opacity = label->opacity;
    region->is_target = label->is_target;
    if (strcmp(label->id, region->id) != 0 && is_free_id(set, label->id))
        memcpy(region->id, label->id, sizeof region->id);
    if (label->has_tissue) {
        region->boron_ratio = label->tissue.boron_ratio;
        region->cbe_boron = label->tissue.cbe_boron;
        region->rbe_nitrogen = label->tissue.rbe_nitrogen;
        region->rbe_fast = label->tissue.rbe_fast;
        region->rbe_gamma = label->tissue.rbe_gamma;
    }
    builder->places[region - set->regions] = label->place;
}

void region_builder_order(struct region_builder *builder)
{
    struct region_set *set = builder->set;
    bool has_places = false;
    for (size_t i = 0; i < set->n_regions; i++)
        has_places |= builder->places[i] > 0;
    for (size_t i = 1; has_places && i < set->n_regions; i++) { /* equal places keep their order */
        struct region region = set->regions[i];
        int place = builder->places[i];
        size_t at = i;
        for (; at > 0 && (unsigned)(builder->places[at - 1] - 1) > (unsigned)(place - 1);
             at--) { /* place 0 sorts last */
            set->regions[at] = set->regions[at - 1];
            builder->places[at] = builder->places[at - 1];
        }
        set->regions[at] = region;
        builder->places[at] = place;
    }
    for (size_t i = 0; has_places && i < set->n_regions; i++)
        if (!set->regions[i].has_file_color)
            region_palette(i, set->regions[i].rgb);
}

static bool add_layer(struct region_builder *builder, struct volume *volume, const char *where, uint32_t *layer,
                      struct error *err)
{
    struct region_set *set = builder->set;
    if (set->n_layers >= REGION_MAX_LAYERS) {
        volume_unref(volume);
        return error_set(err, ERROR_LIMIT, "%s: more than %d layers of labels in the plan", where, REGION_MAX_LAYERS);
    }
    *layer = (uint32_t)set->n_layers;
    set->layers[set->n_layers++] = volume;
    return true;
}

static void count_run(void *context, uint16_t label, uint32_t i, uint32_t j, uint32_t k, uint32_t length)
{
    (void)i;
    (void)j;
    (void)k;
    ((uint64_t *)context)[label] += length;
}

/* Counts the voxels of each label, 1 to 65535. The caller frees the counts. */
static uint64_t *count_labels(const struct volume *volume)
{
    uint64_t *counts = mem_new(65536 * sizeof *counts);
    label_rows_runs(volume, count_run, counts);
    return counts;
}

/* True for the filling around the patient in univel models: its name, and at least four corners of the
 * grid. */
static bool is_surroundings(const struct volume *volume, const char *name, uint16_t label)
{
    if (!text_equal(name, "buffer") && !text_equal(name, "void"))
        return false;
    const uint32_t *size = volume->grid.size;
    int corners = 0;
    for (int corner = 0; corner < 8; corner++)
        corners += volume_label(volume, corner & 1 ? size[0] - 1 : 0, corner & 2 ? size[1] - 1 : 0,
                                corner & 4 ? size[2] - 1 : 0) == label;
    return corners >= 4;
}

static void note_surroundings(struct region_builder *builder, const char *name, const char *where)
{
    report_add(builder->report, REPORT_NOTE, "region.surroundings", where,
               "\"%s\" fills the space around the patient and is not listed as a region.", name);
}

/* Names a label that has no name: after the file when it is the only label, else by its number. */
static void make_name(char name[REGION_NAME_SIZE], uint32_t label, bool is_only, const char *where)
{
    const char *base = part_base_name(where);
    char stem[REGION_NAME_SIZE];
    snprintf(stem, sizeof stem, "%.*s", part_stem_length(base), base);
    if (is_only && stem[0])
        text_clean(stem, name, REGION_NAME_SIZE);
    else
        snprintf(name, REGION_NAME_SIZE, "label %u", label);
}

static bool add_unnamed(struct region_builder *builder, const uint64_t *counts, const bool *is_named, uint32_t layer,
                        const char *where, struct error *err)
{
    size_t n_labels = 0;
    for (uint32_t label = 1; label < 65536; label++)
        n_labels += counts[label] > 0;
    for (uint32_t label = 1; label < 65536; label++) {
        if (counts[label] == 0 || is_named[label])
            continue;
        char name[REGION_NAME_SIZE];
        make_name(name, label, n_labels == 1, where);
        report_add(builder->report, REPORT_NOTE, "region.unnamed", where,
                   "%llu voxels carry the label %u, which has no name.", (unsigned long long)counts[label], label);
        if (!add_region(builder, name, layer, (uint16_t)label, where, err))
            return false;
    }
    return true;
}

static void add_pair(struct region_builder *builder, const char *outer, const char *inner)
{
    if (builder->n_pairs >= PLAN_FILE_MAX_PAIRS)
        return;
    struct plan_file_pair *pair = &builder->pairs[builder->n_pairs++];
    snprintf(pair->outer, sizeof pair->outer, "%s", outer);
    snprintf(pair->inner, sizeof pair->inner, "%s", inner);
}

/* Refuses a file whose labels are more than the plan has room for, before any of them is added. */
static bool has_room_for_labels(const struct region_builder *builder, const uint64_t *counts, const char *where,
                                struct error *err)
{
    size_t n_labels = 0;
    for (uint32_t label = 1; label < 65536; label++)
        n_labels += counts[label] > 0;
    return builder->set->n_regions + n_labels <= REGION_MAX ||
           error_set(err, ERROR_LIMIT, "%s: %zu labels besides %zu regions; at most %d regions in a plan", where,
                     n_labels, builder->set->n_regions, REGION_MAX);
}

static bool has_a_label(const uint64_t *counts)
{
    for (uint32_t label = 1; label < 65536; label++)
        if (counts[label])
            return true;
    return false;
}

bool region_builder_add_labels(struct region_builder *builder, struct volume *labels, const struct label_names *names,
                               const char *where, struct error *err)
{
    uint32_t layer = 0;
    uint64_t *counts = count_labels(labels);
    if (!has_room_for_labels(builder, counts, where, err)) {
        free(counts);
        volume_unref(labels);
        return false;
    }
    if (!add_layer(builder, labels, where, &layer, err)) {
        free(counts);
        return false;
    }
    if (!has_a_label(counts))
        report_add(builder->report, REPORT_WARNING, "region.none", where, "Every voxel is 0, so it holds no region.");
    bool *is_named = mem_new(65536);
    bool is_added = true;
    size_t n_unused = 0;
    for (size_t i = 0; is_added && i < names->n; i++) {
        const struct label_name *label = &names->labels[i];
        if (label->value == 0 || is_named[label->value] || !label->name[0])
            continue;
        is_named[label->value] = true;
        if (counts[label->value] == 0 && !label->id[0]) {
            n_unused++;
            continue;
        }
        if (!label->id[0] && is_surroundings(labels, label->name, label->value)) {
            note_surroundings(builder, label->name, where);
            continue;
        }
        struct region *region = add_region(builder, label->name, layer, label->value, where, err);
        is_added = region != NULL;
        if (region)
            apply_label(builder, region, label);
        if (region && label->parent[0])
            add_pair(builder, label->parent, label->name);
    }
    if (n_unused > 0)
        report_add(builder->report, REPORT_NOTE, "region.unused-names", where, "%zu named labels have no voxel.",
                   n_unused);
    is_added = is_added && add_unnamed(builder, counts, is_named, layer, where, err);
    free(counts);
    free(is_named);
    return is_added;
}

bool region_builder_add_univels(struct region_builder *builder, struct volume *univels, const struct uvh *uvh,
                                const char *where, struct error *err)
{
    uint32_t layer = 0;
    uint64_t *counts = count_labels(univels);
    if (!has_room_for_labels(builder, counts, where, err)) {
        free(counts);
        volume_unref(univels);
        return false;
    }
    if (!add_layer(builder, univels, where, &layer, err)) {
        free(counts);
        return false;
    }
    bool *is_named = mem_new(65536);
    bool is_added = true;
    is_named[1] = true; /* SERA reserves 1 for the buffer, named or not */
    for (size_t i = 0; is_added && i < uvh->n_bodies; i++) {
        const struct uvh_body *body = &uvh->bodies[i];
        is_named[body->uvval] = true;
        if (body->uvval == 0 || is_surroundings(univels, body->name, (uint16_t)body->uvval)) {
            note_surroundings(builder, body->name, where);
            continue;
        }
        if (strstr(body->name, "ABSENT")) {
            report_add(builder->report, REPORT_NOTE, "region.absent", where, "\"%s\" is not listed.", body->name);
            continue;
        }
        char name[REGION_NAME_SIZE];
        snprintf(name, sizeof name, "%s", body->name);
        if (!name[0])
            snprintf(name, sizeof name, "univel %d", body->uvval);
        struct region *region = add_region(builder, name, layer, (uint16_t)body->uvval, where, err);
        is_added = region != NULL;
        if (!region)
            break;
        region->boron_ratio = body->boron_ratio;
        region->cbe_boron = body->cbe_boron;
        region->rbe_nitrogen = body->rbe_nitrogen;
        region->rbe_fast = body->rbe_fast;
        region->rbe_gamma = body->rbe_gamma;
        if (body->has_color) {
            region->has_file_color = true;
            memcpy(region->rgb, body->rgb, 3);
        }
    }
    is_added = is_added && add_unnamed(builder, counts, is_named, layer, where, err);
    free(counts);
    free(is_named);
    return is_added;
}

static bool grids_are_equal(const struct grid *a, const struct grid *b)
{
    if (memcmp(a->size, b->size, sizeof a->size) != 0)
        return false;
    struct vec3 spacing = grid_spacing_mm(a);
    double most_mm = 0.01 * fmin(spacing.x, fmin(spacing.y, spacing.z));
    for (int corner = 0; corner < 8; corner++) {
        struct vec3 at = vec3(corner & 1 ? a->size[0] : 0, corner & 2 ? a->size[1] : 0, corner & 4 ? a->size[2] : 0);
        if (!(vec3_length(vec3_sub(affine_point(&a->lps_mm_from_ijk, at), affine_point(&b->lps_mm_from_ijk, at))) <=
              most_mm))
            return false;
    }
    return true;
}

/* A mask being written into a layer that holds others. */
struct mask_placing {
    const struct volume *layer;
    uint8_t label;
    bool is_free;
};

static uint8_t *run_in(const struct volume *layer, uint32_t i, uint32_t j, uint32_t k)
{
    return (uint8_t *)layer->voxels + ((size_t)k * layer->grid.size[1] + j) * layer->grid.size[0] + i;
}

static void check_run(void *context, uint16_t label, uint32_t i, uint32_t j, uint32_t k, uint32_t length)
{
    (void)label;
    struct mask_placing *placing = context;
    const uint8_t *run = run_in(placing->layer, i, j, k);
    for (uint32_t at = 0; placing->is_free && at < length; at++)
        placing->is_free = run[at] == 0;
}

static void place_run(void *context, uint16_t label, uint32_t i, uint32_t j, uint32_t k, uint32_t length)
{
    (void)label;
    const struct mask_placing *placing = context;
    memset(run_in(placing->layer, i, j, k), placing->label, length);
}

bool region_builder_add_mask(struct region_builder *builder, struct volume *mask, const struct plan_file_region *entry,
                             struct error *err)
{
    struct region_set *set = builder->set;
    uint32_t layer = REGION_MAX_LAYERS;
    for (uint32_t i = 0; i < set->n_layers && layer == REGION_MAX_LAYERS; i++) {
        if (!builder->is_packed[i] || builder->n_labels[i] >= UINT8_MAX ||
            !grids_are_equal(&mask->grid, &set->layers[i]->grid))
            continue;
        struct mask_placing placing = { set->layers[i], (uint8_t)(builder->n_labels[i] + 1), true };
        label_rows_runs(mask, check_run, &placing);
        if (!placing.is_free)
            continue;
        label_rows_runs(mask, place_run, &placing);
        layer = i;
    }
    if (layer == REGION_MAX_LAYERS) {
        if (!add_layer(builder, mask, entry->path, &layer, err))
            return false;
        builder->is_packed[layer] = true;
    } else {
        volume_unref(mask);
    }
    builder->n_labels[layer]++;
    struct region *region = add_region(builder, entry->name, layer, builder->n_labels[layer], entry->path, err);
    if (region && entry->has_color) {
        region->has_file_color = true;
        memcpy(region->rgb, entry->rgb, 3);
    }
    return region != NULL;
}

bool region_builder_add_bits(struct region_builder *builder, const struct mask *mask, const struct grid *grid,
                             const char *name, const uint8_t *rgb, const char *where, struct error *err)
{
    struct region_set *set = builder->set;
    uint32_t layer = 0;
    while (layer < set->n_layers &&
           !(builder->is_packed[layer] && builder->n_labels[layer] < UINT8_MAX &&
             grids_are_equal(grid, &set->layers[layer]->grid) && mask_layer_is_free(mask, set->layers[layer])))
        layer++;
    if (layer < set->n_layers) {
        mask_layer_put(mask, set->layers[layer], (uint16_t)(builder->n_labels[layer] + 1));
    } else {
        struct volume *labels = mask_layer_create(mask, err);
        if (!labels || !add_layer(builder, labels, where, &layer, err))
            return false;
        builder->is_packed[layer] = true;
    }
    builder->n_labels[layer]++;
    struct region *region = add_region(builder, name, layer, builder->n_labels[layer], where, err);
    if (region && rgb) {
        region->has_file_color = true;
        memcpy(region->rgb, rgb, 3);
    }
    return region != NULL;
}

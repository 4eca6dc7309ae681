/* Derives the hierarchy of regions from containment. */
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/region/label_rows.h"
#include "core/region/region.h"

enum { SAMPLES = 4096 };                 /* sampled voxels per region, looked up in the other layers */
static const double touch_share = 0.95;  /* share of A's outward faces that must touch B or a region inside B */
static const double carry_share = 0.99;  /* share of A's sampled voxels that must have B's label, across layers */
static const double border_share = 0.25; /* largest share of A's faces on the outside of the grid */

struct box_facts {
    struct box3 box;
    double volume_mm3;
};

static void find_boxes(const struct region_set *set, struct box_facts *facts)
{
    for (size_t r = 0; r < set->n_regions; r++) {
        const struct region *region = &set->regions[r];
        facts[r].box = box3_empty();
        if (region->n_voxels == 0)
            continue;
        for (int corner = 0; corner < 8; corner++)
            box3_add(&facts[r].box,
                     affine_point(&set->layers[region->layer]->grid.lps_mm_from_ijk,
                                  vec3(corner & 1 ? region->high_ijk[0] + 0.5 : region->low_ijk[0] - 0.5,
                                       corner & 2 ? region->high_ijk[1] + 0.5 : region->low_ijk[1] - 0.5,
                                       corner & 4 ? region->high_ijk[2] + 0.5 : region->low_ijk[2] - 0.5)));
        struct vec3 side = vec3_sub(facts[r].box.high, facts[r].box.low);
        facts[r].volume_mm3 = side.x * side.y * side.z;
    }
}

static bool lies_inside(const struct region_set *set, size_t a, size_t b)
{
    for (int up = set->regions[a].parent; up >= 0; up = set->regions[up].parent)
        if ((size_t)up == b)
            return true;
    return false;
}

/* Makes b the parent of a if its box is smaller than that of a's parent so far. Never makes a cycle. */
static bool offer_parent(struct region_set *set, const struct box_facts *facts, size_t a, size_t b)
{
    if (a == b || lies_inside(set, b, a))
        return false;
    int has = set->regions[a].parent;
    if (has == (int)b || (has >= 0 && facts[has].volume_mm3 <= facts[b].volume_mm3))
        return false;
    set->regions[a].parent = (int)b;
    return true;
}

static bool box_holds(const struct region *outer, const struct region *inner)
{
    for (int axis = 0; axis < 3; axis++)
        if (inner->low_ijk[axis] < outer->low_ijk[axis] || inner->high_ijk[axis] > outer->high_ijk[axis])
            return false;
    return true;
}

/* Faces within one layer. They are counted once; then regions find parents from the inside outward until nothing
 * changes, because A's outward faces can only be told from its inward ones once it is known what lies inside A. */
struct layer_faces {
    size_t n;         /* regions of this layer; slot n is everything else */
    size_t *regions;  /* [n] indices in the region set */
    uint64_t *faces;  /* [n + 1][n + 1] */
    uint64_t *border; /* [n + 1] */
};

static bool encloses(const struct region_set *set, const struct layer_faces *layer, size_t a, size_t b)
{
    size_t width = layer->n + 1;
    uint64_t outward = layer->faces[a * width + layer->n], touching = 0;
    for (size_t c = 0; c < layer->n; c++) {
        uint64_t faces = layer->faces[a * width + c];
        if (c == a || faces == 0 || lies_inside(set, layer->regions[c], layer->regions[a]))
            continue;
        outward += faces;
        if (c == b || lies_inside(set, layer->regions[c], layer->regions[b]))
            touching += faces;
    }
    return outward > 0 && (double)touching >= touch_share * (double)outward &&
           (double)layer->border[a] <= border_share * (double)(outward + layer->border[a]);
}

static void derive_in_layer(struct region_set *set, const struct box_facts *facts, uint32_t layer_index)
{
    struct layer_faces layer = { .regions = mem_new(set->n_regions * sizeof(size_t)) };
    uint16_t *slot = mem_new(65536 * sizeof *slot);
    for (size_t r = 0; r < set->n_regions; r++)
        if (set->regions[r].layer == layer_index && set->regions[r].n_voxels > 0)
            layer.regions[layer.n++] = r;
    size_t width = layer.n + 1;
    for (size_t label = 0; label < 65536; label++)
        slot[label] = (uint16_t)layer.n;
    for (size_t a = 0; a < layer.n; a++)
        slot[set->regions[layer.regions[a]].label] = (uint16_t)a;
    layer.faces = mem_new(width * width * sizeof *layer.faces);
    layer.border = mem_new(width * sizeof *layer.border);
    if (layer.n >= 2) {
        label_rows_faces(set->layers[layer_index], slot, width, layer.faces, layer.border);
        bool is_changed = true;
        for (size_t round = 0; is_changed && round <= layer.n; round++) {
            is_changed = false;
            for (size_t a = 0; a < layer.n; a++)
                for (size_t b = 0; b < layer.n; b++)
                    if (a != b && box_holds(&set->regions[layer.regions[b]], &set->regions[layer.regions[a]]) &&
                        encloses(set, &layer, a, b))
                        is_changed |= offer_parent(set, facts, layer.regions[a], layer.regions[b]);
        }
    }
    free(layer.regions);
    free(layer.faces);
    free(layer.border);
    free(slot);
}

/* Every stride-th voxel of each region of a layer. */
struct samples {
    const struct region_set *set;
    uint32_t layer;
    const uint16_t *region_of_label;
    uint64_t *seen;              /* [n_regions] */
    uint32_t (*ijk)[SAMPLES][3]; /* [n_regions] */
    uint32_t *n;                 /* [n_regions] */
};

static void sample_run(void *context, uint16_t label, uint32_t i, uint32_t j, uint32_t k, uint32_t length)
{
    struct samples *samples = context;
    uint16_t r = samples->region_of_label[label];
    if (r == UINT16_MAX)
        return;
    uint64_t stride = samples->set->regions[r].n_voxels / SAMPLES + 1;
    uint64_t first = (stride - samples->seen[r] % stride) % stride;
    for (uint64_t at = first; at < length && samples->n[r] < SAMPLES; at += stride)
        memcpy(samples->ijk[r][samples->n[r]++], (uint32_t[3]){ i + (uint32_t)at, j, k }, sizeof(uint32_t[3]));
    samples->seen[r] += length;
}

static void derive_across(struct region_set *set, const struct box_facts *facts, size_t a, uint32_t (*ijk)[3],
                          uint32_t n, const uint16_t *const *region_of_label)
{
    const struct grid *own = &set->layers[set->regions[a].layer]->grid;
    uint32_t *hits = mem_new(set->n_regions * sizeof *hits);
    for (size_t layer = 0; layer < set->n_layers; layer++) {
        const struct volume *other = set->layers[layer];
        if (layer == set->regions[a].layer)
            continue;
        for (uint32_t s = 0; s < n; s++) {
            uint32_t at[3];
            struct vec3 point_lps_mm = affine_point(&own->lps_mm_from_ijk, vec3(ijk[s][0], ijk[s][1], ijk[s][2]));
            if (!volume_voxel_at(other, point_lps_mm, at))
                continue;
            uint16_t b = region_of_label[layer][volume_label(other, at[0], at[1], at[2])];
            if (b != UINT16_MAX)
                hits[b]++;
        }
    }
    for (size_t b = 0; b < set->n_regions; b++)
        if (hits[b] > 0 && hits[b] >= carry_share * n &&
            (set->regions[b].volume_cm3 > set->regions[a].volume_cm3 ||
             (set->regions[b].volume_cm3 == set->regions[a].volume_cm3 && b < a)))
            offer_parent(set, facts, a, b);
    free(hits);
}

static void derive_across_layers(struct region_set *set, const struct box_facts *facts)
{
    uint16_t **region_of_label = mem_new(set->n_layers * sizeof *region_of_label);
    for (size_t layer = 0; layer < set->n_layers; layer++) {
        region_of_label[layer] = mem_new(65536 * sizeof **region_of_label);
        memset(region_of_label[layer], 0xff, 65536 * sizeof **region_of_label);
    }
    for (size_t r = 0; r < set->n_regions; r++)
        region_of_label[set->regions[r].layer][set->regions[r].label] = (uint16_t)r;
    struct samples samples = { .set = set,
                               .seen = mem_new(set->n_regions * sizeof(uint64_t)),
                               .ijk = mem_new(set->n_regions * sizeof(uint32_t[SAMPLES][3])),
                               .n = mem_new(set->n_regions * sizeof(uint32_t)) };
    for (size_t layer = 0; layer < set->n_layers; layer++) {
        samples.layer = (uint32_t)layer;
        samples.region_of_label = region_of_label[layer];
        label_rows_runs(set->layers[layer], sample_run, &samples);
    }
    for (size_t a = 0; a < set->n_regions; a++)
        if (samples.n[a] > 0)
            derive_across(set, facts, a, samples.ijk[a], samples.n[a], (const uint16_t *const *)region_of_label);
    for (size_t layer = 0; layer < set->n_layers; layer++)
        free(region_of_label[layer]);
    free(region_of_label);
    free(samples.seen);
    free(samples.ijk);
    free(samples.n);
}

void region_set_derive_hierarchy(struct region_set *set)
{
    if (set->n_regions < 2)
        return;
    struct box_facts *facts = mem_new(set->n_regions * sizeof *facts);
    find_boxes(set, facts);
    for (uint32_t layer = 0; layer < set->n_layers; layer++)
        derive_in_layer(set, facts, layer);
    if (set->n_layers > 1)
        derive_across_layers(set, facts);
    free(facts);
    for (size_t r = 0; r < set->n_regions; r++)
        if (set->regions[r].parent >= 0)
            set->hierarchy = HIERARCHY_DERIVED;
}

/* Region ids, names and palette; counts, boxes and centres of label layers. */
#include "core/region/region.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/region/label_rows.h"

const struct region *region_find(const struct region_set *set, const char *id)
{
    for (size_t i = 0; i < set->n_regions; i++)
        if (strcmp(set->regions[i].id, id) == 0)
            return &set->regions[i];
    return NULL;
}

void region_make_id(const struct region_set *set, const char *name, char id[REGION_ID_SIZE])
{
    enum { ROOM_FOR_NUMBER = 6 };
    size_t n = 0;
    for (const char *c = name; *c && n < REGION_ID_SIZE - 1 - ROOM_FOR_NUMBER; c++) {
        char low = *c >= 'A' && *c <= 'Z' ? (char)(*c - 'A' + 'a') : *c;
        if ((low >= 'a' && low <= 'z') || (low >= '0' && low <= '9'))
            id[n++] = low;
        else if (n > 0 && id[n - 1] != '-')
            id[n++] = '-';
    }
    while (n > 0 && id[n - 1] == '-')
        n--;
    id[n] = 0;
    if (n == 0) {
        memcpy(id, "region", 7);
        n = 6;
    }
    for (int number = 2; region_find(set, id); number++)
        snprintf(id + n, REGION_ID_SIZE - n, "-%d", number);
}

/* Sums over the voxels of one label. */
struct tally {
    uint64_t n, sum[3];
    uint32_t low[3], high[3];
};

struct tallies {
    struct tally *of_label;
};

static void tally_run(void *context, uint16_t label, uint32_t i, uint32_t j, uint32_t k, uint32_t length)
{
    struct tallies *tallies = context;
    struct tally *tally = &tallies->of_label[label];
    uint32_t last = i + length - 1;
    if (tally->n == 0) {
        memcpy(tally->low, (uint32_t[3]){ i, j, k }, sizeof tally->low);
        memcpy(tally->high, (uint32_t[3]){ last, j, k }, sizeof tally->high);
    } else {
        tally->low[0] = i < tally->low[0] ? i : tally->low[0];
        tally->high[0] = last > tally->high[0] ? last : tally->high[0];
        tally->low[1] = j < tally->low[1] ? j : tally->low[1];
        tally->high[1] = j > tally->high[1] ? j : tally->high[1];
        tally->high[2] = k; /* k never decreases */
    }
    tally->n += length;
    tally->sum[0] += ((uint64_t)i + last) * length / 2; /* (i + last) * length is always even */
    tally->sum[1] += (uint64_t)j * length;
    tally->sum[2] += (uint64_t)k * length;
}

static void store_tally(struct region *region, const struct tally *tally, const struct grid *grid)
{
    region->n_voxels = tally->n;
    region->volume_cm3 = (double)tally->n * grid_voxel_mm3(grid) / 1000;
    region->touches_edge = false;
    memcpy(region->low_ijk, tally->low, sizeof region->low_ijk);
    memcpy(region->high_ijk, tally->high, sizeof region->high_ijk);
    if (tally->n == 0) {
        region->centre_lps_mm = vec3(0, 0, 0);
        return;
    }
    double n = (double)tally->n;
    region->centre_lps_mm =
        affine_point(&grid->lps_mm_from_ijk,
                     vec3((double)tally->sum[0] / n, (double)tally->sum[1] / n, (double)tally->sum[2] / n));
    for (int axis = 0; axis < 3; axis++)
        region->touches_edge |= tally->low[axis] == 0 || tally->high[axis] + 1 == grid->size[axis];
}

void region_set_measure(struct region_set *set)
{
    for (uint32_t layer = 0; layer < set->n_layers; layer++) {
        const struct volume *volume = set->layers[layer];
        size_t n_labels = volume->type == VOXEL_U8 ? 256 : 65536;
        struct tallies tallies = { mem_new(n_labels * sizeof(struct tally)) };
        label_rows_runs(volume, tally_run, &tallies);
        for (size_t i = 0; i < set->n_regions; i++) {
            struct region *region = &set->regions[i];
            static const struct tally none;
            if (region->layer == layer)
                store_tally(region, region->label < n_labels ? &tallies.of_label[region->label] : &none, &volume->grid);
        }
        free(tallies.of_label);
    }
}

size_t region_with_descendants(const struct region_set *set, size_t index, size_t *out)
{
    size_t n = 0;
    out[n++] = index;
    for (size_t next = 0; next < n; next++)
        for (size_t i = 0; i < set->n_regions; i++)
            if (set->regions[i].parent == (int)out[next])
                out[n++] = i;
    return n;
}

int region_depth(const struct region_set *set, size_t index)
{
    int depth = 0;
    for (int parent = set->regions[index].parent; parent >= 0; parent = set->regions[parent].parent)
        depth++;
    return depth;
}

void region_set_finish(struct region_set *set)
{
    for (size_t i = 0; i < set->n_layers; i++)
        volume_unref(set->layers[i]);
    free(set->regions);
    *set = (struct region_set){ 0 };
}

void region_palette(size_t index, uint8_t rgb[3])
{
    /* Distant hues first; lightness alternates, so that neighbours in the list also differ in grey. */
    static const uint8_t palette[][3] = {
        { 226, 190, 164 }, { 120, 160, 214 }, { 222, 110, 96 }, { 134, 196, 140 }, { 176, 140, 210 }, { 236, 204, 96 },
        { 84, 150, 160 },  { 240, 166, 176 }, { 150, 118, 84 }, { 168, 214, 232 }, { 196, 96, 150 },  { 190, 206, 92 },
        { 96, 104, 180 },  { 244, 176, 108 }, { 96, 158, 96 },  { 214, 186, 236 }, { 176, 84, 76 },   { 150, 224, 206 },
        { 140, 132, 60 },  { 236, 148, 216 }, { 72, 120, 120 }, { 248, 228, 176 }, { 128, 92, 136 },  { 176, 186, 196 },
    };
    memcpy(rgb, palette[index % (sizeof palette / sizeof palette[0])], 3);
}

/* Reads SERA's sample head from the test data. */
#include "tests/unit/sera_head.h"

#include <zlib.h>

#include "core/base/mem.h"
#include "core/region/boundary.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"

struct volume *sera_head_read(void)
{
    char path[1024];
    gzFile file = data_path("sera-head/generated/head.uv.gz", path, sizeof path) ? gzopen(path, "rb") : NULL;
    if (!file) {
        printf("%s is not here\n", path);
        return NULL;
    }
    struct grid grid;
    struct affine map = { { { 1.01562, 0, 0 }, { 0, 1.01562, 0 }, { 0, 0, 5.49991 } },
                          { -129.492, -129.492, -264.996 } };
    struct error err = { 0 };
    if (!grid_init(&grid, (uint32_t[3]){ 256, 256, 48 }, &map, &err))
        abort();
    struct volume *layer = volume_create(&grid, VOXEL_U8, &err);
    if (!layer || gzread(file, layer->voxels, 256 * 256 * 48) != 256 * 256 * 48)
        abort();
    gzclose(file);
    return layer;
}

struct region_set *sera_head_regions(struct volume *layer)
{
    static const char *const ids[] = { "scalp", "brain", "tumor" };
    struct region_set *set = mem_new(sizeof *set);
    set->layers[0] = layer;
    set->n_layers = 1;
    set->n_regions = 3;
    set->regions = mem_new(3 * sizeof *set->regions);
    set->hierarchy = HIERARCHY_FILE;
    for (int i = 0; i < 3; i++) {
        snprintf(set->regions[i].id, sizeof set->regions[i].id, "%s", ids[i]);
        set->regions[i].label = (uint16_t)(i + 2);
        set->regions[i].parent = i - 1;
    }
    region_set_measure(set);
    return set;
}

struct mask *sera_head_mask(const struct region_set *set, size_t region, bool is_own)
{
    struct error err = { 0 };
    struct mask *mask = is_own ? mask_from_region_own(set, region, 2, &err) : mask_from_region(set, region, 2, &err);
    assert_non_null(mask);
    return mask;
}

void sera_head_destroy(struct region_set *set)
{
    region_set_finish(set);
    free(set);
}

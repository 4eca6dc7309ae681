#pragma once
/* Regions as sets of voxels ("univels") on label layers, and their hierarchy: what lies inside what.
 * Knows nothing of files, meshes or pictures. */
#include <stddef.h>
#include <stdint.h>

#include "core/volume/volume.h"

enum {
    REGION_MAX = 1024,       /* regions in a plan */
    REGION_MAX_LAYERS = 256, /* label layers in a plan */
    REGION_ID_SIZE = 64,
    REGION_NAME_SIZE = 128
};

struct region {
    char id[REGION_ID_SIZE];     /* stable, URL-safe [a-z0-9-], unique in the plan */
    char name[REGION_NAME_SIZE]; /* as the file gives it, UTF-8 */
    uint8_t rgb[3];
    bool has_file_color; /* else the colour is from our palette */
    int parent;          /* index of the region it lies directly inside, or -1; never a cycle */
    uint32_t layer;      /* which label layer */
    uint16_t label;      /* its value there, never 0 */
    /* filled by region_set_measure */
    uint64_t n_voxels;                /* voxels that carry the label: "univels" */
    double volume_cm3;                /* of those voxels */
    uint32_t low_ijk[3], high_ijk[3]; /* bounding voxels, inclusive */
    struct vec3 centre_lps_mm;        /* mean of voxel centres */
    bool touches_edge;                /* reaches the first or last index of an axis: the scan cuts it */
    double file_opacity;              /* above 0 to 1, as a file gives it; 0: none does */
    /* tissue data from the file; not-a-number where it gives none */
    double boron_ratio, cbe_boron, rbe_nitrogen, rbe_fast, rbe_gamma;
};

enum hierarchy_source { HIERARCHY_NONE, HIERARCHY_FILE, HIERARCHY_DERIVED };

struct region_set {
    struct volume *layers[REGION_MAX_LAYERS]; /* U8 or U16; each on its own grid */
    size_t n_layers;
    struct region *regions; /* in file order */
    size_t n_regions;
    enum hierarchy_source hierarchy;
};

/* Makes an id from a name: lower case, runs of anything but [a-z0-9] become one '-', never empty, made unique with -2,
 * -3, ... */
void region_make_id(const struct region_set *set, const char *name, char id[REGION_ID_SIZE]);
const struct region *region_find(const struct region_set *set, const char *id); /* NULL when absent */
/* Counts, boxes, centres and volumes of all regions; one pass a layer. Regions without a voxel keep n_voxels 0. */
void region_set_measure(struct region_set *set);
/* Parents from containment when no file gave them. Within one exclusive layer region A is taken to lie inside B when B
 * encloses A: every path of 6-neighbours from A to the grid's border passes B (approximated: of A's outward boundary
 * faces at least 95 % touch B or a region already inside B, A's box lies in B's box, and no more than a quarter of A's
 * faces lie on the outside of the grid, where a scan cuts; those count for neither side). Across layers: A inside B
 * when at least 99 % of A's voxel centres carry B (up to 4096 of them, evenly taken). The enclosing region with the
 * smallest box is the parent. Sets hierarchy to HIERARCHY_DERIVED when it found any. */
void region_set_derive_hierarchy(struct region_set *set);
/* region index and all of its descendants, index first; returns how many. out holds n_regions. */
size_t region_with_descendants(const struct region_set *set, size_t index, size_t *out);
int region_depth(const struct region_set *set, size_t index); /* 0 for a root */
void region_set_finish(struct region_set *set);
/* Our palette for regions without a colour, >= 20 entries told apart by luminance too; wraps. */
void region_palette(size_t index, uint8_t rgb[3]);

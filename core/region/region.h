#pragma once
/* Regions as sets of voxels ("univels") on label layers, and their hierarchy (which region lies inside which). Knows
 * nothing of files, meshes or pictures. A set is built by one thread and frozen once part of a plan. */
#include <stddef.h>
#include <stdint.h>

#include "core/volume/volume.h"

enum {
    REGION_MAX = 1024,       /* regions per plan */
    REGION_MAX_LAYERS = 256, /* label layers per plan */
    REGION_ID_SIZE = 64,
    REGION_NAME_SIZE = 128
};

struct region {
    char id[REGION_ID_SIZE];     /* stable, URL-safe [a-z0-9-], unique in the plan */
    char name[REGION_NAME_SIZE]; /* as in the file, UTF-8 */
    uint8_t rgb[3];
    bool has_file_color; /* rgb is from the file; false: from region_palette */
    int parent;          /* index of the region directly around it, or -1; never a cycle */
    uint32_t layer;      /* index in layers */
    uint16_t label;      /* its value in that layer, never 0 */
    uint16_t origin;     /* 1 + index of its source in the plan's region_origins; 0: not known */
    /* Filled by region_set_measure. */
    uint64_t n_voxels;                /* voxels with the label: "univels" */
    double volume_cm3;                /* n_voxels times the volume of a voxel */
    uint32_t low_ijk[3], high_ijk[3]; /* bounding box in voxels, inclusive */
    struct vec3 centre_lps_mm;        /* mean of the voxel centres */
    bool touches_edge;                /* reaches the first or last index of an axis: the scan cuts it */
    double file_opacity;              /* from the file, above 0 to 1; 0: not given */
    bool is_target;                   /* the file says so: DICOM's RT ROI Interpreted Type is GTV, CTV or PTV */
    /* Tissue data from the file; NaN where not given. */
    double boron_ratio, cbe_boron, rbe_nitrogen, rbe_fast, rbe_gamma;
};

enum hierarchy_source { HIERARCHY_NONE, HIERARCHY_FILE, HIERARCHY_DERIVED };

struct region_set {
    struct volume *layers[REGION_MAX_LAYERS]; /* U8 or U16, each on a grid of its own */
    size_t n_layers;
    struct region *regions; /* in file order */
    size_t n_regions;
    enum hierarchy_source hierarchy;
};

/* Makes an id from a name: lower case, each run of characters other than [a-z0-9] becomes one '-'; never empty; made
 * unique with -2, -3, ... */
void region_make_id(const struct region_set *set, const char *name, char id[REGION_ID_SIZE]);
const struct region *region_find(const struct region_set *set, const char *id); /* NULL if absent */
/* Fills voxel counts, boxes, centres and volumes of all regions; one pass per layer. A region without voxels keeps
 * n_voxels 0. */
void region_set_measure(struct region_set *set);
/* Derives parents from containment, for a plan whose files give no hierarchy. Sets hierarchy to HIERARCHY_DERIVED if
 * any parent was found. Of all enclosing regions the one with the smallest box becomes the parent.
 *
 * Within one exclusive layer, A is inside B if B encloses A: every path of 6-neighbours from A to the grid's border
 * crosses B. Approximated by: at least 95 % of A's outward faces touch B or a region already inside B; A's box is
 * inside B's box; and at most a quarter of A's faces are on the outside of the grid, where the scan cuts it (those
 * count for neither side). Across layers, A is inside B if at least 99 % of A's voxel centres have B's label (up to
 * 4096 voxels, evenly sampled). */
void region_set_derive_hierarchy(struct region_set *set);
/* Lists region index and all its descendants, index first; returns how many. out has room for n_regions. */
size_t region_with_descendants(const struct region_set *set, size_t index, size_t *out);
int region_depth(const struct region_set *set, size_t index); /* number of ancestors; 0 for a root */
void region_set_finish(struct region_set *set);
/* Colours for regions without one: at least 20, distinguishable by luminance too; wraps around. */
void region_palette(size_t index, uint8_t rgb[3]);

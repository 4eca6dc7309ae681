#pragma once
/* Inside core/load: from what the files gave to the plan's set of regions. */
#include "core/formats/plan_file.h"
#include "core/formats/sera_uvh.h"
#include "core/plan/plan.h"
#include "core/region/mask.h"

struct region_builder {
    struct region_set *set;
    struct report *report;
    bool is_packed[REGION_MAX_LAYERS]; /* made of masks; others may join */
    uint16_t n_labels[REGION_MAX_LAYERS];
    int places[REGION_MAX];       /* among all regions, from 1, where a list of names says it; else 0 */
    struct plan_file_pair *pairs; /* hierarchy named by the parts themselves; PLAN_FILE_MAX_PAIRS of them */
    size_t n_pairs;
};

void region_builder_init(struct region_builder *builder, struct region_set *set, struct report *report);
void region_builder_finish(struct region_builder *builder);

/* Each takes the volume, on failure too. where is the file's name. errors ERROR_LIMIT too many regions or layers */
NODISCARD bool region_builder_add_labels(struct region_builder *builder, struct volume *labels,
                                         const struct label_names *names, const char *where, struct error *err);
NODISCARD bool region_builder_add_univels(struct region_builder *builder, struct volume *univels, const struct uvh *uvh,
                                          const char *where, struct error *err);
NODISCARD bool region_builder_add_mask(struct region_builder *builder, struct volume *mask,
                                       const struct plan_file_region *entry, struct error *err);

/* A region of contours: voxels of a grid that others of the same grid may share a layer with. color may be NULL. mask
 * stays the caller's. errors ERROR_LIMIT, ERROR_MEMORY */
NODISCARD bool region_builder_add_bits(struct region_builder *builder, const struct mask *mask, const struct grid *grid,
                                       const char *name, const uint8_t *rgb, const char *where, struct error *err);

/* After the last part: regions that have a place are put there, in front of the others. */
void region_builder_order(struct region_builder *builder);

/* Parents from pairs of names; outer names that are absent are passed through. is_strict: a name that is absent is
 * reported. Sets hierarchy to HIERARCHY_FILE when it gave any region a parent. */
void region_set_apply_pairs(struct region_set *set, const struct plan_file_pair *pairs, size_t n_pairs, bool is_strict,
                            const char *where, struct report *report);

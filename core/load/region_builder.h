#pragma once
/* Builds the plan's regions from label maps, univels, masks and contours, packed into few label layers. */
#include "core/formats/plan_file.h"
#include "core/formats/sera/sera_uvh.h"
#include "core/plan/plan.h"
#include "core/region/mask.h"

struct region_builder {
    struct region_set *set;
    struct report *report;
    bool is_packed[REGION_MAX_LAYERS]; /* the layer is made of masks; further masks may be added */
    uint16_t n_labels[REGION_MAX_LAYERS];
    int places[REGION_MAX];       /* position among all regions, from 1, where a list of names gives it; else 0 */
    struct plan_file_pair *pairs; /* [PLAN_FILE_MAX_PAIRS] hierarchy that the files of regions give themselves */
    size_t n_pairs;
};

void region_builder_init(struct region_builder *builder, struct region_set *set, struct report *report);
void region_builder_finish(struct region_builder *builder);

/* Each adds the regions of one file and consumes its volume, also on failure. where: the file's name.
 * errors ERROR_LIMIT too many regions or layers */
NODISCARD bool region_builder_add_labels(struct region_builder *builder, struct volume *labels,
                                         const struct label_names *names, const char *where, struct error *err);
NODISCARD bool region_builder_add_univels(struct region_builder *builder, struct volume *univels, const struct uvh *uvh,
                                          const char *where, struct error *err);
NODISCARD bool region_builder_add_mask(struct region_builder *builder, struct volume *mask,
                                       const struct plan_file_region *entry, struct error *err);

/* Adds a region filled from contours; it may share a layer with regions on the same grid. rgb may be NULL. mask stays
 * the caller's. errors ERROR_LIMIT, ERROR_MEMORY */
NODISCARD bool region_builder_add_bits(struct region_builder *builder, const struct mask *mask, const struct grid *grid,
                                       const char *name, const uint8_t *rgb, const char *where, struct error *err);

/* Call it after the last file: sorts the regions by their places, before the regions without one. */
void region_builder_order(struct region_builder *builder);

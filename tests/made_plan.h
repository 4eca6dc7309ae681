#pragma once
/* Plans made by hand for tests: label layers and images filled from functions of the patient point. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/plan/plan.h"

static inline struct grid made_grid(uint32_t ni, uint32_t nj, uint32_t nk, struct affine lps_mm_from_ijk)
{
    struct grid grid;
    struct error err = { 0 };
    if (!grid_init(&grid, (uint32_t[3]){ ni, nj, nk }, &lps_mm_from_ijk, &err)) {
        fprintf(stderr, "%s\n", err.text);
        abort();
    }
    return grid;
}

/* Grid axes along the given directions with the given spacings, its middle at centre. */
static inline struct affine made_affine(struct vec3 i_mm, struct vec3 j_mm, struct vec3 k_mm, const uint32_t size[3],
                                        struct vec3 centre)
{
    struct affine map = { { i_mm, j_mm, k_mm }, { 0, 0, 0 } };
    struct vec3 middle = affine_vector(&map, vec3((size[0] - 1) / 2.0, (size[1] - 1) / 2.0, (size[2] - 1) / 2.0));
    map.origin = vec3_sub(centre, middle);
    return map;
}

/* side^3 voxels of 1 mm along L, P and S, their middle at the patient's origin. */
static inline struct grid made_cube_grid(uint32_t side)
{
    const uint32_t size[3] = { side, side, side };
    return made_grid(side, side, side, made_affine(vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1), size, vec3(0, 0, 0)));
}

static inline struct volume *made_volume(const struct grid *grid, enum voxel_type type,
                                         double (*value)(struct vec3 lps_mm))
{
    struct error err = { 0 };
    struct volume *volume = volume_create(grid, type, &err);
    if (!volume)
        abort();
    size_t at = 0;
    for (uint32_t k = 0; k < grid->size[2]; k++)
        for (uint32_t j = 0; j < grid->size[1]; j++)
            for (uint32_t i = 0; i < grid->size[0]; i++, at++) {
                double v = value(affine_point(&grid->lps_mm_from_ijk, vec3(i, j, k)));
                switch (type) {
                case VOXEL_U8: ((uint8_t *)volume->voxels)[at] = (uint8_t)v; break;
                case VOXEL_I16: ((int16_t *)volume->voxels)[at] = (int16_t)v; break;
                case VOXEL_U16: ((uint16_t *)volume->voxels)[at] = (uint16_t)v; break;
                case VOXEL_F32: ((float *)volume->voxels)[at] = (float)v; break;
                }
            }
    volume_measure(volume);
    return volume;
}

struct made_region {
    const char *id;
    int parent;
    uint32_t rgb;
};

/* Regions with labels 1, 2, ... on one layer; label gives a point's. */
static inline struct plan *made_plan(const struct grid *grid, double (*label)(struct vec3 lps_mm),
                                     const struct made_region *regions, size_t n_regions)
{
    struct plan *plan = plan_create("made");
    plan->bounds_lps_mm = grid_bounds_lps_mm(grid);
    plan->regions.layers[0] = made_volume(grid, n_regions > UINT8_MAX ? VOXEL_U16 : VOXEL_U8, label);
    plan->regions.n_layers = 1;
    plan->regions.regions = mem_new(sizeof(struct region) * (n_regions ? n_regions : 1));
    plan->regions.n_regions = n_regions;
    for (size_t i = 0; i < n_regions; i++) {
        struct region *region = &plan->regions.regions[i];
        snprintf(region->id, sizeof region->id, "%s", regions[i].id);
        snprintf(region->name, sizeof region->name, "%s", regions[i].id);
        region->parent = regions[i].parent;
        region->label = (uint16_t)(i + 1);
        region->rgb[0] = (uint8_t)(regions[i].rgb >> 16);
        region->rgb[1] = (uint8_t)(regions[i].rgb >> 8);
        region->rgb[2] = (uint8_t)regions[i].rgb;
        region->boron_ratio = region->cbe_boron = region->rbe_nitrogen = region->rbe_fast = region->rbe_gamma = NAN;
    }
    region_set_measure(&plan->regions);
    return plan;
}

static inline void made_plan_add_image(struct plan *plan, const struct grid *grid, enum voxel_type type,
                                       double (*value)(struct vec3 lps_mm))
{
    struct plan_image *image = &plan->images[plan->n_images++];
    snprintf(image->id, sizeof image->id, "image-%zu", plan->n_images);
    image->volume = made_volume(grid, type, value);
    image->window_center = (image->volume->low + image->volume->high) / 2;
    image->window_width = image->volume->high - image->volume->low + 1;
}

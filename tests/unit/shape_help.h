#pragma once
/* Grids, a ball and voxel tests for tests of shapes. */
#include "core/surface/shape_parts.h"
#include "tests/unit/made_mask.h"

/* Grids as from scanners: unit; thick slices; left-handed; rotated and tilted, with index axis 0 nearest S. */
enum { N_MAPS = 4 };
extern const struct affine maps[N_MAPS];

struct vec3 load_vec3(const float *at);
struct vec3 mesh_position(const struct mesh *mesh, uint32_t vertex);
struct vec3 index_of(const struct mask *mask, struct vec3 lps_mm);
bool is_border(const struct mask *mask, int64_t i, int64_t j, int64_t k); /* inside, with a 6-neighbour outside */
size_t count_border(const struct mask *mask);
struct mask *ball_mask(double radius_mm, const struct affine *map); /* in the middle of 30^3 voxels */
struct point_set *made_points(const struct mask *mask, int n_threads);
void made_points_finish(struct point_set *set);

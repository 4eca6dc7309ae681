#pragma once
/* The faces between a mask's inside and outside voxels, in blocks of voxels that are joined into ever larger ones, so
 * that the face nearest to a position is found without looking at all that are as far away in voxels. Knows nothing of
 * shapes. */
#include "core/region/mask.h"

struct face_tree;

/* mask is borrowed and outlives the tree. What lies beyond the grid is outside.
 * errors ERROR_RANGE the mask's map cannot be inverted, ERROR_MEMORY */
NODISCARD struct face_tree *face_tree_create(const struct mask *mask, struct error *err);
void face_tree_destroy(struct face_tree *tree);

/* Whether the voxel at ijk, which is inside, has a face on that side (-1 or 1) of an axis. */
bool face_tree_has_face(const struct face_tree *tree, const int64_t ijk[3], int axis, int side);
/* Square of the distance in mm from a position to that face; from_voxel: the position less the voxel's centre, in index
 * steps. */
double face_tree_face_distance_2(const struct face_tree *tree, const double from_voxel[3], int axis, int side);

/* Square of the distance in mm from a position, in index steps, to the nearest face: exact. Infinite when the mask is
 * empty. known_2   a square of a distance to some face that is known already, or INFINITY n_asked   grows by the number
 * of faces whose distance was worked out thread    any */
double face_tree_nearest_2(const struct face_tree *tree, const double at_ijk[3], double known_2, uint64_t *n_asked);

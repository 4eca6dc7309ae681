#pragma once
/* The faces between inside and outside voxels of a mask, in a tree of blocks: finds the face nearest to a position
 * without looking at every voxel within that distance. Knows nothing of shapes. */
#include "core/region/mask.h"

struct face_tree;

/* Builds the tree. mask is borrowed and must outlive it; everything beyond the grid is outside.
 *
 *   errors  ERROR_RANGE the mask's map cannot be inverted; ERROR_MEMORY */
NODISCARD struct face_tree *face_tree_create(const struct mask *mask, struct error *err);
void face_tree_destroy(struct face_tree *tree);

/* Returns true if the inside voxel at ijk has a face on that side (-1 or 1) of an axis. */
bool face_tree_has_face(const struct face_tree *tree, const int64_t ijk[3], int axis, int side);
/* Squared distance in mm2 from a position to that face. from_voxel: the position minus the voxel's centre, in index
 * steps. */
double face_tree_face_distance_2(const struct face_tree *tree, const double from_voxel[3], int axis, int side);

/* Squared distance in mm2 from a position, in index coordinates, to the nearest face. Exact. INFINITY for an empty
 * mask.
 *
 *   known_2  squared distance to some face that is known already, or INFINITY
 *   n_measured  increased by the number of faces whose distance was computed
 *   thread   any */
double face_tree_nearest_2(const struct face_tree *tree, const double at_ijk[3], double known_2, uint64_t *n_measured);

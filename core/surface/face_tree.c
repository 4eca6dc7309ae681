/* Builds and searches the tree of border faces. Each block keeps a bit per direction of its faces: the faces along z of
 * a block are in a few planes, which gives a tight bound even where voxels are a hundred times higher than wide. */
#include "core/surface/face_tree.h"

#include <stdlib.h>

#include "core/base/mem.h"

enum { MAX_LEVELS = 3 * 16 + 1, LEAF_SHIFT = 3, N_WAYS = 6 };
/* Index steps subtracted from bounds, so that rounding never hides the nearest face. */
static const double slack = 1e-9;

/* One level: blocks of 2^shift voxels along each axis; size counts blocks. */
struct level {
    uint32_t shift[3], size[3];
    uint8_t *ways; /* [k][j][i]: bit 2 * axis + (side > 0) is set if a voxel of the block has such a face */
};

struct face_tree {
    const struct mask *mask;
    bool is_square; /* the grid's axes are perpendicular */
    double spacing_mm[3];
    double reach[3]; /* largest number of index steps along each axis within 1 mm, in any direction */
    struct level levels[MAX_LEVELS];
    int n_levels;
};

static double square(double x)
{
    return x * x;
}

/* ---- distance to one face --------------------------------------------------------------------------------------- */

static const uint64_t *row_at(const struct mask *mask, int64_t j, int64_t k)
{
    if (j < 0 || k < 0 || j >= mask->size[1] || k >= mask->size[2])
        return NULL;
    return mask->bits + ((size_t)k * mask->size[1] + (size_t)j) * mask->words;
}

bool face_tree_has_face(const struct face_tree *tree, const int64_t ijk[3], int axis, int side)
{
    int64_t n[3] = { ijk[0], ijk[1], ijk[2] };
    n[axis] += side;
    const uint64_t *row = row_at(tree->mask, n[1], n[2]);
    return !row || n[0] < 0 || n[0] >= tree->mask->size[0] || !(row[n[0] / 64] >> n[0] % 64 & 1);
}

/* Squared distance to the segment m + s u, |s| <= 1/2; offset = p - m. */
static double edge_distance_2(struct vec3 offset, struct vec3 u)
{
    double s = vec3_dot(offset, u) / vec3_dot(u, u);
    s = s < -0.5 ? -0.5 : s > 0.5 ? 0.5 : s;
    struct vec3 left = vec3_sub(offset, vec3_scale(u, s));
    return vec3_dot(left, left);
}

/* Squared distance to the parallelogram m + s u + t v, |s|, |t| <= 1/2. */
static double parallelogram_distance_2(struct vec3 offset, struct vec3 u, struct vec3 v)
{
    double uu = vec3_dot(u, u), vv = vec3_dot(v, v), uv = vec3_dot(u, v), ou = vec3_dot(offset, u),
           ov = vec3_dot(offset, v);
    double det = uu * vv - uv * uv, s = (ou * vv - ov * uv) / det, t = (ov * uu - ou * uv) / det;
    if (fabs(s) <= 0.5 && fabs(t) <= 0.5) {
        struct vec3 left = vec3_sub(offset, vec3_add(vec3_scale(u, s), vec3_scale(v, t)));
        return vec3_dot(left, left);
    }
    double least = INFINITY;
    for (int side = -1; side <= 1; side += 2) {
        double along_u = edge_distance_2(vec3_sub(offset, vec3_scale(v, side * 0.5)), u);
        double along_v = edge_distance_2(vec3_sub(offset, vec3_scale(u, side * 0.5)), v);
        least = along_u < least ? along_u : least;
        least = along_v < least ? along_v : least;
    }
    return least;
}

double face_tree_face_distance_2(const struct face_tree *tree, const double from_voxel[3], int axis, int side)
{
    int b = (axis + 1) % 3, c = (axis + 2) % 3;
    double off[3] = { from_voxel[0], from_voxel[1], from_voxel[2] };
    off[axis] -= side * 0.5;
    if (tree->is_square) {
        double past_b = fabs(off[b]) - 0.5, past_c = fabs(off[c]) - 0.5;
        return square(off[axis] * tree->spacing_mm[axis]) + (past_b > 0 ? square(past_b * tree->spacing_mm[b]) : 0) +
               (past_c > 0 ? square(past_c * tree->spacing_mm[c]) : 0);
    }
    const struct vec3 *columns = tree->mask->lps_mm_from_ijk.columns;
    return parallelogram_distance_2(affine_vector(&tree->mask->lps_mm_from_ijk, vec3(off[0], off[1], off[2])),
                                    columns[b], columns[c]);
}

/* ---- building the tree ------------------------------------------------------------------------------------------ */

/* Returns the voxels with a face on that side, for 64 voxels of a row. rows: the neighbouring rows along y and z, NULL
 * beyond the grid. */
static uint64_t faces_of_word(const struct mask *mask, int64_t w, int64_t j, int64_t k, int way)
{
    const uint64_t *row = row_at(mask, j, k);
    uint64_t bits = row[w], beside = 0;
    if (way == 0)
        beside = bits << 1 | (w > 0 ? row[w - 1] >> 63 : 0);
    else if (way == 1)
        beside = bits >> 1 | (w + 1 < mask->words ? row[w + 1] << 63 : 0);
    else {
        const uint64_t *other =
            way < 4 ? row_at(mask, j + (way == 2 ? -1 : 1), k) : row_at(mask, j, k + (way == 4 ? -1 : 1));
        beside = other ? other[w] : 0;
    }
    return bits & ~beside;
}

static uint8_t *block_at(const struct level *level, size_t i, size_t j, size_t k)
{
    return level->ways + (k * level->size[1] + j) * level->size[0] + i;
}

static void fill_leaves(const struct mask *mask, const struct level *leaves)
{
    for (uint32_t k = mask->low_k; k < mask->end_k; k++)
        for (uint32_t j = mask->low_j; j < mask->end_j; j++) {
            const uint64_t *row = row_at(mask, j, k);
            uint8_t *blocks = block_at(leaves, 0, j >> leaves->shift[1], k >> leaves->shift[2]);
            for (uint32_t w = 0; w < mask->words; w++)
                for (int way = 0; row[w] && way < N_WAYS; way++) {
                    uint64_t faces = faces_of_word(mask, w, j, k, way);
                    for (uint32_t byte = 0; faces; byte++, faces >>= 8)
                        if (faces & 0xff)
                            blocks[8 * w + byte] |= (uint8_t)(1 << way);
                }
        }
}

static void join_blocks(const struct level *from, const struct level *to)
{
    for (uint32_t k = 0; k < from->size[2]; k++)
        for (uint32_t j = 0; j < from->size[1]; j++)
            for (uint32_t i = 0; i < from->size[0]; i++)
                *block_at(to, i >> (to->shift[0] - from->shift[0]), j >> (to->shift[1] - from->shift[1]),
                          k >> (to->shift[2] - from->shift[2])) |= *block_at(from, i, j, k);
}

static bool make_level(const struct mask *mask, struct level *level, struct error *err)
{
    for (int axis = 0; axis < 3; axis++)
        level->size[axis] =
            (uint32_t)(((uint64_t)mask->size[axis] + ((uint64_t)1 << level->shift[axis]) - 1) >> level->shift[axis]);
    level->ways = mem_array((size_t)level->size[0] * level->size[1], level->size[2], UINT64_MAX, err);
    return level->ways != NULL;
}

/* A leaf has 8 voxels along x, and along y and z as many as make it no longer than along x. */
static void shape_leaves(struct face_tree *tree)
{
    uint32_t *shift = tree->levels[0].shift;
    shift[0] = LEAF_SHIFT;
    for (int axis = 1; axis < 3; axis++)
        while (shift[axis] < LEAF_SHIFT &&
               tree->spacing_mm[axis] * (2u << shift[axis]) <= tree->spacing_mm[0] * (1 << LEAF_SHIFT))
            shift[axis]++;
}

/* Doubles blocks along their shortest axes, so that they become roughly cubic. Returns false if only one block is
 * left. */
static bool shape_next(const struct face_tree *tree, const struct level *level, struct level *next)
{
    double shortest = INFINITY;
    for (int axis = 0; axis < 3; axis++)
        if (level->size[axis] > 1)
            shortest = fmin(shortest, tree->spacing_mm[axis] * (double)((uint64_t)1 << level->shift[axis]));
    for (int axis = 0; axis < 3; axis++) {
        double length = tree->spacing_mm[axis] * (double)((uint64_t)1 << level->shift[axis]);
        next->shift[axis] = level->shift[axis] + (level->size[axis] > 1 && length < 1.5 * shortest);
    }
    return isfinite(shortest);
}

static bool measure_grid(struct face_tree *tree, struct error *err)
{
    const struct affine *map = &tree->mask->lps_mm_from_ijk;
    struct affine back;
    if (!affine_invert(map, &back))
        return error_set(err, ERROR_RANGE, "faces of a grid without a volume");
    tree->is_square = true;
    for (int axis = 0; axis < 3; axis++) {
        struct vec3 a = map->columns[axis], b = map->columns[(axis + 1) % 3];
        tree->spacing_mm[axis] = vec3_length(a);
        tree->is_square = tree->is_square && fabs(vec3_dot(a, b)) <= 1e-9 * vec3_length(a) * vec3_length(b);
    }
    tree->reach[0] = sqrt(square(back.columns[0].x) + square(back.columns[1].x) + square(back.columns[2].x));
    tree->reach[1] = sqrt(square(back.columns[0].y) + square(back.columns[1].y) + square(back.columns[2].y));
    tree->reach[2] = sqrt(square(back.columns[0].z) + square(back.columns[1].z) + square(back.columns[2].z));
    return true;
}

struct face_tree *face_tree_create(const struct mask *mask, struct error *err)
{
    struct face_tree *tree = mem_new(sizeof *tree);
    tree->mask = mask;
    if (!measure_grid(tree, err))
        goto fail;
    shape_leaves(tree);
    do {
        struct level *level = &tree->levels[tree->n_levels++];
        if (!make_level(mask, level, err))
            goto fail;
        if (tree->n_levels == 1)
            fill_leaves(mask, level);
        else
            join_blocks(level - 1, level);
    } while (shape_next(tree, &tree->levels[tree->n_levels - 1], &tree->levels[tree->n_levels]));
    return tree;
fail:
    face_tree_destroy(tree);
    return NULL;
}

void face_tree_destroy(struct face_tree *tree)
{
    if (!tree)
        return;
    for (int at = 0; at < tree->n_levels; at++)
        free(tree->levels[at].ways);
    free(tree);
}

/* ---- searching the tree ----------------------------------------------------------------------------------------- */

struct search {
    const struct face_tree *tree;
    const double *at_ijk;
    int way, axis, side;
    double best_2;
    uint64_t n_measured;
};

/* Lower bound of the squared distance to the faces of this direction of voxels first..last. */
static double bound_2(const struct search *search, const int64_t first[3], const int64_t last[3])
{
    const struct face_tree *tree = search->tree;
    double sum = 0, most = 0;
    for (int axis = 0; axis < 3; axis++) {
        double down = axis == search->axis ? 0.5 * search->side : -0.5,
               up = axis == search->axis ? 0.5 * search->side : 0.5;
        double gap =
            fmax((double)first[axis] + down - search->at_ijk[axis], search->at_ijk[axis] - ((double)last[axis] + up)) -
            slack;
        if (gap <= 0)
            continue;
        sum += square(gap * tree->spacing_mm[axis]);
        most = fmax(most, square(gap / tree->reach[axis]));
    }
    return tree->is_square ? sum : most;
}

static void block_voxels(const struct face_tree *tree, const struct level *level, const uint32_t block[3],
                         int64_t first[3], int64_t last[3])
{
    for (int axis = 0; axis < 3; axis++) {
        first[axis] = (int64_t)block[axis] << level->shift[axis];
        last[axis] = first[axis] + ((int64_t)1 << level->shift[axis]) - 1;
        last[axis] = last[axis] < tree->mask->size[axis] ? last[axis] : (int64_t)tree->mask->size[axis] - 1;
    }
}

static void search_leaf(struct search *search, const uint32_t block[3])
{
    const struct face_tree *tree = search->tree;
    int64_t first[3], last[3];
    block_voxels(tree, &tree->levels[0], block, first, last);
    for (int64_t k = first[2]; k <= last[2]; k++)
        for (int64_t j = first[1]; j <= last[1]; j++) {
            uint64_t faces = faces_of_word(tree->mask, first[0] / 64, j, k, search->way) >> first[0] % 64 & 0xff;
            if (!faces ||
                !(bound_2(search, (int64_t[3]){ first[0], j, k }, (int64_t[3]){ last[0], j, k }) < search->best_2))
                continue;
            for (; faces; faces &= faces - 1) {
                const double from_voxel[3] = { search->at_ijk[0] - (double)(first[0] + __builtin_ctzll(faces)),
                                               search->at_ijk[1] - (double)j, search->at_ijk[2] - (double)k };
                double here = face_tree_face_distance_2(tree, from_voxel, search->axis, search->side);
                search->best_2 = here < search->best_2 ? here : search->best_2;
                search->n_measured++;
            }
        }
}

struct child {
    uint32_t block[3];
    double bound_2;
};

/* Lists the blocks one level below that have such faces, nearest first. */
static int find_children(const struct search *search, int level, const uint32_t block[3], struct child children[8])
{
    const struct face_tree *tree = search->tree;
    const struct level *above = &tree->levels[level], *below = above - 1;
    int n = 0;
    for (uint32_t at = 0; at < 8; at++) {
        struct child child;
        bool is_there = true;
        for (int axis = 0; axis < 3; axis++) {
            uint32_t shift = above->shift[axis] - below->shift[axis], step = at >> axis & 1;
            child.block[axis] = (block[axis] << shift) + step;
            is_there = is_there && step <= shift && child.block[axis] < below->size[axis];
        }
        if (!is_there || !(*block_at(below, child.block[0], child.block[1], child.block[2]) >> search->way & 1))
            continue;
        int64_t first[3], last[3];
        block_voxels(tree, below, child.block, first, last);
        child.bound_2 = bound_2(search, first, last);
        int hole = n++;
        for (; hole > 0 && children[hole - 1].bound_2 > child.bound_2; hole--)
            children[hole] = children[hole - 1];
        children[hole] = child;
    }
    return n;
}

static void search_block(struct search *search, int level, const uint32_t block[3])
{
    if (level == 0) {
        search_leaf(search, block);
        return;
    }
    struct child children[8];
    int n = find_children(search, level, block, children);
    for (int at = 0; at < n && children[at].bound_2 < search->best_2; at++)
        search_block(search, level - 1, children[at].block);
}

double face_tree_nearest_2(const struct face_tree *tree, const double at_ijk[3], double known_2, uint64_t *n_measured)
{
    struct search search = { .tree = tree, .at_ijk = at_ijk, .best_2 = known_2 };
    for (int way = N_WAYS - 1; way >= 0; way--) {
        search.way = way;
        search.axis = way / 2;
        search.side = way % 2 ? 1 : -1;
        if (tree->levels[tree->n_levels - 1].ways[0] >> way & 1)
            search_block(&search, tree->n_levels - 1, (uint32_t[3]){ 0, 0, 0 });
    }
    *n_measured += search.n_measured;
    return search.best_2;
}

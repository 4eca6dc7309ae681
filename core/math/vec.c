/* Affine maps, 4x4 projections and boxes: inverting, composing, projecting. */
#include "core/math/vec.h"

double affine_determinant(const struct affine *map)
{
    return vec3_dot(map->columns[0], vec3_cross(map->columns[1], map->columns[2]));
}

bool affine_invert(const struct affine *map, struct affine *inverse)
{
    double det = affine_determinant(map);
    if (!isfinite(det) || !vec3_is_finite(map->origin))
        return false;
    double scale = vec3_length(map->columns[0]) * vec3_length(map->columns[1]) * vec3_length(map->columns[2]);
    if (!(fabs(det) > 1e-9 * scale)) /* zero columns, or columns nearly in one plane */
        return false;
    /* rows of the inverse are cross products of the columns over the determinant */
    struct vec3 r0 = vec3_scale(vec3_cross(map->columns[1], map->columns[2]), 1 / det);
    struct vec3 r1 = vec3_scale(vec3_cross(map->columns[2], map->columns[0]), 1 / det);
    struct vec3 r2 = vec3_scale(vec3_cross(map->columns[0], map->columns[1]), 1 / det);
    struct affine result = { { vec3(r0.x, r1.x, r2.x), vec3(r0.y, r1.y, r2.y), vec3(r0.z, r1.z, r2.z) }, { 0, 0, 0 } };
    result.origin = vec3_scale(affine_vector(&result, map->origin), -1);
    if (!vec3_is_finite(result.origin))
        return false;
    *inverse = result;
    return true;
}

struct affine affine_compose(const struct affine *a, const struct affine *b)
{
    return (struct affine){ { affine_vector(a, b->columns[0]), affine_vector(a, b->columns[1]),
                              affine_vector(a, b->columns[2]) },
                            affine_point(a, b->origin) };
}

struct mat4 mat4_multiply(const struct mat4 *a, const struct mat4 *b)
{
    struct mat4 product = { { 0 } };
    for (int column = 0; column < 4; column++)
        for (int row = 0; row < 4; row++)
            for (int k = 0; k < 4; k++)
                product.m[4 * column + row] += a->m[4 * k + row] * b->m[4 * column + k];
    return product;
}

bool mat4_invert(const struct mat4 *matrix, struct mat4 *inverse)
{
    /* Gauss-Jordan with partial pivoting on rows of [matrix | 1] */
    double rows[4][8];
    for (int r = 0; r < 4; r++)
        for (int c = 0; c < 4; c++) {
            rows[r][c] = matrix->m[4 * c + r];
            rows[r][4 + c] = r == c;
        }
    for (int c = 0; c < 4; c++) {
        int pivot = c;
        for (int r = c + 1; r < 4; r++)
            if (fabs(rows[r][c]) > fabs(rows[pivot][c]))
                pivot = r;
        if (!(fabs(rows[pivot][c]) > 0) || !isfinite(rows[pivot][c]))
            return false;
        for (int k = 0; k < 8; k++) {
            double swap = rows[c][k];
            rows[c][k] = rows[pivot][k];
            rows[pivot][k] = swap;
        }
        double scale = 1 / rows[c][c];
        for (int k = 0; k < 8; k++)
            rows[c][k] *= scale;
        for (int r = 0; r < 4; r++) {
            double factor = r == c ? 0 : rows[r][c];
            for (int k = 0; k < 8; k++)
                rows[r][k] -= factor * rows[c][k];
        }
    }
    for (int r = 0; r < 4; r++)
        for (int c = 0; c < 4; c++)
            inverse->m[4 * c + r] = rows[r][4 + c];
    return true;
}

struct vec3 mat4_project(const struct mat4 *matrix, struct vec3 p)
{
    const double *m = matrix->m;
    double w = m[3] * p.x + m[7] * p.y + m[11] * p.z + m[15];
    return vec3((m[0] * p.x + m[4] * p.y + m[8] * p.z + m[12]) / w, (m[1] * p.x + m[5] * p.y + m[9] * p.z + m[13]) / w,
                (m[2] * p.x + m[6] * p.y + m[10] * p.z + m[14]) / w);
}

struct box3 box3_empty(void)
{
    return (struct box3){ vec3(INFINITY, INFINITY, INFINITY), vec3(-INFINITY, -INFINITY, -INFINITY) };
}

void box3_add(struct box3 *box, struct vec3 p)
{
    box->low = vec3(fmin(box->low.x, p.x), fmin(box->low.y, p.y), fmin(box->low.z, p.z));
    box->high = vec3(fmax(box->high.x, p.x), fmax(box->high.y, p.y), fmax(box->high.z, p.z));
}

#pragma once
/* Vectors, affine maps, 4x4 projections and boxes in double precision: single precision is too coarse for an oblique
 * grid of 512 voxels over 500 mm. */
#include <math.h>
#include <stdbool.h>

#define MATH_PI 3.14159265358979323846

struct vec3 {
    double x, y, z;
};

static inline struct vec3 vec3(double x, double y, double z)
{
    return (struct vec3){ x, y, z };
}
static inline struct vec3 vec3_add(struct vec3 a, struct vec3 b)
{
    return vec3(a.x + b.x, a.y + b.y, a.z + b.z);
}
static inline struct vec3 vec3_sub(struct vec3 a, struct vec3 b)
{
    return vec3(a.x - b.x, a.y - b.y, a.z - b.z);
}
static inline struct vec3 vec3_scale(struct vec3 a, double s)
{
    return vec3(a.x * s, a.y * s, a.z * s);
}
static inline double vec3_dot(struct vec3 a, struct vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline struct vec3 vec3_cross(struct vec3 a, struct vec3 b)
{
    return vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
static inline double vec3_length(struct vec3 a)
{
    return sqrt(vec3_dot(a, a));
}
static inline bool vec3_is_finite(struct vec3 a)
{
    return isfinite(a.x) && isfinite(a.y) && isfinite(a.z);
}
/* Unit length; the zero vector stays zero. */
static inline struct vec3 vec3_normalize(struct vec3 a)
{
    double length = vec3_length(a);
    return length > 0 ? vec3_scale(a, 1 / length) : a;
}

/* p -> columns[0] p.x + columns[1] p.y + columns[2] p.z + origin */
struct affine {
    struct vec3 columns[3];
    struct vec3 origin;
};

static inline struct vec3 affine_vector(const struct affine *map, struct vec3 v)
{
    return vec3_add(vec3_add(vec3_scale(map->columns[0], v.x), vec3_scale(map->columns[1], v.y)),
                    vec3_scale(map->columns[2], v.z));
}
static inline struct vec3 affine_point(const struct affine *map, struct vec3 p)
{
    return vec3_add(affine_vector(map, p), map->origin);
}
double affine_determinant(const struct affine *map);
/* False if the map is singular or not finite; inverse is then untouched. */
bool affine_invert(const struct affine *map, struct affine *inverse);
/* The map that applies first b, then a. */
struct affine affine_compose(const struct affine *a, const struct affine *b);

/* Column-major, m[4 * column + row], as OpenGL takes it. */
struct mat4 {
    double m[16];
};

struct mat4 mat4_multiply(const struct mat4 *a, const struct mat4 *b); /* first b, then a */
bool mat4_invert(const struct mat4 *matrix, struct mat4 *inverse);
/* Includes the division by w; w == 0 gives not-a-number. */
struct vec3 mat4_project(const struct mat4 *matrix, struct vec3 p);

/* Axis-aligned box; empty when low > high. */
struct box3 {
    struct vec3 low, high;
};
struct box3 box3_empty(void);
void box3_add(struct box3 *box, struct vec3 p);
static inline bool box3_is_empty(const struct box3 *box)
{
    return box->low.x > box->high.x;
}

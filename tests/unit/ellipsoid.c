/* Ellipsoids as masks, and the errors of their surfaces against geometry. */
#include "tests/unit/ellipsoid.h"

#include "tests/check.h"
#include "tests/unit/made_mask.h"

struct vec3 ellipsoid_to_body(const struct ellipsoid *body, struct vec3 p)
{
    double c = cos(body->tilt_rad), s = sin(body->tilt_rad), y = c * p.y - s * p.z, z = s * p.y + c * p.z;
    return vec3(c * p.x - s * z, y, s * p.x + c * z);
}

struct vec3 ellipsoid_from_body(const struct ellipsoid *body, struct vec3 p)
{
    double c = cos(body->tilt_rad), s = sin(body->tilt_rad), x = c * p.x + s * p.z, z = -s * p.x + c * p.z;
    return vec3(x, c * p.y + s * z, -s * p.y + c * z);
}

/* Half the gradient of (x / a)^2 + (y / b)^2 + (z / c)^2, in the body's axes. */
static struct vec3 gradient_at(const struct ellipsoid *body, struct vec3 p)
{
    const double *r = body->radius_mm;
    return vec3(p.x / (r[0] * r[0]), p.y / (r[1] * r[1]), p.z / (r[2] * r[2]));
}

struct vec3 ellipsoid_normal(const struct ellipsoid *body, struct vec3 p)
{
    return ellipsoid_from_body(body, gradient_at(body, ellipsoid_to_body(body, p)));
}

double ellipsoid_distance_mm(const struct ellipsoid *body, struct vec3 p)
{
    struct vec3 at = ellipsoid_to_body(body, p), gradient = gradient_at(body, at);
    return (vec3_dot(at, gradient) - 1) / (2 * vec3_length(gradient));
}

struct mask *ellipsoid_mask(const struct ellipsoid *body, int place)
{
    static const double offs[][3] = { { 0.13, -0.21, 0.17 }, { -0.31, 0.08, -0.42 }, { 0.37, 0.29, -0.11 } };
    const double *off = offs[place % 3];
    double reach = fmax(body->radius_mm[0], fmax(body->radius_mm[1], body->radius_mm[2])) + 6;
    uint32_t size[3];
    struct affine map = unit_map;
    for (int axis = 0; axis < 3; axis++)
        size[axis] = (uint32_t)(2 * reach / body->spacing_mm[axis]) + 2;
    map.columns[0].x = body->spacing_mm[0];
    map.columns[1].y = body->spacing_mm[1];
    map.columns[2].z = body->spacing_mm[2];
    map.origin = vec3(-body->spacing_mm[0] * ((size[0] - 1) / 2.0 - off[0]),
                      -body->spacing_mm[1] * ((size[1] - 1) / 2.0 - off[1]),
                      -body->spacing_mm[2] * ((size[2] - 1) / 2.0 - off[2]));
    struct mask *mask = mask_make(size[0], size[1], size[2], &map);
    for (uint32_t k = 0; k < size[2]; k++)
        for (uint32_t j = 0; j < size[1]; j++)
            for (uint32_t i = 0; i < size[0]; i++) {
                struct vec3 p = ellipsoid_to_body(body, affine_point(&map, vec3(i, j, k)));
                if (vec3_dot(p, gradient_at(body, p)) < 1)
                    mask_put(mask, i, j, k);
            }
    return mask;
}

/* ---- percentiles: histograms of a hundredth of a degree --------------------------------------------------------- */

enum { BINS_A_DEG = 100, N_BINS = 180 * BINS_A_DEG + 1 };

struct angles {
    double weight[N_BINS], total;
};

static void angles_add(struct angles *angles, double deg, double weight)
{
    angles->weight[(int)(deg * BINS_A_DEG)] += weight;
    angles->total += weight;
}

static double angles_p95(const struct angles *angles)
{
    double sum = 0;
    for (int bin = 0; bin < N_BINS; bin++) {
        sum += angles->weight[bin];
        if (sum >= 0.95 * angles->total)
            return (bin + 1.0) / BINS_A_DEG;
    }
    return 180;
}

static double angle_deg(struct vec3 a, struct vec3 b)
{
    return acos(fmax(-1, fmin(1, vec3_dot(vec3_normalize(a), vec3_normalize(b))))) * 180 / MATH_PI;
}

static struct vec3 three(const float *p)
{
    return vec3((double)p[0], (double)p[1], (double)p[2]);
}

static bool is_near_pole(struct vec3 normal, int slice_axis)
{
    struct vec3 n = vec3_normalize(normal);
    const double along[3] = { n.x, n.y, n.z };
    return fabs(along[slice_axis]) > cos(30 * MATH_PI / 180);
}

struct ellipsoid_error ellipsoid_error_of(const struct mesh *mesh, const struct ellipsoid *body, int slice_axis)
{
    enum { FACES, POLE_FACES, SHOWN, POLE_SHOWN, N };
    struct angles *angles = calloc(N, sizeof *angles);
    struct ellipsoid_error error = { 0 };
    double squares = 0;
    for (size_t t = 0; t < mesh->n_triangles; t++) {
        const uint32_t *v = mesh->indices + 3 * t;
        struct vec3 a = three(mesh->positions_lps_mm + 3 * v[0]), b = three(mesh->positions_lps_mm + 3 * v[1]),
                    c = three(mesh->positions_lps_mm + 3 * v[2]);
        struct vec3 cross = vec3_cross(vec3_sub(b, a), vec3_sub(c, a));
        double area = vec3_length(cross) / 2;
        if (!(area > 0))
            continue;
        struct vec3 middle = vec3_scale(vec3_add(a, vec3_add(b, c)), 1 / 3.0), exact = ellipsoid_normal(body, middle);
        double deg = angle_deg(exact, cross), distance = ellipsoid_distance_mm(body, middle);
        angles_add(&angles[FACES], deg, area);
        if (is_near_pole(exact, slice_axis))
            angles_add(&angles[POLE_FACES], deg, area);
        squares += area * distance * distance;
    }
    error.rms_mm = sqrt(squares / angles[FACES].total);
    for (size_t v = 0; v < mesh->n_vertices; v++) {
        struct vec3 at = three(mesh->positions_lps_mm + 3 * v), exact = ellipsoid_normal(body, at);
        error.max_mm = fmax(error.max_mm, fabs(ellipsoid_distance_mm(body, at)));
        double deg = angle_deg(exact, three(mesh->normals + 3 * v));
        angles_add(&angles[SHOWN], deg, 1);
        if (is_near_pole(exact, slice_axis))
            angles_add(&angles[POLE_SHOWN], deg, 1);
    }
    error.normal_deg = angles_p95(&angles[FACES]);
    error.pole_normal_deg = angles_p95(&angles[POLE_FACES]);
    error.shown_deg = angles_p95(&angles[SHOWN]);
    error.pole_shown_deg = angles_p95(&angles[POLE_SHOWN]);
    const double *r = body->radius_mm;
    error.volume = mesh_volume_mm3(mesh) / (4 / 3.0 * MATH_PI * r[0] * r[1] * r[2]) - 1;
    free(angles);
    return error;
}

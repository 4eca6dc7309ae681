/* A tally's place and numbers. */
#include "core/formats/tally/tally.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"

#define EVEN_SHARE 1e-3 /* of a step */
#define EVEN_CM 0.0101  /* what two decimals of two edges leave open */

void tally_finish(struct tally *tally)
{
    free(tally->values);
    free(tally->errors);
    *tally = (struct tally){ 0 };
}

bool tally_take_edges(struct tally *tally, int axis, const double *edges_cm, size_t n_edges, const char *name,
                      struct error *err)
{
    if (n_edges < 2 || n_edges > VOLUME_MAX_SIDE + 1)
        return error_set(err, ERROR_RANGE, "%s: %zu bounds along %c, 2 to %d expected", name, n_edges, "xyz"[axis],
                         VOLUME_MAX_SIDE + 1);
    double step = (edges_cm[n_edges - 1] - edges_cm[0]) / (double)(n_edges - 1);
    if (!(step > 0) || !isfinite(step))
        return error_set(err, ERROR_RANGE, "%s: the bounds along %c do not grow", name, "xyz"[axis]);
    for (size_t i = 0; i < n_edges; i++)
        if (!(fabs(edges_cm[i] - (edges_cm[0] + step * (double)i)) <= EVEN_SHARE * step + fmin(EVEN_CM, .25 * step)))
            return error_set(err, ERROR_UNSUPPORTED,
                             "%s: bound %zu along %c is %g cm; a mesh of even steps, here %g cm, is read", name, i + 1,
                             "xyz"[axis], edges_cm[i], step);
    tally->size[axis] = (uint32_t)(n_edges - 1);
    tally->low_cm[axis] = edges_cm[0];
    tally->step_cm[axis] = step;
    return true;
}

bool tally_make_room(struct tally *tally, uint64_t most, bool has_errors, const char *name, struct error *err)
{
    uint64_t n = (uint64_t)tally->size[0] * tally->size[1] * tally->size[2];
    if (n == 0 || n > most)
        return error_set(err, ERROR_FORMAT, "%s: a mesh of %u x %u x %u boxes, more than the file can hold", name,
                         tally->size[0], tally->size[1], tally->size[2]);
    tally->values = mem_array((size_t)n, sizeof *tally->values, VOLUME_MAX_BYTES, err);
    if (tally->values && has_errors)
        tally->errors = mem_array((size_t)n, sizeof *tally->errors, VOLUME_MAX_BYTES, err);
    return tally->values && (!has_errors || tally->errors);
}

/* The patient axis (0 L, 1 P, 2 S) and the sign of a letter; -1: none. */
static int axis_of(char letter, double *sign)
{
    static const char letters[] = "LPSRAI";
    const char *at = letter ? strchr(letters, letter) : NULL;
    if (!at)
        return -1;
    *sign = at - letters < 3 ? 1 : -1;
    return (int)(at - letters) % 3;
}

bool tally_grid(const struct tally *tally, const struct tally_placing *placing, const char *name, struct grid *grid,
                struct error *err)
{
    double way[3][3] = { { 0 } }; /* by axis of the code */
    unsigned seen = 0;
    for (int i = 0; i < 3; i++) {
        double sign = 0;
        int axis = axis_of(placing->axes[i], &sign);
        if (axis >= 0) {
            seen |= 1U << axis;
            way[i][axis] = sign;
        }
    }
    if (seen != 7 || placing->axes[3])
        return error_set(err, ERROR_RANGE,
                         "%s: axes are '%.3s', expected one of L R, one of P A and one of S I, as LPS", name,
                         placing->axes);
    struct affine map = { .origin = placing->origin_mm };
    for (int i = 0; i < 3; i++) {
        struct vec3 unit = vec3(way[i][0], way[i][1], way[i][2]);
        map.columns[i] = vec3_scale(unit, 10 * tally->step_cm[i]);
        map.origin = vec3_add(map.origin, vec3_scale(unit, 10 * (tally->low_cm[i] + .5 * tally->step_cm[i])));
    }
    if (grid_init(grid, tally->size, &map, err))
        return true;
    error_prefix(err, "%s", name);
    return false;
}

struct volume *tally_volume(const struct tally *tally, const struct tally_placing *placing, bool is_error,
                            const char *name, struct error *err)
{
    struct grid grid;
    const float *from = is_error ? tally->errors : tally->values;
    if (!from) {
        error_set(err, ERROR_NOT_FOUND, "%s: the file holds no errors of its values", name);
        return NULL;
    }
    if (!tally_grid(tally, placing, name, &grid, err))
        return NULL;
    struct volume *volume = volume_create_unset(&grid, VOXEL_F32, err);
    if (!volume)
        return NULL;
    float *to = volume->voxels;
    size_t n = grid_n_voxels(&grid);
    for (size_t i = 0; i < n; i++) {
        to[i] = (float)((double)from[i] * placing->factor);
        if (!isfinite(to[i])) {
            error_set(err, ERROR_RANGE, "%s: box %zu: %g times the factor %g is no number that a dose can have", name,
                      i + 1, (double)from[i], placing->factor);
            volume_unref(volume);
            return NULL;
        }
    }
    volume_measure(volume);
    return volume;
}

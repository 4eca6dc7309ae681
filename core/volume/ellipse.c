/* Samples a volume on a lattice within an ellipse. */
#include "core/volume/ellipse.h"

_Static_assert(ELLIPSE_MAX_SAMPLES == 1000 * 1000, "the step is chosen for so many samples");

/* Sums about the first value, so that a small spread about a large value is not lost. */
struct sums {
    size_t n;
    double first, sum, squares;
};

static void add(struct sums *sums, struct ellipse_values *values, double value)
{
    if (sums->n++ == 0)
        sums->first = values->low = values->high = value;
    double d = value - sums->first;
    sums->sum += d;
    sums->squares += d * d;
    values->low = fmin(values->low, value);
    values->high = fmax(values->high, value);
}

bool ellipse_values(const struct volume *volume, struct vec3 centre_lps_mm, struct vec3 a_lps_mm, struct vec3 b_lps_mm,
                    struct ellipse_values *values)
{
    struct vec3 a = vec3_sub(a_lps_mm, centre_lps_mm), b = vec3_sub(b_lps_mm, centre_lps_mm), cross = vec3_cross(a, b);
    double product = vec3_length(cross);
    *values = (struct ellipse_values){ .mean = NAN, .sd = NAN, .low = NAN, .high = NAN };
    if (!(product > 1e-9 * vec3_length(a) * vec3_length(b)))
        return false;
    struct vec3 x = vec3_normalize(a), y = vec3_cross(vec3_normalize(cross), x),
                spacing = grid_spacing_mm(&volume->grid);
    double bx = vec3_dot(b, x), by = vec3_dot(b, y), ax = vec3_length(a); /* a is (ax, 0) in the plane, by > 0 */
    values->area_mm2 = MATH_PI * product;
    double step = fmin(fmin(spacing.x, spacing.y), spacing.z);
    double longest = 2 * (ax + vec3_length(b)); /* a needle has hardly any area */
    values->step_mm = step = fmax(step, fmax(sqrt(values->area_mm2), longest / 1000) / 1000);

    struct sums sums = { 0 };
    int64_t rows = (int64_t)floor(by / step);
    for (int64_t row = -rows; row <= rows; row++) {
        double v = (double)row * step, t = v / by, half = ax * sqrt(fmax(0, 1 - t * t)), middle = t * bx;
        for (int64_t column = (int64_t)ceil((middle - half) / step); (double)column * step <= middle + half; column++) {
            struct vec3 point =
                vec3_add(centre_lps_mm, vec3_add(vec3_scale(x, (double)column * step), vec3_scale(y, v)));
            double value;
            if (volume_sample(volume, point, &value))
                add(&sums, values, value);
            else
                values->n_left_out++;
        }
    }
    values->n = sums.n;
    if (sums.n > 0) {
        double mean = sums.sum / (double)sums.n;
        values->mean = sums.first + mean;
        values->sd = sqrt(fmax(0, sums.squares / (double)sums.n - mean * mean));
    }
    return true;
}

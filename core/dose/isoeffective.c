#include "core/dose/isoeffective.h"

#include <math.h>

double lea_catcheside(double mean_repair_min, double duration_min)
{
    double y = duration_min / mean_repair_min;
    if (y < 1e-3) /* where the closed form cancels */
        return 1 - y / 3 + y * y / 12;
    return 2 * (y + expm1(-y)) / (y * y);
}

void isoeffective_init(struct isoeffective *prepared, const struct isoeffective_set *set, double irradiation_min)
{
    double photon_slow = lea_catcheside(set->repair_slow_min, set->photon_min),
           photon_fast = lea_catcheside(set->repair_fast_min, set->photon_min),
           slow = lea_catcheside(set->repair_slow_min, irradiation_min);
    *prepared = (struct isoeffective){
        .alpha = set->photon.alpha,
        .beta_g = set->photon.beta * (photon_slow - set->low_let_fast_part * (photon_slow - photon_fast)),
        .alpha_boron = set->boron.alpha,
        .alpha_nitrogen = set->nitrogen.alpha,
        .alpha_fast = set->fast.alpha,
        .root_boron = sqrt(set->boron.beta),
        .root_nitrogen = sqrt(set->nitrogen.beta),
        .root_fast = sqrt(set->fast.beta),
        .root_photon = sqrt(set->photon.beta),
        .g_slow = slow,
        .g_step = slow - lea_catcheside(set->repair_fast_min, irradiation_min),
        .low_let_fast_part = set->low_let_fast_part,
        .high_let_fast_part = set->high_let_fast_part,
    };
}

/* G of a pair of photons, with a dose, and another component with a dose. */
static double mixed_g(const struct isoeffective *prepared, double gamma_gy, double other_gy)
{
    double sum = gamma_gy + other_gy, part = prepared->high_let_fast_part;
    if (sum > 0)
        part += (prepared->low_let_fast_part - part) * gamma_gy / sum;
    return prepared->g_slow - part * prepared->g_step;
}

double isoeffective_dose(const struct isoeffective *prepared, double boron_gy, double nitrogen_gy, double fast_gy,
                         double gamma_gy)
{
    double linear = prepared->alpha_boron * boron_gy + prepared->alpha_nitrogen * nitrogen_gy +
                    prepared->alpha_fast * fast_gy + prepared->alpha * gamma_gy;
    double boron = prepared->root_boron * boron_gy,
           neutron = prepared->root_nitrogen * nitrogen_gy + prepared->root_fast * fast_gy,
           gamma = prepared->root_photon * gamma_gy;
    double g_high = prepared->g_slow - prepared->high_let_fast_part * prepared->g_step,
           g_low = prepared->g_slow - prepared->low_let_fast_part * prepared->g_step;
    double square = g_high * (boron + neutron) * (boron + neutron) + g_low * gamma * gamma +
                    2 * gamma *
                        (mixed_g(prepared, gamma_gy, boron_gy) * boron +
                         mixed_g(prepared, gamma_gy, nitrogen_gy + fast_gy) * neutron);
    double effect = linear + square, alpha = prepared->alpha;
    /* the positive root, in the form that does not cancel and holds for beta 0 */
    return 2 * effect / (alpha + sqrt(alpha * alpha + 4 * prepared->beta_g * effect));
}

void isoeffective_doses(const struct isoeffective *prepared, const float *const components[4], const double factors[4],
                        size_t n, float *doses)
{
    for (size_t point = 0; point < n; point++) {
        double gy[4];
        for (int i = 0; i < 4; i++)
            gy[i] = components[i] ? (double)components[i][point] * factors[i] : 0;
        doses[point] = (float)isoeffective_dose(prepared, gy[0], gy[1], gy[2], gy[3]);
    }
}

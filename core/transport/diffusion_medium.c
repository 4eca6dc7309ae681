/* Means over the spectrum of slow neutrons in an infinite medium. */
#include <math.h>
#include <string.h>

#include "core/transport/diffusion.h"

#define EXTRAPOLATION 2.1313 /* of neutrons of one free path: 0.7104 transport mean free paths */

/* Cross-sections of groups of bound hydrogen's matrix, 1/cm. */
struct groups {
    double scatter[WATER_N_GROUPS][WATER_N_GROUPS]; /* by hydrogen, from and to; the rest changes no energy there */
    double leaving[WATER_N_GROUPS];                 /* to other groups, and absorbed */
    double along[WATER_N_GROUPS][WATER_N_GROUPS];   /* scattering times the mean cosine, by all */
    double total[WATER_N_GROUPS];
};

static double middle_ev(int group)
{
    return .5 * ((double)water_bounds_ev[group] + (double)water_bounds_ev[group + 1]);
}

static void make_groups(struct groups *groups, const struct material *material, const struct medium *medium)
{
    double hydrogen = medium_atoms(material, ELEMENT_H), others = 0, others_along = 0;
    for (int i = ELEMENT_C; i < N_ELEMENTS; i++) {
        enum nuclide_id id = medium_nuclide((enum element)i);
        double scatter = medium_atoms(material, (enum element)i) * nuclide_scatter_b(id, .5);
        others += scatter;
        others_along += scatter * 2 / (3 * (double)nuclide_table[id].mass);
    }
    for (int from = 0; from < WATER_N_GROUPS; from++) {
        double out = 0, absorbed = medium->absorption_2200_cm * sqrt(.0253 / middle_ev(from));
        for (int to = 0; to < WATER_N_GROUPS; to++) {
            groups->scatter[from][to] = hydrogen * (double)water_scatter_b[from][to];
            groups->along[from][to] = hydrogen * (double)water_cosine_b[from][to];
            out += groups->scatter[from][to];
        }
        groups->along[from][from] += others_along;
        groups->total[from] = out + others + absorbed;
        groups->leaving[from] = out - groups->scatter[from][from] + absorbed;
    }
}

/* Fluence by group of neutrons that come in at the top, once they fell below DIFFUSION_BELOW_EV: Gauss and Seidel. */
static void solve(const struct groups *groups, double slow[WATER_N_GROUPS])
{
    enum { ROUNDS = 4000 };
    double fast[WATER_N_GROUPS] = { 0 };
    int first = water_group((double)DIFFUSION_BELOW_EV * .999);
    for (int g = 0; g < WATER_N_GROUPS; g++)
        slow[g] = 0;
    for (int round = 0; round < ROUNDS; round++)
        for (int g = 0; g < WATER_N_GROUPS; g++) {
            double in_fast = g == 0, in_slow = 0;
            for (int from = 0; from < WATER_N_GROUPS; from++) {
                if (from == g)
                    continue;
                in_slow += groups->scatter[from][g] * slow[from];
                if (from < first)
                    *(g < first ? &in_fast : &in_slow) += groups->scatter[from][g] * fast[from];
            }
            fast[g] = g < first ? in_fast / groups->leaving[g] : 0;
            slow[g] = in_slow / groups->leaving[g];
        }
}

/* Currents of a gradient of 1 in the fluence: total current = along of all + fluence / 3, group by group (the P1
 * equations; a neutron keeps part of its way while it changes its energy). */
static void find_currents(const struct groups *groups, const double slow[WATER_N_GROUPS],
                          double current[WATER_N_GROUPS])
{
    enum { ROUNDS = 400 };
    memset(current, 0, WATER_N_GROUPS * sizeof *current);
    for (int round = 0; round < ROUNDS; round++)
        for (int g = 0; g < WATER_N_GROUPS; g++) {
            double in = slow[g] / 3;
            for (int from = 0; from < WATER_N_GROUPS; from++)
                in += from == g ? 0 : groups->along[from][g] * current[from];
            current[g] = in / fmax(groups->total[g] - groups->along[g][g], 1e-4);
        }
}

void diffusion_medium_init(struct diffusion_medium *diffusing, const struct material *material,
                           const struct medium *medium)
{
    struct groups groups;
    double slow[WATER_N_GROUPS], current[WATER_N_GROUPS], sum = 0, inverse_speed = 0, thermal = 0, all = 0, longer = 0;
    make_groups(&groups, material, medium);
    bool has_hydrogen = material->weight[ELEMENT_H] > 0 && medium->absorption_2200_cm > 0;
    if (has_hydrogen)
        solve(&groups, slow);
    for (int g = 0; g < WATER_N_GROUPS; g++) {
        if (!has_hydrogen) /* nothing slows neutrons down there: those of room temperature */
            slow[g] = g == water_group(.0253);
        sum += slow[g];
        inverse_speed += slow[g] * sqrt(.0253 / middle_ev(g));
        thermal += water_bounds_ev[g] < NEUTRON_THERMAL_EV * 1.002F ? slow[g] : 0;
    }
    find_currents(&groups, slow, current);
    for (int g = 0; g < WATER_N_GROUPS; g++) {
        all += current[g];
        longer += slow[g] > 0 ? current[g] * current[g] / slow[g] : 0;
    }
    *diffusing = (struct diffusion_medium){ all / sum, EXTRAPOLATION * longer * sum / (all * all),
                                            medium->absorption_2200_cm * inverse_speed / sum, inverse_speed / sum,
                                            thermal / sum };
}

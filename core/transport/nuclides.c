/* Looking up nuclear data. */
#include "core/transport/nuclides.h"

#include <math.h>

int nuclide_group(double energy_ev)
{
    int group = 0;
    while (group < NUCLIDE_N_GROUPS - 1 && energy_ev < (double)nuclide_bounds_ev[group + 1])
        group++;
    return group;
}

int water_group(double energy_ev)
{
    int group = 0;
    while (group < WATER_N_GROUPS - 1 && energy_ev < (double)water_bounds_ev[group + 1])
        group++;
    return group;
}

static double middle_ev(int group)
{
    return sqrt((double)nuclide_bounds_ev[group] * (double)nuclide_bounds_ev[group + 1]);
}

static double free_hydrogen_b(double energy_ev)
{
    const float *scatter_b = nuclide_table[NUCLIDE_H].scatter_b;
    int group = nuclide_group(energy_ev);
    if (energy_ev > middle_ev(group) && group > 0)
        group--;
    if (energy_ev > middle_ev(0) || group == NUCLIDE_N_GROUPS - 1)
        return (double)scatter_b[group];
    double share = log(middle_ev(group) / energy_ev) / log(middle_ev(group) / middle_ev(group + 1));
    return exp((1 - share) * log((double)scatter_b[group]) + share * log((double)scatter_b[group + 1]));
}

double nuclide_scatter_b(enum nuclide_id id, double energy_ev)
{
    if (id != NUCLIDE_H)
        return (double)nuclide_table[id].scatter_b[nuclide_group(energy_ev)];
    if (energy_ev >= (double)water_bounds_ev[0])
        return free_hydrogen_b(energy_ev);
    double sum_b = 0;
    const float *row = water_scatter_b[water_group(energy_ev)];
    for (int i = 0; i < WATER_N_GROUPS; i++)
        sum_b += (double)row[i];
    return sum_b;
}

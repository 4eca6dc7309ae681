#pragma once
/* Nuclear data of neutrons: group cross-sections of the nuclides of tissue, and hydrogen bound in water. Facts alone;
 * knows no materials. Constants: any thread. */

enum nuclide_id {
    NUCLIDE_H,
    NUCLIDE_C,
    NUCLIDE_N_14,
    NUCLIDE_O,
    NUCLIDE_NA,
    NUCLIDE_P,
    NUCLIDE_S,
    NUCLIDE_CL,
    NUCLIDE_K,
    NUCLIDE_CA,
    NUCLIDE_N /* how many there are */
};
enum { NUCLIDE_N_GROUPS = 72, WATER_N_GROUPS = 29 };

struct nuclide {
    float mass;                        /* in units of the neutron's mass */
    float scatter_b[NUCLIDE_N_GROUPS]; /* elastic scattering, barn per atom */
    float cosine[NUCLIDE_N_GROUPS];    /* mean cosine in the centre-of-mass system */
};
extern const struct nuclide nuclide_table[NUCLIDE_N];
extern const float nuclide_bounds_ev[NUCLIDE_N_GROUPS + 1]; /* falling */

/* Hydrogen bound in water below water_bounds_ev[0], rows: group before, columns: group after the collision. */
extern const float water_bounds_ev[WATER_N_GROUPS + 1]; /* falling, last 0 */
extern const float water_scatter_b[WATER_N_GROUPS][WATER_N_GROUPS];
extern const float water_cosine_b[WATER_N_GROUPS][WATER_N_GROUPS]; /* times the mean cosine, laboratory system */

/* Group of an energy; energies beyond the table count in its first or last group. */
int nuclide_group(double energy_ev);
int water_group(double energy_ev);
/* Elastic scattering, barn per atom: hydrogen's between the middles of groups by logarithms, and bound in water below
 * water_bounds_ev[0]; others' as the group's. */
double nuclide_scatter_b(enum nuclide_id id, double energy_ev);

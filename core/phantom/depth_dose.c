/* Interpolates the published table of dose on the beam axis and extends it off the axis. */
#include "core/phantom/depth_dose.h"

#include "core/phantom/head.h"

const double phantom_beam_radius_mm = 50;
const double phantom_source_z_lps_mm = 150;

const double phantom_depths_mm[PHANTOM_N_DEPTHS] = { 2, 10, 18, 22, 26, 30, 38, 50, 70, 90, 110, 130 };

/* Source: Goorley, Kiger and Zamenhof 2002, modified Snyder head. The paper's "thermal" column is mostly from nitrogen
 * and is used for it. */
const struct phantom_component phantom_components[PHANTOM_N_COMPONENTS] = {
    { DOSE_BORON,
      true,
      { .0477, .0793, .0981, .1016, .1015, .0986, .0869, .0639, .0316, .0135, .00539, .00198 },
      8,
      0.14 },
    { DOSE_NITROGEN,
      false,
      { .0913, .1565, .1974, .2056, .2063, .2011, .1781, .1315, .0654, .0279, .0112, .00411 },
      8,
      0.14 },
    { DOSE_FAST,
      false,
      { .1404, .1130, .0812, .0687, .0585, .0500, .0372, .0246, .0131, .00708, .00392, .00217 },
      5,
      0.20 },
    { DOSE_GAMMA, false, { .506, .726, .895, .941, .970, .971, .937, .800, .533, .322, .192, .115 }, 14, 0.25 },
};

enum { CELL_MM = 4 };

/* Logarithms of the table and their slopes at the depths. */
struct curve {
    double log_dose[PHANTOM_N_DEPTHS], slope[PHANTOM_N_DEPTHS];
};

/* Slopes for a cubic that is monotone wherever the table is: 0 at an extremum, else the harmonic mean of the slopes on
 * both sides weighted by the intervals (F. N. Fritsch, J. Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300); at the
 * ends the secant. */
static void curve_init(struct curve *curve, const double table[PHANTOM_N_DEPTHS])
{
    const double *x = phantom_depths_mm;
    double secant[PHANTOM_N_DEPTHS - 1];
    for (int i = 0; i < PHANTOM_N_DEPTHS; i++)
        curve->log_dose[i] = log(table[i]);
    for (int i = 0; i + 1 < PHANTOM_N_DEPTHS; i++)
        secant[i] = (curve->log_dose[i + 1] - curve->log_dose[i]) / (x[i + 1] - x[i]);
    curve->slope[0] = secant[0];
    curve->slope[PHANTOM_N_DEPTHS - 1] = secant[PHANTOM_N_DEPTHS - 2];
    for (int i = 1; i + 1 < PHANTOM_N_DEPTHS; i++) {
        double before = x[i] - x[i - 1], after = x[i + 1] - x[i];
        double weight_before = 2 * after + before, weight_after = after + 2 * before;
        bool is_turn = secant[i - 1] * secant[i] <= 0;
        curve->slope[i] =
            is_turn ? 0 : (weight_before + weight_after) / (weight_before / secant[i - 1] + weight_after / secant[i]);
    }
}

static double curve_dose(const struct curve *curve, double depth_mm)
{
    const double *x = phantom_depths_mm;
    int last = PHANTOM_N_DEPTHS - 1;
    if (depth_mm <= x[0])
        return exp(curve->log_dose[0] + curve->slope[0] * (depth_mm - x[0]));
    if (depth_mm >= x[last])
        return exp(curve->log_dose[last] + curve->slope[last] * (depth_mm - x[last]));
    int i = 0;
    while (depth_mm >= x[i + 1])
        i++;
    double step = x[i + 1] - x[i], t = (depth_mm - x[i]) / step, u = 1 - t;
    double value = curve->log_dose[i] * u * u * (1 + 2 * t) + curve->log_dose[i + 1] * t * t * (3 - 2 * t) +
                   step * t * u * (curve->slope[i] * u - curve->slope[i + 1] * t);
    return exp(value);
}

static double lateral(const struct phantom_component *component, double depth_mm, double radius_mm)
{
    double width_mm = component->edge_mm + component->edge_per_depth * depth_mm;
    return (1 + exp(-phantom_beam_radius_mm / width_mm)) / (1 + exp((radius_mm - phantom_beam_radius_mm) / width_mm));
}

static double dose_of_curve(const struct phantom_component *component, const struct curve *curve, struct vec3 p)
{
    if (phantom_label_at(p) == PHANTOM_AIR)
        return 0;
    double depth_mm = fmax(phantom_scalp_top_mm(p.x, p.y) - p.z, 0);
    return curve_dose(curve, depth_mm) * lateral(component, depth_mm, hypot(p.x, p.y));
}

double phantom_dose(const struct phantom_component *component, double depth_mm, double radius_mm)
{
    struct curve curve;
    curve_init(&curve, component->table);
    return curve_dose(&curve, depth_mm) * lateral(component, depth_mm, radius_mm);
}

double phantom_dose_at(const struct phantom_component *component, struct vec3 point_lps_mm)
{
    struct curve curve;
    curve_init(&curve, component->table);
    return dose_of_curve(component, &curve, point_lps_mm);
}

bool phantom_dose_grid(struct grid *grid, struct error *err)
{
    /* an odd number of cells across, so that one column is on the axis; the topmost cell is the second one above the
     * scalp */
    const uint32_t size[3] = { 41, 57, 49 };
    double top_mm = phantom_tissues[PHANTOM_SCALP].shape.semi_axes_mm.z;
    struct affine map = { { { CELL_MM, 0, 0 }, { 0, CELL_MM, 0 }, { 0, 0, CELL_MM } },
                          { -CELL_MM * 20.0, -CELL_MM * 28.0, top_mm - phantom_depths_mm[0] - CELL_MM * 46.0 } };
    return grid_init(grid, size, &map, err);
}

struct volume *phantom_dose_volume(const struct phantom_component *component, const struct grid *grid,
                                   struct error *err)
{
    struct volume *volume = volume_create(grid, VOXEL_F32, err);
    if (!volume)
        return NULL;
    struct curve curve;
    curve_init(&curve, component->table);
    float *voxel = volume->voxels;
    for (uint32_t k = 0; k < grid->size[2]; k++)
        for (uint32_t j = 0; j < grid->size[1]; j++)
            for (uint32_t i = 0; i < grid->size[0]; i++)
                *voxel++ = (float)dose_of_curve(component, &curve, affine_point(&grid->lps_mm_from_ijk, vec3(i, j, k)));
    return volume;
}

struct volume *phantom_dose_mask(const struct grid *grid, struct error *err)
{
    struct volume *volume = volume_create(grid, VOXEL_U8, err);
    if (!volume)
        return NULL;
    uint8_t *voxel = volume->voxels;
    for (uint32_t k = 0; k < grid->size[2]; k++)
        for (uint32_t j = 0; j < grid->size[1]; j++)
            for (uint32_t i = 0; i < grid->size[0]; i++)
                *voxel++ = phantom_label_at(affine_point(&grid->lps_mm_from_ijk, vec3(i, j, k))) != PHANTOM_AIR;
    return volume;
}

/* Computes photon-isoeffective doses, voxel by voxel, in several threads. */
#include "core/derive/isoeffective_rows.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "dose_presets.h" /* generated from proto/dose_presets.json */

static const enum dose_quantity quantities[] = { DOSE_BORON, DOSE_NITROGEN, DOSE_FAST, DOSE_GAMMA, DOSE_OTHER };
enum { BORON, NITROGEN, FAST, GAMMA, OTHER, N_COMPONENTS };

struct isoeffective_rows {
    size_t n;
    double gy;                                                  /* one unit of the dose */
    struct isoeffective prepared[DOSE_MAX_ROWS];                /* by row */
    struct dose_field *components[DOSE_MAX_ROWS][N_COMPONENTS]; /* NULL: the dose has none */
    const struct grid *grid;                                    /* of all of them */
};

static double map(const struct isoeffective_rows *rows, size_t row, const double values[N_COMPONENTS])
{
    double gy[N_COMPONENTS];
    for (int c = 0; c < N_COMPONENTS; c++)
        gy[c] = values[c] * rows->gy;
    return isoeffective_dose(&rows->prepared[row], gy[BORON], gy[NITROGEN], gy[FAST] + gy[OTHER], gy[GAMMA]) / rows->gy;
}

/* ---- the components --------------------------------------------------------------------------------------------- */

/* The field of a component in the tissue of a row, of those parts that have it. NULL without an error: none has. */
static struct dose_field *component_field(struct derive *derive, const struct dose_choice *choice, size_t row,
                                          enum dose_quantity quantity, dose_field_getter *get, struct error *err)
{
    struct dose_choice of;
    bool is_per_ppm = false;
    memset(&of, 0, sizeof of);
    of.quantity = quantity;
    for (size_t p = 0; p < choice->n_parts; p++) {
        const struct dose_component *component =
            dose_component_of(&derive_plan(derive)->doses[choice->parts[p].dose], quantity);
        if (component) {
            of.parts[of.n_parts] = choice->parts[p];
            of.parts[of.n_parts++].more_ppm = component->is_per_ppm ? choice->parts[p].more_ppm : 0;
            is_per_ppm |= component->is_per_ppm;
        }
    }
    if (of.n_parts == 0)
        return NULL;
    of.blood_ppm = is_per_ppm ? choice->blood_ppm : 0;
    of.n_rows = 1;
    of.rows[0] = (struct tissue_weights){ is_per_ppm ? choice->rows[row].boron_ratio : 1, 1, 1, 1, 1, 1 };
    of.is_everywhere = true;
    memset(of.row_of_region, DOSE_NO_ROW, sizeof of.row_of_region);
    return get(derive, &of, err);
}

static bool find_components(struct isoeffective_rows *rows, struct derive *derive, const struct dose_choice *choice,
                            size_t row, dose_field_getter *get, struct error *err)
{
    isoeffective_init(&rows->prepared[row], &isoeffective_sets[choice->models[row]], choice->irradiation_min);
    for (int c = 0; c < N_COMPONENTS; c++) {
        struct error why = { 0 };
        struct dose_field *field = component_field(derive, choice, row, quantities[c], get, &why);
        rows->components[row][c] = field;
        if (why.code) {
            *err = why;
            return false;
        }
        if (!field)
            continue;
        if (!rows->grid)
            rows->grid = &field->rows[0]->grid;
        if (!grid_is_same(&field->rows[0]->grid, rows->grid))
            return error_set(err, ERROR_UNSUPPORTED,
                             "the components have several grids: no isoeffective dose is computed");
    }
    return rows->grid || error_set(err, ERROR_NOT_FOUND, "the dose has no physical components");
}

struct isoeffective_rows *isoeffective_rows_create(struct derive *derive, const struct dose_choice *choice,
                                                   dose_field_getter *get, struct error *err)
{
    const struct dose *dose = &derive_plan(derive)->doses[choice->parts[0].dose];
    double gy = strcmp(dose->unit, "Gy") == 0 ? 1 : strcmp(dose->unit, "cGy") == 0 ? 0.01 : 0;
    if (gy == 0) {
        (void)error_set(err, ERROR_RANGE, "dose \"%s\" is in \"%s\": an isoeffective dose needs Gy or cGy", dose->id,
                        dose->unit);
        return NULL;
    }
    struct isoeffective_rows *rows = mem_new(sizeof *rows);
    memset(rows, 0, sizeof *rows);
    rows->gy = gy;
    for (; rows->n < choice->n_rows; rows->n++)
        if (!find_components(rows, derive, choice, rows->n, get, err)) {
            rows->n++;
            isoeffective_rows_destroy(rows);
            return NULL;
        }
    return rows;
}

void isoeffective_rows_destroy(struct isoeffective_rows *rows)
{
    for (size_t r = 0; rows && r < rows->n; r++)
        for (int c = 0; c < N_COMPONENTS; c++)
            if (rows->components[r][c])
                derive_result_unref(&rows->components[r][c]->base);
    free(rows);
}

static const float *voxels_of(const struct isoeffective_rows *rows, size_t row, int c)
{
    return rows->components[row][c] ? rows->components[row][c]->rows[0]->voxels : NULL;
}

static bool sample(const struct isoeffective_rows *rows, size_t row, struct vec3 point_lps_mm,
                   double values[N_COMPONENTS])
{
    struct volume_place place;
    if (!volume_place_find(rows->grid, point_lps_mm, &place))
        return false;
    for (int c = 0; c < N_COMPONENTS; c++)
        if (rows->components[row][c] && !volume_place_value(rows->components[row][c]->rows[0], &place, &values[c]))
            return false;
    return true;
}

bool isoeffective_rows_value(const struct isoeffective_rows *rows, size_t row, struct vec3 point_lps_mm, double *value)
{
    double values[N_COMPONENTS] = { 0 };
    if (!sample(rows, row, point_lps_mm, values))
        return false;
    *value = map(rows, row, values);
    return isfinite(*value);
}

bool isoeffective_rows_components(const struct isoeffective_rows *rows, size_t row, struct vec3 point_lps_mm,
                                  double gy[4])
{
    double values[N_COMPONENTS] = { 0 };
    if (!sample(rows, row, point_lps_mm, values))
        return false;
    gy[0] = values[BORON] * rows->gy;
    gy[1] = values[NITROGEN] * rows->gy;
    gy[2] = (values[FAST] + values[OTHER]) * rows->gy;
    gy[3] = values[GAMMA] * rows->gy;
    return true;
}

double isoeffective_rows_unit_gy(const struct isoeffective_rows *rows)
{
    return rows->gy;
}

/* ---- how fine --------------------------------------------------------------------------------------------------- */

enum { MAX_THREADS = 64, MAX_FACTOR = 15 };
static const double low_share = 0.01; /* of the maximum: errors of lower doses are parts of this */

struct judging {
    const struct isoeffective_rows *rows;
    size_t row;
    double highest; /* of the dose at voxels; 0 while it is looked for */
    struct {
        double highest, error[3];
    } parts[MAX_THREADS];
};

static double dose_at(const struct isoeffective_rows *rows, size_t row, size_t at, size_t next)
{
    double values[N_COMPONENTS];
    for (int c = 0; c < N_COMPONENTS; c++) {
        const float *voxels = voxels_of(rows, row, c);
        values[c] = voxels ? ((double)voxels[at] + (double)voxels[next]) / 2 : 0;
    }
    return map(rows, row, values);
}

/* The error in the middle between a voxel and the next one along each axis. */
static void judge_voxel(const struct judging *judging, const uint32_t ijk[3], size_t at, double here, double error[3])
{
    const uint32_t *size = judging->rows->grid->size;
    const size_t strides[3] = { 1, size[0], (size_t)size[0] * size[1] };
    for (int axis = 0; axis < 3; axis++) {
        if (ijk[axis] + 1 == size[axis])
            continue;
        size_t next = at + strides[axis];
        double between = dose_at(judging->rows, judging->row, at, next),
               mean = (here + dose_at(judging->rows, judging->row, next, next)) / 2,
               part = fabs(between - mean) / fmax(fabs(between), low_share * judging->highest);
        if (part > error[axis]) /* false for what is no number */
            error[axis] = part;
    }
}

static void judge_some(void *context, int part, int n_parts)
{
    struct judging *judging = context;
    const uint32_t *size = judging->rows->grid->size;
    double highest = 0, error[3] = { 0 };
    for (uint32_t k = (uint32_t)part; k < size[2]; k += (uint32_t)n_parts)
        for (uint32_t j = 0; j < size[1]; j++)
            for (uint32_t i = 0; i < size[0]; i++) {
                size_t at = i + (size_t)size[0] * (j + (size_t)size[1] * k);
                double here = dose_at(judging->rows, judging->row, at, at);
                if (here > highest)
                    highest = here;
                if (judging->highest > 0 && isfinite(here))
                    judge_voxel(judging, (uint32_t[3]){ i, j, k }, at, here, error);
            }
    judging->parts[part].highest = highest;
    memcpy(judging->parts[part].error, error, sizeof error);
}

/* The greatest error along each axis over all rows. */
static void judge(const struct isoeffective_rows *rows, double error[3])
{
    struct judging *judging = mem_new(sizeof *judging);
    int n_parts = parallel_cores();
    for (size_t row = 0; row < rows->n; row++) {
        *judging = (struct judging){ .rows = rows, .row = row };
        parallel_run(n_parts, judge_some, judging);
        double highest = 0;
        for (int part = 0; part < n_parts; part++)
            highest = fmax(highest, judging->parts[part].highest);
        judging->highest = highest;
        if (highest > 0)
            parallel_run(n_parts, judge_some, judging);
        for (int part = 0; part < n_parts; part++)
            for (int axis = 0; axis < 3; axis++)
                error[axis] = fmax(error[axis], judging->parts[part].error[axis]);
    }
    free(judging);
}

static uint64_t n_voxels(const struct isoeffective_rows *rows, const uint32_t factors[3])
{
    return (uint64_t)grid_n_voxels(rows->grid) * rows->n * factors[0] * factors[1] * factors[2];
}

bool isoeffective_rows_grid(const struct isoeffective_rows *rows, uint64_t limit, struct grid *grid,
                            uint32_t factors[3], double *error, struct error *err)
{
    double coarse[3] = { 0 };
    const uint32_t *size = rows->grid->size;
    judge(rows, coarse);
    for (int axis = 0; axis < 3; axis++) {
        factors[axis] = 1;
        while (factors[axis] < MAX_FACTOR && size[axis] * (factors[axis] + 2) <= VOLUME_MAX_SIDE &&
               coarse[axis] > ISOEFFECTIVE_ERROR / 3 * factors[axis] * factors[axis])
            factors[axis] += 2;
    }
    while (n_voxels(rows, factors) > limit) {
        int least = -1; /* the axis on which a coarser step costs least */
        for (int axis = 0; axis < 3; axis++)
            if (factors[axis] > 1 &&
                (least < 0 || coarse[axis] / pow(factors[axis] - 2, 2) < coarse[least] / pow(factors[least] - 2, 2)))
                least = axis;
        if (least < 0)
            break;
        factors[least] -= 2;
    }
    struct affine map_to_lps = rows->grid->lps_mm_from_ijk;
    uint32_t fine[3];
    *error = 0;
    for (int axis = 0; axis < 3; axis++) {
        *error += coarse[axis] / (factors[axis] * factors[axis]);
        fine[axis] = size[axis] * factors[axis];
        map_to_lps.columns[axis] = vec3_scale(map_to_lps.columns[axis], 1.0 / factors[axis]);
    }
    /* the first of the finer voxels lies (factor - 1) / 2 of them before the first voxel's centre */
    for (int axis = 0; axis < 3; axis++)
        map_to_lps.origin =
            vec3_sub(map_to_lps.origin, vec3_scale(map_to_lps.columns[axis], (factors[axis] - 1) / 2.0));
    return grid_init(grid, fine, &map_to_lps, err);
}

/* ---- filling ---------------------------------------------------------------------------------------------------- */

/* Where a finer voxel lies between two voxels: exactly on one where t is 0. */
struct place {
    uint32_t low, high;
    float t;
};

static struct place place_of(uint32_t fine, uint32_t factor, uint32_t size)
{
    int64_t steps = 2 * (int64_t)fine + 1 - factor; /* from the first centre, in halves of finer voxels */
    int64_t low = steps < 0 ? 0 : steps / (2 * factor), rest = steps < 0 ? 0 : steps % (2 * factor);
    if (low >= size - 1)
        return (struct place){ size - 1, size - 1, 0 };
    return (struct place){ (uint32_t)low, (uint32_t)low + (rest != 0), (float)rest / (float)(2 * factor) };
}

struct row_job {
    const struct isoeffective_rows *rows;
    size_t row;
    const uint32_t *factors;
    struct volume *volume;
    const struct place *along_i; /* [size of the volume along i] */
    float *lines;                /* [n_parts][N_COMPONENTS][size of the components along i] */
};

static inline float mixed(float low, float high, float t)
{
    return t == 0 ? low : low + t * (high - low);
}

/* A component's voxels along i at a place between its rows. */
static void mix_line(const float *voxels, const uint32_t size[3], struct place y, struct place z, float *line)
{
    const float *rows[2][2];
    for (int a = 0; a < 2; a++)
        for (int b = 0; b < 2; b++)
            rows[a][b] = voxels + size[0] * ((b ? y.high : y.low) + (size_t)size[1] * (a ? z.high : z.low));
    for (uint32_t i = 0; i < size[0]; i++)
        line[i] = mixed(mixed(rows[0][0][i], rows[0][1][i], y.t), mixed(rows[1][0][i], rows[1][1][i], y.t), z.t);
}

static void fill_some(void *context, int part, int n_parts)
{
    const struct row_job *job = context;
    const uint32_t *size = job->rows->grid->size, *fine = job->volume->grid.size;
    float *lines = job->lines + (size_t)part * N_COMPONENTS * size[0];
    for (uint32_t k = (uint32_t)part; k < fine[2]; k += (uint32_t)n_parts)
        for (uint32_t j = 0; j < fine[1]; j++) {
            float *to = (float *)job->volume->voxels + fine[0] * (j + (size_t)fine[1] * k);
            struct place y = place_of(j, job->factors[1], size[1]), z = place_of(k, job->factors[2], size[2]);
            for (int c = 0; c < N_COMPONENTS; c++)
                if (voxels_of(job->rows, job->row, c))
                    mix_line(voxels_of(job->rows, job->row, c), size, y, z, lines + (size_t)c * size[0]);
            for (uint32_t i = 0; i < fine[0]; i++) {
                struct place x = job->along_i[i];
                double values[N_COMPONENTS] = { 0 };
                for (int c = 0; c < N_COMPONENTS; c++)
                    if (job->rows->components[job->row][c])
                        values[c] =
                            (double)mixed(lines[(size_t)c * size[0] + x.low], lines[(size_t)c * size[0] + x.high], x.t);
                to[i] = (float)map(job->rows, job->row, values);
            }
        }
}

bool isoeffective_rows_fill(const struct isoeffective_rows *rows, size_t row, const uint32_t factors[3],
                            struct volume *volume, struct error *err)
{
    const uint32_t *size = rows->grid->size;
    int n_parts = parallel_cores();
    struct place *along_i = mem_array(volume->grid.size[0], sizeof *along_i, UINT64_MAX, err);
    float *lines = mem_array((size_t)n_parts * N_COMPONENTS * size[0], sizeof *lines, UINT64_MAX, err);
    bool is_good = along_i && lines;
    if (is_good) {
        struct row_job job = { rows, row, factors, volume, along_i, lines };
        for (uint32_t i = 0; i < volume->grid.size[0]; i++)
            along_i[i] = place_of(i, factors[0], size[0]);
        parallel_run(n_parts, fill_some, &job);
        volume_measure(volume);
    }
    free(along_i);
    free(lines);
    return is_good;
}

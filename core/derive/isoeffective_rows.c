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

struct row_job {
    struct isoeffective prepared;
    const float *components[N_COMPONENTS]; /* NULL: the dose has none */
    double gy;                             /* one unit of the dose */
    float *doses;
    size_t n;
};

static void fill_some(void *context, int part, int n_parts)
{
    const struct row_job *job = context;
    size_t from = job->n / (size_t)n_parts * (size_t)part,
           to = part + 1 == n_parts ? job->n : job->n / (size_t)n_parts * (size_t)(part + 1);
    for (size_t i = from; i < to; i++) {
        double gy[N_COMPONENTS];
        for (int c = 0; c < N_COMPONENTS; c++)
            gy[c] = job->components[c] ? (double)job->components[c][i] * job->gy : 0;
        job->doses[i] =
            (float)(isoeffective_dose(&job->prepared, gy[BORON], gy[NITROGEN], gy[FAST] + gy[OTHER], gy[GAMMA]) /
                    job->gy);
    }
}

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
            of.parts[of.n_parts++] = choice->parts[p];
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

static bool fill_row(struct derive *derive, const struct dose_choice *choice, size_t row, double gy,
                     struct volume *volume, dose_field_getter *get, struct error *err)
{
    struct dose_field *fields[N_COMPONENTS] = { NULL };
    struct row_job job = { .gy = gy, .doses = volume->voxels, .n = grid_n_voxels(&volume->grid) };
    bool is_good = true;
    isoeffective_init(&job.prepared, &isoeffective_sets[choice->models[row]], choice->irradiation_min);
    for (int c = 0; is_good && c < N_COMPONENTS; c++) {
        struct error why = { 0 };
        fields[c] = component_field(derive, choice, row, quantities[c], get, &why);
        if (why.code) {
            *err = why;
            is_good = false;
        } else if (fields[c]) {
            job.components[c] = fields[c]->rows[0]->voxels;
            if (!grid_is_same(&fields[c]->rows[0]->grid, &volume->grid))
                is_good = error_set(err, ERROR_UNSUPPORTED,
                                    "the components have several grids: no isoeffective dose is computed");
        }
    }
    if (is_good)
        parallel_run(parallel_cores(), fill_some, &job);
    for (int c = 0; c < N_COMPONENTS; c++)
        if (fields[c])
            derive_result_unref(&fields[c]->base);
    return is_good;
}

bool isoeffective_rows_fill(struct derive *derive, const struct dose_choice *choice, struct volume *const rows[],
                            dose_field_getter *get, struct error *err)
{
    const struct dose *dose = &derive_plan(derive)->doses[choice->parts[0].dose];
    double gy = strcmp(dose->unit, "Gy") == 0 ? 1 : strcmp(dose->unit, "cGy") == 0 ? 0.01 : 0;
    if (gy == 0)
        return error_set(err, ERROR_RANGE, "dose \"%s\" is in \"%s\": an isoeffective dose needs Gy or cGy", dose->id,
                         dose->unit);
    for (size_t r = 0; r < choice->n_rows; r++)
        if (!fill_row(derive, choice, r, gy, rows[r], get, err))
            return false;
    return true;
}

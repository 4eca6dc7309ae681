#pragma once
/* The values of a dose as they are shown, as results of the store: quantities and weighted sums on the dose's own grid,
 * one volume for each set of factors, and which set holds at each univel. */
#include "core/derive/derive.h"
#include "core/dose/weights.h"

enum { DOSE_MAX_ROWS = 32, DOSE_NO_ROW = 255 };

/* Everything that a value of dose depends on. Compared by its bytes: zeroed before it is filled. */
struct dose_choice {
    struct {
        size_t dose; /* index in the plan */
        double factor;
        double more_ppm;     /* of boron in blood, beside blood_ppm, while this part is given */
    } parts[PLAN_MAX_DOSES]; /* what is summed; the first is the dose shown. The finest of their grids is the sum's */
    size_t n_parts;
    size_t unit_of; /* index in the plan of the dose in whose unit the values are; the parts' units convert to it */
    enum dose_shown shown;
    enum dose_quantity quantity; /* of DOSE_SHOWN_QUANTITY */
    double blood_ppm;
    double irradiation_min; /* of the isoeffective dose; else 0 */
    /* Distinct weights. */
    struct tissue_weights rows[DOSE_MAX_ROWS];
    uint32_t models[DOSE_MAX_ROWS]; /* isoeffective: index in isoeffective_sets; else 0 */
    size_t n_rows;
    bool is_everywhere;                /* rows[0] holds at every point; else: */
    uint8_t row_of_region[REGION_MAX]; /* by region index; DOSE_NO_ROW: no region around it has weights either */
    uint8_t left_out[REGION_MAX / 8];  /* bits by region index: not used with this dose, and in none of its figures */
};
static inline bool dose_leaves_out(const struct dose_choice *choice, size_t region)
{
    return choice->left_out[region / 8] >> region % 8 & 1;
}

/* Which row holds at each univel. */
struct tissue_rows {
    struct derive_result base;
    struct volume *rows; /* U8, on the grid of the plan's label layers (of several grids: of the one with the smallest
                            voxels); DOSE_NO_ROW: in no region with weights. The row is that of the innermost region
                            with weights: the deepest in the hierarchy, of equally deep ones the smaller */
};

struct dose_field {
    struct derive_result base;
    struct grid grid; /* the one with the smallest voxels of the components and parts, of equal ones that of the first
                         in the plan */
    struct volume *rows[DOSE_MAX_ROWS]; /* F32, slope 1, all on this grid; of an isoeffective dose on one with finer
                                           voxels, some of which have the same centres (isoeffective_rows.h). NaN
                                           where there is no value: a voxel under the dose's mask, beside another
                                           component's or part's grid, or not finite in a file */
    size_t n_rows;
    struct tissue_rows *tissue; /* NULL: rows[0] holds everywhere */
    char unit[DOSE_UNIT_SIZE];
    char per[64];     /* of the first part */
    uint32_t missing; /* bits 1 << enum dose_quantity of summands that some part lacks; 0 for a quantity of the files */
    struct isoeffective_rows *exact; /* of an isoeffective dose: the components that dose_field_value maps; else NULL */
    double row_error;                /* of an isoeffective dose: how far interpolated rows are off it, a part of it */
    struct dose_filling *filling;    /* combines the rows, see dose_field_begin; NULL: they are complete */
    bool is_resampled; /* a component or part on another grid was interpolated tri-linearly at the voxels of this one */
};

/* One reference, the caller's, dropped by derive_result_unref(&field->base).
 * errors  ERROR_NOT_FOUND a part lacks the quantity, or has nothing to sum; ERROR_RANGE the parts' units differ, there
 *         are no weights; ERROR_MEMORY
 * thread  any; the first builds, on all cores */
NODISCARD struct dose_field *dose_field_get(struct derive *derive, const struct dose_choice *choice, struct error *err);

/* Like dose_field_get, but rows are combined only where they are needed: a slider that moves asks for a new field with
 * each picture. The voxels of rows are undefined, and low and high of rows 0, until dose_field_need_... returned for a
 * part that holds the points that are read, or dose_field_get for all; then they stay. Any number of threads may ask
 * for, and read, parts of one field. rows[r] is there where univels of row r read it, and up to a univel around them:
 * at other points it may not be. dose_field_value needs no call before it. thread  any; parts are combined on all cores
 */
NODISCARD struct dose_field *dose_field_begin(struct derive *derive, const struct dose_choice *choice,
                                              struct error *err);
void dose_field_need_all(const struct dose_field *field);
void dose_field_need_box(const struct dose_field *field, const struct box3 *box_lps_mm);
void dose_field_need_plane(const struct dose_field *field, struct vec3 point_lps_mm, struct vec3 normal_lps);

/* The row at a patient point: of the univel that holds it. DOSE_NO_ROW: there is no value. */
uint8_t dose_field_row(const struct dose_field *field, struct vec3 point_lps_mm);
/* The value at a patient point: the components interpolated, as volume_sample, then combined. For sums that is the
 * same as tri-linear in the row's volume; an isoeffective dose read from its rows differs by up to row_error, at most
 * 0.1 % unless its grid is too large to be refined so far. False: there is none. Every picture, histogram and read-out
 * agrees with this. */
bool dose_field_value(const struct dose_field *field, struct vec3 point_lps_mm, double *value);
/* Like dose_field_value, with the weights of one row wherever the point lies. field: from dose_field_get. */
bool dose_field_value_in(const struct dose_field *field, uint8_t row, struct vec3 point_lps_mm, double *value);

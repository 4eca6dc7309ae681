#pragma once
/* Reads SERA's dose contours: a header .chd, a table of points .cdf and images of regions .cmf, as seraMC and seraPlan
 * write them. Points lie on a lattice of columns (RL), rows (PA) and planes (IS). Their coordinates give the position,
 * not their order; the names in the header give the quantity, not the order of the columns. Works on unpacked bytes in
 * memory.
 *
 * The files hold values as SERA draws them: boron times ppm in blood, the tissue's ratio to blood and a weight; the
 * other components times a weight. Weights and ppm are divided out. The ratio is not in the files: when boron divided
 * by the thermal fluence is in every region what 1 ppm gives, the ratio was 1 and boron is physical; else the component
 * stays DOSE_BLOOD_BORON. A total that includes weights other than 1 stays DOSE_WEIGHTED_TOTAL. source   output of
 * seraMC 1C0; SERA's boron dose per ppm and thermal fluence, 7.3e-12 cGy cm2 */
#include "core/formats/folder.h"
#include "core/formats/sera/sera_doses.h"
#include "core/report/report.h"

enum {
    CHD_MAX_BYTES = 1 << 20,
    CHD_N_COLUMNS = 9,
    CHD_MAX_SIDE = 1024, /* most columns, rows or planes of the lattice */
    CHD_MAX_POINTS = 4 << 20,
    CHD_LINE_MAX_BYTES = 160, /* of one point in the table, on average */
    CHD_MASK_MAX_SIDE = 512
};

struct chd {
    char version[32];
    double mm;              /* length of one unit of the following: 10 (cm), or 1 when only millimetres can be right */
    double half_width;      /* "FOV": half the width of the field; coordinates are fractions of it */
    double low[2], high[2]; /* x (RL) and y (PA) of the first and last points, as fractions of half_width */
    uint32_t n_columns, n_rows, n_planes;
    double *planes; /* [n_planes] z (IS), rising */
    bool has_column[CHD_N_COLUMNS];
    enum dose_quantity quantities[CHD_N_COLUMNS]; /* by the names in the header */
    bool has_concentration[CHD_N_COLUMNS];        /* false: the header gives none, and concentration is 1 */
    double concentration[CHD_N_COLUMNS], weight[CHD_N_COLUMNS], reference[CHD_N_COLUMNS];
};
void chd_finish(struct chd *chd);

/* Reads the header. errors ERROR_FORMAT (with the line and the key), ERROR_LIMIT */
NODISCARD bool chd_parse(const uint8_t *data, size_t size, const char *name, struct chd *chd, struct report *report,
                         struct error *err);

/* Upper bound on the bytes of the table and the images of a header. */
uint64_t chd_table_bytes(const struct chd *chd);
uint64_t chd_mask_bytes(const struct chd *chd);

struct chd_files {
    struct bytes table, mask; /* mask.data is NULL when there is none */
    const char *name, *table_name, *mask_name;
};
/* Reads the doses. Points without a dose (region 0, or no value above 0) become not-a-number, so that interpolation
 * excludes them. Unevenly spaced planes are resampled at their smallest gap, and reported.
 * errors  ERROR_FORMAT (with the line), ERROR_UNSUPPORTED planes too uneven for an even grid, ERROR_RANGE,
 *         ERROR_MEMORY */
NODISCARD bool chd_read(const struct chd *chd, const struct chd_files *files, struct sera_doses *doses,
                        struct report *report, struct error *err);

/* Reads the table of points and the images of regions of SERA's dose contours. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/formats/sera/sera_axes.h"
#include "core/formats/sera/sera_chd.h"
#include "core/formats/sera/sera_row.h"

static const double lattice_share = 0.1; /* tolerance as a fraction of a step: coordinates have four digits */
static const double uneven_share = 0.01; /* unevenness as a fraction of the spacing; less is rounding */
static const double boron_per_thermal_cgy_cm2 = 7.3e-12; /* boron dose of 1 ppm per thermal fluence */
static const double boron_share = 0.12;
enum { N_REGIONS = 10000, ENOUGH_POINTS = 20, MOST_PLANES = 4096 };

struct table {
    const struct chd *chd;
    const char *name;
    float *values[CHD_N_COLUMNS]; /* [plane][row][column]; NULL: not kept */
    uint16_t *regions;            /* region of each point; UINT16_MAX: not read */
    size_t n_points, n_unprinted, n_unread, first_bad_line, n_nothing;
    struct error *err;
};

static bool table_create(struct table *table)
{
    size_t n = table->n_points;
    table->regions = malloc(n * sizeof *table->regions);
    bool is_whole = table->regions != NULL;
    for (int c = 0; c < CHD_N_COLUMNS; c++)
        if (table->chd->has_column[c] && is_whole) {
            table->values[c] = malloc(n * sizeof(float));
            is_whole = table->values[c] != NULL;
        }
    if (!is_whole)
        return error_set(table->err, ERROR_MEMORY, "%s: no memory for %zu points", table->name, n);
    memset(table->regions, 0xff, n * sizeof *table->regions);
    return true;
}

static void table_finish(struct table *table)
{
    for (int c = 0; c < CHD_N_COLUMNS; c++)
        free(table->values[c]);
    free(table->regions);
}

static double step_of(const struct chd *chd, int axis)
{
    return (chd->high[axis] - chd->low[axis]) / ((axis == 0 ? chd->n_columns : chd->n_rows) - 1.0);
}

/* Index of the plane at z (in the header's unit); n_planes: none. */
static uint32_t find_plane(const struct chd *chd, double z)
{
    uint32_t low = 0, high = chd->n_planes - 1;
    while (low < high) {
        uint32_t middle = (low + high) / 2;
        if (chd->planes[middle] < z)
            low = middle + 1;
        else
            high = middle;
    }
    if (low > 0 && z - chd->planes[low - 1] < chd->planes[low] - z)
        low--;
    /* z has four digits and is up to some half widths; a point half way to the next plane belongs to none */
    double off = fabs(chd->planes[low] - z), most = 2e-3 * fmax(fabs(z), chd->half_width);
    for (int next = -1; next <= 1; next += 2)
        if ((next > 0 || low > 0) && (next < 0 || low + 1 < chd->n_planes))
            most = fmin(most, fabs(chd->planes[low + (uint32_t)next] - chd->planes[low]) / 2);
    return off <= most ? low : chd->n_planes;
}

/* Finds the lattice point at these coordinates; false when there is none. */
static bool find_point(const struct chd *chd, const double at[3], size_t *index)
{
    uint32_t ij[2];
    for (int a = 0; a < 2; a++) {
        double along = (at[a] - chd->low[a]) / step_of(chd, a), nearest = round(along);
        if (!(fabs(along - nearest) <= lattice_share && nearest >= 0 &&
              nearest < (a == 0 ? chd->n_columns : chd->n_rows)))
            return false;
        ij[a] = (uint32_t)nearest;
    }
    uint32_t k = find_plane(chd, at[2] * chd->half_width);
    *index = ((size_t)k * chd->n_rows + ij[1]) * chd->n_columns + ij[0];
    return k < chd->n_planes;
}

static bool put_row(struct table *table, const struct sera_row *row, size_t line)
{
    size_t index;
    if (row->n_unprinted + row->n_unread > 0 && table->first_bad_line == 0)
        table->first_bad_line = line;
    table->n_unprinted += row->n_unprinted;
    table->n_unread += row->n_unread;
    if (isnan(row->at[0]) || isnan(row->at[1]) || isnan(row->at[2]))
        return true; /* its position is unknown; the lattice point it belongs to stays empty */
    if (!find_point(table->chd, row->at, &index))
        return error_set(table->err, ERROR_FORMAT,
                         "%s: line %zu: the point (%.4g, %.4g, %.4g) is not one of the header's columns, rows and "
                         "planes",
                         table->name, line, row->at[0], row->at[1], row->at[2]);
    if (table->regions[index] != UINT16_MAX)
        return error_set(table->err, ERROR_FORMAT, "%s: line %zu: the point (%.4g, %.4g, %.4g) is there twice",
                         table->name, line, row->at[0], row->at[1], row->at[2]);
    bool is_nothing = true;
    for (int c = 0; c < CHD_N_COLUMNS; c++)
        is_nothing = is_nothing && !(row->values[c] > 0) && !isnan(row->values[c]);
    table->regions[index] = isnan(row->region) ? UINT16_MAX - 1 : (uint16_t)row->region;
    is_nothing |= table->regions[index] == 0;
    for (int c = 0; c < CHD_N_COLUMNS; c++)
        if (table->values[c])
            table->values[c][index] = is_nothing ? NAN : (float)row->values[c];
    table->n_nothing += is_nothing;
    return true;
}

static bool read_table(struct table *table, const struct bytes *text)
{
    const char *at = (const char *)text->data, *end = at + text->size;
    size_t line = 0, n_rows = 0;
    bool is_fixed = false;
    while (at < end) {
        const char *stop = memchr(at, '\n', (size_t)(end - at));
        size_t n = (size_t)((stop ? stop : end) - at);
        while (n > 0 && (at[n - 1] == '\r' || at[n - 1] == ' '))
            n--;
        line++;
        if (n > 0) {
            struct sera_row row;
            if (n_rows == 0)
                is_fixed = sera_row_is_fixed(at, n, CHD_N_COLUMNS);
            if (!sera_row_parse(at, n, is_fixed, CHD_N_COLUMNS, &row))
                return error_set(table->err, ERROR_FORMAT, "%s: line %zu: %zu characters, expected 13 numbers %s",
                                 table->name, line, n,
                                 is_fixed ? "in columns of 10 characters and one of 4" : "parted by blanks");
            if (++n_rows > table->n_points)
                return error_set(table->err, ERROR_FORMAT,
                                 "%s: line %zu: more points than the %u x %u x %u of the header", table->name, line,
                                 table->chd->n_columns, table->chd->n_rows, table->chd->n_planes);
            if (!put_row(table, &row, line))
                return false;
        }
        at += (size_t)((stop ? stop + 1 : end) - at);
    }
    if (n_rows < table->n_points)
        return error_set(table->err, ERROR_FORMAT, "%s: %zu points, but the header says %u x %u x %u = %zu",
                         table->name, n_rows, table->chd->n_columns, table->chd->n_rows, table->chd->n_planes,
                         table->n_points);
    for (size_t i = 0; i < table->n_points; i++)
        for (int c = 0; c < CHD_N_COLUMNS && table->regions[i] == UINT16_MAX; c++)
            if (table->values[c])
                table->values[c][i] = NAN;
    return true;
}

/* ---- meaning of the columns ------------------------------------------------------------------------------------- */

static int column_of(const struct chd *chd, enum dose_quantity quantity)
{
    for (int c = 0; c < CHD_N_COLUMNS; c++)
        if (chd->has_column[c] && chd->quantities[c] == quantity)
            return c;
    return -1;
}

/* True if boron divided by the thermal fluence is in each region what 1 ppm gives, so boron is physical. */
static bool boron_is_physical(const struct table *table, double factor, const char *name, struct report *report)
{
    int boron = column_of(table->chd, DOSE_BORON), thermal = column_of(table->chd, DOSE_THERMAL_FLUENCE);
    double reference = thermal >= 0 ? table->chd->reference[thermal] : 0, lowest = INFINITY, highest = 0;
    struct sums {
        double boron, thermal;
        size_t n;
    } *sums = mem_new(N_REGIONS * sizeof *sums);
    for (size_t i = 0; thermal >= 0 && reference > 0 && i < table->n_points; i++) {
        double b = (double)table->values[boron][i], t = (double)table->values[thermal][i];
        if (table->regions[i] >= N_REGIONS || !(t > 0.1 * reference && t < 3 * reference) || isnan(b))
            continue;
        struct sums *sum = &sums[table->regions[i]];
        sum->boron += b * factor;
        sum->thermal += t * (table->chd->weight[thermal] > 0 ? 1 / table->chd->weight[thermal] : 1);
        sum->n++;
    }
    for (int r = 0; r < N_REGIONS; r++)
        if (sums[r].n >= ENOUGH_POINTS) {
            lowest = fmin(lowest, sums[r].boron / sums[r].thermal);
            highest = fmax(highest, sums[r].boron / sums[r].thermal);
        }
    free(sums);
    double low = boron_per_thermal_cgy_cm2 * (1 - boron_share), high = boron_per_thermal_cgy_cm2 * (1 + boron_share);
    bool is_physical = lowest >= low && highest <= high && highest > 0;
    if (is_physical)
        report_add(
            report, REPORT_NOTE, "dose.boron-ratio", name,
            "Boron is %.3g to %.3g cGy cm2 per ppm and thermal fluence in every region, as 1 ppm makes it: tissue holds as much boron "
            "as blood in this file, and it was taken as boron per ppm.",
            lowest, highest);
    else
        report_add(
            report, REPORT_WARNING, "dose.boron-ratio", name,
            "Boron holds each tissue's ratio to blood, which the file does not store; it is kept as blood boron, per ppm in blood, and "
            "not mixed with boron per ppm.");
    return is_physical;
}

static bool has_other_weights(const struct chd *chd)
{
    bool is_other = false;
    for (int c = 0; c < CHD_N_COLUMNS; c++)
        is_other |=
            chd->has_column[c] && !dose_quantity_is_fluence(chd->quantities[c]) && fabs(chd->weight[c] - 1) > 1e-6;
    return is_other;
}

/* Finds the quantity of a column and the factor that its values are multiplied with; false: it cannot be used. */
static bool resolve(const struct table *table, int column, const char *name, enum dose_quantity *quantity,
                    double *factor, struct report *report)
{
    const struct chd *chd = table->chd;
    double weight = chd->weight[column], ppm = chd->concentration[column];
    *quantity = chd->quantities[column];
    *factor = 1;
    if (*quantity == DOSE_TOTAL) {
        int boron = column_of(chd, DOSE_BORON);
        bool is_weighted = has_other_weights(chd);
        *quantity = is_weighted ? DOSE_WEIGHTED_TOTAL : DOSE_TOTAL;
        char ppm_text[40] = "an unknown amount";
        if (boron < 0 || chd->has_concentration[boron])
            snprintf(ppm_text, sizeof ppm_text, "%g ppm", boron >= 0 ? chd->concentration[boron] : 0);
        report_add(
            report, is_weighted ? REPORT_WARNING : REPORT_NOTE, "dose.total-boron", name,
            "The total is %s, with %s of boron in blood times each tissue's ratio in it; neither can be taken out.",
            is_weighted ? "weighted" : "physical", ppm_text);
        return true;
    }
    double divisor = *quantity == DOSE_BORON ? weight * ppm : weight;
    if (!(divisor > 1e-12 && divisor <= 1e12)) {
        report_add(
            report, REPORT_WARNING, "dose.weight-zero", name,
            "The weight of %s (with its ppm) is %g in this file, so that nothing is left of it; it was left out.",
            dose_quantity_word(*quantity), divisor);
        return false;
    }
    *factor = 1 / divisor;
    if (*quantity == DOSE_BORON && !boron_is_physical(table, *factor, name, report))
        *quantity = DOSE_BLOOD_BORON;
    return true;
}

/* ---- planes ----------------------------------------------------------------------------------------------------- */

/* The evenly spaced planes of the grid among the planes of the file. */
struct spacing {
    double first, step; /* in the header's unit */
    uint32_t n;
    bool is_resampled;
};

static bool find_spacing(const struct chd *chd, const char *name, struct spacing *spacing, struct report *report,
                         struct error *err)
{
    uint32_t n = chd->n_planes;
    const double *z = chd->planes;
    *spacing = (struct spacing){ .first = z[0], .step = step_of(chd, 0) * chd->half_width, .n = n };
    if (n == 1) {
        report_add(report, REPORT_NOTE, "geometry.assumed", name,
                   "There is one plane; it was made as thick as its columns are apart.");
        return true;
    }
    double worst = 0, smallest = INFINITY, largest = 0;
    spacing->step = (z[n - 1] - z[0]) / (n - 1.0);
    for (uint32_t i = 1; i < n; i++) {
        worst = fmax(worst, fabs(z[i] - (z[0] + spacing->step * i)));
        smallest = fmin(smallest, z[i] - z[i - 1]);
        largest = fmax(largest, z[i] - z[i - 1]);
    }
    if (worst <= uneven_share * spacing->step)
        return true;
    double n_even = floor((z[n - 1] - z[0]) / smallest + 1e-6) + 1;
    if (n_even > MOST_PLANES || n_even * chd->n_columns * chd->n_rows > CHD_MAX_POINTS)
        return error_set(err, ERROR_UNSUPPORTED,
                         "%s: the planes lie between %g and %g apart: an even grid would need %.0f planes of %u x %u",
                         name, smallest, largest, n_even, chd->n_columns, chd->n_rows);
    *spacing = (struct spacing){ z[0], (z[n - 1] - z[0]) / (n_even - 1), (uint32_t)n_even, true };
    report_add(
        report, REPORT_WARNING, "dose.planes-uneven", name,
        "The %u planes lie between %.4g and %.4g mm apart; they were resampled to %u planes every %.4g mm, linearly in between.",
        n, smallest * chd->mm, largest * chd->mm, spacing->n, spacing->step * chd->mm);
    return true;
}

/* Finds the planes of the file below and above the grid's plane k, and its share t of the way between them. */
static void place(const struct chd *chd, const struct spacing *spacing, uint32_t k, uint32_t *below, uint32_t *above,
                  double *t)
{
    double z = spacing->first + spacing->step * k;
    uint32_t i = 0;
    *below = *above = k;
    *t = 0;
    if (!spacing->is_resampled)
        return;
    while (i + 2 < chd->n_planes && chd->planes[i + 1] <= z)
        i++;
    *below = i;
    *above = i + 1;
    *t = fmin(fmax((z - chd->planes[i]) / (chd->planes[i + 1] - chd->planes[i]), 0), 1);
    if (*t < 1e-9)
        *above = *below;
    if (*t > 1 - 1e-9)
        *below = *above;
}

static void copy_planes(const struct chd *chd, const struct spacing *spacing, const float *in, double factor,
                        float *out)
{
    size_t n = (size_t)chd->n_columns * chd->n_rows;
    for (uint32_t k = 0; k < spacing->n; k++) {
        uint32_t below, above;
        double t;
        place(chd, spacing, k, &below, &above, &t);
        for (size_t i = 0; i < n; i++) {
            double low = (double)in[below * n + i], high = (double)in[above * n + i];
            double value = (below == above ? low : low + t * (high - low)) * factor;
            out[k * n + i] = fabs(value) <= 1e30 ? (float)value : NAN;
        }
    }
}

/* Makes the grid of a lattice whose index 0 lies at (first_x, first_y), in fractions of the half width; rows run toward
 * anterior or posterior. */
static bool make_grid(const struct chd *chd, const struct spacing *spacing, const uint32_t size[2],
                      const double first[2], const double step[2], const char *name, struct grid *grid,
                      struct error *err)
{
    const double mm = chd->mm, f = chd->half_width * mm;
    const uint32_t sizes[3] = { size[0], size[1], spacing->n };
    const struct affine map = { { sera_lps_from_rpi(step[0] * f, 0, 0), sera_lps_from_rpi(0, step[1] * f, 0),
                                  sera_lps_from_rpi(0, 0, spacing->step * mm) },
                                sera_lps_from_rpi(first[0] * f, first[1] * f, spacing->first * mm) };
    if (grid_init(grid, sizes, &map, err))
        return true;
    error_prefix(err, "%s", name);
    return false;
}

/* ---- images of regions ------------------------------------------------------------------------------------------ */

/* Images are square and cover the whole field, row 0 anterior; a byte is the region's number times 255 / number of
 * regions. Finds their side. */
static bool mask_side(const struct chd *chd, size_t n_bytes, uint32_t *side)
{
    size_t n = n_bytes / chd->n_planes;
    *side = (uint32_t)(sqrt((double)n) + 0.5);
    return n_bytes % chd->n_planes == 0 && *side >= 16 && *side <= CHD_MASK_MAX_SIDE && (size_t)*side * *side == n;
}

/* Fraction of the points whose image shows another region than the table gives. */
static double mask_disagreement(const struct table *table, const uint8_t *pixels, uint32_t side)
{
    const struct chd *chd = table->chd;
    size_t n = 0, n_other = 0;
    unsigned most = 1;
    for (size_t i = 0; i < table->n_points; i++)
        if (table->regions[i] < UINT16_MAX - 1 && table->regions[i] > most)
            most = table->regions[i];
    unsigned scale = most < 255 ? 255 / most : 1;
    for (size_t i = 0; i < table->n_points; i++) {
        size_t column = i % chd->n_columns, row = i / chd->n_columns % chd->n_rows,
               plane = i / chd->n_columns / chd->n_rows;
        double x = chd->low[0] + step_of(chd, 0) * (double)column, y = chd->low[1] + step_of(chd, 1) * (double)row;
        double u = (x + 1) / 2 * side, v = (1 - y) / 2 * side;
        if (table->regions[i] >= UINT16_MAX - 1 || !(u >= 1 && u < side - 1 && v >= 1 && v < side - 1))
            continue;
        n++;
        n_other += pixels[(plane * side + (size_t)v) * side + (size_t)u] != (uint8_t)(table->regions[i] * scale);
    }
    return n > 0 ? (double)n_other / (double)n : 0;
}

static bool read_mask(const struct table *table, const struct chd_files *files, const struct spacing *spacing,
                      struct volume **mask, struct report *report, struct error *err)
{
    const struct chd *chd = table->chd;
    uint32_t side;
    *mask = NULL;
    if (!files->mask.data)
        return true;
    if (!mask_side(chd, files->mask.size, &side)) {
        report_add(
            report, REPORT_WARNING, "dose.mask-unread", files->mask_name,
            "%zu bytes are not %u square pictures, one a plane; where the dose is valid was taken from its points alone.",
            files->mask.size, chd->n_planes);
        return true;
    }
    double share = mask_disagreement(table, files->mask.data, side);
    if (share > 0.25) {
        report_add(report, REPORT_WARNING, "dose.mask-unread", files->mask_name,
                   "The pictures show other regions than the table at %.0f %% of its points; they were not used.",
                   share * 100);
        return true;
    }
    if (!memchr(files->mask.data, 0, files->mask.size))
        return true; /* valid everywhere */
    struct grid grid;
    if (!make_grid(chd, spacing, (uint32_t[]){ side, side }, (double[]){ -1 + 1.0 / side, 1 - 1.0 / side },
                   (double[]){ 2.0 / side, -2.0 / side }, files->mask_name, &grid, err))
        return false;
    *mask = volume_create(&grid, VOXEL_U8, err);
    if (!*mask)
        return false;
    size_t n = (size_t)side * side;
    uint8_t *out = (*mask)->voxels;
    for (uint32_t k = 0; k < spacing->n; k++) {
        uint32_t below, above;
        double t;
        place(chd, spacing, k, &below, &above, &t);
        const uint8_t *in = files->mask.data + (t < 0.5 ? below : above) * n;
        for (size_t i = 0; i < n; i++)
            out[k * n + i] = in[i] != 0;
    }
    volume_measure(*mask);
    return true;
}

/* ---- the whole file --------------------------------------------------------------------------------------------- */

static bool add_columns(const struct table *table, const struct chd_files *files, const struct spacing *spacing,
                        struct sera_doses *doses, struct report *report, struct error *err)
{
    const struct chd *chd = table->chd;
    const double first[2] = { chd->low[0], chd->low[1] }, step[2] = { step_of(chd, 0), step_of(chd, 1) };
    struct grid grid;
    size_t n_references = 0, n_kept = 0;
    if (!make_grid(chd, spacing, (uint32_t[]){ chd->n_columns, chd->n_rows }, first, step, files->name, &grid, err))
        return false;
    for (int c = 0; c < CHD_N_COLUMNS; c++) {
        enum dose_quantity quantity;
        double factor;
        if (!chd->has_column[c] || !resolve(table, c, files->name, &quantity, &factor, report))
            continue;
        bool is_per_ppm = quantity == DOSE_BORON || quantity == DOSE_BLOOD_BORON;
        float *values = sera_doses_add(doses, quantity, is_per_ppm, &grid, err);
        if (!values)
            return false;
        copy_planes(chd, spacing, table->values[c], factor, values);
        struct dose_component *added = &doses->components[doses->n_components - 1];
        volume_measure(added->values);
        int boron = column_of(chd, DOSE_BORON);
        if ((quantity == DOSE_TOTAL || quantity == DOSE_WEIGHTED_TOTAL) && boron >= 0 &&
            chd->has_concentration[boron]) {
            added->has_boron_ppm = true;
            added->boron_ppm = chd->concentration[boron];
        }
        doses->reference[quantity] = chd->reference[c] > 0 ? chd->reference[c] * factor : 0;
        n_references += chd->reference[c] > 0;
        n_kept++;
    }
    if (n_references < n_kept)
        report_add(report, REPORT_NOTE, "dose.no-reference", files->name,
                   "%zu of %zu quantities have a reference of 0 or none.", n_kept - n_references, n_kept);
    return n_kept > 0 || error_set(err, ERROR_FORMAT, "%s: no column holds anything that can be shown", files->name);
}

static void note_table(const struct table *table, struct report *report)
{
    if (table->n_unprinted + table->n_unread > 0)
        report_add(
            report, REPORT_WARNING, "dose.bad-values", table->name,
            "%zu values too large or small for their columns (***) and %zu that are no numbers, first in line %zu; they are shown "
            "as nothing.",
            table->n_unprinted, table->n_unread, table->first_bad_line);
    if (table->n_nothing > 0)
        report_add(
            report, REPORT_NOTE, "dose.outside-mesh", table->name,
            "%zu of %zu points lie in no region or hold zeros alone; they are not valid and nothing is blended with them.",
            table->n_nothing, table->n_points);
}

bool chd_read(const struct chd *chd, const struct chd_files *files, struct sera_doses *doses, struct report *report,
              struct error *err)
{
    struct spacing spacing;
    struct table table = { .chd = chd, .name = files->table_name, .err = err };
    table.n_points = (size_t)chd->n_columns * chd->n_rows * chd->n_planes;
    *doses = (struct sera_doses){ 0 };
    bool is_read = find_spacing(chd, files->name, &spacing, report, err) && table_create(&table) &&
                   read_table(&table, &files->table) && add_columns(&table, files, &spacing, doses, report, err) &&
                   read_mask(&table, files, &spacing, &doses->mask, report, err);
    if (is_read)
        note_table(&table, report);
    else
        sera_doses_finish(doses);
    table_finish(&table);
    return is_read;
}

/* Writes small sets of SERA's dose contours (.chd, .cdf, .cmf) for tests. */
#include "tests/unit/made_chd.h"

const char *const chd_sera_mc[9] = {
    "total", "boron", "gamma", "nitrogen", "fast", "fast fluence", "epithermal fluence", "thermal fluence", "other"
};
const char *const chd_sera_plan[9] = { "total",          "boron", "gamma",        "nitrogen",
                                       "fast",           "other", "fast fluence", "epithermal fluence",
                                       "thermal fluence" };

const struct made_chd chd_plain = { .version = "seraMC_1C0",
                                    .names = chd_sera_mc,
                                    .fov = 10,
                                    .n_planes = 2,
                                    .z = { -5, -4 },
                                    .order = { 0, 1 },
                                    .ppm = 1,
                                    .weight = 1,
                                    .other_weight = 1,
                                    .ratio = 1,
                                    .more = "" };

void chd_put(struct chd_text *text, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    text->n += (size_t)vsnprintf(text->at + text->n, CHD_TEXT_SIZE - text->n, format, arguments);
    va_end(arguments);
    assert_true(text->n < CHD_TEXT_SIZE);
}

/* A number in ten characters as Fortran writes 1PE10.3: "-1.000E+00" leaves no blank. */
static void word10(char out[16], double value)
{
    snprintf(out, 16, "%10.3E", value);
}

/* Physical values at a point: each quantity its own, growing with the point's number. */
double chd_physical(enum dose_quantity quantity, size_t point)
{
    double x = 1 + 0.01 * (double)point;
    switch (quantity) {
    case DOSE_BLOOD_BORON:
    case DOSE_BORON: return 7.3e-12 * 1e11 * x;
    case DOSE_GAMMA: return 20 * x;
    case DOSE_NITROGEN: return 5 * x;
    case DOSE_FAST: return 2 * x;
    case DOSE_OTHER: return 0.1 * x;
    case DOSE_FAST_FLUENCE: return 2e9 * x;
    case DOSE_EPITHERMAL_FLUENCE: return 3e10 * x;
    case DOSE_THERMAL_FLUENCE: return 1e11 * x;
    default: return 0;
    }
}

double chd_printed(const struct made_chd *made, const char *name, size_t point, int region)
{
    double boron = chd_physical(DOSE_BORON, point) * made->ppm * made->weight * (region == 7 ? made->ratio : 1);
    double others = (chd_physical(DOSE_GAMMA, point) + chd_physical(DOSE_NITROGEN, point) +
                     chd_physical(DOSE_FAST, point) + chd_physical(DOSE_OTHER, point)) *
                    made->other_weight;
    if (strcmp(name, "total") == 0)
        return boron + others;
    if (strcmp(name, "boron") == 0)
        return boron;
    const struct {
        const char *name;
        enum dose_quantity quantity;
    } rest[] = {
        { "gamma", DOSE_GAMMA }, { "nitrogen", DOSE_NITROGEN }, { "fast", DOSE_FAST }, { "other", DOSE_OTHER }
    };
    for (size_t i = 0; i < 4; i++)
        if (strcmp(name, rest[i].name) == 0)
            return chd_physical(rest[i].quantity, point) * made->other_weight;
    return chd_physical(name[0] == 'f'   ? DOSE_FAST_FLUENCE
                        : name[0] == 'e' ? DOSE_EPITHERMAL_FLUENCE
                                         : DOSE_THERMAL_FLUENCE,
                        point);
}

struct chd_text chd_make_header(const struct made_chd *made)
{
    struct chd_text text = { malloc(CHD_TEXT_SIZE), 0 };
    chd_put(
        &text,
        "Version_stamp:  %s\nFOV:              %.5E\nxmin:            -1.00000E+00\nxmax:             1.00000E+00\n",
        made->version, made->fov);
    chd_put(
        &text,
        "ymin:            -1.00000E+00\nymax:             1.00000E+00\nx_in_field:              1\ny_in_field:              2\n"
        "z_in_field:              3\nnum_cols:               %d\nnum_rows:               %d\nrun_title:      head: one field\n"
        "num_planes:             %zu\n",
        CHD_COLS, CHD_ROWS, made->n_planes);
    for (int i = 0; i < 9; i++) {
        const char *name = made->names[i];
        bool is_boron = strcmp(name, "boron") == 0, is_other = strstr("gamma nitrogen fast other", name) != NULL;
        chd_put(&text,
                "dose_comp_%d:    %-40s\nconc_%d:           %.5E\nrbe_val_%d:        %.5E\nref_dose_%d:       %.5E\n",
                i, name, i, is_boron ? made->ppm : 1.0, i,
                is_boron   ? made->weight
                : is_other ? made->other_weight
                           : 1.0,
                i, chd_printed(made, name, 0, 6) * 1.25);
    }
    chd_put(&text, "number_beams:            1\nphi_val_00:       5.50000E+01\ntheta_val_00:    -1.40000E+02\n%s",
            made->more);
    for (size_t p = 0; p < made->n_planes; p++)
        chd_put(&text, "z_value_%02zu:      %.5E\n", p, made->z[p]);
    return text;
}

/* The number of a point: x fastest, then y from the posterior up, then planes as the header counts them. */
struct chd_text chd_make_table(const struct made_chd *made)
{
    struct chd_text text = { malloc(CHD_TEXT_SIZE), 0 };
    for (size_t p = 0; p < made->n_planes; p++)
        for (size_t r = 0; r < CHD_ROWS; r++)
            for (size_t c = 0; c < CHD_COLS; c++) {
                size_t plane = made->order[p], point = (plane * CHD_ROWS + r) * CHD_COLS + c;
                int region = c == 0 ? 6 : 7;
                double at[3] = { -1 + (double)c, -1 + 2 * (double)r, made->z[plane] / made->fov };
                for (int i = 0; i < 3; i++) {
                    char word[16];
                    word10(word, at[i]);
                    chd_put(&text, made->is_plan ? "%s " : "%s", word);
                }
                chd_put(&text, "%4d", region);
                for (int i = 0; i < 9; i++) {
                    char word[16];
                    word10(word, chd_printed(made, made->names[i], point, region));
                    if (made->special && i == 2 && point == 0)
                        snprintf(word, sizeof word, "%10s", made->special);
                    chd_put(&text, made->is_plan ? " %s" : "%s", word);
                }
                chd_put(&text, "\n");
            }
    return text;
}

bool chd_read_both(const struct chd_text *header, const struct chd_text *table, const struct bytes *mask,
                   struct chd_result *result)
{
    *result = (struct chd_result){ 0 };
    if (!chd_parse((const uint8_t *)header->at, header->n, "a.chd", &result->chd, &result->report, &result->err))
        return false;
    struct chd_files files = {
        .table = { (uint8_t *)table->at, table->n }, .name = "a.chd", .table_name = "a.cdf.sz", .mask_name = "a.cmf.sz"
    };
    if (mask)
        files.mask = *mask;
    return chd_read(&result->chd, &files, &result->doses, &result->report, &result->err);
}

void chd_result_finish(struct chd_result *result)
{
    chd_finish(&result->chd);
    sera_doses_finish(&result->doses);
    report_finish(&result->report);
}

struct chd_result chd_read_made(const struct made_chd *made)
{
    struct chd_text header = chd_make_header(made), table = chd_make_table(made);
    struct chd_result result;
    if (!chd_read_both(&header, &table, NULL, &result))
        fail_msg("%s", result.err.text);
    free(header.at);
    free(table.at);
    return result;
}

const struct volume *chd_volume_of(const struct sera_doses *doses, enum dose_quantity quantity)
{
    for (size_t i = 0; i < doses->n_components; i++)
        if (doses->components[i].quantity == quantity)
            return doses->components[i].values;
    return NULL;
}

/* Four digits are printed. */
void chd_check_quantity(const struct sera_doses *doses, enum dose_quantity quantity)
{
    const struct volume *values = chd_volume_of(doses, quantity);
    assert_non_null(values);
    for (uint32_t point = 0; point < values->grid.size[2] * CHD_ROWS * CHD_COLS; point++)
        assert_near(volume_value(values, point % CHD_COLS, point / CHD_COLS % CHD_ROWS, point / CHD_COLS / CHD_ROWS),
                    chd_physical(quantity, point), 6e-4);
}

/* Damaged numbers: every character of the numbers in a made-up plan, structure set, dose and CT is changed, one at a
 * time; wherever the result changes, the report must say so. */
#include <ctype.h>

#include "core/formats/dicom/dicom_rtdose.h"
#include "core/formats/dicom/dicom_rtplan.h"
#include "core/formats/dicom/dicom_rtstruct.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/made_contours.h"
#include "tests/unit/made_rtplan.h"
#include "tests/unit/made_series.h"
#include "tests/unit/plan_help.h"

#define TAG DICOM_TAG

/* ---- where the numbers stand ------------------------------------------------------------------------------------ */

struct number {
    uint32_t tag;
    size_t at, size; /* of the value */
};

/* Finds the DS and IS values of a file in explicit encoding: a tag, the two letters, a length. */
static size_t find_numbers(const struct made_dicom *made, struct number *numbers, size_t most)
{
    size_t n = 0;
    for (size_t at = 132; at + 8 < made->size; at++) {
        const uint8_t *p = made->data + at;
        uint32_t group = (uint32_t)(p[0] | p[1] << 8), element = (uint32_t)(p[2] | p[3] << 8);
        bool is_number = (p[4] == 'D' || p[4] == 'I') && p[5] == 'S';
        if (!is_number || (group != 0x18 && group != 0x20 && group != 0x28 && group != 0x3004 && group != 0x3006 &&
                           group != 0x300a && group != 0x300c))
            continue;
        assert_true(n < most);
        numbers[n++] = (struct number){ TAG(group, element), at + 8, (size_t)(p[6] | p[7] << 8) };
    }
    return n;
}

static void begin(struct made_dicom *made, const char *sop_class, const char *modality)
{
    made_begin(made, MADE_EXPLICIT);
    made_text(made, TAG(0x0008, 0x0016), "UI", sop_class);
    made_text(made, TAG(0x0008, 0x0018), "UI", "1.2.3.4");
    made_text(made, TAG(0x0008, 0x0060), "CS", modality);
}

/* ---- a plan ----------------------------------------------------------------------------------------------------- */

static void make_plan(struct made_dicom *made)
{
    begin(made, "1.2.840.10008.5.1.4.1.1.481.5", "RTPLAN");
    made_sequence(made, TAG(0x300a, 0x0010));
    made_item(made);
    made_text(made, TAG(0x300a, 0x0020), "CS", "TARGET");
    made_text(made, TAG(0x300a, 0x0026), "DS", "60.5");
    made_item_end(made);
    made_sequence_end(made);
    made_sequence(made, TAG(0x300a, 0x0070));
    made_item(made);
    made_text(made, TAG(0x300a, 0x0078), "IS", "30");
    made_sequence(made, TAG(0x300c, 0x0004));
    made_item(made);
    made_text(made, TAG(0x300a, 0x0084), "DS", "2.05");
    made_text(made, TAG(0x300a, 0x0086), "DS", "234.5");
    made_text(made, TAG(0x300c, 0x0006), "IS", "1");
    made_item_end(made);
    made_sequence_end(made);
    made_item_end(made);
    made_sequence_end(made);
    made_sequence(made, TAG(0x300a, 0x00b0));
    made_item(made);
    made_text(made, TAG(0x300a, 0x00b4), "DS", "1000");
    made_sequence(made, TAG(0x300a, 0x00b6));
    made_rt_device(made, "ASYMX", "1", NULL);
    made_rt_device(made, "ASYMY", "1", NULL);
    made_rt_device(made, "MLCX", "4", "-40\\-20\\0\\20\\40");
    made_sequence_end(made);
    made_text(made, TAG(0x300a, 0x00c0), "IS", "1");
    made_text(made, TAG(0x300a, 0x00c2), "LO", "Front");
    made_text(made, TAG(0x300a, 0x0110), "IS", "2");
    made_sequence(made, TAG(0x300a, 0x0111));
    for (int i = 0; i < 2; i++) {
        made_item(made);
        if (i == 0)
            made_text(made, TAG(0x300a, 0x0114), "DS", "6");
        made_sequence(made, TAG(0x300a, 0x011a));
        if (i == 0) {
            made_rt_position(made, "ASYMX", "-50\\50");
            made_rt_position(made, "ASYMY", "-45\\45.5");
        }
        made_rt_position(made, "MLCX",
                         i ? "-40\\-30\\-30\\-40\\20\\30\\30\\20" : "-30\\-20.5\\-20\\-30\\30\\20\\20\\30");
        made_sequence_end(made);
        made_text(made, TAG(0x300a, 0x011e), "DS", i ? "20.5" : "10");
        if (i == 0) {
            made_text(made, TAG(0x300a, 0x011f), "CS", "CW");
            made_text(made, TAG(0x300a, 0x0120), "DS", "15");
            made_text(made, TAG(0x300a, 0x0122), "DS", "5");
            made_text(made, TAG(0x300a, 0x0125), "DS", "0");
            made_text(made, TAG(0x300a, 0x012c), "DS", "10.5\\-20\\30");
            made_text(made, TAG(0x300a, 0x0130), "DS", "930.2");
            made_text(made, TAG(0x300a, 0x0140), "DS", "0");
            made_text(made, TAG(0x300a, 0x0144), "DS", "0");
        }
        made_item_end(made);
    }
    made_sequence_end(made);
    made_text(made, TAG(0x300c, 0x006a), "IS", "1");
    made_item_end(made);
    made_sequence_end(made);
    made_sequence(made, TAG(0x300a, 0x0180));
    made_item(made);
    made_text(made, TAG(0x0018, 0x5100), "CS", "HFS");
    made_text(made, TAG(0x300a, 0x0182), "IS", "1");
    made_item_end(made);
    made_sequence_end(made);
}

/* ---- what is read, as bytes to compare -------------------------------------------------------------------------- */

struct outcome {
    struct report report;
    bool is_refused;
    uint64_t hash; /* of everything that was read */
};

static void add(struct outcome *outcome, const void *data, size_t n)
{
    for (size_t i = 0; i < n; i++)
        outcome->hash = (outcome->hash ^ ((const uint8_t *)data)[i]) * 0x100000001b3u;
}

static struct outcome read_plan(const struct made_dicom *made)
{
    struct outcome outcome = { .hash = 0xcbf29ce484222325u };
    struct error err = { 0 };
    struct rt_file file = rt_file_of(made);
    struct rtplan *plan = rtplan_read(file.file, "plan.dcm", &outcome.report, &err);
    outcome.is_refused = !plan;
    if (plan) {
        add(&outcome, plan->beams, plan->n_beams * sizeof *plan->beams);
        add(&outcome, &plan->n_fractions, sizeof plan->n_fractions);
        add(&outcome, &plan->target_dose_gy, sizeof plan->target_dose_gy);
    }
    rtplan_destroy(plan);
    rt_file_close(&file);
    return outcome;
}

static void make_structs(struct made_dicom *made)
{
    begin(made, "1.2.840.10008.5.1.4.1.1.481.3", "RTSTRUCT");
    made_sequence(made, TAG(0x3006, 0x0020));
    made_item(made);
    made_text(made, TAG(0x3006, 0x0022), "IS", "3");
    made_text(made, TAG(0x3006, 0x0026), "LO", "Brain");
    made_item_end(made);
    made_sequence_end(made);
    made_sequence(made, TAG(0x3006, 0x0039));
    made_item(made);
    made_text(made, TAG(0x3006, 0x002a), "IS", "10\\200\\30");
    made_sequence(made, TAG(0x3006, 0x0040));
    made_item(made);
    made_text(made, TAG(0x3006, 0x0042), "CS", "CLOSED_PLANAR");
    made_text(made, TAG(0x3006, 0x0046), "IS", "4");
    made_text(made, TAG(0x3006, 0x0050), "DS", "0\\0\\5\\10.5\\0\\5\\10.5\\10\\5\\0\\10\\5");
    made_item_end(made);
    made_sequence_end(made);
    made_text(made, TAG(0x3006, 0x0084), "IS", "3");
    made_item_end(made);
    made_sequence_end(made);
}

static struct outcome read_structs(const struct made_dicom *made)
{
    struct outcome outcome = { .hash = 0xcbf29ce484222325u };
    struct error err = { 0 };
    struct rt_file file = rt_file_of(made);
    struct rtstruct *set = rtstruct_read(file.file, "set.dcm", &outcome.report, &err);
    outcome.is_refused = !set;
    for (size_t i = 0; set && i < set->n_rois; i++) {
        const struct rtstruct_roi *roi = &set->rois[i];
        struct grid grid = grid_make(32, 32, 8, 1, 1, 1, vec3(0, 0, 0));
        struct contour_choice choice = { .grid = grid, .subdivision = { 1, 1, 1 } };
        struct contour_facts facts;
        struct mask *mask = contour_fill(&roi->contours, &grid, &contour_defaults, &facts, &err);
        assert_non_null(mask);
        rtstruct_report_fill(roi, &choice, &facts, "set.dcm", &outcome.report);
        mask_destroy(mask);
        add(&outcome, &roi->number, sizeof roi->number);
        add(&outcome, roi->rgb, 3);
        for (size_t c = 0; c < roi->contours.n_contours; c++)
            add(&outcome, roi->contours.contours[c].points_lps_mm, 24 * roi->contours.contours[c].n_points);
    }
    rtstruct_destroy(set);
    rt_file_close(&file);
    return outcome;
}

static void make_dose(struct made_dicom *made)
{
    begin(made, "1.2.840.10008.5.1.4.1.1.481.2", "RTDOSE");
    made_text(made, TAG(0x0020, 0x0032), "DS", "-10\\20.5\\30");
    made_text(made, TAG(0x0020, 0x0037), "DS", "1\\0\\0\\0\\1\\0");
    made_u16(made, TAG(0x0028, 0x0002), 1);
    made_text(made, TAG(0x0028, 0x0004), "CS", "MONOCHROME2");
    made_text(made, TAG(0x0028, 0x0008), "IS", "3");
    made_u16(made, TAG(0x0028, 0x0010), 2);
    made_u16(made, TAG(0x0028, 0x0011), 2);
    made_text(made, TAG(0x0028, 0x0030), "DS", "2\\2.5");
    made_u16(made, TAG(0x0028, 0x0100), 16);
    made_u16(made, TAG(0x0028, 0x0101), 16);
    made_u16(made, TAG(0x0028, 0x0102), 15);
    made_u16(made, TAG(0x0028, 0x0103), 0);
    made_text(made, TAG(0x3004, 0x0002), "CS", "GY");
    made_text(made, TAG(0x3004, 0x000c), "DS", "0\\3\\6");
    made_text(made, TAG(0x3004, 0x000e), "DS", "0.001");
    made_head(made, TAG(0x7FE0, 0x0010), "OW", 24);
    made_words(made, (uint16_t[12]){ 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12000 }, 12);
}

static struct outcome read_dose(const struct made_dicom *made)
{
    struct outcome outcome = { .hash = 0xcbf29ce484222325u };
    struct error err = { 0 };
    struct rt_file file = rt_file_of(made);
    struct rtdose dose = { 0 };
    outcome.is_refused = !rtdose_read(file.file, "dose.dcm", &dose, &outcome.report, &err);
    if (!outcome.is_refused) {
        add(&outcome, &dose.values->grid, sizeof dose.values->grid);
        add(&outcome, &dose.values->low, sizeof(double));
        add(&outcome, &dose.values->high, sizeof(double));
        rtdose_finish(&dose);
    }
    rt_file_close(&file);
    return outcome;
}

/* ---- a CT of five slices, of which the third is damaged --------------------------------------------------------- */

static struct made_slice ct_slice(int k)
{
    struct made_slice slice = made_slice_defaults;
    slice.number = k + 1;
    slice.position[0] = -12.5;
    slice.position[1] = 20;
    slice.position[2] = 3 * k;
    slice.spacing[0] = slice.spacing[1] = 0.75;
    slice.thickness = 3;
    slice.base = 10 * k;
    slice.has_rescale = true;
    slice.slope = 1;
    slice.offset = -1024;
    return slice;
}

static void make_ct(struct made_dicom *made)
{
    struct made_slice slice = ct_slice(2);
    made_slice_bytes(made, &slice);
}

static struct outcome read_ct(const struct made_dicom *made)
{
    struct outcome outcome = { .hash = 0xcbf29ce484222325u };
    struct scanned s;
    struct error err = { 0 };
    folder_make(s.path);
    s.is_kept = false;
    for (int k = 0; k < 5; k++) {
        struct made_slice slice = ct_slice(k);
        char name[16];
        snprintf(name, sizeof name, "%d.dcm", k);
        if (k == 2)
            folder_put(s.path, name, made->data, made->size);
        else
            made_slice_put(s.path, name, &slice);
    }
    scanned_open(&s);
    add(&outcome, &s.index->n_stacks, sizeof s.index->n_stacks);
    for (size_t i = 0; i < s.index->n_stacks; i++) {
        struct volume *volume = dicom_series_read(&s.folder, s.index, i, NULL, NULL, &s.report, &err);
        outcome.is_refused |= !volume;
        if (!volume)
            continue;
        add(&outcome, &volume->grid, sizeof volume->grid);
        for (uint32_t k = 0; k < volume->grid.size[2]; k++) {
            double value = volume_value(volume, 1, 1, k);
            add(&outcome, &value, sizeof value);
        }
        volume_unref(volume);
    }
    report_move(&outcome.report, &s.report);
    scanned_finish(&s);
    return outcome;
}

/* ---- changes ---------------------------------------------------------------------------------------------------- */

struct kind {
    const char *name;
    void (*make)(struct made_dicom *made);
    struct outcome (*read)(const struct made_dicom *made);
    uint32_t undecidable[24]; /* elements where another number of the same length is just as plausible: nothing can
                                 detect the change */
};

static const struct kind kinds[] = {
    { "plan",
      make_plan,
      read_plan,
      { TAG(0x300a, 0x0026), TAG(0x300a, 0x0078), TAG(0x300a, 0x0084), TAG(0x300a, 0x0086), TAG(0x300a, 0x00b4),
        TAG(0x300a, 0x00be), TAG(0x300a, 0x0114), TAG(0x300a, 0x011c), TAG(0x300a, 0x011e), TAG(0x300a, 0x0120),
        TAG(0x300a, 0x0122), TAG(0x300a, 0x0125), TAG(0x300a, 0x012c), TAG(0x300a, 0x0130), TAG(0x300a, 0x0140),
        TAG(0x300a, 0x0144) } },
    { "structure set", make_structs, read_structs, { TAG(0x3006, 0x002a), TAG(0x3006, 0x0050) } },
    { "dose",
      make_dose,
      read_dose,
      { TAG(0x0020, 0x0032), TAG(0x0028, 0x0030), TAG(0x3004, 0x000c), TAG(0x3004, 0x000e) } },
    { "CT", make_ct, read_ct, { 0 } },
};

/* Number of warnings that the undamaged file does not have. */
static size_t n_warnings(const struct report *report)
{
    size_t n = report->n_dropped;
    for (size_t i = 0; i < report->n_lines; i++)
        n += report->lines[i].severity != REPORT_NOTE;
    return n;
}

static bool is_undecidable(const struct kind *kind, uint32_t tag)
{
    for (size_t i = 0; i < sizeof kind->undecidable / sizeof kind->undecidable[0]; i++)
        if (kind->undecidable[i] == tag && tag != 0)
            return true;
    return false;
}

/* Changes every character in turn; returns how many changes of the result have no warning although they must. */
static size_t change_all(const struct kind *kind, char (*change)(char c), bool may_be_undecidable)
{
    struct made_dicom made;
    struct number numbers[120];
    kind->make(&made);
    size_t n = find_numbers(&made, numbers, 120), n_changes = 0, n_silent = 0, n_undecided = 0;
    struct outcome whole = kind->read(&made);
    assert_false(whole.is_refused);
    size_t n_before = n_warnings(&whole.report);
    for (size_t i = 0; i < n; i++)
        for (size_t at = numbers[i].at; at < numbers[i].at + numbers[i].size; at++) {
            char was = (char)made.data[at], now = change(was);
            if (now == was)
                continue;
            made.data[at] = (uint8_t)now;
            struct outcome damaged = kind->read(&made);
            made.data[at] = (uint8_t)was;
            n_changes++;
            bool is_silent =
                damaged.hash != whole.hash && !damaged.is_refused && n_warnings(&damaged.report) <= n_before;
            bool is_excused = is_silent && may_be_undecidable && is_undecidable(kind, numbers[i].tag);
            n_undecided += is_excused;
            if (is_silent && !is_excused) {
                n_silent++;
                printf("%s: (%04X,%04X), character %zu '%c' made '%c': no word\n", kind->name, numbers[i].tag >> 16,
                       numbers[i].tag & 0xffff, at - numbers[i].at, was, now);
            }
            report_finish(&damaged.report);
        }
    printf("%s: %zu changes, %zu of them to another number that nothing can tell from the right one\n", kind->name,
           n_changes, n_undecided);
    assert_true(n_changes > 20);
    report_finish(&whole.report);
    made_finish(&made);
    return n_silent;
}

static char to_letter(char c)
{
    (void)c;
    return 'x';
}
static char to_other_digit(char c)
{
    return isdigit((unsigned char)c) ? (char)('0' + (c - '0' + 5) % 10) : c;
}
static char flip_low_bit(char c)
{
    return (char)(c ^ 1);
}
static char flip_high_bit(char c)
{
    return (char)(c ^ 0x40);
}

static void no_number_becomes_something_else_without_a_word(void **state)
{
    (void)state;
    size_t n_silent = 0;
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++)
        n_silent += change_all(&kinds[i], to_letter, false) + change_all(&kinds[i], flip_high_bit, false);
    assert_int_equal(n_silent, 0);
}

static void another_digit_is_said_where_anything_can_tell(void **state)
{
    (void)state;
    size_t n_silent = 0;
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++)
        n_silent += change_all(&kinds[i], to_other_digit, true) + change_all(&kinds[i], flip_low_bit, true);
    assert_int_equal(n_silent, 0);
}

/* ---- single values ---------------------------------------------------------------------------------------------- */

/* The plan with one value replaced by another of the same length. */
static struct outcome plan_with(uint32_t tag, size_t nth, const char *value)
{
    struct made_dicom made;
    struct number numbers[120];
    make_plan(&made);
    size_t n = find_numbers(&made, numbers, 120), i = 0;
    while (i < n && !(numbers[i].tag == tag && nth-- == 0))
        i++;
    assert_true(i < n && strlen(value) <= numbers[i].size);
    memset(made.data + numbers[i].at, ' ', numbers[i].size);
    memcpy(made.data + numbers[i].at, value, strlen(value));
    struct outcome outcome = read_plan(&made);
    made_finish(&made);
    return outcome;
}

static void values_that_cannot_be_are_named_with_what_was_found_and_expected(void **state)
{
    (void)state;
    static const struct {
        uint32_t tag;
        size_t nth;
        const char *value, *code, *words[3];
    } cases[] = {
        { TAG(0x300a, 0x011c),
          0,
          "50\\-50",
          "beam.bad-value",
          { "ASYMX", "(300A,011C)", "50 and -50" } }, /* jaws that overlap */
        { TAG(0x300a, 0x011c),
          2,
          "-30\\-20.5\\-20\\-30\\30\\-90\\20\\30",
          "beam.bad-value",
          { "pair 2", "(300A,011C)", "-20.5 and -90" } },
        { TAG(0x300a, 0x011c),
          3,
          "-40\\-30\\-30\\-40\\20\\30\\30",
          "beam.bad-value",
          { "control point 2", "are 7", "expected 8" } },
        { TAG(0x300a, 0x011c), 0, "-999", "beam.bad-value", { "ASYMX", "are 1", "expected 2" } },
        { TAG(0x300a, 0x011c), 1, "-45\\4550", "beam.bad-value", { "ASYMY", "4550", "expected at most 500" } },
        { TAG(0x300a, 0x00be), 0, "-40\\-20\\0\\-2\\40", "beam.bad-value", { "boundary 4", "(300A,00BE)", "-2" } },
        { TAG(0x300a, 0x00be), 0, "-40\\-20\\0\\20", "beam.bad-value", { "are 4", "expected 5", "(300A,00BE)" } },
        { TAG(0x300a, 0x011e), 1, "720", "beam.bad-value", { "gantry angle", "(300A,011E)", "720" } },
        { TAG(0x300a, 0x012c), 0, "1e5\\-2\\3", "beam.bad-value", { "isocentre", "(300A,012C)", "100000" } },
        { TAG(0x300a, 0x012c), 0, "10.5\\-20", "beam.bad-value", { "isocentre", "2 values", "expected 3" } },
        { TAG(0x300a, 0x00b4), 0, "-5", "beam.bad-value", { "source-axis distance", "(300A,00B4)", "-5" } },
        { TAG(0x300a, 0x0078), 0, "-3", "beam.bad-value", { "number of fractions", "(300A,0078)", "-3" } },
        { TAG(0x300a, 0x0086), 0, "-1", "beam.bad-value", { "meterset", "(300A,0086)", "-1" } },
        { TAG(0x300c, 0x0006), 0, "7", "beam.bad-value", { "beam 7", "(300C,0006)", "does not have" } },
        { TAG(0x300a, 0x0120),
          0,
          "1O",
          "dicom.bad-number",
          { "(300A,00B0) item 1, (300A,0111) item 1, (300A,0120)", "1O", "expected a number" } },
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct outcome outcome = plan_with(cases[i].tag, cases[i].nth, cases[i].value);
        const char *said = report_said(&outcome.report, cases[i].code);
        for (int w = 0; w < 3; w++)
            if (!strstr(said, cases[i].words[w]))
                fail_msg("case %zu: \"%s\" does not say \"%s\"", i, said, cases[i].words[w]);
        report_finish(&outcome.report);
    }
}

static struct outcome ct_with(void (*change)(struct made_slice *slice))
{
    struct made_slice slice = ct_slice(2);
    struct made_dicom made;
    change(&slice);
    made_slice_bytes(&made, &slice);
    struct outcome outcome = read_ct(&made);
    made_finish(&made);
    return outcome;
}

static void be_unsigned(struct made_slice *slice)
{
    slice->is_signed = 0;
}
static void be_neither(struct made_slice *slice)
{
    slice->is_signed = 3;
}
static void be_short(struct made_slice *slice)
{
    slice->stored = 12;
}
static void be_scaled(struct made_slice *slice)
{
    slice->slope = 6;
}
static void be_shifted(struct made_slice *slice)
{
    slice->offset = -24;
}
static void be_wide(struct made_slice *slice)
{
    slice->spacing[1] = 0.25;
}
static void be_turned(struct made_slice *slice)
{
    slice->cosines[1] = 0.2;
}

static void a_slice_that_contradicts_the_others_is_named(void **state)
{
    (void)state;
    static const struct {
        void (*change)(struct made_slice *slice);
        const char *code, *words[3];
    } cases[] = {
        { be_unsigned, "image.slices-contradict", { "(0028,0103)", "found 0, expected 1", "1 of 5 slices" } },
        { be_neither, "dicom.unreadable", { "(0028,0103)", "found 3", "expected 0 to 1" } },
        { be_short, "image.slices-contradict", { "(0028,0101)", "found 12, expected 16", "1 of 5 slices" } },
        { be_scaled, "image.slices-contradict", { "(0028,1053)", "found 6, expected 1", "1 of 5 slices" } },
        { be_shifted, "image.slices-contradict", { "(0028,1052)", "found -24, expected -1024", "1 of 5 slices" } },
        { be_wide, "image.slices-stray", { "(0028,0030)", "found 0.75\\0.25", "expected 0.75\\0.75" } },
        { be_turned, "image.slices-stray", { "(0020,0037)", "found 1\\0.2", "expected 1\\0" } },
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct outcome outcome = ct_with(cases[i].change);
        const char *said = report_said(&outcome.report, cases[i].code);
        for (int w = 0; w < 3; w++)
            if (!strstr(said, cases[i].words[w]))
                fail_msg("case %zu: \"%s\" does not say \"%s\"", i, said, cases[i].words[w]);
        for (size_t l = 0; l < outcome.report.n_lines; l++)
            if (strcmp(outcome.report.lines[l].code, cases[i].code) == 0)
                assert_string_equal(outcome.report.lines[l].where, "2.dcm");
        report_finish(&outcome.report);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_number_becomes_something_else_without_a_word),
        cmocka_unit_test(another_digit_is_said_where_anything_can_tell),
        cmocka_unit_test(values_that_cannot_be_are_named_with_what_was_found_and_expected),
        cmocka_unit_test(a_slice_that_contradicts_the_others_is_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

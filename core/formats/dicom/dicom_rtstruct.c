/* Reads RT Structure Set objects: names, colours and contours, joined by ROI number. */
#include "core/formats/dicom/dicom_rtstruct.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/formats/dicom/dicom_numbers.h"
#include "core/formats/text.h"

#define RTSTRUCT_CLASS "1.2.840.10008.5.1.4.1.1.481.3"

enum {
    SOP_CLASS = DICOM_TAG(0x0008, 0x0016),
    SOP_INSTANCE = DICOM_TAG(0x0008, 0x0018),
    MODALITY = DICOM_TAG(0x0008, 0x0060),
    SERIES_INSTANCE = DICOM_TAG(0x0020, 0x000e),
    FRAME_UID = DICOM_TAG(0x0020, 0x0052),
    SET_LABEL = DICOM_TAG(0x3006, 0x0002),
    FRAME_SEQUENCE = DICOM_TAG(0x3006, 0x0010),
    STUDY_SEQUENCE = DICOM_TAG(0x3006, 0x0012),
    SERIES_SEQUENCE = DICOM_TAG(0x3006, 0x0014),
    ROI_SEQUENCE = DICOM_TAG(0x3006, 0x0020),
    ROI_NUMBER = DICOM_TAG(0x3006, 0x0022),
    ROI_FRAME_UID = DICOM_TAG(0x3006, 0x0024),
    ROI_NAME = DICOM_TAG(0x3006, 0x0026),
    ROI_COLOR = DICOM_TAG(0x3006, 0x002a),
    ROI_CONTOUR_SEQUENCE = DICOM_TAG(0x3006, 0x0039),
    CONTOUR_SEQUENCE = DICOM_TAG(0x3006, 0x0040),
    CONTOUR_TYPE = DICOM_TAG(0x3006, 0x0042),
    CONTOUR_N_POINTS = DICOM_TAG(0x3006, 0x0046),
    CONTOUR_DATA = DICOM_TAG(0x3006, 0x0050),
    OBSERVATION_SEQUENCE = DICOM_TAG(0x3006, 0x0080),
    REFERENCED_ROI = DICOM_TAG(0x3006, 0x0084),
    ROI_KIND = DICOM_TAG(0x3006, 0x00a4)
};

/* One ROI while it is read, with counts for the report. */
struct reading_roi {
    struct rtstruct_roi roi;
    size_t n_points_alone, n_open; /* contours of a single point, and open ones: they enclose nothing */
    size_t n_miscounted, n_uneven, n_twice_round;
    bool is_unnamed, is_refused;
    uint64_t n_points, n_contours; /* read, of those that count for the limits of the file */
};

struct reading {
    const struct dicom_file *file;
    const char *where;
    struct report *report;
    struct reading_roi *rois;
    size_t n_rois, most_rois;
    size_t n_beyond; /* described beyond most_rois, so not looked at */
    double *values;  /* the numbers of the current contour */
    size_t room;
    uint64_t n_points, n_contours;
};

static struct reading_roi *find_roi(struct reading *reading, int64_t number)
{
    for (size_t i = 0; i < reading->n_rois; i++)
        if (reading->rois[i].roi.number == number)
            return &reading->rois[i];
    return NULL;
}

/* Adds a region; NULL beyond the limit. */
static struct reading_roi *add_roi(struct reading *reading, int64_t number)
{
    if (reading->n_rois >= reading->most_rois) {
        reading->n_beyond++;
        return NULL;
    }
    struct reading_roi *roi = &reading->rois[reading->n_rois++];
    roi->roi.number = number;
    return roi;
}

static void read_names(struct reading *reading, const char *frame_uid)
{
    const struct dicom_item *root = dicom_root(reading->file);
    size_t n = dicom_n_items(root, ROI_SEQUENCE);
    for (size_t i = 0; i < n; i++) {
        const struct dicom_item *item = dicom_item_at(root, ROI_SEQUENCE, i);
        int64_t number;
        if (!dicom_integer(item, ROI_NUMBER, &number)) {
            report_add(reading->report, REPORT_WARNING, "region.roi-number", reading->where,
                       "Item %zu of the regions has no number, so nothing can refer to it; it was left out.", i + 1);
            continue;
        }
        if (find_roi(reading, number)) {
            report_add(reading->report, REPORT_WARNING, "region.roi-number", reading->where,
                       "Two regions have the number %lld; the contours were given to the first.", (long long)number);
            continue;
        }
        struct reading_roi *roi = add_roi(reading, number);
        if (!roi)
            continue;
        if (!dicom_text(item, ROI_NAME, roi->roi.name, sizeof roi->roi.name)) {
            snprintf(roi->roi.name, sizeof roi->roi.name, "ROI %lld", (long long)number);
            roi->is_unnamed = true;
        }
        if (!dicom_text(item, ROI_FRAME_UID, roi->roi.frame_uid, sizeof roi->roi.frame_uid))
            snprintf(roi->roi.frame_uid, sizeof roi->roi.frame_uid, "%s", frame_uid);
    }
}

static void read_kinds(struct reading *reading)
{
    const struct dicom_item *root = dicom_root(reading->file);
    size_t n = dicom_n_items(root, OBSERVATION_SEQUENCE);
    for (size_t i = 0; i < n; i++) {
        const struct dicom_item *item = dicom_item_at(root, OBSERVATION_SEQUENCE, i);
        int64_t number;
        struct reading_roi *roi = dicom_integer(item, REFERENCED_ROI, &number) ? find_roi(reading, number) : NULL;
        if (roi && !roi->roi.kind[0])
            dicom_text(item, ROI_KIND, roi->roi.kind, sizeof roi->roi.kind);
    }
}

/* Reads all numbers of one contour into reading->values, if that many points are within the limit. Returns how many
 * there are; SIZE_MAX when there is no memory. */
static size_t read_values(struct reading *reading, const struct dicom_item *item, struct error *err)
{
    size_t n = dicom_numbers(item, CONTOUR_DATA, reading->values, reading->room);
    if (n <= reading->room || reading->n_points + n / 3 > RTSTRUCT_MAX_POINTS)
        return n;
    free(reading->values);
    reading->room = n;
    reading->values = mem_array(n, sizeof *reading->values, UINT64_MAX, err);
    return reading->values ? dicom_numbers(item, CONTOUR_DATA, reading->values, n) : SIZE_MAX;
}

enum contour_kind { KIND_CLOSED, KIND_XOR, KIND_POINT, KIND_OPEN };

static enum contour_kind kind_of(const struct dicom_item *item, size_t n_points)
{
    char type[32];
    if (!dicom_text(item, CONTOUR_TYPE, type, sizeof type))
        return n_points >= 3 ? KIND_CLOSED : KIND_POINT;
    if (strcmp(type, "CLOSED_PLANAR") == 0)
        return KIND_CLOSED;
    if (strcmp(type, "CLOSEDPLANAR_XOR") == 0)
        return KIND_XOR;
    return strcmp(type, "POINT") == 0 ? KIND_POINT : KIND_OPEN;
}

/* Number of points of the first round if a contour goes round twice over the same points; else n. Even-odd would fill
 * nothing of the whole. */
static size_t first_round(const double *xyz, size_t n)
{
    const double same_mm = 0.05;
    if (n < 6 || n % 2 != 0)
        return n;
    for (size_t i = 0; i < 3 * (n / 2); i++)
        if (!(fabs(xyz[i] - xyz[i + 3 * (n / 2)]) <= same_mm))
            return n;
    return n / 2;
}

static bool read_contour(struct reading *reading, struct reading_roi *roi, const struct dicom_item *item,
                         struct contour *contour, struct error *err)
{
    size_t n = read_values(reading, item, err);
    if (n == SIZE_MAX)
        return false;
    size_t n_points = n / 3;
    int64_t n_said;
    roi->n_uneven += n % 3 != 0;
    roi->n_miscounted += dicom_integer(item, CONTOUR_N_POINTS, &n_said) && (n_said < 0 || (uint64_t)n_said != n_points);
    if (reading->n_points + n_points > RTSTRUCT_MAX_POINTS || reading->n_contours >= RTSTRUCT_MAX_CONTOURS) {
        roi->is_refused = true;
        return true;
    }
    reading->n_points += n_points;
    reading->n_contours++;
    roi->n_points += n_points;
    roi->n_contours++;
    enum contour_kind kind = kind_of(item, n_points);
    roi->n_points_alone += kind == KIND_POINT;
    roi->n_open += kind == KIND_OPEN;
    if ((kind != KIND_CLOSED && kind != KIND_XOR) || n_points == 0)
        return true;
    size_t n_once = first_round(reading->values, n_points);
    roi->n_twice_round += n_once < n_points;
    n_points = n_once;
    contour->points_lps_mm = mem_array(3 * n_points, sizeof *contour->points_lps_mm, UINT64_MAX, err);
    if (!contour->points_lps_mm)
        return false;
    memcpy(contour->points_lps_mm, reading->values, 3 * n_points * sizeof *contour->points_lps_mm);
    contour->n_points = n_points;
    contour->is_xor = kind == KIND_XOR;
    return true;
}

/* Drops the contours of a region that is beyond a limit, so that there is room for the next ones. */
static void refuse(struct reading *reading, struct reading_roi *roi)
{
    contour_set_finish(&roi->roi.contours);
    reading->n_points -= roi->n_points;
    reading->n_contours -= roi->n_contours;
    roi->n_points = roi->n_contours = 0;
}

static bool read_contours(struct reading *reading, struct reading_roi *roi, const struct dicom_item *item,
                          struct error *err)
{
    size_t n = dicom_n_items(item, CONTOUR_SEQUENCE);
    struct contour_set *set = &roi->roi.contours;
    if (n == 0 || roi->is_refused)
        return true;
    if (n > RTSTRUCT_MAX_CONTOURS) {
        roi->is_refused = true;
        refuse(reading, roi);
        return true;
    }
    struct contour *contours = realloc(set->contours, (set->n_contours + n) * sizeof *contours);
    if (!contours)
        return error_set(err, ERROR_MEMORY, "%s: no memory for %zu contours", reading->where, n);
    set->contours = contours;
    for (size_t i = 0; i < n && !roi->is_refused; i++) {
        struct contour *contour = &set->contours[set->n_contours];
        *contour = (struct contour){ 0 };
        if (!read_contour(reading, roi, dicom_item_at(item, CONTOUR_SEQUENCE, i), contour, err))
            return false;
        set->n_contours += contour->n_points > 0;
    }
    if (roi->is_refused)
        refuse(reading, roi);
    return true;
}

static void read_color(const struct reading *reading, struct rtstruct_roi *roi, const struct dicom_item *item)
{
    double rgb[3] = { 0, 0, 0 };
    size_t n = dicom_numbers(item, ROI_COLOR, rgb, 3);
    if (n == 0)
        return;
    bool is_color = n == 3;
    for (int i = 0; i < 3; i++)
        is_color = is_color && rgb[i] >= 0 && rgb[i] <= 255;
    if (!is_color) {
        char found[40];
        dicom_text(item, ROI_COLOR, found, sizeof found);
        report_add(reading->report, REPORT_WARNING, "dicom.bad-number", reading->where,
                   "\"%s\": its colour (3006,002A) is \"%s\", expected three "
                   "numbers from 0 to 255; it has the palette's.",
                   roi->name, found);
        return;
    }
    for (int i = 0; i < 3; i++)
        roi->rgb[i] = (uint8_t)rgb[i];
    roi->has_color = true;
}

static bool read_all_contours(struct reading *reading, struct error *err)
{
    const struct dicom_item *root = dicom_root(reading->file);
    size_t n = dicom_n_items(root, ROI_CONTOUR_SEQUENCE);
    for (size_t i = 0; i < n; i++) {
        const struct dicom_item *item = dicom_item_at(root, ROI_CONTOUR_SEQUENCE, i);
        int64_t number;
        if (!dicom_integer(item, REFERENCED_ROI, &number)) {
            report_add(reading->report, REPORT_WARNING, "region.roi-number", reading->where,
                       "Item %zu of the contours does not say which region it is of; it was left out.", i + 1);
            continue;
        }
        struct reading_roi *roi = find_roi(reading, number);
        if (!roi) {
            roi = add_roi(reading, number);
            if (!roi)
                continue;
            snprintf(roi->roi.name, sizeof roi->roi.name, "ROI %lld", (long long)number);
            report_add(reading->report, REPORT_WARNING, "region.roi-number", reading->where,
                       "There are contours for region %lld, which the file does not describe; it is called \"%s\".",
                       (long long)number, roi->roi.name);
        }
        read_color(reading, &roi->roi, item);
        if (!read_contours(reading, roi, item, err))
            return false;
    }
    return true;
}

/* Appends ", name" while there is room. */
static void add_name(char *text, size_t size, const char *name)
{
    size_t length = strlen(text), more = strlen(name) + 2;
    if (length + more + 5 < size)
        snprintf(text + length, size - length, "%s%s", length ? ", " : "", name);
    else if (length + 5 < size && strcmp(text + length - (length < 3 ? length : 3), "...") != 0)
        snprintf(text + length, size - length, ", ...");
}

static void report_roi(const struct reading *reading, const struct reading_roi *roi)
{
    const char *name = roi->roi.name;
    if (roi->is_unnamed)
        report_add(reading->report, REPORT_NOTE, "region.unnamed", reading->where,
                   "Region %lld has no name; it is called \"%s\".", (long long)roi->roi.number, name);
    if (roi->n_points_alone + roi->n_open > 0)
        report_add(reading->report, REPORT_NOTE, "region.contours-open", reading->where,
                   "\"%s\" has %zu points and %zu open contours; they enclose nothing and were left out.", name,
                   roi->n_points_alone, roi->n_open);
    if (roi->n_miscounted > 0)
        report_add(
            reading->report, REPORT_WARNING, "region.contours-count", reading->where,
            "\"%s\": %zu contours have another number of points than the file says; the points there are were taken.",
            name, roi->n_miscounted);
    if (roi->n_twice_round > 0)
        report_add(reading->report, REPORT_WARNING, "region.contours-left-out", reading->where,
                   "\"%s\": %zu contours go round twice; the second round was left out.", name, roi->n_twice_round);
    if (roi->n_uneven > 0)
        report_add(reading->report, REPORT_WARNING, "region.contours-count", reading->where,
                   "\"%s\": %zu contours have coordinates that are not three for each point; the last were left out.",
                   name, roi->n_uneven);
}

static void report_empty(const struct reading *reading)
{
    char names[300] = "";
    size_t n_empty = 0;
    for (size_t i = 0; i < reading->n_rois; i++)
        if (reading->rois[i].roi.contours.n_contours == 0 && !reading->rois[i].is_refused) {
            add_name(names, sizeof names, reading->rois[i].roi.name);
            n_empty++;
        }
    if (n_empty > 0)
        report_add(reading->report, REPORT_NOTE, "region.no-contours", reading->where,
                   "%zu of %zu regions have no closed contour and are not listed: %s.", n_empty, reading->n_rois,
                   names);
}

static void report_refused(const struct reading *reading)
{
    char names[300] = "";
    size_t n_refused = 0;
    for (size_t i = 0; i < reading->n_rois; i++)
        if (reading->rois[i].is_refused) {
            add_name(names, sizeof names, reading->rois[i].roi.name);
            n_refused++;
        }
    if (n_refused > 0)
        report_add(reading->report, REPORT_ERROR, "region.contours-refused", reading->where,
                   "%zu regions were left out, as the contours of the file would be more than %d or have more than %d "
                   "points: %s.",
                   n_refused, RTSTRUCT_MAX_CONTOURS, RTSTRUCT_MAX_POINTS, names);
}

static void find_references(struct rtstruct *set, const struct dicom_item *root, char *frame_uid, size_t frame_size)
{
    dicom_text(root, SOP_INSTANCE, set->uid, sizeof set->uid);
    dicom_text(root, SET_LABEL, set->label, sizeof set->label);
    const struct dicom_item *frame = dicom_item_at(root, FRAME_SEQUENCE, 0);
    const struct dicom_item *study = frame ? dicom_item_at(frame, STUDY_SEQUENCE, 0) : NULL;
    const struct dicom_item *series = study ? dicom_item_at(study, SERIES_SEQUENCE, 0) : NULL;
    if (series)
        dicom_text(series, SERIES_INSTANCE, set->series_uid, sizeof set->series_uid);
    if (!frame || !dicom_text(frame, FRAME_UID, frame_uid, frame_size))
        dicom_text(root, FRAME_UID, frame_uid, frame_size);
}

/* Moves the regions that were read into the set, up to the limit; reports the others. */
static struct rtstruct *made_set(struct reading *reading, struct rtstruct *set, struct error *err)
{
    char names[300] = "";
    size_t n_left = reading->n_beyond;
    size_t most = reading->n_rois < RTSTRUCT_MAX_ROIS ? reading->n_rois : RTSTRUCT_MAX_ROIS;
    set->rois = mem_array(most, sizeof *set->rois, UINT64_MAX, err);
    if (!set->rois)
        return NULL;
    for (size_t i = 0; i < reading->n_rois; i++) {
        struct rtstruct_roi *roi = &reading->rois[i].roi;
        if (roi->contours.n_contours == 0)
            continue;
        if (set->n_rois == most) {
            add_name(names, sizeof names, roi->name);
            n_left++;
            continue;
        }
        set->rois[set->n_rois++] = *roi;
        roi->contours = (struct contour_set){ 0 };
    }
    if (n_left > 0)
        report_add(reading->report, REPORT_ERROR, "region.too-many", reading->where,
                   "Of its regions the first %d with contours are read; %zu were left out: %s.", RTSTRUCT_MAX_ROIS,
                   n_left, names[0] ? names : "with numbers that were not looked at");
    return set;
}

struct rtstruct *rtstruct_read(const struct dicom_file *file, const char *where, struct report *report,
                               struct error *err)
{
    const struct dicom_item *root = dicom_root(file);
    char class[DICOM_UID_SIZE], modality[17], frame_uid[DICOM_UID_SIZE] = "";
    dicom_text(root, SOP_CLASS, class, sizeof class);
    dicom_text(root, MODALITY, modality, sizeof modality);
    if (strcmp(class, RTSTRUCT_CLASS) != 0 && strcmp(modality, "RTSTRUCT") != 0) {
        error_set(err, ERROR_UNSUPPORTED, "%s: a DICOM object of modality \"%s\", expected RTSTRUCT", where, modality);
        return NULL;
    }
    if (!dicom_has(root, ROI_SEQUENCE)) {
        error_set(err, ERROR_FORMAT, "%s: no Structure Set ROI Sequence (3006,0020)", where);
        return NULL;
    }
    dicom_numbers_report(file, CONTOUR_DATA, where, report); /* contour data is counted separately */
    struct reading reading = { .file = file, .where = where, .report = report };
    size_t n_described = dicom_n_items(root, ROI_SEQUENCE) + dicom_n_items(root, ROI_CONTOUR_SEQUENCE);
    reading.most_rois = n_described < RTSTRUCT_MAX_DESCRIBED ? n_described : RTSTRUCT_MAX_DESCRIBED;
    reading.rois = mem_array(reading.most_rois, sizeof *reading.rois, UINT64_MAX, err);
    if (!reading.rois)
        return NULL;
    struct rtstruct *set = mem_new(sizeof *set), *made = NULL;
    find_references(set, root, frame_uid, sizeof frame_uid);
    read_names(&reading, frame_uid);
    if (read_all_contours(&reading, err)) {
        read_kinds(&reading);
        for (size_t i = 0; i < reading.n_rois; i++)
            report_roi(&reading, &reading.rois[i]);
        report_empty(&reading);
        report_refused(&reading);
        made = made_set(&reading, set, err);
    }
    for (size_t i = 0; i < reading.n_rois; i++)
        contour_set_finish(&reading.rois[i].roi.contours);
    free(reading.rois);
    free(reading.values);
    if (!made)
        rtstruct_destroy(set);
    return made;
}

void rtstruct_destroy(struct rtstruct *set)
{
    if (!set)
        return;
    for (size_t i = 0; i < set->n_rois; i++)
        contour_set_finish(&set->rois[i].contours);
    free(set->rois);
    free(set);
}

void rtstruct_check_frame(const struct rtstruct *set, const char *image_frame_uid, const char *where,
                          struct report *report)
{
    size_t n_unknown = 0, n_other = 0;
    char unknown[200] = "", other[200] = "";
    bool is_known = image_frame_uid && image_frame_uid[0];
    for (size_t i = 0; i < set->n_rois; i++) {
        const struct rtstruct_roi *roi = &set->rois[i];
        if (!roi->frame_uid[0] || !is_known) {
            add_name(unknown, sizeof unknown, roi->name);
            n_unknown++;
        } else if (strcmp(roi->frame_uid, image_frame_uid) != 0) {
            add_name(other, sizeof other, roi->name);
            n_other++;
        }
    }
    if (n_unknown > 0)
        report_add(
            report, REPORT_NOTE, "region.no-frame", where,
            "%s frame of reference, so nothing says that %zu regions fit the image: %s. They are shown where their coordinates are.",
            is_known ? "The regions name no" : "The image names no", n_unknown, unknown);
    if (n_other > 0)
        report_add(
            report, REPORT_WARNING, "region.frame-differs", where,
            "%zu regions were drawn in another frame of reference than the image's and may be shifted against it: %s.",
            n_other, other);
}

void rtstruct_report_reach(const struct rtstruct *set, const struct contour_choice *choices, const char *only,
                           const char *image, const char *where, struct report *report)
{
    char names[200] = "";
    size_t n_beyond = 0, n_all = 0;
    for (size_t i = 0; i < set->n_rois; i++) {
        if (only[0] && !text_equal(only, set->rois[i].name))
            continue;
        n_all++;
        if (choices[i].is_beyond)
            add_name(names, sizeof names, set->rois[i].name);
        n_beyond += choices[i].is_beyond;
    }
    if (n_beyond > 0)
        report_add(report, REPORT_WARNING, "region.contours-beyond", where,
                   "Contours of %zu of %zu regions reach beyond the image \"%s\"; they "
                   "were filled on a grid that continues it and covers them: %s.",
                   n_beyond, n_all, image, names);
}

static void report_left_out(const char *name, const struct contour_facts *facts, const char *where,
                            struct report *report)
{
    const struct {
        size_t n;
        const char *why;
    } reasons[] = { { facts->n_not_finite, "have coordinates that are no numbers or beyond 100 m" },
                    { facts->n_degenerate, "enclose no area" },
                    { facts->n_repeated, "repeat another of their plane" },
                    { facts->n_not_parallel, "are tilted against the others" } };
    for (size_t i = 0; i < sizeof reasons / sizeof reasons[0]; i++)
        if (reasons[i].n > 0)
            report_add(report, i == 1 ? REPORT_NOTE : REPORT_WARNING, "region.contours-left-out", where,
                       "\"%s\": %zu contours %s and were left out.", name, reasons[i].n, reasons[i].why);
}

/* Returns true if voxels and outlines differ by more than 2 % (5 % below 1 cm3) of the outlines. */
static bool is_doubtful(const struct contour_facts *facts)
{
    double most = facts->outlines_cm3 < 1 ? 0.05 : 0.02;
    return fabs(facts->filled_cm3 - facts->outlines_cm3) >= most * facts->outlines_cm3 &&
           facts->filled_cm3 != facts->outlines_cm3;
}

static void report_doubts(const char *name, const struct contour_facts *facts, const char *where, struct report *report)
{
    if (facts->n_overlap_planes > 0)
        report_add(
            report, REPORT_WARNING, "region.contours-overlap", where,
            "\"%s\": contours partly overlap on %zu of %zu planes. Their union was filled: %.4g cm3; other programs "
            "may leave out the overlap.",
            name, facts->n_overlap_planes, facts->n_planes, facts->filled_cm3);
    if (is_doubtful(facts))
        report_add(report, REPORT_WARNING, "region.contours-differ", where,
                   "\"%s\": its voxels hold %.4g cm3, the areas of its outlines without holes add up to %.4g cm3.%s",
                   name, facts->filled_cm3, facts->outlines_cm3,
                   facts->n_overlap_planes > 0 ? " Overlaps count twice there."
                   : facts->n_outside > 0      ? " Part of it lies outside the image."
                                               : " An outline may cross itself, or touch another.");
    if (facts->n_close_planes > 0)
        report_add(report, REPORT_WARNING, "region.contours-moved", where,
                   "\"%s\": %zu times a contour lies so near to the plane of others that it was moved into it.", name,
                   facts->n_close_planes);
}

void rtstruct_report_fill(const struct rtstruct_roi *roi, const struct contour_choice *choice,
                          const struct contour_facts *facts, const char *where, struct report *report)
{
    const char *name = roi->name;
    const uint32_t *s = choice->subdivision;
    report_left_out(name, facts, where, report);
    if (facts->n_planes == 0)
        return;
    char grid[80] = "the image's voxels";
    struct vec3 mm = grid_spacing_mm(&choice->grid);
    if (choice->is_beyond)
        snprintf(grid, sizeof grid, "voxels of %.4g x %.4g x %.4g mm", mm.x, mm.y, mm.z);
    else if (s[0] * s[1] * s[2] > 1)
        snprintf(grid, sizeof grid, "voxels of the image divided %u x %u x %u", s[0], s[1], s[2]);
    char check[120];
    double percent = 100 * (facts->filled_cm3 / facts->outlines_cm3 - 1);
    if (facts->outlines_cm3 > 0)
        snprintf(check, sizeof check, "the areas of its outlines, without holes, add up to %.4g cm3 (%+.1f %%)",
                 facts->outlines_cm3, percent);
    else
        snprintf(check, sizeof check, "the areas of its outlines %s",
                 isnan(facts->outlines_cm3) ? "were too intricate to add up" : "add up to nothing");
    report_add(report, choice->is_short ? REPORT_WARNING : REPORT_NOTE,
               choice->is_short ? "region.contours-coarse" : "region.contours-filled", where,
               "\"%s\": %zu planes %.4g mm apart, filled at the centres of %s: %.4g cm3; %s.", name, facts->n_planes,
               facts->spacing_mm, grid, facts->filled_cm3, check);
    report_doubts(name, facts, where, report);
    if (facts->n_moved_planes > 0 && s[0] * s[1] * s[2] == 1) /* finer slices are nearer than the image's */
        report_add(report, REPORT_NOTE, "region.contours-moved", where,
                   "\"%s\": %zu of %zu planes lie beside the slices that they were filled on, by up to %.3g mm.", name,
                   facts->n_moved_planes, facts->n_planes, facts->moved_mm);
    if (facts->n_gaps > 0)
        report_add(
            report, REPORT_NOTE, "region.contours-gap", where,
            "\"%s\": at %zu places the next contour is further away than %.4g mm (up to %.4g mm); nothing was filled there.",
            name, facts->n_gaps, facts->spacing_mm, facts->widest_gap_mm);
    if (facts->n_outside > 0)
        report_add(
            report, REPORT_WARNING, "region.contours-outside", where,
            "\"%s\": %zu contours leave the image, further than %g mm or with too many points to be filled there; what lies outside is "
            "not shown.",
            name, facts->n_outside, CONTOUR_MAX_REACH_MM);
    if (facts->n_not_planar > 0)
        report_add(report, REPORT_NOTE, "region.contours-not-planar", where,
                   "\"%s\": %zu contours are not flat; they were flattened.", name, facts->n_not_planar);
}

/* Reads the head of one file: its kind, its identifiers, what it refers to and, for images, the geometry. */
#include "core/formats/dicom/dicom_head.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/formats/dicom/dicom_padding.h"
#include "core/formats/dicom/dicom_patients.h"
#include "core/formats/dicom/dicom_tags.h"

#define CLASSES "1.2.840.10008.5.1.4.1.1."

/* SOP classes (DICOM PS3.4 B.5). An object of any other class is an image if its pixels have a position in the
 * patient. */
static const struct {
    const char *uid; /* part after CLASSES */
    enum dicom_kind kind;
    const char *name;
} classes[] = {
    { "2", DICOM_KIND_IMAGE, "CT image" },
    { "2.1", DICOM_KIND_IMAGE, "enhanced CT image" },
    { "2.2", DICOM_KIND_IMAGE, "converted enhanced CT image" },
    { "4", DICOM_KIND_IMAGE, "MR image" },
    { "4.1", DICOM_KIND_IMAGE, "enhanced MR image" },
    { "4.4", DICOM_KIND_IMAGE, "converted enhanced MR image" },
    { "128", DICOM_KIND_IMAGE, "PET image" },
    { "128.1", DICOM_KIND_IMAGE, "converted enhanced PET image" },
    { "130", DICOM_KIND_IMAGE, "enhanced PET image" },
    { "481.2", DICOM_KIND_DOSE, "dose" },
    { "481.3", DICOM_KIND_STRUCT, "structure set" },
    { "481.5", DICOM_KIND_PLAN, "plan" },
    { "481.8", DICOM_KIND_PLAN, "ion plan" },
    { "1", DICOM_KIND_OTHER, "radiograph" },
    { "1.1", DICOM_KIND_OTHER, "radiograph" },
    { "1.2", DICOM_KIND_OTHER, "mammogram" },
    { "6.1", DICOM_KIND_OTHER, "sonogram" },
    { "3.1", DICOM_KIND_OTHER, "sonogram film" },
    { "7", DICOM_KIND_OTHER, "screen capture" },
    { "7.1", DICOM_KIND_OTHER, "screen capture" },
    { "7.2", DICOM_KIND_OTHER, "screen capture" },
    { "7.3", DICOM_KIND_OTHER, "screen capture" },
    { "7.4", DICOM_KIND_OTHER, "screen capture" },
    { "4.2", DICOM_KIND_OTHER, "MR spectrum" },
    { "11.1", DICOM_KIND_OTHER, "presentation state" },
    { "12.1", DICOM_KIND_OTHER, "picture of blood vessels" },
    { "30", DICOM_KIND_OTHER, "parametric map" },
    { "66", DICOM_KIND_OTHER, "set of raw data" },
    { "66.1", DICOM_KIND_REGISTRATION, "registration" },
    { "66.3", DICOM_KIND_OTHER, "deformable registration" },
    { "66.4", DICOM_KIND_SEGMENTATION, "segmentation" },
    { "88.11", DICOM_KIND_OTHER, "report" },
    { "88.22", DICOM_KIND_OTHER, "report" },
    { "88.33", DICOM_KIND_OTHER, "report" },
    { "88.67", DICOM_KIND_OTHER, "radiation dose report" },
    { "104.1", DICOM_KIND_OTHER, "PDF document" },
    { "481.1", DICOM_KIND_OTHER, "radiotherapy image" },
    { "481.4", DICOM_KIND_OTHER, "treatment record" },
    { "481.6", DICOM_KIND_OTHER, "brachytherapy record" },
    { "481.7", DICOM_KIND_OTHER, "treatment summary" },
    { "481.9", DICOM_KIND_OTHER, "record of ion treatment" },
    { "66.7", DICOM_KIND_OTHER, "label map segmentation" },
    { "66.5", DICOM_KIND_OTHER, "surface segmentation" },
};

static const char *known_class(const char *sop_class, enum dicom_kind *kind)
{
    for (size_t i = 0; i < sizeof classes / sizeof classes[0]; i++)
        if (strncmp(sop_class, CLASSES, sizeof CLASSES - 1) == 0 &&
            strcmp(sop_class + sizeof CLASSES - 1, classes[i].uid) == 0) {
            *kind = classes[i].kind;
            return classes[i].name;
        }
    return NULL;
}

/* A name for people by SOP class: "CT image", "structure set", ...; "object of class 1.2.3" for an unknown class. */
static void class_name(const char *sop_class, char *out, size_t size)
{
    enum dicom_kind kind;
    const char *name = known_class(sop_class, &kind);
    if (name)
        snprintf(out, size, "%s", name);
    else
        snprintf(out, size, "object of class %s", sop_class[0] ? sop_class : "not said");
}

static double number_or(const struct dicom_item *item, uint32_t tag, double otherwise)
{
    double value;
    return dicom_number(item, tag, &value) ? value : otherwise;
}

static int64_t integer_or_none(const struct dicom_item *item, uint32_t tag)
{
    int64_t value;
    return dicom_integer(item, tag, &value) ? value : INT64_MIN;
}

/* Reads n finite numbers, each of at most `high` in magnitude. On false, reason says that the element is absent ("it
 * does not say ...") or what is wrong with it. */
static bool read_all(const struct dicom_item *root, uint32_t tag, const char *name, const char *not_said, double high,
                     double *values, size_t n, char *reason, size_t size)
{
    char found[40];
    if (!dicom_text(root, tag, found, sizeof found))
        return snprintf(reason, size, "it does not say %s (%04X,%04X)", not_said, tag >> 16, tag & 0xFFFF) < 0;
    bool is_good = dicom_numbers(root, tag, values, n) == n;
    for (size_t i = 0; i < n; i++)
        is_good = is_good && fabs(values[i]) <= high;
    return is_good || snprintf(reason, size, "%s (%04X,%04X): expected %zu number%s up to %g, found \"%s\"", name,
                               tag >> 16, tag & 0xFFFF, n, n == 1 ? "" : "s", high, found) < 0;
}

/* Reads position, orientation and pixel spacing from the elements of a single-frame image. On false, reason says what
 * is absent or malformed. */
static bool read_place(const struct dicom_item *root, struct dicom_image *image, char *reason, size_t size)
{
    double cosines[6];
    if (!read_all(root, TAG_POSITION, "position", "where it lies in the patient", 1e6, image->position_mm, 3, reason,
                  size) ||
        !read_all(root, TAG_ORIENTATION, "orientation", "how it lies in the patient", 2, cosines, 6, reason, size) ||
        !read_all(root, TAG_SPACING, "pixel spacing", "how large its pixels are", 1e4, image->spacing_mm, 2, reason,
                  size))
        return false;
    if (!(image->spacing_mm[0] > 0 && image->spacing_mm[1] > 0))
        return snprintf(reason, size, "pixel spacing (0028,0030): expected numbers above 0, found %g\\%g",
                        image->spacing_mm[0], image->spacing_mm[1]) < 0;
    memcpy(image->row, cosines, sizeof image->row);
    memcpy(image->column, cosines + 3, sizeof image->column);
    image->has_place = true;
    return true;
}

/* Reads rescale slope and intercept. Absent: 1 and 0. A malformed one is a failure, because it would make every value
 * wrong. */
static bool read_scale(const struct dicom_item *root, struct dicom_image *image, char *reason, size_t size)
{
    image->slope = 1;
    image->offset = 0;
    return (dicom_numbers(root, TAG_SLOPE, NULL, 0) == 0 ||
            read_all(root, TAG_SLOPE, "rescale slope", "", DBL_MAX, &image->slope, 1, reason, size)) &&
           (dicom_numbers(root, TAG_OFFSET, NULL, 0) == 0 ||
            read_all(root, TAG_OFFSET, "rescale intercept", "", DBL_MAX, &image->offset, 1, reason, size));
}

/* Notes the first malformed optional element; such elements are ignored. */
static void note_bad_number(const struct dicom_item *root, struct dicom_image *image)
{
    static const uint32_t used[] = { TAG_THICKNESS, TAG_INSTANCE,     TAG_ACQUISITION,   TAG_ECHO_NUMBER, TAG_TEMPORAL,
                                     TAG_ECHO_TIME, TAG_TRIGGER_TIME, TAG_WINDOW_CENTER, TAG_WINDOW_WIDTH };
    enum { MOST = 16 };
    struct dicom_bad_number bad[MOST];
    size_t n = dicom_bad_numbers(root, false, 0, bad, MOST);
    for (size_t i = 0; i < n && i < MOST; i++)
        for (size_t u = 0; u < sizeof used / sizeof used[0] && image->bad_tag == 0; u++)
            if (bad[i].tag == used[u]) {
                image->bad_tag = bad[i].tag;
                memcpy(image->bad_found, bad[i].found, sizeof image->bad_found);
            }
}

static void read_image_facts(const struct dicom_item *root, struct dicom_image *image)
{
    image->padding = dicom_padding_read(root, &image->pixels);
    image->thickness_mm = fmax(0, number_or(root, TAG_THICKNESS, 0));
    if (!dicom_text(root, TAG_RESCALE_TYPE, image->unit, sizeof image->unit))
        (void)dicom_text(root, TAG_UNITS, image->unit, sizeof image->unit);
    image->instance = integer_or_none(root, TAG_INSTANCE);
    image->acquisition = integer_or_none(root, TAG_ACQUISITION);
    image->echo = integer_or_none(root, TAG_ECHO_NUMBER);
    image->temporal = integer_or_none(root, TAG_TEMPORAL);
    image->echo_ms = number_or(root, TAG_ECHO_TIME, NAN);
    image->trigger_ms = number_or(root, TAG_TRIGGER_TIME, NAN);
    image->b_value = number_or(root, TAG_B_VALUE, NAN);
    (void)dicom_text(root, TAG_IMAGE_TYPE, image->image_type, sizeof image->image_type);
    char lossy[8];
    image->is_lossy = dicom_text(root, TAG_LOSSY, lossy, sizeof lossy) && strcmp(lossy, "01") == 0;
}

/* Makes object an IMAGE if everything needed is present and readable; else OTHER with the reason. */
static void read_image(const struct dicom_file *file, uint64_t n_bytes, struct dicom_object *object)
{
    const struct dicom_item *root = dicom_root(file);
    struct dicom_image image = { 0 };
    struct error err = { 0 };
    object->kind = DICOM_KIND_OTHER;
    if (!dicom_has(root, DICOM_TAG(0x7FE0, 0x0010)) && !dicom_has(root, DICOM_TAG(0x7FE0, 0x0008))) {
        char name[100];
        const char *word = dicom_uid_word(object->sop_class);
        class_name(object->sop_class, name, sizeof name);
        snprintf(object->reason, sizeof object->reason, "it has no picture (%s)", word[0] ? word : name);
        return;
    }
    if (!dicom_pixels_look(file, &image.pixels, &err)) {
        const char *text = strstr(err.text, ": "); /* skip the file name */
        snprintf(object->reason, sizeof object->reason, "%.159s", text ? text + 2 : err.text);
        return;
    }
    read_image_facts(root, &image);
    if (dicom_n_items(root, TAG_MODALITY_LUT) > 0) {
        snprintf(object->reason, sizeof object->reason,
                 "it gives its values by a table (Modality LUT Sequence (0028,3000)), which is not applied");
        return;
    }
    if (strstr(image.image_type, "LOCALIZER")) {
        snprintf(object->reason, sizeof object->reason, "it is a localizer");
        return;
    }
    if (strstr(image.image_type, "MOSAIC")) {
        snprintf(object->reason, sizeof object->reason, "it is a mosaic of many slices in one picture");
        return;
    }
    bool has_frames = dicom_has(root, TAG_FRAME_GROUPS);
    if (!has_frames && image.pixels.n_frames > 1) {
        snprintf(object->reason, sizeof object->reason,
                 "it has %u frames and does not say where they lie in the patient (5200,9230)", image.pixels.n_frames);
        return;
    }
    if (!has_frames && !read_place(root, &image, object->reason, sizeof object->reason))
        return;
    if (!read_scale(root, &image, object->reason, sizeof object->reason))
        return;
    note_bad_number(root, &image);
    image.has_stored = dicom_pixels_stored(file, &image.stored);
    uint64_t needed =
        (uint64_t)image.pixels.rows * image.pixels.columns * (image.pixels.bits_allocated / 8) * image.pixels.n_frames;
    if (image.has_stored && (image.stored.at > n_bytes || needed > n_bytes - image.stored.at)) {
        snprintf(object->reason, sizeof object->reason,
                 "cut short: its pixels need %llu bytes from byte %llu on, the file has %llu",
                 (unsigned long long)needed, (unsigned long long)image.stored.at, (unsigned long long)n_bytes);
        return;
    }
    object->kind = DICOM_KIND_IMAGE;
    object->image = mem_new(sizeof *object->image);
    *object->image = image;
}

static const struct dicom_item *first_item(const struct dicom_item *item, uint32_t tag)
{
    return item ? dicom_item_at(item, tag, 0) : NULL;
}

/* Reads the references of an RTSTRUCT, RTDOSE, RTPLAN or segmentation. Source: DICOM PS3.3 C.8.8.5, C.8.8.3,
 * C.8.8.9. */
static void read_references(const struct dicom_item *root, struct dicom_object *object)
{
    const struct dicom_item *frame = first_item(root, DICOM_TAG(0x3006, 0x0010));
    const struct dicom_item *series =
        first_item(first_item(frame, DICOM_TAG(0x3006, 0x0012)), DICOM_TAG(0x3006, 0x0014));
    if (object->kind == DICOM_KIND_STRUCT && frame && !object->frame_of_reference[0])
        (void)dicom_text(frame, TAG_FRAME_OF_REFERENCE, object->frame_of_reference, DICOM_UID_SIZE);
    if (series)
        (void)dicom_text(series, TAG_SERIES, object->referenced_series, DICOM_UID_SIZE);
    const struct dicom_item *drawn_on = first_item(root, DICOM_TAG(0x0008, 0x1115));
    if (object->kind == DICOM_KIND_SEGMENTATION && drawn_on)
        (void)dicom_text(drawn_on, TAG_SERIES, object->referenced_series, DICOM_UID_SIZE);
    const struct dicom_item *plan = first_item(root, DICOM_TAG(0x300C, 0x0002));
    const struct dicom_item *structs = first_item(root, DICOM_TAG(0x300C, 0x0060));
    if (plan)
        (void)dicom_text(plan, TAG_REFERENCED_SOP_INSTANCE, object->referenced_plan, DICOM_UID_SIZE);
    if (structs)
        (void)dicom_text(structs, TAG_REFERENCED_SOP_INSTANCE, object->referenced_struct, DICOM_UID_SIZE);
    if (object->kind == DICOM_KIND_STRUCT)
        (void)dicom_text(root, DICOM_TAG(0x3006, 0x0002), object->label, DICOM_TEXT_SIZE);
    if (object->kind == DICOM_KIND_PLAN)
        (void)dicom_text(root, DICOM_TAG(0x300A, 0x0002), object->label, DICOM_TEXT_SIZE);
}

static void read_identity(const struct dicom_file *file, struct dicom_object *object)
{
    const struct dicom_item *root = dicom_root(file);
    (void)dicom_text(root, TAG_SOP_CLASS, object->sop_class, DICOM_UID_SIZE);
    (void)dicom_text(root, TAG_SOP_INSTANCE, object->sop_instance, DICOM_UID_SIZE);
    (void)dicom_text(root, TAG_SERIES, object->series, DICOM_UID_SIZE);
    (void)dicom_text(root, TAG_STUDY, object->study, DICOM_UID_SIZE);
    (void)dicom_text(root, TAG_FRAME_OF_REFERENCE, object->frame_of_reference, DICOM_UID_SIZE);
    (void)dicom_text(root, TAG_MODALITY, object->modality, sizeof object->modality);
    (void)dicom_text(root, TAG_SERIES_DESCRIPTION, object->description, DICOM_TEXT_SIZE);
    free(object->named);
    object->named = dicom_patient_read(root);
    snprintf(object->transfer_syntax, sizeof object->transfer_syntax, "%s", dicom_transfer_syntax(file));
}

/* Without a known SOP class the modality decides the kind. */
static enum dicom_kind kind_of(const struct dicom_object *object, const char **name)
{
    static const struct {
        const char *modality;
        enum dicom_kind kind;
    } modalities[] = { { "RTSTRUCT", DICOM_KIND_STRUCT },
                       { "RTDOSE", DICOM_KIND_DOSE },
                       { "RTPLAN", DICOM_KIND_PLAN } };
    enum dicom_kind kind = DICOM_KIND_IMAGE;
    *name = known_class(object->sop_class, &kind);
    for (size_t i = 0; !*name && i < sizeof modalities / sizeof modalities[0]; i++)
        if (strcmp(object->modality, modalities[i].modality) == 0)
            kind = modalities[i].kind;
    return kind;
}

static bool grow(struct bytes *scratch, size_t size, const char *path, struct error *err)
{
    if (scratch->size >= size)
        return true;
    free(scratch->data);
    scratch->data = malloc(size);
    scratch->size = scratch->data ? size : 0;
    return scratch->data ? true : error_set(err, ERROR_MEMORY, "%s: no memory for %zu bytes", path, size);
}

static enum dicom_head_result refuse_foreign(const uint8_t *data, size_t n, const char *path, struct error *err)
{
    char found[16] = "";
    for (size_t i = 0; i < n && i < 4; i++)
        (void)snprintf(found + 3 * i, sizeof found - 3 * i, " %02x", data[i]);
    (void)error_set(err, ERROR_FORMAT,
                    "%s: byte 0: expected \"DICM\" at byte 128, or an element of group 0002 or 0008 here; found%s",
                    path, n > 0 ? found : " an empty file");
    return DICOM_HEAD_FOREIGN;
}

static enum dicom_head_result describe(const struct dicom_file *file, uint64_t n_bytes, struct dicom_object *object)
{
    const char *name;
    object->kind = kind_of(object, &name);
    if (strcmp(object->sop_class, "1.2.840.10008.1.3.10") == 0 ||
        dicom_has(dicom_root(file), DICOM_TAG(0x0004, 0x1220)))
        return DICOM_HEAD_DIRECTORY;
    if (object->kind == DICOM_KIND_IMAGE)
        read_image(file, n_bytes, object);
    else if (object->kind == DICOM_KIND_OTHER)
        snprintf(object->reason, sizeof object->reason, "it is a %s (%.60s)", name, dicom_uid_word(object->sop_class));
    else
        read_references(dicom_root(file), object);
    return DICOM_HEAD_READ;
}

enum dicom_head_result dicom_head_read(const struct folder *folder, const char *path, struct dicom_object *object,
                                       struct bytes *scratch, struct error *err)
{
    /* Most heads end within the first step. Private elements of some vendors, and tables of frames, need more. */
    static const uint64_t steps[] = { 1 << 14, 1 << 18, 1 << 22, 1 << 26, (uint64_t)DICOM_MAX_FILE_MIB << 20 };
    *object = (struct dicom_object){ 0 };
    struct folder_part part;
    if (!folder_open_part(folder, path, &part, err))
        return DICOM_HEAD_BROKEN;
    enum dicom_head_result result = DICOM_HEAD_BROKEN;
    struct dicom_file *file = NULL;
    for (size_t step = 0; step < sizeof steps / sizeof steps[0]; step++) {
        size_t n = part.n_bytes < steps[step] ? (size_t)part.n_bytes : (size_t)steps[step];
        if (!grow(scratch, n, path, err) || !folder_read_part(&part, path, 0, scratch->data, n, err))
            break;
        if (!dicom_looks_like(scratch->data, n)) {
            result = refuse_foreign(scratch->data, n, path, err);
            break;
        }
        dicom_file_destroy(file);
        bool is_all = n == part.n_bytes; /* only a second parse, of the whole file, tells what is wrong with it */
        file = dicom_file_parse(scratch->data, n, path, is_all && step > 0 ? DICOM_HEAD : DICOM_START, err);
        if (!file)
            break;
        const char *name;
        read_identity(file, object);
        object->n_bytes = part.n_bytes;
        /* of a plan or dose the first step is enough: its references come early, and the whole file is read later */
        bool is_enough = !dicom_is_cut(file) || (step > 0 && kind_of(object, &name) != DICOM_KIND_IMAGE);
        if (is_enough) {
            result = describe(file, part.n_bytes, object);
            break;
        }
        if (is_all && step > 0) {
            error_set(err, ERROR_FORMAT, "%s: cut short", path);
            break;
        }
    }
    dicom_file_destroy(file);
    folder_close_part(&part);
    return result;
}

void dicom_object_finish(struct dicom_object *object)
{
    free(object->path);
    free(object->image);
    free(object->named);
    *object = (struct dicom_object){ 0 };
}

/* Writes folders of slices and scans them. */
#include "tests/unit/made_series.h"

#include "tests/check.h"
#include "tests/unit/data_folder.h"

const struct made_slice made_slice_defaults = {
    .transfer_syntax = MADE_EXPLICIT,
    .series = "1.2.3",
    .modality = "CT",
    .description = "made up",
    .color = "MONOCHROME2",
    .image_type = "ORIGINAL\\PRIMARY\\AXIAL",
    .frame_of_reference = "1.2.9",
    .cosines = { 1, 0, 0, 0, 1, 0 },
    .spacing = { 1, 1 },
    .thickness = 0,
    .number = 1,
    .rows = 2,
    .columns = 3,
    .bits = 16,
    .stored = 16,
    .is_signed = 1,
};

void made_number(struct made_dicom *made, uint32_t tag, const char *vr, const double *values, int n)
{
    char text[256];
    int at = 0;
    for (int i = 0; i < n; i++)
        at += snprintf(text + at, sizeof text - (size_t)at, "%s%.15g", i ? "\\" : "", values[i]);
    made_text(made, tag, vr, text);
}

static void put_pixels(struct made_dicom *made, const struct made_slice *slice)
{
    size_t n = (size_t)(slice->rows * slice->columns), bytes = n * (size_t)slice->bits / 8;
    made_head(made, DICOM_TAG(0x7FE0, 0x0010), slice->bits == 8 ? "OB" : "OW", (uint32_t)(bytes + bytes % 2));
    for (int y = 0; y < slice->rows; y++)
        for (int x = 0; x < slice->columns; x++) {
            int value = slice->base + 10 * y + x;
            uint16_t cell = (uint16_t)(value & ((1 << (slice->stored < 16 ? slice->stored : 16)) - 1));
            if (slice->bits == 8)
                made_raw(made, (uint8_t[]){ (uint8_t)value }, 1);
            else
                made_words(made, &cell, 1);
            if (slice->bits == 32)
                made_words(made, (uint16_t[]){ value < 0 ? 0xFFFF : 0 }, 1);
        }
    if (bytes % 2)
        made_raw(made, "", 1);
}

void made_slice_bytes(struct made_dicom *made, const struct made_slice *slice)
{
    char uid[64], number[16];
    snprintf(uid, sizeof uid, "%s.%d.%d", slice->series, slice->number, (int)(1000 * slice->position[2] + 500000));
    made_begin(made, slice->transfer_syntax);
    made_text(made, DICOM_TAG(0x0008, 0x0008), "CS", slice->image_type);
    made_text(made, DICOM_TAG(0x0008, 0x0016), "UI", "1.2.840.10008.5.1.4.1.1.2");
    made_text(made, DICOM_TAG(0x0008, 0x0018), "UI", slice->instance_uid ? slice->instance_uid : uid);
    made_text(made, DICOM_TAG(0x0008, 0x0060), "CS", slice->modality);
    made_text(made, DICOM_TAG(0x0008, 0x103E), "LO", slice->description);
    made_text(made, DICOM_TAG(0x0010, 0x0010), "PN", slice->patient_name ? slice->patient_name : "SECRET^NAME");
    if (slice->patient_id)
        made_text(made, DICOM_TAG(0x0010, 0x0020), "LO", slice->patient_id);
    if (slice->birth_date)
        made_text(made, DICOM_TAG(0x0010, 0x0030), "DA", slice->birth_date);
    if (slice->thickness > 0)
        made_number(made, DICOM_TAG(0x0018, 0x0050), "DS", &slice->thickness, 1);
    if (slice->echo > 0)
        made_number(made, DICOM_TAG(0x0018, 0x0086), "IS", &(double){ slice->echo }, 1);
    made_text(made, DICOM_TAG(0x0020, 0x000D), "UI", slice->study ? slice->study : "1.2.1");
    made_text(made, DICOM_TAG(0x0020, 0x000E), "UI", slice->series);
    snprintf(number, sizeof number, "%d", slice->number);
    made_text(made, DICOM_TAG(0x0020, 0x0013), "IS", number);
    made_number(made, DICOM_TAG(0x0020, 0x0032), "DS", slice->position, 3);
    made_number(made, DICOM_TAG(0x0020, 0x0037), "DS", slice->cosines, 6);
    made_text(made, DICOM_TAG(0x0020, 0x0052), "UI", slice->frame_of_reference);
    made_u16(made, DICOM_TAG(0x0028, 0x0002), 1);
    made_text(made, DICOM_TAG(0x0028, 0x0004), "CS", slice->color);
    made_u16(made, DICOM_TAG(0x0028, 0x0010), (uint16_t)slice->rows);
    made_u16(made, DICOM_TAG(0x0028, 0x0011), (uint16_t)slice->columns);
    made_number(made, DICOM_TAG(0x0028, 0x0030), "DS", slice->spacing, 2);
    made_u16(made, DICOM_TAG(0x0028, 0x0100), (uint16_t)slice->bits);
    made_u16(made, DICOM_TAG(0x0028, 0x0101), (uint16_t)slice->stored);
    made_u16(made, DICOM_TAG(0x0028, 0x0102), (uint16_t)(slice->stored - 1));
    made_u16(made, DICOM_TAG(0x0028, 0x0103), (uint16_t)slice->is_signed);
    for (int i = 0; i < slice->n_padding; i++)
        made_u16(made, DICOM_TAG(0x0028, 0x0120 + i), (uint16_t)slice->padding[i]);
    if (slice->has_rescale) {
        made_number(made, DICOM_TAG(0x0028, 0x1052), "DS", &slice->offset, 1);
        made_number(made, DICOM_TAG(0x0028, 0x1053), "DS", &slice->slope, 1);
    }
    put_pixels(made, slice);
}

void made_slice_put(const char *folder, const char *name, const struct made_slice *slice)
{
    struct made_dicom made;
    made_slice_bytes(&made, slice);
    folder_put(folder, name, made.data, made.size);
    made_finish(&made);
}

void scanned_open(struct scanned *scanned)
{
    struct error err = { 0 };
    assert_true(folder_open(&scanned->folder, scanned->path, &err));
    scanned->report = (struct report){ 0 };
    scanned->index = dicom_index_scan(&scanned->folder, NULL, 0, NULL, &scanned->report, &err);
    assert_string_equal(err.text, "");
    assert_non_null(scanned->index);
}

void scanned_finish(struct scanned *scanned)
{
    for (size_t i = 0; i < scanned->report.n_lines; i++) { /* the report never contains a person's name */
        assert_null(strstr(scanned->report.lines[i].sentence, "SECRET"));
        assert_null(strstr(scanned->report.lines[i].where, "SECRET"));
    }
    dicom_index_destroy(scanned->index);
    report_finish(&scanned->report);
    folder_close(&scanned->folder);
    if (!scanned->is_kept)
        folder_remove(scanned->path);
}

struct volume *scanned_read(struct scanned *scanned, size_t stack)
{
    struct error err = { 0 };
    assert_true(stack < scanned->index->n_stacks);
    struct volume *volume =
        dicom_series_read(&scanned->folder, scanned->index, stack, NULL, NULL, &scanned->report, &err);
    assert_string_equal(err.text, "");
    assert_non_null(volume);
    return volume;
}

const struct report_line *scanned_said(const struct scanned *scanned, const char *code)
{
    for (size_t i = 0; i < scanned->report.n_lines; i++)
        if (strcmp(scanned->report.lines[i].code, code) == 0)
            return &scanned->report.lines[i];
    return NULL;
}

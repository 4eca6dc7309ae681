/* Scanning folders for DICOM: kinds, references, stacks, duplicates, and files that are not DICOM. */
#include <sys/stat.h>

#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/made_dose.h"
#include "tests/unit/made_series.h"

static const struct dicom_object *object_named(const struct scanned *s, const char *path)
{
    for (size_t i = 0; i < s->index->n_objects; i++)
        if (strcmp(s->index->objects[i].path, path) == 0)
            return &s->index->objects[i];
    fail_msg("no object %s", path);
    return NULL;
}

static void files_of_other_kinds_are_passed_over(void **state)
{
    (void)state;
    struct scanned s = { 0 };
    folder_make(s.path);
    static uint8_t zeros[5000];
    made_slice_put(s.path, "slice without an ending", &made_slice_defaults);
    folder_put(s.path, "empty.dcm", "", 0);
    folder_put(s.path, "notes.txt", "DICM is a word in this text", 27);
    folder_put(s.path, "zeros", zeros, sizeof zeros);
    /* like an element, but with an impossible length */
    folder_put(s.path, "0800.bin", "\x08\x00\x05\x00\xFF\xFF\xFF\xFFxxxxxxxxxxxx", 20);
    folder_put(s.path, ".hidden", "DICM", 4);
    scanned_open(&s);
    assert_int_equal(s.index->n_files, 5);
    assert_int_equal(s.index->n_foreign, 4);
    assert_int_equal(s.index->n_objects, 1);
    assert_int_equal(s.index->n_stacks, 1);
    assert_int_equal(s.report.n_lines, 1); /* only a file whose name says DICOM gets a report line */
    assert_string_equal(s.report.lines[0].where, "empty.dcm");
    assert_non_null(strstr(s.report.lines[0].sentence, "Named like DICOM"));
    assert_non_null(strstr(s.report.lines[0].sentence, "found an empty file"));
    scanned_finish(&s);
}

static void folders_in_folders_are_entered_and_named_parts_alone_are_read(void **state)
{
    (void)state;
    struct scanned s = { 0 };
    folder_make(s.path);
    struct made_slice slice = made_slice_defaults;
    for (int k = 0; k < 4; k++) {
        char name[32];
        slice.position[2] = k;
        slice.number = k;
        slice.series = k < 2 ? "1.2.3" : "1.2.4";
        snprintf(name, sizeof name, "%s/IM%d", k < 2 ? "a" : "b", k);
        made_slice_put(s.path, name, &slice);
    }
    scanned_open(&s);
    assert_int_equal(s.index->n_objects, 4);
    assert_int_equal(s.index->n_stacks, 2);
    assert_string_equal(s.index->objects[0].path, "a/IM0");
    struct error err = { 0 };
    char *names[] = { (char[]){ "b" }, (char[]){ "a/IM1" }, (char[]){ "b/IM2" } };
    struct dicom_index *index = dicom_index_scan(&s.folder, names, 3, NULL, NULL, &err);
    assert_non_null(index);
    assert_int_equal(index->n_objects, 3); /* one is named twice */
    assert_string_equal(index->objects[0].path, "a/IM1");
    dicom_index_destroy(index);
    char *none[] = { (char[]){ "c" } };
    assert_null(dicom_index_scan(&s.folder, none, 1, NULL, NULL, &err));
    assert_true(err.code == ERROR_IO || err.code == ERROR_NOT_FOUND);
    scanned_finish(&s);
}

static void a_file_without_preamble_and_without_header_is_found(void **state)
{
    (void)state;
    static const char *const encodings[] = { NULL, MADE_IMPLICIT, MADE_BIG_ENDIAN, MADE_EXPLICIT };
    for (size_t e = 0; e < 4; e++) {
        struct scanned s = { 0 };
        folder_make(s.path);
        struct made_slice slice = made_slice_defaults;
        slice.transfer_syntax = encodings[e];
        struct made_dicom made;
        made_slice_bytes(&made, &slice);
        size_t skip_bytes = encodings[e] ? 132 + 12 + 8 + (strlen(encodings[e]) + 1) / 2 * 2
                                         : 0; /* preamble, group length, transfer syntax */
        folder_put(s.path, "bare", made.data + skip_bytes, made.size - skip_bytes);
        folder_put(s.path, "no-preamble", made.data + (encodings[e] ? 132 : 0), made.size - (encodings[e] ? 132 : 0));
        made_finish(&made);
        scanned_open(&s);
        assert_int_equal(s.index->n_objects, 2);
        assert_int_equal(s.index->n_stacks, 1); /* the other one is a copy */
        struct volume *volume = scanned_read(&s, 0);
        assert_close(volume_value(volume, 2, 1, 0), 12, 0);
        volume_unref(volume);
        scanned_finish(&s);
    }
}

static void put_object(const char *folder, const char *name, const char *sop_class, const char *modality,
                       const char *instance, void (*more)(struct made_dicom *made))
{
    struct made_dicom made;
    made_begin(&made, MADE_EXPLICIT);
    made_text(&made, DICOM_TAG(0x0008, 0x0005), "CS", "ISO_IR 100");
    if (sop_class)
        made_text(&made, DICOM_TAG(0x0008, 0x0016), "UI", sop_class);
    made_text(&made, DICOM_TAG(0x0008, 0x0018), "UI", instance);
    made_text(&made, DICOM_TAG(0x0008, 0x0060), "CS", modality);
    made_text(&made, DICOM_TAG(0x0010, 0x0010), "PN", "SECRET^NAME");
    if (more)
        more(&made);
    folder_put(folder, name, made.data, made.size);
    made_finish(&made);
}

static void reference(struct made_dicom *made, uint32_t tag, const char *instance)
{
    made_sequence(made, tag);
    made_item(made);
    made_text(made, DICOM_TAG(0x0008, 0x1155), "UI", instance);
    made_item_end(made);
    made_sequence_end(made);
}

static void more_of_struct(struct made_dicom *made)
{
    made_text(made, DICOM_TAG(0x3006, 0x0002), "SH", "Plan f\xFCr heute");
    made_sequence(made, DICOM_TAG(0x3006, 0x0010));
    made_item(made);
    made_text(made, DICOM_TAG(0x0020, 0x0052), "UI", "1.2.9");
    made_sequence(made, DICOM_TAG(0x3006, 0x0012));
    made_item(made);
    made_sequence(made, DICOM_TAG(0x3006, 0x0014));
    made_item(made);
    made_text(made, DICOM_TAG(0x0020, 0x000E), "UI", "1.2.3");
    made_item_end(made);
    made_sequence_end(made);
    made_item_end(made);
    made_sequence_end(made);
    made_item_end(made);
    made_sequence_end(made);
}

static void more_of_dose(struct made_dicom *made)
{
    reference(made, DICOM_TAG(0x300C, 0x0002), "1.2.3.20");
    reference(made, DICOM_TAG(0x300C, 0x0060), "1.2.3.10");
}

static void more_of_plan(struct made_dicom *made)
{
    made_text(made, DICOM_TAG(0x300A, 0x0002), "SH", "BNCT 1");
    reference(made, DICOM_TAG(0x300C, 0x0060), "1.2.3.10");
}

static void structures_doses_and_plans_are_told_with_what_they_refer_to(void **state)
{
    (void)state;
    struct scanned s = { 0 };
    folder_make(s.path);
    put_object(s.path, "rs", "1.2.840.10008.5.1.4.1.1.481.3", "RTSTRUCT", "1.2.3.10", more_of_struct);
    put_object(s.path, "rd", "1.2.840.10008.5.1.4.1.1.481.2", "RTDOSE", "1.2.3.30", more_of_dose);
    put_object(s.path, "rp", NULL, "RTPLAN", "1.2.3.20", more_of_plan); /* by its modality */
    put_object(s.path, "sr", "1.2.840.10008.5.1.4.1.1.88.11", "SR", "1.2.3.40", NULL);
    put_object(s.path, "xx", "1.2.840.10008.5.1.4.1.1.9999", "XX", "1.2.3.50", NULL);
    put_object(s.path, "DICOMDIR", "1.2.840.10008.1.3.10", "", "1.2.3.60", NULL);
    scanned_open(&s);
    assert_int_equal(s.index->n_objects, 5);
    const struct dicom_object *structs = object_named(&s, "rs"), *dose = object_named(&s, "rd"),
                              *plan = object_named(&s, "rp");
    assert_int_equal(structs->kind, DICOM_KIND_STRUCT);
    assert_string_equal(structs->label, "Plan f\xC3\xBCr heute");
    assert_string_equal(structs->frame_of_reference, "1.2.9");
    assert_string_equal(structs->referenced_series, "1.2.3");
    assert_int_equal(dose->kind, DICOM_KIND_DOSE);
    assert_string_equal(dose->referenced_plan, "1.2.3.20");
    assert_string_equal(dose->referenced_struct, "1.2.3.10");
    assert_int_equal(plan->kind, DICOM_KIND_PLAN);
    assert_string_equal(plan->label, "BNCT 1");
    assert_ptr_equal(dicom_index_find(s.index, dose->referenced_plan), plan);
    assert_null(dicom_index_find(s.index, ""));
    assert_int_equal(object_named(&s, "sr")->kind, DICOM_KIND_OTHER);
    assert_string_equal(object_named(&s, "sr")->reason, "it is a report (BasicTextSRStorage)");
    assert_non_null(strstr(object_named(&s, "xx")->reason, "object of class 1.2.840.10008.5.1.4.1.1.9999"));
    assert_non_null(scanned_said(&s, "dicom.not-used"));
    assert_null(scanned_said(&s, "dicom.unreadable"));
    scanned_finish(&s);
}

static void copies_are_used_once_and_slices_at_one_place_too(void **state)
{
    (void)state;
    struct scanned s = { 0 };
    folder_make(s.path);
    struct made_slice slice = made_slice_defaults;
    for (int k = 0; k < 3; k++) {
        char name[32];
        slice.position[2] = 2 * k;
        slice.base = 100 * k;
        snprintf(name, sizeof name, "a%d", k);
        made_slice_put(s.path, name, &slice);
        snprintf(name, sizeof name, "b%d", k); /* the same object under another name */
        made_slice_put(s.path, name, &slice);
    }
    slice.number = 7; /* another object at the position of the last one */
    slice.base = 999;
    made_slice_put(s.path, "a7", &slice);
    scanned_open(&s);
    const struct report_line *line = scanned_said(&s, "dicom.duplicate");
    assert_non_null(line);
    assert_non_null(strstr(line->sentence, "3 objects are there more than once"));
    assert_string_equal(line->where, "b0");
    line = scanned_said(&s, "image.slices-repeated");
    assert_non_null(line);
    assert_non_null(strstr(line->sentence, "1 of 4 slices"));
    struct volume *volume = scanned_read(&s, 0);
    assert_int_equal(volume->grid.size[2], 3);
    assert_close(volume_value(volume, 0, 0, 2), 200, 0); /* number 1, not 7 */
    volume_unref(volume);
    scanned_finish(&s);
}

/* Three doses of one UID: a, a copy of it with another description, and one with another voxel. */
static void one_number_given_to_other_values_drops_none(void **state)
{
    (void)state;
    struct scanned s = { 0 };
    folder_make(s.path);
    for (int i = 0; i < 12; i++) {
        struct made_dicom made;
        made_dose_begin(&made, 1);
        if (i == 1) /* compares equal: another word for the same dose */
            made_text(&made, DICOM_TAG(0x3004, 0x0012), "CS", "NONE");
        made_dose_end(&made, 1);
        if (i == 2)
            made.data[made.size - 1] ^= 1;
        char name[8];
        snprintf(name, sizeof name, "%02d", i);
        folder_put(s.path, name, made.data, made.size);
        made_finish(&made);
    }
    scanned_open(&s);
    size_t n_doses = 0;
    for (size_t i = 0; i < s.index->n_objects; i++)
        n_doses += s.index->objects[i].kind == DICOM_KIND_DOSE;
    assert_int_equal(n_doses, 2);
    assert_non_null(strstr(scanned_said(&s, "dicom.duplicate")->sentence, "10 objects are there more than once"));
    const struct report_line *line = scanned_said(&s, "dicom.same-uid");
    assert_non_null(line);
    assert_string_equal(line->where, "02");
    scanned_finish(&s);
}

/* Two slices of one place and number, but with other pixels, are no copies either. */
static void a_slice_with_other_pixels_is_no_copy(void **state)
{
    (void)state;
    struct scanned s = { 0 };
    folder_make(s.path);
    struct made_slice slice = made_slice_defaults;
    slice.instance_uid = "1.2.3.4.5";
    made_slice_put(s.path, "a", &slice);
    slice.base += 1;
    made_slice_put(s.path, "b", &slice);
    scanned_open(&s);
    assert_null(scanned_said(&s, "dicom.duplicate"));
    assert_non_null(scanned_said(&s, "dicom.same-uid"));
    scanned_finish(&s);
}

static void one_number_given_to_different_slices_by_mistake_drops_none(void **state)
{
    (void)state;
    struct scanned s = { 0 };
    folder_make(s.path);
    struct made_slice slice = made_slice_defaults;
    slice.instance_uid = "1.2.3.4.5";
    for (int k = 0; k < 3; k++) {
        char name[32];
        slice.position[2] = 2 * k;
        snprintf(name, sizeof name, "a%d", k);
        made_slice_put(s.path, name, &slice);
    }
    scanned_open(&s);
    assert_int_equal(s.index->stacks[0].n_slices, 3);
    assert_null(scanned_said(&s, "dicom.duplicate"));
    scanned_finish(&s);
}

static void mixed_pictures_become_a_stack_for_each_series_size_and_orientation(void **state)
{
    (void)state;
    struct scanned s = { 0 };
    folder_make(s.path);
    for (int k = 0; k < 5; k++) {
        char name[32];
        struct made_slice slice = made_slice_defaults;
        slice.number = k;
        slice.position[2] = k;
        snprintf(name, sizeof name, "%d-a", k);
        made_slice_put(s.path, name, &slice);
        slice.series = "1.2.4"; /* another series */
        slice.modality = "MR";
        snprintf(name, sizeof name, "%d-b", k);
        if (k < 4)
            made_slice_put(s.path, name, &slice);
        slice = made_slice_defaults; /* the first series again, coronal */
        slice.number = 10 + k;
        memcpy(slice.cosines, (double[]){ 1, 0, 0, 0, 0, -1 }, sizeof slice.cosines);
        slice.position[1] = k;
        snprintf(name, sizeof name, "%d-c", k);
        if (k < 3)
            made_slice_put(s.path, name, &slice);
        slice = made_slice_defaults; /* and of another size */
        slice.number = 20 + k;
        slice.columns = 4;
        slice.position[2] = k;
        snprintf(name, sizeof name, "%d-d", k);
        if (k < 2)
            made_slice_put(s.path, name, &slice);
    }
    scanned_open(&s);
    assert_int_equal(s.index->n_stacks, 4);
    static const uint32_t slices[] = { 5, 4, 3, 2 };
    for (size_t i = 0; i < 4; i++) {
        assert_int_equal(s.index->stacks[i].n_slices, slices[i]);
        struct volume *volume = scanned_read(&s, i);
        assert_int_equal(volume->grid.size[2], slices[i]);
        assert_int_equal(volume->grid.size[0], i == 3 ? 4 : 3);
        volume_unref(volume);
    }
    assert_string_equal(s.index->stacks[0].description, "made up (1 of 3)");
    assert_string_equal(s.index->stacks[1].description, "made up");
    assert_string_equal(s.index->stacks[1].modality, "MR");
    assert_non_null(scanned_said(&s, "image.split"));
    scanned_finish(&s);
}

static void echoes_and_passes_at_the_same_places_become_stacks_of_their_own(void **state)
{
    (void)state;
    for (int has_echoes = 0; has_echoes < 2; has_echoes++) {
        struct scanned s = { 0 };
        folder_make(s.path);
        struct made_slice slice = made_slice_defaults;
        for (int k = 0; k < 6; k++) {
            char name[32];
            slice.position[2] = k % 3;
            slice.number = k;
            slice.echo = has_echoes ? 1 + k / 3 : 0;
            slice.base = 100 * k;
            snprintf(name, sizeof name, "%d", 9 - k);
            made_slice_put(s.path, name, &slice);
        }
        scanned_open(&s);
        assert_int_equal(s.index->n_stacks, 2);
        bool has_found[2] = { false };
        for (size_t i = 0; i < 2; i++) {
            struct volume *volume = scanned_read(&s, i);
            int pass = volume_value(volume, 0, 0, 0) == 300;
            has_found[pass] = true;
            for (uint32_t k = 0; k < 3; k++)
                assert_close(volume_value(volume, 0, 0, k), 300.0 * pass + 100 * k, 0);
            const char *expected = has_echoes ? pass ? "made up (echo 2)" : "made up (echo 1)"
                                   : pass     ? "made up (pass 2)"
                                              : "made up (pass 1)";
            assert_string_equal(s.index->stacks[i].description, expected);
            volume_unref(volume);
        }
        assert_true(has_found[0] && has_found[1]);
        assert_non_null(scanned_said(&s, "image.split"));
        scanned_finish(&s);
    }
}

static void pictures_that_cannot_be_used_say_why(void **state)
{
    (void)state;
    struct scanned s = { 0 };
    folder_make(s.path);
    struct made_slice slice = made_slice_defaults;
    slice.image_type = "ORIGINAL\\PRIMARY\\LOCALIZER";
    made_slice_put(s.path, "localizer", &slice);
    slice.number = 8;
    slice.image_type = "ORIGINAL\\PRIMARY\\M\\ND\\MOSAIC";
    made_slice_put(s.path, "mosaic", &slice);
    slice = made_slice_defaults;
    slice.number = 2;
    slice.color = "PALETTE COLOR";
    made_slice_put(s.path, "color", &slice);
    slice = made_slice_defaults;
    slice.number = 3;
    slice.spacing[0] = 0;
    made_slice_put(s.path, "spacing", &slice);
    slice = made_slice_defaults;
    slice.number = 4;
    memset(slice.cosines, 0, sizeof slice.cosines);
    made_slice_put(s.path, "flat", &slice);
    slice = made_slice_defaults;
    slice.number = 5;
    slice.position[1] = NAN;
    made_slice_put(s.path, "nowhere", &slice);
    slice = made_slice_defaults;
    slice.number = 6;
    slice.transfer_syntax = "1.2.840.10008.1.2.4.92"; /* part 2 of JPEG 2000 */
    made_slice_put(s.path, "length", &slice);
    struct made_dicom made; /* pixels in fragments of an unsupported encoding */
    made_slice_bytes(&made, &slice);
    made.size -= 12 + 12; /* without its pixels */
    made_head(&made, DICOM_TAG(0x7FE0, 0x0010), "OB", UINT32_MAX);
    made_head(&made, DICOM_TAG(0xFFFE, 0xE000), "", 0);
    made_head(&made, DICOM_TAG(0xFFFE, 0xE000), "", 4);
    made_raw(&made, "\xFF\x4F\xFF\x51", 4);
    made_sequence_end(&made);
    folder_put(s.path, "encoding", made.data, made.size);
    folder_put(s.path, "cut", made.data, 400);
    made_finish(&made);
    scanned_open(&s);
    assert_int_equal(s.index->n_stacks, 0);
    static const struct {
        const char *path, *words;
    } cases[] = { { "localizer", "it is a localizer" },
                  { "mosaic", "it is a mosaic of many slices" },
                  { "color", "it is a colour picture (PALETTE COLOR" },
                  { "spacing", "pixel spacing (0028,0030): expected numbers above 0, found 0\\1" },
                  { "nowhere", "position (0020,0032): expected 3 numbers up to 1e+06, found \"0\\nan\\0\"" },
                  { "length", "where the transfer syntax (JPEG 2000" },
                  { "encoding", "its pixels are encoded as JPEG 2000" } };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const struct dicom_object *object = object_named(&s, cases[i].path);
        if (object->kind != DICOM_KIND_OTHER || !strstr(object->reason, cases[i].words))
            fail_msg("%s: \"%s\" does not say \"%s\"", cases[i].path, object->reason, cases[i].words);
    }
    bool is_flat_said = false, is_cut_said = false;
    for (size_t i = 0; i < s.report.n_lines; i++) {
        const struct report_line *line = &s.report.lines[i];
        is_flat_said =
            is_flat_said || (strcmp(line->where, "flat") == 0 && strstr(line->sentence, "do not span a plane"));
        is_cut_said = is_cut_said || (strcmp(line->where, "cut") == 0 && strcmp(line->code, "dicom.unreadable") == 0);
    }
    assert_true(is_flat_said);
    assert_true(is_cut_said);
    scanned_finish(&s);
}

static void put_unread(const char *folder, const char *name, const char *sop_class, const char *modality, int number)
{
    struct made_dicom made;
    char uid[32];
    snprintf(uid, sizeof uid, "1.2.3.%d", number);
    made_begin(&made, MADE_EXPLICIT);
    made_text(&made, DICOM_TAG(0x0008, 0x0016), "UI", sop_class);
    made_text(&made, DICOM_TAG(0x0008, 0x0018), "UI", uid);
    made_text(&made, DICOM_TAG(0x0008, 0x0060), "CS", modality);
    folder_put(folder, name, made.data, made.size);
    made_finish(&made);
}

static void objects_that_are_not_read_are_warned_of_by_name_and_number(void **state)
{
    (void)state;
    struct scanned s = { 0 };
    folder_make(s.path);
    put_unread(s.path, "i1", "1.2.840.10008.5.1.4.1.1.481.1", "RTIMAGE", 1);
    put_unread(s.path, "i2", "1.2.840.10008.5.1.4.1.1.481.1", "RTIMAGE", 2);
    put_unread(s.path, "i3", "1.2.840.10008.5.1.4.1.1.481.1", "RTIMAGE", 3);
    put_unread(s.path, "record", "1.2.840.10008.5.1.4.1.1.481.4", "RTRECORD", 4);
    put_unread(s.path, "report", "1.2.840.10008.5.1.4.1.1.88.67", "SR", 5);
    put_unread(s.path, "shown", "1.2.840.10008.5.1.4.1.1.11.1", "PR", 6);
    put_unread(s.path, "capture", "1.2.840.10008.5.1.4.1.1.7", "OT", 7);
    put_unread(s.path, "waves", "1.2.840.10008.5.1.4.1.1.9.1.1", "ECG", 8);
    struct made_slice slice = made_slice_defaults; /* values by a lookup table: not applied, so not shown */
    struct made_dicom made;
    slice.color = "MONOCHROME2";
    made_slice_bytes(&made, &slice);
    size_t pixels = made.size - 12 - 12;
    uint8_t kept[24];
    memcpy(kept, made.data + pixels, sizeof kept);
    made.size = pixels;
    made_sequence(&made, DICOM_TAG(0x0028, 0x3000));
    made_item(&made);
    made_text(&made, DICOM_TAG(0x0028, 0x3004), "LO", "HU");
    made_item_end(&made);
    made_sequence_end(&made);
    made_raw(&made, kept, sizeof kept);
    folder_put(s.path, "table", made.data, made.size);
    made_finish(&made);
    scanned_open(&s);
    static const struct {
        const char *path, *words[2];
    } cases[] = { { "i1", { "3 objects are not used", "RTImageStorage" } },
                  { "record", { "treatment record", "RTBeamsTreatmentRecordStorage" } },
                  { "report", { "radiation dose report", "XRayRadiationDoseSRStorage" } },
                  { "shown", { "presentation state", "GrayscaleSoftcopy" } },
                  { "capture", { "screen capture", "SecondaryCaptureImageStorage" } },
                  { "waves", { "no picture", "TwelveLeadECGWaveformStorage" } },
                  { "table", { "Modality LUT", "(0028,3000)" } } };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const struct report_line *found = NULL;
        for (size_t l = 0; l < s.report.n_lines; l++)
            if (strcmp(s.report.lines[l].where, cases[i].path) == 0)
                found = &s.report.lines[l];
        if (!found)
            fail_msg("nothing is said of %s", cases[i].path);
        assert_int_equal(found->severity, REPORT_WARNING);
        assert_string_equal(found->code, "dicom.not-used");
        for (int w = 0; w < 2; w++)
            if (!strstr(found->sentence, cases[i].words[w]))
                fail_msg("\"%s\" does not say \"%s\"", found->sentence, cases[i].words[w]);
    }
    assert_int_equal(s.index->n_stacks, 0);
    scanned_finish(&s);
}

static void a_folder_of_unreadable_files_does_not_flood_the_report(void **state)
{
    (void)state;
    struct scanned s = { 0 };
    folder_make(s.path);
    struct made_dicom made;
    made_begin(&made, MADE_EXPLICIT);
    made_head(&made, DICOM_TAG(0x0008, 0x0008), "CS", 500);
    for (int i = 0; i < 60; i++) {
        char name[16];
        snprintf(name, sizeof name, "%d", i);
        folder_put(s.path, name, made.data, made.size);
    }
    made_finish(&made);
    scanned_open(&s);
    assert_int_equal(s.index->n_objects, 0);
    assert_int_equal(s.report.n_lines, 21);
    assert_non_null(strstr(s.report.lines[20].sentence, "40 more files"));
    assert_string_equal(s.report.lines[1].where, "1");
    assert_true(strncmp(s.report.lines[1].sentence, "byte ", 5) == 0); /* the report names the file once */
    scanned_finish(&s);
}

static void real_sets_hold_what_their_makers_say(void **state)
{
    (void)state;
    struct scanned s = { .is_kept = true };
    if (!data_path("dicomrt-oncentra-phantom", s.path, sizeof s.path))
        skip();
    scanned_open(&s); /* data/README.md: 5 CT, RTSTRUCT, RTPLAN, 4 RTDOSE, 6 RTIMAGE, and a licence */
    size_t n[DICOM_KIND_OTHER + 1] = { 0 };
    for (size_t i = 0; i < s.index->n_objects; i++)
        n[s.index->objects[i].kind]++;
    assert_int_equal(n[DICOM_KIND_IMAGE], 5);
    assert_int_equal(n[DICOM_KIND_STRUCT], 1);
    assert_int_equal(n[DICOM_KIND_PLAN], 1);
    assert_int_equal(n[DICOM_KIND_DOSE], 4);
    assert_int_equal(n[DICOM_KIND_OTHER], 6);
    assert_int_equal(s.index->n_foreign, 1);
    const struct dicom_object *dose = NULL;
    for (size_t i = 0; i < s.index->n_objects && !dose; i++)
        dose = s.index->objects[i].kind == DICOM_KIND_DOSE ? &s.index->objects[i] : NULL;
    const struct dicom_object *plan = dicom_index_find(s.index, dose->referenced_plan);
    assert_non_null(plan);
    assert_int_equal(plan->kind, DICOM_KIND_PLAN);
    assert_int_equal(dicom_index_find(s.index, plan->referenced_struct)->kind, DICOM_KIND_STRUCT);
    scanned_finish(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(files_of_other_kinds_are_passed_over),
        cmocka_unit_test(folders_in_folders_are_entered_and_named_parts_alone_are_read),
        cmocka_unit_test(a_file_without_preamble_and_without_header_is_found),
        cmocka_unit_test(structures_doses_and_plans_are_told_with_what_they_refer_to),
        cmocka_unit_test(copies_are_used_once_and_slices_at_one_place_too),
        cmocka_unit_test(one_number_given_to_other_values_drops_none),
        cmocka_unit_test(a_slice_with_other_pixels_is_no_copy),
        cmocka_unit_test(one_number_given_to_different_slices_by_mistake_drops_none),
        cmocka_unit_test(mixed_pictures_become_a_stack_for_each_series_size_and_orientation),
        cmocka_unit_test(echoes_and_passes_at_the_same_places_become_stacks_of_their_own),
        cmocka_unit_test(pictures_that_cannot_be_used_say_why),
        cmocka_unit_test(objects_that_are_not_read_are_warned_of_by_name_and_number),
        cmocka_unit_test(a_folder_of_unreadable_files_does_not_flood_the_report),
        cmocka_unit_test(real_sets_hold_what_their_makers_say),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

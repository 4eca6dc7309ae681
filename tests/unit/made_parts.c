/* Writes small DICOM plans. */
#include "tests/unit/made_parts.h"

#include <stdio.h>

#include "tests/unit/data_folder.h"
#include "tests/unit/rt_files.h"

#define TAG DICOM_TAG
#define CLASSES "1.2.840.10008.5.1.4.1.1."

static void put_text(struct made_dicom *made, uint32_t tag, const char *vr, const char *text)
{
    if (text)
        made_text(made, tag, vr, text);
}

static void begin(struct made_dicom *made, const struct made_owner *owner, const char *sop_class, const char *uid,
                  const char *modality, const char *date, const char *description)
{
    *made = (struct made_dicom){ 0 };
    made_begin(made, MADE_EXPLICIT);
    made_text(made, TAG(0x0008, 0x0005), "CS", "ISO_IR 192");
    put_text(made, TAG(0x0008, 0x0012), "DA", date);
    made_text(made, TAG(0x0008, 0x0016), "UI", sop_class);
    made_text(made, TAG(0x0008, 0x0018), "UI", uid);
    made_text(made, TAG(0x0008, 0x0060), "CS", modality);
    put_text(made, TAG(0x0008, 0x103e), "LO", description);
    put_text(made, TAG(0x0010, 0x0010), "PN", owner->name);
    put_text(made, TAG(0x0010, 0x0020), "LO", owner->id);
    put_text(made, TAG(0x0010, 0x0021), "LO", owner->issuer);
    put_text(made, TAG(0x0010, 0x0030), "DA", owner->birth_date);
    put_text(made, TAG(0x0020, 0x000d), "UI", owner->study);
    made_text(made, TAG(0x0020, 0x000e), "UI", "1.2.77");
}

static void end(struct made_dicom *made, const char *folder, const char *file)
{
    folder_put(folder, file, made->data, made->size);
    made_finish(made);
}

static void refer(struct made_dicom *made, uint32_t sequence, const char *sop_class, const char *uid)
{
    made_sequence(made, sequence);
    made_item(made);
    made_text(made, TAG(0x0008, 0x1150), "UI", sop_class);
    made_text(made, TAG(0x0008, 0x1155), "UI", uid);
}

static void refer_end(struct made_dicom *made)
{
    made_item_end(made);
    made_sequence_end(made);
}

void made_part_images(const char *folder, const char *prefix, const struct made_owner *owner, const char *series, int n)
{
    for (int k = 0; k < n; k++) {
        struct made_slice slice = made_slice_defaults;
        char name[80];
        slice.rows = slice.columns = 8;
        slice.spacing[0] = slice.spacing[1] = 2;
        slice.position[2] = 3 * k;
        slice.thickness = 3;
        slice.number = k + 1;
        slice.base = -1000;
        slice.series = series;
        slice.patient_id = owner->id;
        slice.patient_name = owner->name ? owner->name : "";
        slice.birth_date = owner->birth_date;
        slice.study = owner->study;
        slice.frame_of_reference = owner->frame;
        snprintf(name, sizeof name, "%s%d.dcm", prefix, k);
        made_slice_put(folder, name, &slice);
    }
}

static void refer_to_beam(struct made_dicom *made, int number)
{
    made_sequence(made, TAG(0x300c, 0x0020));
    made_item(made);
    made_sequence(made, TAG(0x300c, 0x0004));
    made_item(made);
    made_integer(made, TAG(0x300c, 0x0006), number);
    refer_end(made);
    refer_end(made);
}

void made_part_dose(const char *folder, const char *file, const struct made_owner *owner,
                    const struct made_part_dose *dose)
{
    struct made_dicom made;
    begin(&made, owner, CLASSES "481.2", dose->uid, "RTDOSE", dose->date, dose->description);
    made_text(&made, TAG(0x0020, 0x0032), "DS", "0\\0\\0");
    made_text(&made, TAG(0x0020, 0x0037), "DS", "1\\0\\0\\0\\1\\0");
    put_text(&made, TAG(0x0020, 0x0052), "UI", owner->frame);
    made_u16(&made, TAG(0x0028, 0x0002), 1);
    made_text(&made, TAG(0x0028, 0x0004), "CS", "MONOCHROME2");
    made_text(&made, TAG(0x0028, 0x0008), "IS", "2");
    made_u16(&made, TAG(0x0028, 0x0010), 2);
    made_u16(&made, TAG(0x0028, 0x0011), 2);
    made_text(&made, TAG(0x0028, 0x0030), "DS", "6\\6");
    made_u16(&made, TAG(0x0028, 0x0100), 16);
    made_u16(&made, TAG(0x0028, 0x0101), 16);
    made_u16(&made, TAG(0x0028, 0x0102), 15);
    made_u16(&made, TAG(0x0028, 0x0103), 0);
    made_text(&made, TAG(0x3004, 0x0002), "CS", "GY");
    made_text(&made, TAG(0x3004, 0x0004), "CS", "PHYSICAL");
    made_text(&made, TAG(0x3004, 0x000a), "CS", dose->summation);
    made_text(&made, TAG(0x3004, 0x000c), "DS", "0\\6");
    made_text(&made, TAG(0x3004, 0x000e), "DS", dose->scaling ? dose->scaling : "0.5");
    if (dose->plan_uid) {
        refer(&made, TAG(0x300c, 0x0002), CLASSES "481.5", dose->plan_uid);
        if (dose->beam)
            refer_to_beam(&made, dose->beam);
        refer_end(&made);
    }
    made_head(&made, TAG(0x7fe0, 0x0010), "OW", 16);
    made_words(&made, (uint16_t[]){ 1, 2, 3, 4, 5, 6, 7, 8 }, 8);
    end(&made, folder, file);
}

static void put_beam(struct made_dicom *made, const char *name, int number)
{
    made_item(made);
    made_text(made, TAG(0x300a, 0x00b4), "DS", "1000");
    made_integer(made, TAG(0x300a, 0x00c0), number);
    made_text(made, TAG(0x300a, 0x00c2), "LO", name);
    made_sequence(made, TAG(0x300a, 0x0111));
    made_item(made);
    made_text(made, TAG(0x300a, 0x011e), "DS", "0");
    made_text(made, TAG(0x300a, 0x012c), "DS", "7\\7\\3");
    refer_end(made);
    made_item_end(made);
}

void made_part_plan(const char *folder, const char *file, const struct made_owner *owner,
                    const struct made_part_plan *plan)
{
    struct made_dicom made;
    begin(&made, owner, CLASSES "481.5", plan->uid, "RTPLAN", NULL, NULL);
    if (plan->has_frame)
        put_text(&made, TAG(0x0020, 0x0052), "UI", owner->frame);
    put_text(&made, TAG(0x300a, 0x0002), "SH", plan->label);
    put_text(&made, TAG(0x300a, 0x0006), "DA", plan->date);
    made_sequence(&made, TAG(0x300a, 0x00b0));
    for (int b = 0; b < 4 && plan->beams[b]; b++)
        put_beam(&made, plan->beams[b], b + 1);
    made_sequence_end(&made);
    if (plan->structs_uid) {
        refer(&made, TAG(0x300c, 0x0060), CLASSES "481.3", plan->structs_uid);
        refer_end(&made);
    }
    put_text(&made, TAG(0x300e, 0x0002), "CS", plan->approval);
    if (plan->approval) {
        made_text(&made, TAG(0x300e, 0x0004), "DA", "20261112");
        made_text(&made, TAG(0x300e, 0x0008), "PN", "Reviewer^R");
    }
    end(&made, folder, file);
}

void made_part_structs(const char *folder, const char *file, const struct made_owner *owner, const char *uid,
                       const char *series)
{
    struct made_dicom made;
    begin(&made, owner, CLASSES "481.3", uid, "RTSTRUCT", NULL, NULL);
    made_sequence(&made, TAG(0x3006, 0x0010));
    made_item(&made);
    put_text(&made, TAG(0x0020, 0x0052), "UI", owner->frame);
    made_sequence(&made, TAG(0x3006, 0x0012));
    made_item(&made);
    made_sequence(&made, TAG(0x3006, 0x0014));
    made_item(&made);
    made_text(&made, TAG(0x0020, 0x000e), "UI", series);
    refer_end(&made);
    refer_end(&made);
    refer_end(&made);
    made_sequence(&made, TAG(0x3006, 0x0020));
    made_item(&made);
    made_integer(&made, TAG(0x3006, 0x0022), 1);
    put_text(&made, TAG(0x3006, 0x0024), "UI", owner->frame);
    made_text(&made, TAG(0x3006, 0x0026), "LO", "Box");
    refer_end(&made);
    made_sequence(&made, TAG(0x3006, 0x0039));
    made_item(&made);
    made_sequence(&made, TAG(0x3006, 0x0040));
    for (int k = 1; k <= 2; k++) {
        double z = 3 * k, box[] = { 3, 3, z, 9, 3, z, 9, 9, z, 3, 9, z };
        made_item(&made);
        made_text(&made, TAG(0x3006, 0x0042), "CS", "CLOSED_PLANAR");
        made_integer(&made, TAG(0x3006, 0x0046), 4);
        made_numbers(&made, TAG(0x3006, 0x0050), box, 12);
        made_item_end(&made);
    }
    made_sequence_end(&made);
    made_integer(&made, TAG(0x3006, 0x0084), 1);
    refer_end(&made);
    end(&made, folder, file);
}

void made_part_registration(const char *folder, const char *file, const struct made_owner *owner, const char *from,
                            const char *to, const char *type, const char *matrix)
{
    struct made_dicom made;
    begin(&made, owner, CLASSES "66.1", "1.2.91", "REG", NULL, NULL);
    put_text(&made, TAG(0x0020, 0x0052), "UI", to);
    made_sequence(&made, TAG(0x0070, 0x0308));
    made_item(&made); /* the frame itself, as most programs write it */
    put_text(&made, TAG(0x0020, 0x0052), "UI", to);
    made_item_end(&made);
    made_item(&made);
    put_text(&made, TAG(0x0020, 0x0052), "UI", from);
    made_sequence(&made, TAG(0x0070, 0x0309));
    made_item(&made);
    made_sequence(&made, TAG(0x0070, 0x030a));
    made_item(&made);
    made_text(&made, TAG(0x0070, 0x030c), "CS", type);
    made_text(&made, TAG(0x3006, 0x00c6), "DS", matrix);
    refer_end(&made);
    refer_end(&made);
    refer_end(&made);
    end(&made, folder, file);
}

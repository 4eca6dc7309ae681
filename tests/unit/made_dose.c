/* Writes the smallest RT Dose. */
#include "tests/unit/made_dose.h"

#include <stdio.h>

#define TAG DICOM_TAG

void made_dose_begin(struct made_dicom *made, int number)
{
    static const char sop_class[] = "1.2.840.10008.5.1.4.1.1.481.2";
    char uid[32];
    *made = (struct made_dicom){ 0 };
    made_begin(made, MADE_IMPLICIT);
    made_text(made, TAG(0x0008, 0x0016), "UI", sop_class);
    snprintf(uid, sizeof uid, "1.2.8.%d", number);
    made_text(made, TAG(0x0008, 0x0018), "UI", uid);
    made_text(made, TAG(0x0008, 0x0060), "CS", "RTDOSE");
    made_text(made, TAG(0x0020, 0x0032), "DS", "0\\0\\0");
    made_text(made, TAG(0x0020, 0x0037), "DS", "1\\0\\0\\0\\1\\0");
    made_text(made, TAG(0x0020, 0x0052), "UI", "1.2.3");
    made_u16(made, TAG(0x0028, 0x0002), 1);
    made_text(made, TAG(0x0028, 0x0004), "CS", "MONOCHROME2");
    made_text(made, TAG(0x0028, 0x0008), "IS", "1");
    made_u16(made, TAG(0x0028, 0x0010), 2);
    made_u16(made, TAG(0x0028, 0x0011), 2);
    made_text(made, TAG(0x0028, 0x0030), "DS", "2\\2");
    made_u16(made, TAG(0x0028, 0x0100), 16);
    made_u16(made, TAG(0x0028, 0x0101), 16);
    made_u16(made, TAG(0x0028, 0x0102), 15);
    made_u16(made, TAG(0x0028, 0x0103), 0);
    made_text(made, TAG(0x3004, 0x0002), "CS", "GY");
    made_text(made, TAG(0x3004, 0x0004), "CS", "PHYSICAL");
    made_text(made, TAG(0x3004, 0x000a), "CS", "PLAN");
    made_text(made, TAG(0x3004, 0x000c), "DS", "0");
    made_text(made, TAG(0x3004, 0x000e), "DS", "0.5");
}

void made_dose_end(struct made_dicom *made, int number)
{
    static const char plan_class[] = "1.2.840.10008.5.1.4.1.1.481.5";
    char uid[32];
    made_sequence(made, TAG(0x300c, 0x0002));
    made_item(made);
    made_text(made, TAG(0x0008, 0x1150), "UI", plan_class);
    snprintf(uid, sizeof uid, "1.2.9.%d", number);
    made_text(made, TAG(0x0008, 0x1155), "UI", uid);
    made_item_end(made);
    made_sequence_end(made);
    made_head(made, TAG(0x7fe0, 0x0010), "OW", 8);
    made_words(made, (uint16_t[]){ 1, 2, 3, 4 }, 4);
}

void made_dose(struct made_dicom *made, int number)
{
    made_dose_begin(made, number);
    made_dose_end(made, number);
}

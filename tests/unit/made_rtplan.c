/* Makes RT Plans with one beam. */
#include "tests/unit/made_rtplan.h"

#include "tests/check.h"

#define TAG DICOM_TAG

void made_rtplan_put(struct made_dicom *made, const struct made_rtplan *plan)
{
    made_rt_begin(made, MADE_RTPLAN, "RTPLAN", NULL);
    made_text(made, TAG(0x300a, 0x0002), "SH", "Label");
    made_sequence(made, TAG(0x300a, 0x00b0));
    made_item(made);
    if (plan->sad)
        made_text(made, TAG(0x300a, 0x00b4), "DS", plan->sad);
    if (plan->devices)
        plan->devices(made);
    made_integer(made, TAG(0x300a, 0x00c0), 5);
    made_text(made, TAG(0x300a, 0x00c2), "LO", "Front");
    if (plan->radiation)
        made_text(made, TAG(0x300a, 0x00c6), "CS", plan->radiation);
    if (plan->is_setup)
        made_text(made, TAG(0x300a, 0x00ce), "CS", "SETUP");
    made_integer(made, TAG(0x300a, 0x0110), plan->n_points);
    made_sequence(made, TAG(0x300a, 0x0111));
    for (int i = 0; i < plan->n_points; i++) {
        made_item(made);
        if (plan->positions)
            plan->positions(made, i);
        if (plan->gantries[i])
            made_text(made, TAG(0x300a, 0x011e), "DS", plan->gantries[i]);
        if (plan->directions[i])
            made_text(made, TAG(0x300a, 0x011f), "CS", plan->directions[i]);
        if (plan->collimator && i == 0)
            made_text(made, TAG(0x300a, 0x0120), "DS", plan->collimator);
        if (plan->table && i == 0)
            made_text(made, TAG(0x300a, 0x0122), "DS", plan->table);
        if (plan->iso && i == 0)
            made_text(made, TAG(0x300a, 0x012c), "DS", plan->iso);
        made_item_end(made);
    }
    made_sequence_end(made);
    made_integer(made, TAG(0x300c, 0x006a), 2);
    made_item_end(made);
    made_sequence_end(made);
    if (plan->position) {
        made_sequence(made, TAG(0x300a, 0x0180));
        for (int i = 1; i <= 2; i++) {
            made_item(made);
            made_text(made, TAG(0x0018, 0x5100), "CS", i == 2 ? plan->position : "FFDR");
            made_integer(made, TAG(0x300a, 0x0182), i);
            made_item_end(made);
        }
        made_sequence_end(made);
    }
}

struct rtplan *made_rtplan_read(const struct made_rtplan *plan, struct report *report)
{
    struct made_dicom made;
    made_rtplan_put(&made, plan);
    struct rt_file file = rt_file_of(&made);
    struct error err = { 0 };
    struct rtplan *read = rtplan_read(file.file, "made.dcm", report, &err);
    if (!read)
        fail_msg("%s", err.text);
    rt_file_close(&file);
    made_finish(&made);
    return read;
}

void made_rt_device(struct made_dicom *made, const char *type, const char *pairs, const char *boundaries)
{
    made_item(made);
    made_text(made, TAG(0x300a, 0x00b8), "CS", type);
    if (pairs)
        made_text(made, TAG(0x300a, 0x00bc), "IS", pairs);
    if (boundaries)
        made_text(made, TAG(0x300a, 0x00be), "DS", boundaries);
    made_item_end(made);
}

void made_rt_position(struct made_dicom *made, const char *type, const char *positions)
{
    made_item(made);
    made_text(made, TAG(0x300a, 0x00b8), "CS", type);
    made_text(made, TAG(0x300a, 0x011c), "DS", positions);
    made_item_end(made);
}

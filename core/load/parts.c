/* Frees the parts of a plan. */
#include "core/load/parts.h"

void plan_parts_finish(struct plan_parts *parts)
{
    plan_file_destroy(parts->file);
    dicom_index_destroy(parts->dicom);
    *parts = (struct plan_parts){ 0 };
}

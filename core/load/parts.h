#pragma once
/* The parts of a plan before any voxel is read: the entries of plan.json, or what its folder was recognised as. */
#include "core/formats/dicom/dicom_index.h"
#include "core/formats/plan_file.h"

struct plan_parts {
    struct plan_file *file;
    struct dicom_index *dicom; /* headers of the DICOM files among the parts; NULL without any */
    bool is_recognised;        /* no plan.json: the parts were told by names and contents */
    bool is_all_dicom;         /* no plan.json: every RTDOSE and RTPLAN of the index is a part as well */
};
void plan_parts_finish(struct plan_parts *parts);

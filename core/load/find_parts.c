/* Finds the parts of a plan: from plan.json, or by recognising the folder's files. */
#include "core/load/find_parts.h"

#include "core/formats/plan/plan_json.h"
#include "core/load/dicom_scan.h"
#include "core/load/part_names.h"
#include "core/load/recognise.h"

static bool describe(const struct folder *folder, const struct dicom_progress *progress, struct plan_parts *parts,
                     struct report *report, struct error *err)
{
    if (folder_look(folder, "plan.json", NULL) == FOLDER_ABSENT)
        return plan_recognise(folder, progress, parts, report, err);
    struct bytes text;
    if (!folder_read(folder, "plan.json", PLAN_FILE_MAX_BYTES, UINT64_MAX, &text, err))
        return false;
    parts->file = plan_file_parse(text.data, text.size, report, err);
    bytes_free(&text);
    if (!parts->file)
        return false;
    if (!parts->file->name[0])
        plan_folder_name(folder->path, parts->file->name, sizeof parts->file->name);
    return plan_dicom_scan_named(folder, parts, progress, report, err);
}

/* A file that could not be looked at for want of memory or descriptors would be missing, or taken for another kind. */
bool plan_find_parts(const struct folder *folder, const struct dicom_progress *progress, struct plan_parts *parts,
                     struct report *report, struct error *err)
{
    struct error why = { 0 };
    size_t n_lacked = error_n_memory();
    *parts = (struct plan_parts){ 0 };
    bool is_described = describe(folder, progress, parts, report, &why);
    if (error_n_memory() != n_lacked && why.code != ERROR_MEMORY)
        is_described = error_set(&why, ERROR_MEMORY, "no memory, or too many open files, to look at the plan's folder");
    if (!is_described && err)
        *err = why;
    return is_described;
}

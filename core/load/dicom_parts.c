/* Finds the DICOM objects of a plan's folder, and opens them. */
#include "core/load/dicom_parts.h"

#include <string.h>

bool plan_dicom_is_under(const struct dicom_object *object, const char *path)
{
    size_t n = strlen(path);
    while (n > 0 && path[n - 1] == '/')
        n--;
    return strncmp(object->path, path, n) == 0 && (n == 0 || object->path[n] == 0 || object->path[n] == '/');
}

const struct dicom_object *plan_dicom_object(const struct dicom_index *index, enum dicom_kind kind, const char *path,
                                             size_t nth)
{
    for (size_t i = 0; index && i < index->n_objects; i++)
        if (index->objects[i].kind == kind && plan_dicom_is_under(&index->objects[i], path) && nth-- == 0)
            return &index->objects[i];
    return NULL;
}

int plan_dicom_stack(const struct dicom_index *index, const char *path)
{
    for (size_t s = 0; index && s < index->n_stacks; s++) /* stacks are sorted, more slices first */
        for (size_t i = 0; i < index->stacks[s].n_objects; i++)
            if (plan_dicom_is_under(&index->objects[index->stacks[s].objects[i]], path))
                return (int)s;
    return -1;
}

bool plan_dicom_open(const struct folder *folder, const char *path, struct plan_dicom_file *opened, struct error *err)
{
    *opened = (struct plan_dicom_file){ 0 };
    if (!folder_read(folder, path, PLAN_DICOM_MAX_FILE_BYTES, UINT64_MAX, &opened->bytes, err))
        return false;
    opened->file = dicom_file_parse(opened->bytes.data, opened->bytes.size, path, DICOM_WHOLE, err);
    if (!opened->file)
        plan_dicom_close(opened);
    return opened->file != NULL;
}

void plan_dicom_close(struct plan_dicom_file *opened)
{
    dicom_file_destroy(opened->file);
    bytes_free(&opened->bytes);
    opened->file = NULL;
}

/* Unpacks, finds and parses DICOM-RT files. */
#include "tests/unit/rt_files.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/oracle.h"

static struct rt_file parsed(struct bytes bytes, const char *name)
{
    struct error err = { 0 };
    struct rt_file file = { bytes, dicom_file_parse(bytes.data, bytes.size, name, DICOM_WHOLE, &err) };
    if (!file.file)
        fail_msg("%s", err.text);
    return file;
}

struct rt_file rt_file_open(const char *path)
{
    const char *slash = strrchr(path, '/');
    char folder_path[512];
    struct folder folder;
    struct bytes bytes = { NULL, 0 };
    struct error err = { 0 };
    snprintf(folder_path, sizeof folder_path, "%.*s", (int)(slash - path), path);
    if (!folder_open(&folder, folder_path, &err) ||
        !folder_read(&folder, slash + 1, UINT32_MAX, UINT64_MAX, &bytes, &err))
        fail_msg("%s", err.text);
    folder_close(&folder);
    return parsed(bytes, slash + 1);
}

struct rt_file rt_file_of(const struct made_dicom *made)
{
    struct bytes bytes = { malloc(made->size), made->size };
    assert_non_null(bytes.data);
    memcpy(bytes.data, made->data, made->size);
    return parsed(bytes, "made.dcm");
}

void rt_file_close(struct rt_file *file)
{
    dicom_file_destroy(file->file);
    bytes_free(&file->bytes);
}

bool rt_unpack(const char *archive, char folder[256])
{
    char path[512];
    if (!data_path(archive, path, sizeof path))
        return false;
    folder_make(folder);
    if (oracle_unpack(path, folder))
        return true;
    folder_remove(folder);
    return false;
}

bool rt_find(const char *folder, const char *beginning, size_t which, char *path, size_t size)
{
    struct folder opened;
    char **names;
    size_t n;
    struct error err = { 0 };
    if (!folder_open(&opened, folder, &err))
        return false;
    bool is_listed = folder_list(&opened, &names, &n, &err);
    folder_close(&opened);
    if (!is_listed)
        return false;
    bool is_found = false;
    for (size_t i = 0; i < n && !is_found; i++) {
        if (strncmp(names[i], beginning, strlen(beginning)) != 0 || which-- > 0)
            continue;
        snprintf(path, size, "%s/%s", folder, names[i]);
        is_found = true;
    }
    folder_free_names(names, n);
    return is_found;
}

void made_rt_begin(struct made_dicom *made, const char *sop_class, const char *modality, const char *charset)
{
    *made = (struct made_dicom){ 0 };
    made_begin(made, MADE_IMPLICIT); /* implicit, because values may be longer than 64 KiB */
    if (charset)
        made_text(made, DICOM_TAG(0x0008, 0x0005), "CS", charset);
    made_text(made, DICOM_TAG(0x0008, 0x0016), "UI", sop_class);
    made_text(made, DICOM_TAG(0x0008, 0x0018), "UI", "1.2.3.4");
    made_text(made, DICOM_TAG(0x0008, 0x0060), "CS", modality);
}

void made_numbers(struct made_dicom *made, uint32_t tag, const double *values, size_t n)
{
    enum { MOST = 24 };
    char *text = malloc(n * MOST + 1);
    assert_non_null(text);
    size_t length = 0;
    for (size_t i = 0; i < n; i++)
        length += (size_t)snprintf(text + length, MOST, "%s%.10g", i ? "\\" : "", values[i]);
    made_element(made, tag, "DS", text, length);
    free(text);
}

void made_integer(struct made_dicom *made, uint32_t tag, long value)
{
    char text[24];
    snprintf(text, sizeof text, "%ld", value);
    made_text(made, tag, "IS", text);
}

/* Reads SERA's files of a plan's folder. */
#include "core/load/sera_parts.h"

#include <stdio.h>
#include <string.h>

#include "core/formats/text.h"
#include "core/formats/zlib_stream.h"
#include "core/load/part_names.h"

#define DATA_FILE_MAX_BYTES (VOLUME_MAX_BYTES + (1 << 20))

/* Reads a file that may be packed (gzip, or zlib in a .sz); at most limit bytes before and after unpacking. */
static bool read_unpacked(const struct folder *folder, const char *name, uint64_t limit, struct bytes *bytes,
                          struct error *err)
{
    struct bytes file;
    bool is_packed;
    *bytes = (struct bytes){ 0 };
    if (!folder_read(folder, name, limit, UINT64_MAX, &file, err))
        return false;
    bool is_read = sera_unpack(&file, name, limit, &is_packed, bytes, err);
    if (is_read && !is_packed) {
        *bytes = file;
        return true;
    }
    bytes_free(&file);
    return is_read;
}

bool plan_read_univels(const struct folder *folder, const char *path, double given_mm, struct uvh *uvh,
                       struct volume **univels, struct report *report, struct error *err)
{
    struct bytes header, data;
    char data_name[FOLDER_NAME_SIZE];
    if (!folder_read(folder, path, UVH_MAX_BYTES, UINT64_MAX, &header, err))
        return false;
    bool is_read = uvh_parse_in(header.data, header.size, path, given_mm, uvh, report, err);
    bytes_free(&header);
    if (!is_read)
        return false;
    if (!part_find_data(folder, path, ".uv", data_name))
        return error_set(err, ERROR_NOT_FOUND, "%s: the univels, a .uv or .uv.gz file beside it, are missing", path);
    if (!folder_read(folder, data_name, DATA_FILE_MAX_BYTES, UINT64_MAX, &data, err))
        return false;
    *univels = uvh_read_univels(uvh, &data, data_name, err);
    bytes_free(&data);
    return *univels != NULL;
}

bool plan_read_qsh(const struct folder *folder, const char *path, const char *header, double given_mm,
                   struct volume **image, char modality[16], bool *is_grid_doubtful, struct report *report,
                   struct error *err)
{
    struct bytes text, pixels;
    struct qhd qhd;
    char header_name[FOLDER_NAME_SIZE], pixel_name[FOLDER_NAME_SIZE];
    snprintf(pixel_name, sizeof pixel_name, "%s", path);
    snprintf(header_name, sizeof header_name, "%s", header);
    if (text_has_ending(path, ".qhd")) {
        snprintf(header_name, sizeof header_name, "%s", path);
        if (!part_find_data(folder, path, ".qim", pixel_name))
            return error_set(err, ERROR_NOT_FOUND, "%s: the pixels, a .qim or .qim.gz file beside it, are missing",
                             path);
    } else if (!header[0]) {
        bool is_packed = text_has_ending(path, ".gz") || text_has_ending(path, ".sz");
        size_t stem = strlen(path) - (is_packed ? strlen(".qim.gz") : strlen(".qim"));
        snprintf(header_name, sizeof header_name, "%.*s.qhd", (int)stem, path);
    }
    if (!folder_read(folder, header_name, QHD_MAX_BYTES, UINT64_MAX, &text, err))
        return false;
    bool is_read = qhd_parse(text.data, text.size, header_name, &qhd, report, err);
    bytes_free(&text);
    if (!is_read)
        return false;
    qhd.given_mm = given_mm;
    snprintf(modality, 16, "%s", qhd.modality);
    if (folder_read(folder, pixel_name, DATA_FILE_MAX_BYTES, UINT64_MAX, &pixels, err)) {
        *image = qhd_read_pixels(&qhd, &pixels, header_name, pixel_name, is_grid_doubtful, report, err);
        bytes_free(&pixels);
    }
    qhd_finish(&qhd);
    return *image != NULL;
}

bool plan_read_rst(const struct folder *folder, const char *path, struct sera_doses *doses, struct report *report,
                   struct error *err)
{
    struct bytes text;
    if (!read_unpacked(folder, path, RST_MAX_BYTES, &text, err))
        return false;
    bool is_read = rst_read(&text, path, doses, report, err);
    bytes_free(&text);
    return is_read;
}

static bool read_chd_header(const struct folder *folder, const char *path, struct chd *chd, struct report *report,
                            struct error *err)
{
    struct bytes text;
    if (!folder_read(folder, path, CHD_MAX_BYTES, UINT64_MAX, &text, err))
        return false;
    bool is_read = chd_parse(text.data, text.size, path, chd, report, err);
    bytes_free(&text);
    return is_read;
}

bool plan_read_chd(const struct folder *folder, const char *path, struct sera_doses *doses, struct report *report,
                   struct error *err)
{
    char table_name[FOLDER_NAME_SIZE], mask_name[FOLDER_NAME_SIZE] = "";
    struct chd chd;
    if (!part_find_data(folder, path, ".cdf", table_name))
        return error_set(err, ERROR_NOT_FOUND, "%s: the table of points, a .cdf.sz or .cdf file beside it, is missing",
                         path);
    if (!read_chd_header(folder, path, &chd, report, err))
        return false;
    struct chd_files files = { .name = path, .table_name = table_name, .mask_name = mask_name };
    bool is_read = read_unpacked(folder, table_name, chd_table_bytes(&chd), &files.table, err);
    if (is_read && !part_find_data(folder, path, ".cmf", mask_name))
        report_add(
            report, REPORT_NOTE, "dose.mask-unread", path,
            "There are no pictures of regions, .cmf.sz, beside it; where the dose is valid was taken from its points alone.");
    else if (is_read)
        is_read = read_unpacked(folder, mask_name, chd_mask_bytes(&chd), &files.mask, err);
    is_read = is_read && chd_read(&chd, &files, doses, report, err);
    bytes_free(&files.table);
    bytes_free(&files.mask);
    chd_finish(&chd);
    return is_read;
}

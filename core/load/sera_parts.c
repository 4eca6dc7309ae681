/* Reads SERA's files of a plan's folder: univels and images with the data beside their header, and doses. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/formats/gzip.h"
#include "core/formats/sera/sera_chd.h"
#include "core/formats/sera/sera_qhd.h"
#include "core/formats/sera/sera_rst.h"
#include "core/formats/sera/sera_uvh.h"
#include "core/formats/text.h"
#include "core/formats/zlib_stream.h"
#include "core/load/loading.h"
#include "core/load/part_names.h"
#include "core/load/reader_table.h"

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

/* ---- univels ------------------------------------------------------------------------------------------------------- */

/* errors ERROR_NOT_FOUND */
static bool find_univels(const struct folder *folder, const char *header, char data[FOLDER_NAME_SIZE],
                         struct error *err)
{
    if (part_find_data(folder, header, ".uv", data))
        return true;
    data[0] = 0;
    return error_set(err, ERROR_NOT_FOUND, "%s: the univels, a .uv or .uv.gz file beside it, are missing", header);
}

static bool read_univels(struct loading *loading, struct part_reading *reading)
{
    const struct folder *folder = &loading->folder;
    const char *path = reading->path;
    double given_mm = loading->file->regions[reading->index].mm;
    struct error *err = &reading->err;
    struct bytes header, data;
    char data_name[FOLDER_NAME_SIZE];
    if (!folder_read(folder, path, UVH_MAX_BYTES, UINT64_MAX, &header, err))
        return false;
    bool is_read = uvh_parse_in(header.data, header.size, path, given_mm, &reading->uvh, &reading->report, err);
    bytes_free(&header);
    if (!is_read || !find_univels(folder, path, data_name, err))
        return false;
    if (!folder_read(folder, data_name, DATA_FILE_MAX_BYTES, UINT64_MAX, &data, err))
        return false;
    reading->volume = uvh_read_univels(&reading->uvh, &data, data_name, err);
    bytes_free(&data);
    return reading->volume != NULL;
}

static void recognise_univels(struct recognition *all, char *name)
{
    char data[FOLDER_NAME_SIZE];
    if (part_find_data(all->folder, name, ".uv", data))
        recognition_add_regions(all, name);
    else
        recognition_ignore(all, name, "There is no file of univels beside it.");
}

static struct part_need estimate_univels(const struct loading *loading, const struct part_reading *reading,
                                         enum raw_use use)
{
    (void)use;
    struct bytes header;
    struct uvh uvh = { 0 };
    struct part_need need = { reading->bytes, 0 };
    if (!folder_read(&loading->folder, reading->path, UVH_MAX_BYTES, UINT64_MAX, &header, NULL))
        return need;
    if (uvh_parse(header.data, header.size, reading->path, &uvh, NULL, NULL)) {
        uint64_t n = grid_n_voxels(&uvh.grid);
        need = (struct part_need){ n, 2 * n };
        uvh_finish(&uvh);
    }
    bytes_free(&header);
    return need;
}

static size_t count_bodies(const struct uvh *uvh)
{
    size_t n = 0;
    for (size_t i = 0; i < uvh->n_bodies; i++) {
        const struct uvh_body *body = &uvh->bodies[i];
        n += body->uvval != 0 && !text_equal(body->name, "buffer") && !text_equal(body->name, "void") &&
             !strstr(body->name, "ABSENT");
    }
    return n;
}

static bool summarise_univels(const struct folder *folder, const char *name, struct part_summary *summary,
                              struct error *err)
{
    struct bytes header;
    struct uvh uvh;
    if (!folder_read(folder, name, UVH_MAX_BYTES, UINT64_MAX, &header, err))
        return false;
    bool is_good = uvh_parse(header.data, header.size, name, &uvh, NULL, err);
    bytes_free(&header);
    if (!is_good)
        return false;
    summary->n_regions = count_bodies(&uvh);
    uvh_finish(&uvh);
    return find_univels(folder, name, summary->data, err);
}

static void find_univels_beside(const struct folder *folder, const char *name, char other[FOLDER_NAME_SIZE])
{
    if (!part_find_data(folder, name, ".uv", other))
        other[0] = 0;
}

static const char *const uvh_names[] = { ".uvh", NULL };
const struct part_reader part_uvh = { .word = "SERA univels",
                                      .names = uvh_names,
                                      .reads = PART_READS_REGIONS,
                                      .recognise = recognise_univels,
                                      .estimate = estimate_univels,
                                      .summarise = summarise_univels,
                                      .read = read_univels,
                                      .find_companion = find_univels_beside };

/* ---- images -------------------------------------------------------------------------------------------------------- */

/* The names of header and pixels, of which path is one. given: the header, when the plan names both; else "". */
static bool find_qsh(const struct folder *folder, const char *path, const char *given, char header[FOLDER_NAME_SIZE],
                     char pixels[FOLDER_NAME_SIZE], struct error *err)
{
    snprintf(pixels, FOLDER_NAME_SIZE, "%s", path);
    snprintf(header, FOLDER_NAME_SIZE, "%s", given);
    if (text_has_ending(path, ".qhd")) {
        snprintf(header, FOLDER_NAME_SIZE, "%s", path);
        if (!part_find_data(folder, path, ".qim", pixels))
            return error_set(err, ERROR_NOT_FOUND, "%s: the pixels, a .qim or .qim.gz file beside it, are missing",
                             path);
    } else if (!given[0]) {
        bool is_packed = text_has_ending(path, ".gz") || text_has_ending(path, ".sz");
        size_t stem = strlen(path) - (is_packed ? strlen(".qim.gz") : strlen(".qim"));
        snprintf(header, FOLDER_NAME_SIZE, "%.*s.qhd", (int)stem, path);
    }
    return true;
}

static bool read_qsh(struct loading *loading, struct part_reading *reading)
{
    const struct folder *folder = &loading->folder;
    const struct plan_file_image *entry = &loading->file->images[reading->index];
    struct error *err = &reading->err;
    struct bytes text, pixels;
    struct qhd qhd;
    char header_name[FOLDER_NAME_SIZE], pixel_name[FOLDER_NAME_SIZE];
    if (!find_qsh(folder, reading->path, entry->header, header_name, pixel_name, err) ||
        !folder_read(folder, header_name, QHD_MAX_BYTES, UINT64_MAX, &text, err))
        return false;
    bool is_read = qhd_parse(text.data, text.size, header_name, &qhd, &reading->report, err);
    bytes_free(&text);
    if (!is_read)
        return false;
    qhd.given_mm = entry->mm;
    snprintf(reading->modality, sizeof reading->modality, "%s", qhd.modality);
    if (folder_read(folder, pixel_name, DATA_FILE_MAX_BYTES, UINT64_MAX, &pixels, err)) {
        reading->volume =
            qhd_read_pixels(&qhd, &pixels, header_name, pixel_name, &reading->is_grid_doubtful, &reading->report, err);
        bytes_free(&pixels);
    }
    qhd_finish(&qhd);
    return reading->volume != NULL;
}

static void recognise_qsh(struct recognition *all, char *name)
{
    char data[FOLDER_NAME_SIZE];
    if (!text_has_ending(name, ".qhd"))
        return;
    if (part_find_data(all->folder, name, ".qim", data))
        recognition_add_image(all, data, name);
    else
        recognition_ignore(all, name, "There is no file of pixels beside it.");
}

/* Only reading it says whether it is valid. */
static bool summarise_qsh(const struct folder *folder, const char *name, struct part_summary *summary,
                          struct error *err)
{
    (void)folder, (void)name, (void)summary, (void)err;
    return true;
}

static const char *const qsh_names[] = { ".qim", ".qim.gz", ".qim.sz", ".qhd", NULL };
const struct part_reader part_qsh = { .word = "SERA image",
                                      .names = qsh_names,
                                      .reads = PART_READS_IMAGES,
                                      .recognise = recognise_qsh,
                                      .summarise = summarise_qsh,
                                      .read = read_qsh };

/* ---- doses on a mesh ----------------------------------------------------------------------------------------------- */

static bool read_rst(struct loading *loading, struct part_reading *reading)
{
    struct bytes text;
    if (!read_unpacked(&loading->folder, reading->path, RST_MAX_BYTES, &text, &reading->err))
        return false;
    bool is_read = rst_read(&text, reading->path, &reading->doses, &reading->report, &reading->err);
    bytes_free(&text);
    return is_read;
}

static bool is_rst(const struct folder *folder, const char *name)
{
    struct bytes head;
    uint8_t text[RST_HEAD_BYTES];
    struct rst_header header;
    if (!folder_read(folder, name, UINT64_MAX, sizeof text, &head, NULL))
        return false;
    size_t n = head.size;
    if (gzip_is(head.data, head.size))
        n = gzip_head(head.data, head.size, text, sizeof text);
    else
        memcpy(text, head.data, n);
    bytes_free(&head);
    return rst_parse_header(text, n, name, &header, NULL);
}

static void recognise_rst(struct recognition *all, char *name)
{
    if (is_rst(all->folder, name))
        recognition_add_dose(all, name);
    else
        recognition_ignore(all, name, "Named like a dose of SERA, but its header is another one's.");
}

static struct part_need estimate_rst(const struct loading *loading, const struct part_reading *reading,
                                     enum raw_use use)
{
    (void)use;
    enum { COLUMNS = 14, COLUMN_BYTES = 15 };
    struct bytes head;
    struct rst_header header;
    uint8_t *text = malloc(RST_HEAD_BYTES);
    struct part_need need = { reading->bytes, reading->bytes };
    if (text && folder_read(&loading->folder, reading->path, UINT64_MAX, RST_HEAD_BYTES, &head, NULL)) {
        bool is_packed = gzip_is(head.data, head.size);
        size_t n = is_packed ? gzip_head(head.data, head.size, text, RST_HEAD_BYTES) : head.size;
        if (rst_parse_header(is_packed ? text : head.data, n, reading->path, &header, NULL)) {
            uint64_t cells = (uint64_t)header.n_cells * header.n_cells * header.n_cells;
            need = (struct part_need){ cells * RST_N_DOSES * sizeof(float),
                                       reading->bytes + (is_packed ? cells * COLUMNS * COLUMN_BYTES : 0) };
        }
        bytes_free(&head);
    }
    free(text);
    return need;
}

static const char *const rst_names[] = { ".rst", ".rst.gz", ".rstb", ".rstb.gz", NULL };
const struct part_reader part_sera_rst = { .word = "SERA dose",
                                           .names = rst_names,
                                           .reads = PART_READS_DOSES,
                                           .n_doses = RST_N_DOSES,
                                           .recognise = recognise_rst,
                                           .estimate = estimate_rst,
                                           .read = read_rst };

/* ---- doses on planes ----------------------------------------------------------------------------------------------- */

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

static bool read_chd(struct loading *loading, struct part_reading *reading)
{
    const struct folder *folder = &loading->folder;
    const char *path = reading->path;
    struct report *report = &reading->report;
    struct error *err = &reading->err;
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
    is_read = is_read && chd_read(&chd, &files, &reading->doses, report, err);
    bytes_free(&files.table);
    bytes_free(&files.mask);
    chd_finish(&chd);
    return is_read;
}

static void recognise_chd(struct recognition *all, char *name)
{
    char data[FOLDER_NAME_SIZE];
    if (part_find_data(all->folder, name, ".cdf", data))
        recognition_add_dose(all, name);
    else
        recognition_ignore(all, name, "There is no table of points, .cdf.sz or .cdf, beside it.");
}

static struct part_need estimate_chd(const struct loading *loading, const struct part_reading *reading,
                                     enum raw_use use)
{
    (void)use;
    struct bytes header;
    struct chd chd = { 0 };
    struct part_need need = { reading->bytes, reading->bytes };
    if (!folder_read(&loading->folder, reading->path, CHD_MAX_BYTES, UINT64_MAX, &header, NULL))
        return need;
    if (chd_parse(header.data, header.size, reading->path, &chd, NULL, NULL))
        need = (struct part_need){ chd_table_bytes(&chd) / 2, chd_table_bytes(&chd) + chd_mask_bytes(&chd) };
    chd_finish(&chd);
    bytes_free(&header);
    return need;
}

static void find_table(const struct folder *folder, const char *name, char other[FOLDER_NAME_SIZE])
{
    if (!part_find_data(folder, name, ".cdf", other))
        other[0] = 0;
}

static const char *const chd_names[] = { ".chd", NULL };
const struct part_reader part_sera_chd = { .word = "SERA dose contours",
                                           .names = chd_names,
                                           .reads = PART_READS_DOSES,
                                           .n_doses = CHD_N_COLUMNS,
                                           .recognise = recognise_chd,
                                           .estimate = estimate_chd,
                                           .read = read_chd,
                                           .find_companion = find_table };

/* ---- read by curves_and_preferences.c ------------------------------------------------------------------------------ */

static const char *const curve_names[] = { ".dose", ".dose.gz", NULL };
const struct part_reader part_sera_curve = { .word = "SERA dose over depth",
                                             .names = curve_names,
                                             .recognise = recognition_add_curve };

static const char *const settings_names[] = { ".rsc", ".cmap", "body_data.txt", NULL };
const struct part_reader part_sera_settings = { .word = "SERA preferences",
                                                .names = settings_names,
                                                .recognise = recognition_add_preferences };

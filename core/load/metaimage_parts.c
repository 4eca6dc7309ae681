/* Reads MetaImage files of a plan's folder, with the data file that a header names. */
#include <string.h>

#include "core/formats/metaimage.h"
#include "core/load/loading.h"
#include "core/load/reader_table.h"

#define DATA_FILE_MAX_BYTES (VOLUME_MAX_BYTES + (1 << 20))

/* The header alone; the data file has to be there. */
static bool read_header(const struct folder *folder, const char *name, struct metaimage_header *header,
                        struct error *err)
{
    struct bytes head;
    *header = (struct metaimage_header){ 0 };
    if (!folder_read(folder, name, UINT64_MAX, METAIMAGE_HEAD_BYTES, &head, err))
        return false;
    bool is_read = metaimage_parse_header(head.data, head.size, name, header, NULL, err);
    bytes_free(&head);
    return is_read && (!header->data_file[0] || folder_look(folder, header->data_file, NULL) == FOLDER_FILE ||
                       error_set(err, ERROR_NOT_FOUND, "%s: its data file %s is not there", name, header->data_file));
}

static struct volume *read_grid(const struct folder *folder, const char *name, enum raw_use use, struct report *report,
                                struct error *err)
{
    struct metaimage_header header;
    struct bytes data = { 0 };
    const char *data_name = name;
    struct volume *volume = NULL;
    if (!folder_read(folder, name, DATA_FILE_MAX_BYTES, UINT64_MAX, &data, err))
        return NULL;
    bool is_read = metaimage_parse_header(data.data, data.size, name, &header, report, err);
    if (is_read && header.data_file[0]) {
        bytes_free(&data);
        data = (struct bytes){ 0 };
        data_name = header.data_file;
        is_read = folder_read(folder, data_name, DATA_FILE_MAX_BYTES, UINT64_MAX, &data, err);
        if (!is_read)
            error_prefix(err, "%s", name);
    }
    if (is_read)
        volume = metaimage_read(&header, &data, data_name, use, report, err);
    bytes_free(&data);
    return volume;
}

static bool peek(const struct folder *folder, const char *name, struct grid_facts *facts, struct error *err)
{
    struct metaimage_header header;
    bool is_read = read_header(folder, name, &header, err);
    *facts = (struct grid_facts){ header.grid, false, 1 };
    return is_read;
}

static struct part_need estimate(const struct loading *loading, const struct part_reading *reading, enum raw_use use)
{
    struct metaimage_header header;
    uint64_t file_bytes = reading->bytes;
    if (!read_header(&loading->folder, reading->path, &header, NULL))
        return (struct part_need){ reading->bytes, 0 };
    if (header.data_file[0])
        folder_look(&loading->folder, header.data_file, &file_bytes);
    return part_need_of_voxels(grid_n_voxels(&header.grid), header.type, use, file_bytes, true, false);
}

static bool summarise(const struct folder *folder, const char *name, struct part_summary *summary, struct error *err)
{
    struct metaimage_header header;
    bool is_good = read_header(folder, name, &header, err);
    if (is_good)
        memcpy(summary->data, header.data_file, sizeof summary->data);
    return is_good;
}

static void find_companion(const struct folder *folder, const char *name, char other[FOLDER_NAME_SIZE])
{
    struct metaimage_header header;
    other[0] = 0;
    if (read_header(folder, name, &header, NULL))
        memcpy(other, header.data_file, FOLDER_NAME_SIZE);
}

static const char *const names[] = { ".mha", ".mhd", NULL };
static const struct grid_reader grids = { .peek = peek, .read = read_grid, .map_endings = names };
const struct part_reader part_metaimage = { .word = "MetaImage",
                                            .names = names,
                                            .reads = PART_READS_GRIDS,
                                            .grid = &grids,
                                            .estimate = estimate,
                                            .summarise = summarise,
                                            .find_companion = find_companion };

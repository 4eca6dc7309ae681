/* Reads NRRD files of a plan's folder, with the data file that a detached header names. */
#include <string.h>

#include "core/formats/nrrd.h"
#include "core/load/loading.h"
#include "core/load/reader_table.h"

#define DATA_FILE_MAX_BYTES (VOLUME_MAX_BYTES + NRRD_HEAD_BYTES)

/* Reads the header alone, and checks that the data file exists. The caller finishes header, also after a failure. */
static bool read_header(const struct folder *folder, const char *name, struct nrrd_header *header, struct error *err)
{
    struct bytes head;
    *header = (struct nrrd_header){ 0 };
    if (!folder_read(folder, name, UINT64_MAX, NRRD_HEAD_BYTES, &head, err))
        return false;
    bool is_read = nrrd_parse_header(head.data, head.size, name, header, NULL, err);
    bytes_free(&head);
    return is_read && (!header->data_file[0] || folder_look(folder, header->data_file, NULL) == FOLDER_FILE ||
                       error_set(err, ERROR_NOT_FOUND, "%s: its data file %s is not there", name, header->data_file));
}

/* Reads the header, and the bytes of the file that holds the voxels. data_name: that file, name itself or the detached
 * one. */
static bool read_parts(const struct folder *folder, const char *name, struct nrrd_header *header, struct bytes *data,
                       const char **data_name, struct report *report, struct error *err)
{
    *header = (struct nrrd_header){ 0 };
    *data_name = name;
    if (!folder_read(folder, name, DATA_FILE_MAX_BYTES, UINT64_MAX, data, err))
        return false;
    bool is_read = nrrd_parse_header(data->data, data->size, name, header, report, err);
    if (is_read && header->data_file[0]) {
        bytes_free(data);
        *data_name = header->data_file;
        is_read = folder_read(folder, header->data_file, DATA_FILE_MAX_BYTES, UINT64_MAX, data, err);
        if (!is_read)
            error_prefix(err, "%s", name);
    }
    return is_read;
}

static struct volume *read_grid(const struct folder *folder, const char *name, enum raw_use use, struct report *report,
                                struct error *err)
{
    struct nrrd_header header;
    struct bytes data;
    const char *data_name;
    struct volume *volume = NULL;
    if (read_parts(folder, name, &header, &data, &data_name, report, err))
        volume = nrrd_read(&header, &data, data_name, use, report, err);
    bytes_free(&data);
    nrrd_header_finish(&header);
    return volume;
}

static bool read_layers(const struct folder *folder, const char *name, struct nrrd_layers *layers,
                        struct report *report, struct error *err)
{
    struct nrrd_header header;
    struct bytes data;
    const char *data_name;
    bool is_read = read_parts(folder, name, &header, &data, &data_name, report, err) &&
                   nrrd_read_layers(&header, &data, data_name, layers, report, err);
    bytes_free(&data);
    nrrd_header_finish(&header);
    return is_read;
}

static bool peek(const struct folder *folder, const char *name, struct grid_facts *facts, struct error *err)
{
    struct nrrd_header header;
    bool is_read = read_header(folder, name, &header, err);
    *facts = (struct grid_facts){ header.grid, header.n_segments > 0, header.n_layers };
    nrrd_header_finish(&header);
    return is_read;
}

static struct part_need estimate(const struct loading *loading, const struct part_reading *reading, enum raw_use use)
{
    struct nrrd_header header;
    struct part_need need = { reading->bytes, 0 };
    uint64_t file_bytes = reading->bytes;
    if (read_header(&loading->folder, reading->path, &header, NULL)) {
        if (header.data_file[0])
            folder_look(&loading->folder, header.data_file, &file_bytes);
        need = part_need_of_voxels(grid_n_voxels(&header.grid) * header.n_layers, header.type, use, file_bytes, true,
                                   false);
    }
    nrrd_header_finish(&header);
    return need;
}

static bool summarise(const struct folder *folder, const char *name, struct part_summary *summary, struct error *err)
{
    struct nrrd_header header;
    bool is_good = read_header(folder, name, &header, err);
    for (size_t i = 0; is_good && i < header.n_segments; i++)
        summary->n_segments += header.segments[i].is_present;
    if (is_good)
        memcpy(summary->data, header.data_file, sizeof summary->data);
    nrrd_header_finish(&header);
    return is_good;
}

static void find_companion(const struct folder *folder, const char *name, char other[FOLDER_NAME_SIZE])
{
    struct nrrd_header header;
    other[0] = 0;
    if (read_header(folder, name, &header, NULL))
        memcpy(other, header.data_file, FOLDER_NAME_SIZE);
    nrrd_header_finish(&header);
}

static const char *const names[] = { ".seg.nrrd", ".nrrd", ".nhdr", NULL };
static const struct grid_reader grids = {
    .peek = peek, .read = read_grid, .read_layers = read_layers, .map_endings = names
};
const struct part_reader part_nrrd = { .word = "NRRD",
                                       .names = names,
                                       .reads = PART_READS_GRIDS,
                                       .grid = &grids,
                                       .estimate = estimate,
                                       .summarise = summarise,
                                       .find_companion = find_companion };

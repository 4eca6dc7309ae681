/* Reads NRRD files of a plan's folder. */
#include "core/load/nrrd_parts.h"

#define DATA_FILE_MAX_BYTES (VOLUME_MAX_BYTES + NRRD_HEAD_BYTES)

bool plan_nrrd_peek(const struct folder *folder, const char *name, struct nrrd_header *header, struct error *err)
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

struct volume *plan_nrrd_read(const struct folder *folder, const char *name, enum raw_use use, struct report *report,
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

bool plan_nrrd_read_layers(const struct folder *folder, const char *name, struct nrrd_layers *layers,
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

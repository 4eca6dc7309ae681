/* Reads NIfTI files of a plan's folder, single or in pairs. */
#include "core/load/nifti_parts.h"

#include <stdio.h>
#include <string.h>

#include "core/formats/gzip.h"
#include "core/formats/text.h"
#include "core/load/loading.h"
#include "core/load/reader_table.h"

enum { HEAD_BYTES = 1 << 16 };
#define DATA_FILE_MAX_BYTES (VOLUME_MAX_BYTES + (1 << 20))

static const char *const head_endings[] = { ".hdr", ".hdr.gz" }, *const voxel_endings[] = { ".img", ".img.gz" };

/* Index of the ending that name has; -1: neither. */
static int ending_of(const char *name, const char *const endings[2])
{
    return text_has_ending(name, endings[1]) ? 1 : text_has_ending(name, endings[0]) ? 0 : -1;
}

bool plan_nifti_is_pair(const char *name)
{
    return ending_of(name, head_endings) >= 0 || ending_of(name, voxel_endings) >= 0;
}

/* Finds the file with the same stem and one of two endings; tries first the ending packed like the named file. */
static bool find_other(const struct folder *folder, const char *name, size_t stem, const char *const endings[2],
                       int packing, char other[FOLDER_NAME_SIZE])
{
    bool is_upper = name[stem + 1] >= 'A' && name[stem + 1] <= 'Z';
    for (int turn = 0; turn < 2; turn++) {
        int n =
            snprintf(other, FOLDER_NAME_SIZE, "%.*s%s", (int)stem, name, endings[turn == 0 ? packing : 1 - packing]);
        if (n < 0 || n >= FOLDER_NAME_SIZE)
            continue;
        for (char *c = other + stem; is_upper && *c; c++)
            if (*c >= 'a' && *c <= 'z')
                *c = (char)(*c - 'a' + 'A');
        if (folder_look(folder, other, NULL) == FOLDER_FILE)
            return true;
    }
    other[0] = 0;
    return false;
}

bool plan_nifti_find_pair(const struct folder *folder, const char *name, struct nifti_pair *pair, struct error *err)
{
    int head = ending_of(name, head_endings), voxels = ending_of(name, voxel_endings);
    bool is_head = head >= 0;
    int packing = is_head ? head : voxels;
    *pair = (struct nifti_pair){ 0 };
    if (packing < 0)
        return error_set(err, ERROR_FORMAT, "%s: expected a file that ends in .hdr or .img", name);
    size_t stem = strlen(name) - strlen(head_endings[packing]);
    char *named = is_head ? pair->head : pair->voxels, *other = is_head ? pair->voxels : pair->head;
    snprintf(named, FOLDER_NAME_SIZE, "%s", name);
    return find_other(folder, name, stem, is_head ? voxel_endings : head_endings, packing, other) ||
           error_set(err, ERROR_NOT_FOUND, "%s: %s, is not there", name,
                     is_head ? "the voxels, the file of the same name with .img or .img.gz"
                             : "the header, the file of the same name with .hdr or .hdr.gz");
}

void plan_nifti_voxels(const struct folder *folder, const char *name, char voxels[FOLDER_NAME_SIZE])
{
    struct nifti_pair pair;
    if (!plan_nifti_is_pair(name))
        snprintf(voxels, FOLDER_NAME_SIZE, "%s", name);
    else if (plan_nifti_find_pair(folder, name, &pair, NULL))
        memcpy(voxels, pair.voxels, FOLDER_NAME_SIZE);
    else
        voxels[0] = 0;
}

bool plan_nifti_peek(const struct folder *folder, const char *name, struct nifti_header *header, struct error *err)
{
    struct nifti_pair pair;
    struct bytes head;
    bool is_pair = plan_nifti_is_pair(name);
    if (is_pair && !plan_nifti_find_pair(folder, name, &pair, err))
        return false;
    const char *head_name = is_pair ? pair.head : name;
    if (!folder_read(folder, head_name, UINT64_MAX, HEAD_BYTES, &head, err))
        return false;
    bool is_read =
        nifti_peek(&head, head_name, header, NULL, err) && nifti_check_place(header, is_pair, head_name, err);
    bytes_free(&head);
    return is_read;
}

static struct volume *read_pair(const struct folder *folder, const char *name, enum raw_use use, struct report *report,
                                struct error *err)
{
    struct nifti_pair pair;
    struct bytes head, voxels;
    struct volume *volume = NULL;
    if (!plan_nifti_find_pair(folder, name, &pair, err) ||
        !folder_read(folder, pair.head, UINT64_MAX, HEAD_BYTES, &head, err))
        return NULL;
    if (folder_read(folder, pair.voxels, DATA_FILE_MAX_BYTES, UINT64_MAX, &voxels, err)) {
        volume = nifti_read_pair(&head, pair.head, &voxels, pair.voxels, use, report, err);
        bytes_free(&voxels);
    }
    bytes_free(&head);
    return volume;
}

struct volume *plan_nifti_read(const struct folder *folder, const char *name, enum raw_use use, struct report *report,
                               struct error *err)
{
    struct bytes bytes;
    if (plan_nifti_is_pair(name))
        return read_pair(folder, name, use, report, err);
    if (!folder_read(folder, name, DATA_FILE_MAX_BYTES, UINT64_MAX, &bytes, err))
        return NULL;
    struct volume *volume = nifti_read(&bytes, name, use, report, err);
    bytes_free(&bytes);
    return volume;
}

/* ---- the format's reader ---------------------------------------------------------------------------------------- */

static bool peek(const struct folder *folder, const char *name, struct grid_facts *facts, struct error *err)
{
    struct nifti_header header;
    if (!plan_nifti_peek(folder, name, &header, err))
        return false;
    *facts = (struct grid_facts){ .grid = header.grid, .n_layers = 1 };
    return true;
}

/* True if this file of a pair must be passed over: a pair is taken once, by its header, and by the unpacked header
 * where there are two. */
static bool is_second_of_pair(const struct folder *folder, const char *name)
{
    struct nifti_pair pair, other;
    if (!plan_nifti_is_pair(name) || !plan_nifti_find_pair(folder, name, &pair, NULL))
        return false;
    if (strcmp(pair.head, name) != 0)
        return true;
    return text_has_ending(name, ".gz") && plan_nifti_find_pair(folder, pair.voxels, &other, NULL) &&
           strcmp(other.head, name) != 0;
}

static struct part_need estimate(const struct loading *loading, const struct part_reading *reading, enum raw_use use)
{
    struct bytes head;
    struct nifti_header header;
    char voxels[FOLDER_NAME_SIZE];
    struct part_need need = { reading->bytes, 0 };
    plan_nifti_voxels(&loading->folder, reading->path, voxels);
    if (!plan_nifti_peek(&loading->folder, reading->path, &header, NULL) ||
        !folder_read(&loading->folder, voxels, UINT64_MAX, 2, &head, NULL))
        return need;
    bool is_packed = gzip_is(head.data, head.size);
    bytes_free(&head);
    return part_need_of_voxels(grid_n_voxels(&header.grid), header.type, use, reading->bytes,
                               is_packed || header.is_swapped || header.data_at % 8 != 0, is_packed);
}

static bool summarise(const struct folder *folder, const char *name, struct part_summary *summary, struct error *err)
{
    struct nifti_header header;
    plan_nifti_voxels(folder, name, summary->data);
    if (strcmp(summary->data, name) == 0)
        summary->data[0] = 0;
    return plan_nifti_peek(folder, name, &header, err);
}

static void find_companion(const struct folder *folder, const char *name, char other[FOLDER_NAME_SIZE])
{
    struct nifti_pair pair;
    other[0] = 0;
    if (plan_nifti_is_pair(name) && plan_nifti_find_pair(folder, name, &pair, NULL))
        memcpy(other, strcmp(pair.head, name) == 0 ? pair.voxels : pair.head, FOLDER_NAME_SIZE);
}

static const char *const names[] = { ".nii", ".nii.gz", NULL };
static const char *const pair_names[] = { ".hdr", ".hdr.gz", ".img", ".img.gz", NULL }; /* DICOM slices may be .img */
static const char *const map_endings[] = { ".nii.gz", ".nii", ".hdr", ".hdr.gz", NULL };
static const struct grid_reader grids = {
    .peek = peek, .read = plan_nifti_read, .is_passed_over = is_second_of_pair, .map_endings = map_endings
};
const struct part_reader part_nifti = { .word = "NIfTI",
                                        .names = names,
                                        .names_in_doubt = pair_names,
                                        .reads = PART_READS_GRIDS,
                                        .grid = &grids,
                                        .estimate = estimate,
                                        .summarise = summarise,
                                        .find_companion = find_companion };

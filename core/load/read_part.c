/* Reads one listed file of a plan. */
#include "core/load/read_part.h"

#include <string.h>

#include "core/base/mem.h"
#include "core/formats/plan/plan_json.h"
#include "core/load/part_names.h"
#include "core/load/reader_table.h"

static bool read_grid(const struct grid_reader *grid, const struct folder *folder, struct part_reading *reading,
                      enum raw_use use)
{
    reading->volume = grid->read(folder, reading->path, use, &reading->report, &reading->err);
    return reading->volume != NULL;
}

static bool read_layers(const struct folder *folder, struct part_reading *reading)
{
    reading->layers = mem_new(sizeof *reading->layers);
    return reading->reader->grid->read_layers(folder, reading->path, reading->layers, &reading->report, &reading->err);
}

/* Reads the list of names of a label map. A list that cannot be read is reported, and the map stays without names. */
static bool read_names(const struct folder *folder, const char *path, struct part_reading *reading)
{
    struct bytes bytes = { 0 };
    struct error why = { 0 };
    if (!path[0])
        return true;
    bool is_read = folder_read(folder, path, TEXT_FILE_MAX_BYTES, UINT64_MAX, &bytes, &why) &&
                   label_names_parse(bytes.data, bytes.size, path, &reading->names, &why);
    bytes_free(&bytes);
    if (!is_read && loading_may_leave_out(&why)) {
        label_names_finish(&reading->names);
        report_add(&reading->report, REPORT_ERROR, "part.unreadable", path,
                   "Left out: %s. The labels of %.120s go by their numbers.", why.text, reading->path);
        return true;
    }
    if (!is_read)
        reading->err = why;
    if (is_read && reading->names.file[0] &&
        strcmp(part_base_name(reading->names.file), part_base_name(reading->path)) != 0)
        report_add(&reading->report, REPORT_WARNING, "region.names-elsewhere", reading->path,
                   "The list of names, %.120s, says that it belongs to %.120s; "
                   "it was used as the plan says.",
                   path, reading->names.file);
    return is_read;
}

/* True if the file of a label map says itself that it is one: by segments, or by layers. */
static bool says_labels(const struct folder *folder, const struct part_reading *reading)
{
    struct grid_facts facts;
    const struct grid_reader *grid = reading->reader->grid;
    return grid->read_layers &&
           (!grid->peek(folder, reading->path, &facts, NULL) || facts.has_segments || facts.n_layers > 1);
}

/* Reads a file that is called like a label map; when its values are no labels, as an image. */
static bool read_by_content(const struct folder *folder, struct part_reading *reading)
{
    const struct grid_reader *grid = reading->reader->grid;
    bool is_read = read_grid(grid, folder, reading, RAW_LABELS);
    if (!is_read && reading->err.code == ERROR_RANGE) {
        report_finish(&reading->report);
        reading->err = (struct error){ 0 };
        reading->is_no_labels = true;
        return read_grid(grid, folder, reading, RAW_IMAGE);
    }
    if (!is_read)
        return false;
    grid_content_measure(reading->volume, true, &reading->content);
    reading->is_no_labels = !grid_content_is_labels(&reading->content, true);
    return true;
}

static bool read_image(const struct loading *loading, struct part_reading *reading)
{
    if (!read_grid(reading->reader->grid, &loading->folder, reading, RAW_IMAGE))
        return false;
    if (loading->parts.is_recognised) {
        grid_content_measure(reading->volume, false, &reading->content);
        reading->is_label_like = grid_content_is_labels(&reading->content, false);
    }
    return true;
}

static bool read_region(const struct loading *loading, struct part_reading *reading)
{
    const struct plan_file_region *region = &loading->file->regions[reading->index];
    const struct grid_reader *grid = reading->reader->grid;
    if (loading->parts.is_recognised && !says_labels(&loading->folder, reading))
        return read_by_content(&loading->folder, reading) &&
               (reading->is_no_labels || read_names(&loading->folder, region->names, reading));
    if (!read_names(&loading->folder, region->names, reading))
        return false;
    if (grid->read_layers && !region->name[0])
        return read_layers(&loading->folder, reading);
    return read_grid(grid, &loading->folder, reading, region->name[0] ? RAW_MASK : RAW_LABELS);
}

/* Reads a volume that belongs to a dose; any other file is refused as NIfTI. */
static bool read_beside_dose(const struct loading *loading, struct part_reading *reading, enum raw_use use)
{
    const struct part_reader *reader = reading->reader->grid ? reading->reader : &part_nifti;
    return read_grid(reader->grid, &loading->folder, reading, use);
}

static bool read_dose_error(const struct loading *loading, struct part_reading *reading)
{
    const struct grid_reader *grid = reading->reader->grid;
    if (!grid || !grid->read_error)
        return read_beside_dose(loading, reading, RAW_IMAGE);
    reading->volume = grid->read_error(&loading->folder, reading->path, &reading->err);
    return reading->volume != NULL;
}

bool plan_read_part(struct loading *loading, struct part_reading *reading)
{
    switch (reading->kind) {
    case PART_KIND_DOSE_ERROR: return read_dose_error(loading, reading);
    case PART_KIND_DOSE_MASK: return read_beside_dose(loading, reading, RAW_MASK);
    default: break;
    }
    if (!reading->reader->grid)
        return reading->reader->read(loading, reading);
    switch (reading->kind) {
    case PART_KIND_IMAGE: return read_image(loading, reading);
    case PART_KIND_REGION: return read_region(loading, reading);
    default: return read_grid(reading->reader->grid, &loading->folder, reading, RAW_IMAGE);
    }
}

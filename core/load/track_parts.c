/* Reads files of particle tracks. */
#include "core/formats/sera/sera_pp.h"
#include "core/formats/text.h"
#include "core/formats/track_csv.h"
#include "core/load/reader_table.h"
#include "core/plan/plan.h"

static bool read_pp(struct plan *plan, const struct plan_file_tracks *entry, const struct bytes *bytes, double *unit_mm,
                    struct error *err)
{
    size_t first = plan->tracks.n_segments;
    if (!pp_parse(bytes->data, bytes->size, entry->path, &plan->tracks, &plan->report, err))
        return false;
    *unit_mm = pp_unit_mm(&plan->tracks, first, entry->mm, &plan->bounds_lps_mm, entry->path, &plan->report);
    if (!(*unit_mm > 0))
        return error_set(err, ERROR_MEMORY, "%s: no memory to tell its unit", entry->path);
    pp_scale(&plan->tracks, first, *unit_mm, entry->path, &plan->report);
    return true;
}

static const char *const pp_names[] = { ".pp", NULL };
const struct part_reader part_pp = { .word = "SERA tracks",
                                     .names = pp_names,
                                     .recognise = recognition_add_tracks,
                                     .tracks_max_bytes = PP_MAX_BYTES,
                                     .read_tracks = read_pp };

/* The columns of a table say their unit. */
static bool read_table(struct plan *plan, const struct plan_file_tracks *entry, const struct bytes *bytes,
                       double *unit_mm, struct error *err)
{
    *unit_mm = 1;
    if (entry->mm > 0 && entry->mm != 1)
        report_add(&plan->report, REPORT_WARNING, "tracks.unit-doubtful", entry->path,
                   "The plan says the tracks are in cm, but the columns of the table are in mm; mm was taken.");
    return track_csv_parse(bytes->data, bytes->size, entry->path, &plan->tracks, &plan->report, err);
}

static bool is_table(const struct folder *folder, const char *name, struct error *err)
{
    uint8_t head[1024];
    struct folder_part part;
    if (!text_has_ending(name, ".csv") || !folder_open_part(folder, name, &part, err))
        return false;
    size_t n = part.n_bytes < sizeof head ? (size_t)part.n_bytes : sizeof head;
    bool is_read = folder_read_part(&part, name, 0, head, n, err);
    folder_close_part(&part);
    return is_read && track_csv_looks_like(head, n);
}

const struct part_reader part_track_csv = { .word = "a table of tracks",
                                            .looks_like = is_table,
                                            .recognise = recognition_add_tracks,
                                            .tracks_max_bytes = TRACK_CSV_MAX_BYTES,
                                            .read_tracks = read_table };

#pragma once
/* Interface of a format of files: one struct part_reader each, all of them in reader_table.h. A volume format gives a
 * struct grid_reader and an estimate; the steps of loading that all volumes share are written once, in recognise.c,
 * read_part.c and summary.c. Any thread. */
#include "core/formats/nrrd.h"
#include "core/load/recognition.h"

enum part_kind {
    PART_KIND_IMAGE,
    PART_KIND_REGION,
    PART_KIND_DOSE,
    PART_KIND_DOSE_MASK,
    PART_KIND_DOSE_ERROR,
    PART_KIND_BEAMS
};
/* Bits of part_reader.reads. */
enum {
    PART_READS_IMAGES = 1 << PART_KIND_IMAGE,
    PART_READS_REGIONS = 1 << PART_KIND_REGION,
    PART_READS_DOSES = 1 << PART_KIND_DOSE,
    PART_READS_GRIDS = PART_READS_IMAGES | PART_READS_REGIONS | PART_READS_DOSES
};

struct loading;
struct part_reading;
struct plan;

/* Facts of a volume's header. */
struct grid_facts {
    struct grid grid;
    bool has_segments; /* the file names labels itself */
    size_t n_layers;   /* of a label map; at least 1 */
};

/* A file of voxels on a grid: an image, a label map, a component of a dose. errors as folder_read and the format's
 * reader; the text names the file. */
struct grid_reader {
    bool (*peek)(const struct folder *folder, const char *name, struct grid_facts *facts, struct error *err);
    struct volume *(*read)(const struct folder *folder, const char *name, enum raw_use use, struct report *report,
                           struct error *err);
    /* Reads the statistical errors that the file of a dose holds beside its values, and says whether there are any;
     * NULL: the format has none. */
    bool (*has_error)(const struct folder *folder, const char *name);
    struct volume *(*read_error)(const struct folder *folder, const char *name, struct error *err);
    /* Reads a label map of several layers, with the names that the file gives; NULL: the format has neither. */
    bool (*read_layers)(const struct folder *folder, const char *name, struct nrrd_layers *layers,
                        struct report *report, struct error *err);
    /* True for a file that another one stands for, such as the second of a pair; NULL: there is none. */
    bool (*is_passed_over)(const struct folder *folder, const char *name);
    const char *const *map_endings; /* of label maps; a list of names may be called after the map */
};

/* Bytes of memory for one file: kept stays with the plan, work is freed once the file is read. */
struct part_need {
    uint64_t kept, work;
};
/* For voxels of a type. is_copied: they are unpacked or converted before raw_read; is_taken: that copy may become the
 * volume's own. */
struct part_need part_need_of_voxels(uint64_t n_voxels, enum raw_type type, enum raw_use use, uint64_t file_bytes,
                                     bool is_copied, bool is_taken);

/* Facts of a part from names and headers, for the list of plans. */
struct part_summary {
    size_t n_regions;            /* of a file that is regions alone */
    size_t n_segments;           /* labels that a label map names itself */
    char data[FOLDER_NAME_SIZE]; /* the file beside it that holds its voxels; "" none */
};

struct part_reader {
    const char *word; /* "NIfTI", "DICOM", ...: for the report */
    /* Names that are the format's, whatever the content: an ending with its dot, or the whole name. Then names that are
     * the format's unless the first bytes say another one. Both end with NULL, and may be NULL. */
    const char *const *names, *const *names_in_doubt;
    /* True if a file that no name decides is the format's. err: why its first bytes could not be read. NULL: never. */
    bool (*looks_like)(const struct folder *folder, const char *name, struct error *err);
    unsigned reads;                 /* kinds of parts that a file may be */
    size_t n_doses;                 /* how many quantities a file of a dose holds, when they are several */
    const struct grid_reader *grid; /* NULL: not a volume */
    /* Makes a part of a file in a folder without plan.json. NULL: of a volume its header and name decide. */
    void (*recognise)(struct recognition *all, char *name);
    /* NULL: four times the size of the file. use: how the voxels of a volume are read. */
    struct part_need (*estimate)(const struct loading *loading, const struct part_reading *reading, enum raw_use use);
    /* Checks that the files exist and that the header is valid; also after a failure summary is valid. NULL: the index
     * of DICOM files says it. */
    bool (*summarise)(const struct folder *folder, const char *name, struct part_summary *summary, struct error *err);
    /* Fills a listed reading as plan_read_part does. NULL: a volume. */
    bool (*read)(struct loading *loading, struct part_reading *reading);
    /* The file beside it that is read with it; "" none. NULL: none. */
    void (*find_companion)(const struct folder *folder, const char *name, char other[FOLDER_NAME_SIZE]);
    /* Particle tracks: the size of a file at most, and its segments to the plan's. unit_mm: receives the length of the
     * file's unit. */
    size_t tracks_max_bytes;
    bool (*read_tracks)(struct plan *plan, const struct plan_file_tracks *entry, const struct bytes *bytes,
                        double *unit_mm, struct error *err);
};

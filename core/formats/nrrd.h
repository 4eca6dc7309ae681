#pragma once
/* Reads NRRD: one grid with its voxels after the header (.nrrd) or in a file beside it (.nhdr), and 3D Slicer's
 * .seg.nrrd, layers of labels with the segments' names and colours. Works on bytes in memory; opens no file. source G.
 * Kindlmann, "Definition of NRRD File Format" (Teem); 3D Slicer's segmentation keys (Segment0_Name ...). Differs: every
 * assumption about left and right is reported; series of volumes are refused. */
#include "core/formats/plan_file.h"
#include "core/formats/raw_voxels.h"

enum {
    NRRD_HEAD_BYTES = 1 << 20, /* longest header */
    NRRD_MAX_VALUE = 4096,     /* longest value of a field */
    NRRD_MAX_SEGMENTS = REGION_MAX,
    NRRD_MAX_SKIP = 1 << 30 /* of "byte skip" and "line skip" */
};

struct nrrd_segment {
    bool is_present, has_layer, has_bad_label;
    char name[REGION_NAME_SIZE];
    uint32_t layer;
    uint16_t label;
    bool has_color;
    uint8_t rgb[3];
};

struct nrrd_header {
    struct grid grid;
    enum raw_type type;
    uint32_t voxel_bytes;
    bool is_swapped;       /* the file's byte order is the other one than this machine's */
    bool is_packed;        /* the voxels are a gzip stream */
    uint32_t n_layers;     /* 1 for an image */
    bool is_layer_fastest; /* each voxel's values of all layers lie together; else one layer follows the other */
    char list_kind[16];    /* kind of the axis of layers, in the file's word */
    uint64_t data_bytes;   /* of the voxels of all layers, unpacked */
    int64_t byte_skip;     /* -1: the voxels are the last bytes of the file */
    uint64_t line_skip;
    size_t head_bytes;                /* length of the header; the voxels follow it when they are attached */
    char data_file[FOLDER_NAME_SIZE]; /* file of the voxels, relative to the plan's folder; "" attached */
    struct nrrd_segment *segments;    /* NULL when the file names none */
    size_t n_segments;
};

/* Reads and checks a header; head holds the first bytes of the file, NRRD_HEAD_BYTES are enough.
 *   name     of the file in the plan's folder: for error and report, and to find its data file; report may be NULL
 *   errors   ERROR_FORMAT, ERROR_UNSUPPORTED (an encoding, a series of volumes), ERROR_RANGE (geometry, a data file
 *            outside the folder), ERROR_LIMIT; the text names the line
 * The caller calls nrrd_header_finish, also after a failure. */
NODISCARD bool nrrd_parse_header(const uint8_t *head, size_t size, const char *name, struct nrrd_header *header,
                                 struct report *report, struct error *err);
void nrrd_header_finish(struct nrrd_header *header);

/* Reads a grid of one layer.
 *   data     the whole file that holds the voxels; data_name: its name, for error and report
 *   returns  the volume, measured. One reference, the caller's; NULL on failure.
 *   errors   ERROR_UNSUPPORTED more than one layer; as raw_unpack and raw_read */
NODISCARD struct volume *nrrd_read(const struct nrrd_header *header, const struct bytes *data, const char *data_name,
                                   enum raw_use use, struct report *report, struct error *err);

/* The layers of a label map. names[i]: names of the segments in volumes[i]; empty when the file gives none. */
struct nrrd_layers {
    struct volume *volumes[REGION_MAX_LAYERS];
    struct label_names names[REGION_MAX_LAYERS];
    size_t n;
};
/* Reads every layer as labels. errors as nrrd_read; ERROR_LIMIT more than REGION_MAX_LAYERS. layers is empty after a
 * failure. */
NODISCARD bool nrrd_read_layers(const struct nrrd_header *header, const struct bytes *data, const char *data_name,
                                struct nrrd_layers *layers, struct report *report, struct error *err);
void nrrd_layers_finish(struct nrrd_layers *layers); /* volumes that were moved out are NULL */

/* Used by nrrd_header.c alone: reads a "key:=value" of a segment; returns false for any other key. */
bool nrrd_segment_key(struct nrrd_header *header, const char *name, size_t line, const char *key, const char *value,
                      struct report *report);
/* Used by nrrd_header.c alone, once the number of layers is known: reports faulty segments and removes them. */
void nrrd_segments_check(struct nrrd_header *header, const char *name, struct report *report);

#pragma once
/* Draws particle tracks: segments are projected and sorted into the bands of a picture, then drawn band by band. The
 * rule that lines follow stands in core/render/visible/draw.h. */
#include "core/base/image.h"
#include "core/render/soft/kernels.h"
#include "core/render/visible/draw.h"

/* Segments that are projected and sorted at a time. */
enum { SOFT_TRACK_CHUNK = 2048 };
enum { SOFT_TRACK_LEVELS = 256 };
/* Columns of a tile of a band, and how many chunks are drawn until the tiles' farthest depths are looked up again: in a
 * picture full of tracks most of them are behind others. */
enum { SOFT_TRACK_TILE = 32, SOFT_TRACK_TILES = 2 * IMAGE_MAX_SIDE_PX / SOFT_TRACK_TILE + 1, SOFT_TRACK_LOOK = 8 };

enum {
    SOFT_TRACK_TALL = 1,   /* rises by more than it runs: one sample a row, else one a column */
    SOFT_TRACK_DASHED = 2, /* by its class */
    SOFT_TRACK_CUT = 4     /* a clip plane cuts it or is near: each sample is tested */
};

/* A line in the picture; places are in samples. Along: from column to column, of a tall one from row to row. */
struct soft_track_line {
    uint8_t class, flags;
    union {
        uint16_t cue;    /* thin: of the first sample, in 1 / 256 levels */
        uint8_t cues[2]; /* wide: at both ends, in levels */
    };
    union {
        struct {
            int16_t first, n;           /* columns (rows) along */
            int32_t at, step;           /* across, in 1 / 65536 samples, and its change along */
            float z, z_step, cue_step;  /* at the first sample, and change along */
            uint16_t phase, phase_step; /* of the dashes, in 1 / 65536 of a period */
        } thin;
        struct {
            float x[2], y[2], z[2];
            float phase; /* at the first end, in periods */
        } wide;
    };
};
_Static_assert(sizeof(struct soft_track_line) == 32, "half a line of a processor's cache");

/* The bands that a line reaches. */
struct soft_track_reach {
    uint16_t first_band, last_band;
};

/* The tracks of a picture, as the loops need them. Rows are applied to (x, y, z, 1). */
struct soft_track_view {
    const struct draw_tracks *tracks;
    float row_x[4], row_y[4], row_z[4], row_w[4]; /* give samples times w, depth times w, w */
    float row_ahead[4];                           /* mm beyond nearest_mm */
    float row_cue[4];
    struct soft_cuts cuts;
    float near_cut_mm;                /* a line within this height of a clip plane may have samples above it */
    float cut_rows[SOFT_MAX_CUTS][4]; /* by cut, applied to a sample's (x, y, z, 1): not negative where it is kept */
    int width, height, n_bands;       /* in samples */
    float margin;                     /* what lies farther than this outside of the picture cannot reach into it */
    float line_width;                 /* in samples */
    float cross;                      /* half the side of a cross, in samples */
    bool is_thin;
    uint32_t special;                                    /* bit by class: drawn by soft_track_special */
    float periods[TRACK_N_CLASSES];                      /* of dashes, in a sample; 0: none */
    float dashes[TRACK_N_CLASSES];                       /* part of a period that is drawn */
    uint32_t colors[TRACK_N_CLASSES][SOFT_TRACK_LEVELS]; /* by level of the cue, 255: full */
};
/* scope, draw: of the picture, borrowed. */
void soft_track_view_init(struct soft_track_view *view, const struct draw *draw, const struct draw_scope *scope,
                          int width, int height, int n_bands);

struct soft_track_kernels {
    /* Lines of the segments first .. first + n - 1 that need nothing special: lines and reaches have room for n.
     * Returns how many. special: numbers of the segments that soft_track_special draws, n at most. */
    size_t (*project)(const struct soft_track_view *view, size_t first, size_t n, struct soft_track_line *lines,
                      struct soft_track_reach *reaches, uint32_t *special, size_t *n_special);
    /* The farthest depth in each SOFT_TRACK_TILE columns of a band; 1 in the last ones if they are fewer. */
    void (*find_farthest)(const struct soft_band *band, float *farthest);
    /* Draws lines into a band; all of them are tall, or none. Those behind `farthest` are passed over. */
    void (*raster)(const struct soft_track_view *view, const struct soft_band *band, const float *farthest,
                   const struct soft_track_line *lines, size_t n, bool is_tall);
};
extern const struct soft_track_kernels soft_track_kernels_portable;
const struct soft_track_kernels *soft_track_kernels_of(const struct soft_kernels *kernels);

/* The memory in which a thread projects a chunk. */
struct soft_track_scratch {
    struct soft_track_line *lines;
    struct soft_track_reach *reaches;
    size_t n, lines_capacity, reaches_capacity;
    uint32_t special[SOFT_TRACK_CHUNK];
};
void soft_track_scratch_finish(struct soft_track_scratch *scratch);

/* Adds the lines of a segment that is cut, leaves the picture or the range of depths, or has a cross. False: no memory.
 */
NODISCARD bool soft_track_special(const struct soft_track_view *view, size_t segment,
                                  struct soft_track_scratch *scratch);

/* The lines of a chunk: of band b those that are not tall are starts[2 b] .. starts[2 b + 1] - 1, then the tall ones up
 * to starts[2 b + 2] - 1. */
struct soft_track_chunk {
    struct soft_track_line *lines;
    uint32_t *starts;
    size_t lines_capacity, starts_capacity;
};
void soft_track_chunk_finish(struct soft_track_chunk *chunk);
static inline size_t soft_track_n_chunks(const struct draw_tracks *tracks)
{
    return (tracks->shown.end - tracks->shown.first + SOFT_TRACK_CHUNK - 1) / SOFT_TRACK_CHUNK;
}
/* The chunks of a picture, kept from picture to picture. */
struct soft_track_chunks {
    struct soft_track_chunk *chunks;
    size_t n;
};
/* Makes room for n chunks. errors ERROR_MEMORY */
NODISCARD bool soft_track_chunks_resize(struct soft_track_chunks *chunks, size_t n, struct error *err);
void soft_track_chunks_finish(struct soft_track_chunks *chunks);
/* Fills chunk number `index` of the tracks. False: no memory. */
NODISCARD bool soft_track_chunk_sort(struct soft_track_chunk *chunk, size_t index, const struct soft_track_view *view,
                                     const struct soft_track_kernels *kernels, struct soft_track_scratch *scratch);
/* Draws the lines of the first n chunks in a band. index: the band's number. */
void soft_tracks_draw(const struct soft_track_view *view, const struct soft_track_kernels *kernels,
                      const struct soft_track_chunks *chunks, size_t n, const struct soft_band *band, int index);

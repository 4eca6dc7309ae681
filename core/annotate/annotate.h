#pragma once
/* Paints what a report needs onto a finished picture: letters and a scale bar on it, a caption below it. From plain
 * data; knows no plan, no scene and no back end. describe.h fills the data from a snapshot. */
#include <stdint.h>

#include "core/annotate/letters.h"
#include "core/base/image.h"

/* Rows of a caption. Items of one row stand beside each other, and go on below where the row is full. */
enum annotation_row {
    ANNOTATION_TITLE, /* in a larger font */
    ANNOTATION_WORDS, /* of whoever orders the picture */
    ANNOTATION_PANE,
    ANNOTATION_BEAM,
    ANNOTATION_REGIONS,
    ANNOTATION_DOSE,
    ANNOTATION_LEVELS,
    ANNOTATION_METHODS,
    ANNOTATION_MISSING,
    ANNOTATION_ORIGIN,
    ANNOTATION_USE,
    ANNOTATION_N_ROWS
};
enum { ANNOTATION_TEXT_SIZE = 256 };
struct annotation_item {
    enum annotation_row row;
    bool has_chip; /* a square of the colour stands before the text */
    uint8_t rgb[3];
    char text[ANNOTATION_TEXT_SIZE]; /* UTF-8, also hostile (font.h) */
};

/* A line on the picture, a pixel and a half wide. Places are in parts of the picture's width and height, y down. */
struct annotation_line {
    double from[2], to[2];
    uint32_t rgb;
};
/* A word on the picture: its middle at the place, or above it and to the right. */
struct annotation_label {
    double at[2];
    bool is_centred;
    char text[ANNOTATION_TEXT_SIZE + 128]; /* UTF-8, also hostile */
};

struct annotations {
    struct edge_letters letters;
    struct annotation_line *lines; /* owned; [n_lines] */
    size_t n_lines;
    struct annotation_label *labels; /* owned; [n_labels] */
    size_t n_labels;
    double pixels_per_mm;          /* of the picture as it is; 0: no scale bar */
    bool is_on_light;              /* letters and scale bar are dark with a light rim */
    bool has_no_caption;           /* letters and scale bar alone: the items are told elsewhere */
    struct annotation_item *items; /* owned; [n_items], row by row */
    size_t n_items;
    size_t patient; /* number of the item that names the patient, masked, counted from 1; 0: none does */
};
/* Appends an item, of the row of the last one or of a later row; the caller has made room for it. */
struct annotation_item *annotation_add(struct annotations *annotations, enum annotation_row row);
/* Adds a sentence by its clauses, so that a narrow caption breaks it and elides nothing; at most ANNOTATION_MAX_CLAUSES
 * items. */
enum { ANNOTATION_MAX_CLAUSES = 4 };
void annotation_add_sentence(struct annotations *annotations, enum annotation_row row, const char *sentence);
void annotations_finish(struct annotations *annotations);

/* Lines of a row before its last one says how many more items there are. */
enum { ANNOTATE_MAX_LINES = 6 };
/* A picture that is narrower becomes this wide, white at its right. */
enum { ANNOTATE_MIN_WIDTH_PX = 320 };
/* The height of a caption, at most. */
enum { ANNOTATE_MAX_CAPTION_PX = 1024 };
/* Length and place of the scale bar on a picture. length_mm 0: none, because no round length fits. */
struct scale_bar {
    double length_mm;
    int x_px, y_px, length_px; /* the bar's left end, its line */
};
struct scale_bar annotate_scale_bar(int width_px, int height_px, double pixels_per_mm);
/* Size of the text on a picture of this width. */
int annotate_text_px(int width_px);

/* A copy of the picture with lines, labels, letters and scale bar painted on it, and the caption on white below: as
 * wide as the picture (see ANNOTATE_MIN_WIDTH_PX), higher by the caption. All other pixels of the picture are
 * unchanged. errors ERROR_RANGE   the picture with its caption is higher than IMAGE_MAX_SIDE_PX ERROR_MEMORY thread any
 */
NODISCARD struct image *annotate_image(const struct image *image, const struct annotations *annotations,
                                       struct error *err);

/* Paints words in amber with a dark rim at the image's top left, larger than other words on a picture: for screens that
 * draw nothing themselves. On failure the image is unchanged or painted in part. errors ERROR_MEMORY thread any */
NODISCARD bool annotate_mark(struct image *image, const char *words, struct error *err);

#pragma once
/* Labels of the isodose lines in a picture: what they say and where they stand. The page draws them over its pictures,
 * core/annotate into snapshots. Any thread. */
#include "core/render/visible/isoline_scene.h"
#include "core/render/visible/label_places.h"

enum { ISOLINE_MAX_LABELS = 384, ISOLINE_TEXT_SIZE = 56 };
/* A pane that is lower has no labels. */
enum { ISOLINE_LABELS_MIN_PX = 240 };

struct isoline_label {
    size_t level;             /* index in the scene's dose.levels */
    struct label_place place; /* on the full-size picture */
};
struct isoline_labels {
    struct isoline_label labels[ISOLINE_MAX_LABELS];
    size_t n;
};

/* "90 %", or with the field's unit "12.5 Gy(w)". */
void isoline_text(char text[ISOLINE_TEXT_SIZE], const struct scene_dose_level *level, const char *unit);
/* The width of a text, estimated for sans-serif fonts, at most 5 % too narrow. */
double isoline_text_width_px(const char *text, double text_px);

/* Places the labels of a slice pane's lines, of the dose shown; none in 3-D and in low panes. lines: of the snapshot.
 * text_px: size of the font on the full-size picture. errors ERROR_MEMORY */
enum isoline_labels_for {
    ISOLINE_LABELS_UPRIGHT, /* not turned with the lines */
    ISOLINE_LABELS_TURNED,
    ISOLINE_LABELS_CHOICE, /* turned; many places of each level, none over the outline of a visible target */
};
NODISCARD bool isoline_labels_place(struct isoline_labels *labels, const struct snapshot *snapshot,
                                    const struct isoline_scene *lines, double text_px, enum isoline_labels_for what,
                                    struct error *err);

#pragma once
/* The beam of an annotated picture in words: which one, where along it, its ring; and that a dose belongs to the
 * planned beam while a draft is shown. */
#include "core/annotate/annotate.h"
#include "core/annotate/words.h"

enum { DESCRIBE_BEAM_MAX_ITEMS = 4 };
/* Adds items of the row ANNOTATION_BEAM, at most DESCRIBE_BEAM_MAX_ITEMS: of the views that belong to a beam; of every
 * picture with something of a dose while the scene's beam is a draft. */
void beam_describe(struct annotations *annotations, const struct snapshot *snapshot);

/* Adds the names of the beams that are drawn in space, and along a beam the numbers of the crosshair, the ring's
 * diameter and "planned source end", of a picture that is as wide; numbers only where no label is. camera: the
 * snapshot's. errors ERROR_MEMORY */
NODISCARD bool beam_label(struct annotations *annotations, const struct snapshot *snapshot, const struct camera *camera,
                          int width_px, struct error *err);

/* "beam-1", "beam-1 (AP)" with a name of its own; of a draft "draft of beam-1", "draft steeper of beam-1". */
void beam_words(char text[WORDS_SIZE], const struct snapshot *snapshot, const struct beam_shown *beam);
/* "44.3 mm from source end", "4.4 m before source end": as the page has it. */
void beam_place_words(char text[WORDS_SIZE], double along_mm);

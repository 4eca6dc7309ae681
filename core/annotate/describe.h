#pragma once
/* The annotations of a snapshot's picture: in words, which plan, pane and settings it shows. */
#include "core/annotate/annotate.h"
#include "core/scene/snapshot.h"

enum { ANNOTATE_DATE_SIZE = 24 };
/* The time in UTC, as "2026-07-01 09:30 UTC"; seconds since 1970. */
void annotate_date(int64_t unix_s, char date[ANNOTATE_DATE_SIZE]);

/* Names the patient in full in the caption of annotations that annotations_describe has filled. */
void annotations_name_patient(struct annotations *annotations, const struct plan *plan);

/* Adds a row below the title of annotations that annotations_describe has filled: the items of words, which "; "
 * separates, at most ANNOTATE_MAX_WORDS of them. errors ERROR_MEMORY: nothing is added */
enum { ANNOTATE_MAX_WORDS = 6 };
NODISCARD bool annotations_add_words(struct annotations *annotations, const char *words, struct error *err);

/* Fills annotations, for annotations_finish, also on failure. After the picture of width_px was drawn with full detail:
 * regions whose shape was refused are listed as missing. On a slice pane only regions that reach to its plane are
 * listed. date: as annotate_date gives it.
 *   errors  ERROR_MEMORY
 *   thread  any */
NODISCARD bool annotations_describe(struct annotations *annotations, const struct snapshot *snapshot, int width_px,
                                    const char *date, struct error *err);

#pragma once
/* Words of a caption: numbers, planes, images with their window and colours. From plain data of plan and scene. */
#include "core/scene/snapshot.h"

enum { WORDS_SIZE = 256 }; /* as ANNOTATION_TEXT_SIZE */
enum { WORDS_UNIT_SIZE = 48 };

/* A number as the page writes it: with a true minus, and rounded up where it lies exactly between two. */
void words_number(char text[40], double value, int digits);
/* Three significant figures: "0.0447", "10.0"; before the point all figures stay. As "1.23e+10" below 0.0001 and from
 * ten million on. */
void words_significant(char text[40], double value);
/* The day of a time in ms since 1970: "27 Nov 2026 UTC"; "" of one that no calendar has. Returns text. */
enum { WORDS_DAY_SIZE = 24 };
const char *words_day(int64_t ms, char text[WORDS_DAY_SIZE]);
/* "S 34.0 mm": where a plane square to the patient cuts its axis. Of another one "through L 1.0  P 2.0  S 3.0 mm"; the
 * point is the one that the scene gives of an oblique plane. */
void words_plane(char text[WORDS_SIZE], const struct scene *scene, const struct plane *plane);
/* "normal L 0.00  P 0.71  S 0.71"; "" of a plane square to the patient. */
void words_normal(char text[WORDS_SIZE], const struct plane *plane);
/* The name, or else the id, of the scene's oblique plane that lies there; "": it has none. */
const char *words_plane_name(const struct scene *scene, const struct plane *plane);
/* The image's name with its modality. */
void words_image(char text[WORDS_SIZE], const struct plan *plan, size_t image);
/* The unit of an image's values for people: "Bq/mL" for DICOM's code BQML, "g/mL (SUV)" for GML. A code that is none of
 * DICOM's comes in quotation marks, written to quoted; other text as it is. */
const char *words_unit(const char *unit, char quoted[WORDS_UNIT_SIZE]);
/* "C 40  W 400 HU" */
void words_window(char text[WORDS_SIZE], const struct scene_window *window, const char *unit);
/* "in hot iron"; "" for grey. */
const char *words_color_map(enum scene_color_map map);
/* The image that is blended over the one shown: "50 % PT over it: C 5  W 10 SUV, in hot iron". snapshot->blend >= 0. */
void words_blend(char text[WORDS_SIZE], const struct snapshot *snapshot);

#pragma once
/* What a scene shows of a dose, as the recipe of its field; and whether it may be drawn. Any thread. */
#include "core/derive/dose_field.h"
#include "core/plan/dose_fit.h"
#include "core/region/population.h"
#include "scene.h" /* generated from proto/scene.json */

/* Index of the dose that a scene shows; -1 if the plan has no dose, or none of that id. */
int scene_dose_index(const struct plan *plan, const struct scene *scene);

/* The field that a scene shows of a dose of the plan; of the scene's own dose with the doses added to it.
 *   quantity   the scene's, or another one to be read out beside it
 *   returns    false with a sentence: nothing can be shown
 *   errors     ERROR_NOT_FOUND the dose lacks the quantity, the tissue has no weights; ERROR_LIMIT more than
 *              DOSE_MAX_ROWS different weights */
NODISCARD bool dose_choice_of(const struct plan *plan, const struct scene *scene, size_t dose,
                              enum scene_dose_quantity quantity, struct dose_choice *choice, struct error *why);

/* The same with the weights of one tissue, whatever the scene's dose.tissue says: of the region with that id; "": each
 * tissue's own. For the figures of regions, which no choice of how a dose is drawn may change. */
NODISCARD bool dose_choice_in(const struct plan *plan, const struct scene *scene, size_t dose,
                              enum scene_dose_quantity quantity, const char *tissue, struct dose_choice *choice,
                              struct error *why);
/* Which univels count in a scene's figures of regions. */
enum region_population scene_population(const struct plan *plan, const struct scene *scene);
/* False: no such word; "" and "usual" are what is usual for the plan. */
bool population_from_word(const struct plan *plan, const char *word, enum region_population *population);
/* Whose weights count in a choice of that tissue: "each region's own weights", "weights of brain"; NULL: the quantity
 * depends on no weights. */
const char *dose_basis_words(const struct plan *plan, const struct dose_choice *choice, const char *tissue,
                             char words[96]);

/* The word of a quantity in the scene, "weighted", "thermal-fluence"; and the quantity of a word. */
const char *dose_quantity_scene_word(enum scene_dose_quantity quantity);
bool dose_quantity_from_scene_word(const char *word, enum scene_dose_quantity *quantity);

/* Weights of a region in a scene: its own row, else that of the innermost region around it that has one. NULL: none. */
const struct scene_tissue_weights *scene_weights_of(const struct plan *plan, const struct scene *scene, size_t region);
struct tissue_weights tissue_weights_of(const struct scene_tissue_weights *row);

/* True if a dose may be drawn over the plan's image: it fits, or a person accepted it in this scene. why, unless NULL:
 * on false, one sentence. */
bool scene_dose_may_be_drawn(const struct plan *plan, const struct scene *scene, size_t dose,
                             char why[DOSE_FIT_WHY_SIZE]);

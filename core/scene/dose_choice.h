#pragma once
/* Turns a scene's choice of dose into the recipe of its field, and says whether it may be drawn. Any thread. */
#include "core/derive/dose_field.h"
#include "core/region/population.h"
#include "core/scene/fit_use.h"
#include "scene.h" /* generated from proto/scene.json */

/* Index of the dose that a scene shows; -1 if the plan has no dose, or none of that id. */
int scene_dose_index(const struct plan *plan, const struct scene *scene);

struct snapshot;
/* The field that a snapshot shows of a dose of the plan; of the dose that is named with the doses added to it. This,
 * dose_choice_compared and dose_choice_given are the only ways to the values of a dose: they use what the snapshot's
 * fits use. Doses added
 * that are not used are left out: dose_part_use tells.
 *   quantity   the scene's, or another one to be read out beside it
 *   returns    false with a sentence: nothing can be shown
 *   errors     ERROR_STATE the dose is not used; ERROR_NOT_FOUND it lacks the quantity, the tissue has no weights;
 *              ERROR_LIMIT more than DOSE_MAX_ROWS different weights */
NODISCARD bool dose_choice_of(const struct snapshot *snapshot, size_t dose, enum scene_dose_quantity quantity,
                              struct dose_choice *choice, struct error *why);
/* The field of a second dose beside the one shown, in the unit of that one, with the weights of a tissue as in
 * dose_choice_in. The errors are those of dose_choice_of. */
NODISCARD bool dose_choice_compared(const struct snapshot *snapshot, size_t second, enum scene_dose_quantity quantity,
                                    const char *tissue, struct dose_choice *choice, struct error *why);
/* Whether a dose of scene.dose.sum, or the one of scene.dose.compare, is used with the dose shown. */
struct fit_use dose_part_use(const struct snapshot *snapshot, size_t dose, double factor);
struct fit_use dose_compared_use(const struct snapshot *snapshot, size_t second);
int dose_index_of(const struct plan *plan, const char *id); /* -1: none */

/* Like dose_choice_of, with the weights of one tissue, whatever the scene's dose.tissue says: of the region with that
 * id; "": each tissue's own. For the figures of regions, which no choice of how a dose is drawn may change. */
NODISCARD bool dose_choice_in(const struct snapshot *snapshot, size_t dose, enum scene_dose_quantity quantity,
                              const char *tissue, struct dose_choice *choice, struct error *why);
/* A field of an irradiation. */
struct dose_given {
    size_t dose; /* index in the plan */
    double factor;
    double blood_ppm; /* boron-10 in blood while it is given */
    bool is_measured; /* blood_ppm was measured, so the dose has to depend on it */
};
/* The sum of fields that are given one after the other, in the unit of the first; without the scene's factor and
 * dose.sum. tissue: as in dose_choice_in.
 * errors   those of dose_choice_of; ERROR_STATE a field is not used with the first, or is measured and its dose holds
 *          boron of another concentration, or of one that is not stated */
NODISCARD bool dose_choice_given(const struct snapshot *snapshot, const struct dose_given *given, size_t n,
                                 enum scene_dose_quantity quantity, const char *tissue, struct dose_choice *choice,
                                 struct error *why);
/* Which univels count in a scene's figures of regions. */
enum region_population scene_population(const struct plan *plan, const struct scene *scene);
/* False: no such word; "" and "usual" are what is usual for the plan. */
bool population_from_word(const struct plan *plan, const char *word, enum region_population *population);
/* Names the weights that count in a choice of that tissue: "each region's own weights", "weights of brain"; NULL: the
 * quantity depends on no weights. */
const char *dose_basis_words(const struct plan *plan, const struct dose_choice *choice, const char *tissue,
                             char words[96]);

/* The word of a quantity in the scene, "weighted", "thermal-fluence"; and the quantity of a word. */
const char *dose_quantity_scene_word(enum scene_dose_quantity quantity);
bool dose_quantity_from_scene_word(const char *word, enum scene_dose_quantity *quantity);

/* Weights of a region in a scene: its own row, else that of the innermost region around it that has one. NULL: none. */
const struct scene_tissue_weights *scene_weights_of(const struct plan *plan, const struct scene *scene, size_t region);
struct tissue_weights tissue_weights_of(const struct scene_tissue_weights *row);

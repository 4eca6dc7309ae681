#pragma once
/* Inside server/renderer: what the answers to questions about doses have in common. */
#include "core/dose/dvh_metrics.h"
#include "core/scene/dose_scale.h"
#include "server/wire/document.h"

/* Adds the basis that every read-out of the snapshot's dose states beside its numbers; snapshot->dose >= 0. */
void dose_add_basis(cJSON *json, const struct snapshot *snapshot, const struct dose_scale *scale);
/* accepted: {by, words}, or null. */
void dose_add_accepted(cJSON *json, const struct fit_use *use);
void dose_add_weights(cJSON *json, const struct snapshot *snapshot); /* a row for each region with weights */
/* False with problem: the plan has no dose. */
NODISCARD bool dose_is_there(const struct snapshot *snapshot, struct problem *problem);

/* The dose shown, or another one beside it, in a quantity, as the scene weighs it; both in the first one's unit. */
struct dose_asked {
    size_t dose; /* index in the plan */
    struct dose_choice choice;
    char unit[DOSE_UNIT_SIZE];
};
/* Returns false with why: it is not used, or it has no such quantity or no weights. */
NODISCARD bool dose_asked_of(const struct snapshot *snapshot, size_t dose, enum scene_dose_quantity quantity,
                             struct dose_asked *asked, struct error *why);
/* Like dose_asked_of, with the weights of one tissue (dose_choice_in), whatever the scene's says. */
NODISCARD bool dose_asked_in(const struct snapshot *snapshot, size_t dose, enum scene_dose_quantity quantity,
                             const char *tissue, struct dose_asked *asked, struct error *why);
/* The snapshot with another quantity of its dose, or its own (word NULL or ""). Borrows all of the snapshot's; freed
 * with free(). NULL with problem: no such quantity. */
NODISCARD struct snapshot *dose_snapshot_of(const struct snapshot *snapshot, const char *word, struct problem *problem);
/* Like dose_snapshot_of, with the weights of one tissue, "" for each region's own, in place of the scene's dose.tissue:
 * for figures of regions. */
NODISCARD struct snapshot *dose_snapshot_in(const struct snapshot *snapshot, const char *word, const char *tissue,
                                            struct problem *problem);
/* {basis, population} of figures of regions. */
void dose_add_population(cJSON *json, const struct snapshot *snapshot, const struct dose_choice *choice,
                         const char *tissue, enum region_population population);

/* False with why: the region has no univels, or is not used. */
NODISCARD bool dose_is_counted(const struct snapshot *snapshot, size_t region, struct error *why);
/* The unit of a figure: the dose's, "%", "cm3" or "". */
const char *dose_metric_unit(const struct dvh_metric *metric, const char *dose_unit);

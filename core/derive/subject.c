/* Compares, hashes and names subjects. */
#include "core/derive/subject.h"

bool subject_equal(struct subject a, struct subject b)
{
    return a.kind == b.kind && a.index == b.index && a.key == b.key;
}

/* The multiplier is 2^64 divided by the golden ratio: neighbouring numbers land far apart. */
static uint64_t mix(uint64_t hash, uint64_t number)
{
    hash = (hash ^ number) * UINT64_C(0x9e3779b97f4a7c15);
    return hash ^ hash >> 32;
}

uint64_t subject_hash(struct subject subject)
{
    return mix(mix(mix(0, (uint64_t)subject.kind), subject.index), subject.key);
}

bool subject_exists(const struct plan *plan, struct subject subject)
{
    switch (subject.kind) {
    case SUBJECT_PLAN: return true;
    case SUBJECT_REGION: return subject.index < plan->regions.n_regions;
    case SUBJECT_IMAGE: return subject.index < plan->n_images;
    case SUBJECT_LABEL_LAYER: return subject.index < plan->regions.n_layers;
    case SUBJECT_DOSE: return subject.index < plan->n_doses;
    case SUBJECT_ISODOSE: return plan->n_doses > 0;
    case SUBJECT_BEAM: return subject.key || subject.index < plan->n_beams;
    case SUBJECT_TRACKS: return subject.index < plan->tracks.n_segments;
    }
    return false;
}

const char *subject_id(const struct plan *plan, struct subject subject)
{
    switch (subject.kind) {
    case SUBJECT_PLAN: return plan->id;
    case SUBJECT_REGION: return plan->regions.regions[subject.index].id;
    case SUBJECT_IMAGE: return plan->images[subject.index].id;
    case SUBJECT_DOSE: return plan->doses[subject.index].id;
    case SUBJECT_BEAM: return subject.key ? "" : plan->beams[subject.index].id;
    case SUBJECT_LABEL_LAYER:
    case SUBJECT_TRACKS:
    case SUBJECT_ISODOSE: break; /* have none in the plan */
    }
    return "";
}

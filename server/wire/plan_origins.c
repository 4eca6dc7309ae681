/* Writes where the parts of a plan come from. */
#include "server/wire/plan_origins.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/plan/beam_doses.h"
#include "core/plan/identity.h"

/* Distinct UIDs in the order of their first use: a UID is told by its place. */
struct uids {
    const char **texts;
    size_t n;
};

struct numbers {
    struct uids frames, studies, structs;
};

static void add_uid(struct uids *uids, const char *uid)
{
    for (size_t i = 0; i < uids->n; i++)
        if (strcmp(uids->texts[i], uid) == 0)
            return;
    if (uid[0])
        uids->texts[uids->n++] = uid;
}

static cJSON *number_of(const struct uids *uids, const char *uid)
{
    for (size_t i = 0; i < uids->n; i++)
        if (strcmp(uids->texts[i], uid) == 0)
            return cJSON_CreateNumber((double)i);
    return cJSON_CreateNull();
}

static void add_uids(struct numbers *numbers, const struct part_origin *origins, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        add_uid(&numbers->frames, origins[i].frame_uid);
        add_uid(&numbers->studies, origins[i].study_uid);
    }
}

static struct numbers number_uids(const struct plan *plan)
{
    size_t most = plan->n_images + plan->n_doses + plan->n_beams + plan->n_region_origins + 1;
    struct uids *lists[3];
    struct numbers numbers = { 0 };
    lists[0] = &numbers.frames;
    lists[1] = &numbers.studies;
    lists[2] = &numbers.structs;
    for (int i = 0; i < 3; i++)
        lists[i]->texts = mem_new(most * sizeof *lists[i]->texts); /* at most REGION_MAX and some */
    add_uids(&numbers, plan->image_origins, plan->n_images);
    add_uids(&numbers, plan->region_origins, plan->n_region_origins);
    add_uids(&numbers, plan->dose_origins, plan->n_doses);
    add_uids(&numbers, plan->beam_origins, plan->n_beams);
    for (size_t i = 0; i < plan->n_region_origins; i++)
        add_uid(&numbers.structs, plan->region_origins[i].structs_uid);
    return numbers;
}

static void numbers_finish(struct numbers *numbers)
{
    free(numbers->frames.texts);
    free(numbers->studies.texts);
    free(numbers->structs.texts);
}

static cJSON *index_or_null(int index, size_t n)
{
    return index >= 0 && (size_t)index < n ? cJSON_CreateNumber(index) : cJSON_CreateNull();
}

static void add_origin(cJSON *part, const struct plan *plan, const struct numbers *numbers,
                       const struct part_origin *origin)
{
    cJSON *index = index_or_null(origin->treatment_plan, plan->n_treatment_plans);
    bool is_absent = origin->plan_uid[0] && cJSON_IsNull(index);
    json_add(part, "patient", index_or_null(origin->patient, plan->n_patients));
    json_add(part, "plan", index);
    json_add(part, "is_plan_absent", cJSON_CreateBool(is_absent));
    json_add(part, "frame", number_of(&numbers->frames, origin->frame_uid));
    json_add(part, "study", number_of(&numbers->studies, origin->study_uid));
}

/* Adds the origins to the entries of a list of the document, which are in the plan's order. */
static void add_to_list(const cJSON *document, const char *name, const struct plan *plan, const struct numbers *numbers,
                        const struct part_origin *origins)
{
    cJSON *list = cJSON_GetObjectItemCaseSensitive(document, name);
    for (cJSON *part = list ? list->child : NULL; part; part = part->next)
        add_origin(part, plan, numbers, origins++);
}

/* ---- regions of one name ---------------------------------------------------------------------------------------- */

struct named {
    const char *name;
    const struct part_origin *origin; /* NULL: not known */
    size_t index;
};

static int by_name(const void *a, const void *b)
{
    const struct named *left = a, *right = b;
    const int order = strcmp(left->name, right->name);
    return order ? order : left->index < right->index ? -1 : left->index > right->index;
}

static const char *label_of(const struct part_origin *origin)
{
    return origin ? origin->set_label : "";
}

static const char *file_of(const struct part_origin *origin)
{
    const char *slash = origin ? strrchr(origin->path, '/') : NULL;
    return slash ? slash + 1 : origin ? origin->path : "";
}

/* Adds to the regions of one name, of which some are of other files, what tells them apart: the label of their
 * structure set, or where another has the same the name of their file. */
static void tell_apart(cJSON *const *parts, const struct named *group, size_t n)
{
    bool is_of_others = false, has_labels = true;
    for (size_t i = 1; i < n; i++)
        is_of_others = is_of_others || group[i].origin != group[0].origin;
    for (size_t i = 0; i < n && is_of_others && has_labels; i++) {
        has_labels = label_of(group[i].origin)[0] != 0;
        for (size_t j = 0; j < i && has_labels && i < 64; j++) /* of more, the files tell */
            has_labels =
                group[i].origin == group[j].origin || strcmp(label_of(group[i].origin), label_of(group[j].origin)) != 0;
    }
    for (size_t i = 0; i < n && is_of_others; i++)
        json_add(parts[group[i].index], "set",
                 cJSON_CreateString(has_labels && n <= 64 ? label_of(group[i].origin) : file_of(group[i].origin)));
}

static void tell_regions_apart(const cJSON *list, const struct plan *plan)
{
    const size_t n = plan->regions.n_regions;
    size_t i = 0;
    if (plan->n_region_origins < 2)
        return;
    struct named *named = mem_new((n + 1) * sizeof *named); /* at most REGION_MAX */
    cJSON **parts = mem_new((n + 1) * sizeof *parts);
    for (cJSON *part = list ? list->child : NULL; part && i < n; part = part->next, i++) {
        const struct region *region = &plan->regions.regions[i];
        const bool is_known = region->origin > 0 && region->origin <= plan->n_region_origins;
        parts[i] = part;
        named[i] = (struct named){ region->name, is_known ? &plan->region_origins[region->origin - 1] : NULL, i };
    }
    if (i > 1)
        qsort(named, i, sizeof *named, by_name);
    for (size_t first = 0, last; first < i; first = last) {
        for (last = first + 1; last < i && strcmp(named[last].name, named[first].name) == 0;)
            last++;
        if (last - first > 1)
            tell_apart(parts, named + first, last - first);
    }
    free(parts);
    free(named);
}

static void add_to_regions(const cJSON *document, const struct plan *plan, const struct numbers *numbers)
{
    static const struct part_origin unknown = { .patient = -1, .treatment_plan = -1 };
    cJSON *list = cJSON_GetObjectItemCaseSensitive(document, "regions");
    const struct region *region = plan->regions.regions;
    for (cJSON *part = list ? list->child : NULL; part; part = part->next, region++) {
        bool is_known = region->origin > 0 && region->origin <= plan->n_region_origins;
        const struct part_origin *origin = is_known ? &plan->region_origins[region->origin - 1] : &unknown;
        add_origin(part, plan, numbers, origin);
        json_add(part, "source", is_known ? cJSON_CreateNumber((double)region->origin) : cJSON_CreateNull());
        json_add(part, "structs", number_of(&numbers->structs, origin->structs_uid));
    }
    tell_regions_apart(list, plan);
}

static cJSON *patients_array(const struct plan *plan)
{
    cJSON *array = cJSON_CreateArray();
    for (size_t i = 0; i < plan->n_patients; i++) {
        char masked[IDENTITY_MASK_SIZE];
        cJSON *object = cJSON_CreateObject();
        identity_mask(&plan->patients[i], masked);
        json_add(object, "masked", cJSON_CreateString(masked));
        json_add(object, "has_identity", cJSON_CreateTrue());
        json_add(object, "has_conflict", cJSON_CreateBool(plan->patients[i].has_conflict));
        json_append(array, object);
    }
    return array;
}

/* Without the patient: who that is stands masked in patients. */
static cJSON *statement_object(const struct plan_statement *statement)
{
    if (statement->kind == STATEMENT_NONE)
        return cJSON_CreateNull();
    cJSON *object = cJSON_CreateObject();
    json_add(object, "kind", cJSON_CreateString(statement_kind_word(statement->kind)));
    json_add(object, "state", cJSON_CreateString(statement_state_word(statement->state)));
    json_add(object, "by", cJSON_CreateString(statement->by));
    json_add(object, "time_ms", cJSON_CreateNumber((double)statement->time_ms));
    json_add(object, "words", cJSON_CreateString(statement->words));
    return object;
}

/* YYYYMMDD as YYYY-MM-DD; anything else as it is. */
static cJSON *date(const char *text)
{
    char out[16];
    if (strlen(text) != 8 || strspn(text, "0123456789") != 8)
        return cJSON_CreateString(text);
    (void)snprintf(out, sizeof out, "%.4s-%.2s-%.2s", text, text + 4, text + 6);
    return cJSON_CreateString(out);
}

/* Ids of the doses of single beams that add up to the treatment plan's, by the beams' order. */
static cJSON *beam_doses(const struct plan *plan, int treatment)
{
    size_t doses[PLAN_MAX_DOSES], n = plan_beam_doses(plan, treatment, doses);
    cJSON *list = cJSON_CreateArray();
    for (size_t i = 0; i < n; i++)
        json_append(list, cJSON_CreateString(plan->doses[doses[i]].id));
    return list;
}

static cJSON *treatment_plan_object(const struct plan *plan, const struct treatment_plan *treatment,
                                    const struct numbers *numbers)
{
    cJSON *object = cJSON_CreateObject(), *structs = number_of(&numbers->structs, treatment->structs_uid);
    bool is_absent = treatment->structs_uid[0] && cJSON_IsNull(structs);
    json_add(object, "label", cJSON_CreateString(treatment->label));
    json_add(object, "name", cJSON_CreateString(treatment->name));
    json_add(object, "date", date(treatment->date));
    json_add(object, "time", cJSON_CreateString(treatment->time));
    json_add(object, "approval", cJSON_CreateString(treatment->approval));
    json_add(object, "review_date", date(treatment->review_date));
    json_add(object, "reviewer", cJSON_CreateString(treatment->reviewer));
    json_add(object, "fractions",
             treatment->n_fractions > 0 ? cJSON_CreateNumber((double)treatment->n_fractions) : cJSON_CreateNull());
    json_add_finite(object, "prescription_gy", treatment->prescription_gy);
    json_add(object, "patient", index_or_null(treatment->patient, plan->n_patients));
    json_add(object, "structs", structs);
    json_add(object, "is_structs_absent", cJSON_CreateBool(is_absent));
    json_add(object, "beams",
             treatment->n_beams > 0 ? cJSON_CreateNumber((double)treatment->n_beams) : cJSON_CreateNull());
    json_add(object, "beam_doses", beam_doses(plan, (int)(treatment - plan->treatment_plans)));
    return object;
}

void plan_origins_add(cJSON *document, const struct plan *plan)
{
    struct numbers numbers = number_uids(plan);
    cJSON *treatments = cJSON_CreateArray();
    for (size_t i = 0; i < plan->n_treatment_plans; i++)
        json_append(treatments, treatment_plan_object(plan, &plan->treatment_plans[i], &numbers));
    json_add(document, "patients", patients_array(plan));
    json_add(document, "statement", statement_object(&plan->statement));
    json_add(document, "treatment_plans", treatments);
    json_add(document, "shown_patient", index_or_null(plan_shown_patient(plan), plan->n_patients));
    json_add(document, "shown_plan", index_or_null(plan_shown_treatment_plan(plan), plan->n_treatment_plans));
    add_to_list(document, "images", plan, &numbers, plan->image_origins);
    add_to_list(document, "doses", plan, &numbers, plan->dose_origins);
    add_to_list(document, "beams", plan, &numbers, plan->beam_origins);
    add_to_regions(document, plan, &numbers);
    numbers_finish(&numbers);
}

cJSON *plan_identity(const struct plan *plan)
{
    cJSON *object = cJSON_CreateObject(), *array = cJSON_CreateArray();
    for (size_t i = 0; i < plan->n_patients; i++) {
        const struct plan_patient *patient = &plan->patients[i];
        char masked[IDENTITY_MASK_SIZE];
        cJSON *entry = cJSON_CreateObject();
        identity_mask(patient, masked);
        json_add(entry, "id", cJSON_CreateString(patient->id));
        json_add(entry, "issuer", cJSON_CreateString(patient->issuer));
        json_add(entry, "name", cJSON_CreateString(patient->name));
        json_add(entry, "birth_date", date(patient->birth_date));
        json_add(entry, "sex", cJSON_CreateString(patient->sex));
        json_add(entry, "has_conflict", cJSON_CreateBool(patient->has_conflict));
        json_add(entry, "masked", cJSON_CreateString(masked));
        json_append(array, entry);
    }
    json_add(object, "patients", array);
    return object;
}

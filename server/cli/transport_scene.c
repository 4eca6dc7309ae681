/* Materials in the voxels of a plan; a result as a dose of the plan. */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "core/base/mem.h"
#include "server/cli/text.h"
#include "server/cli/transport_parts.h"

static const struct beam_file_material *material_in_file(const struct beam_file *file, const struct region *region)
{
    for (size_t i = 0; i < file->n_materials; i++)
        if (strcasecmp(file->materials[i].region, region->name) == 0 ||
            strcmp(file->materials[i].region, region->id) == 0)
            return &file->materials[i];
    return NULL;
}

int transport_first_region(const struct plan *plan)
{
    for (size_t r = 0; r < plan->regions.n_regions; r++)
        if (!fit_is_of_other(plan, fit_part_of_region(plan, r)))
            return (int)r;
    return -1;
}

bool transport_fits(const struct plan *plan, struct fit_part part, struct error *err)
{
    int first = transport_first_region(plan);
    if (first < 0)
        return true;
    struct fit_part region = fit_part_of_region(plan, (size_t)first);
    struct fit fit = fit_of(plan, part, region);
    if (fit_pair_needs(&fit) == FIT_NEEDS_NOTHING)
        return true;
    char why[FIT_WHY_SIZE];
    fit_sentence(plan, part, region, fit.relation, why);
    return error_set(err, ERROR_STATE, "%s", why);
}

/* Every source of regions with the first that is used. */
static bool check_sources(const struct plan *plan, struct error *err)
{
    for (size_t source = 0; source <= plan->n_region_origins; source++) {
        struct fit_part part = { FIT_REGIONS, source };
        bool is_used = false;
        for (size_t r = 0; r < plan->regions.n_regions && !is_used; r++)
            is_used = fit_part_of_region(plan, r).index == source;
        if (is_used && !fit_is_of_other(plan, part) && !transport_fits(plan, part, err))
            return false;
    }
    return true;
}

static bool check_names(const struct plan *plan, const struct beam_file *file, struct error *err)
{
    for (size_t i = 0; i < file->n_materials; i++) {
        bool is_there = false;
        for (size_t r = 0; r < plan->regions.n_regions; r++)
            is_there |= material_in_file(file, &plan->regions.regions[r]) == &file->materials[i];
        if (!is_there)
            return error_set(err, ERROR_NOT_FOUND,
                             "materials: the plan has no region '%.60s', or another entry names it",
                             file->materials[i].region);
    }
    return true;
}

static bool own_material(const struct beam_file_material *from, struct material *material, struct error *err)
{
    *material = (struct material){ .word = "own", .g_cm3 = from->g_cm3 };
    for (size_t i = 0; i < from->n_elements; i++)
        if (!material_set_element(material, from->elements[i].symbol, from->elements[i].fraction, err))
            return false;
    return true;
}

struct choice {
    struct material material;
    bool is_air, is_helper; /* then without a material */
    const char *how;        /* for people */
};

static bool choose(const struct beam_file *file, const struct region *region, struct choice *choice, struct error *err)
{
    const struct beam_file_material *from = material_in_file(file, region);
    const char *word = from ? from->word : material_word_of_region(region->name);
    *choice = (struct choice){ .how = from ? "" : word ? " (by its name)" : " (assumed: the name tells nothing)" };
    if (!word)
        word = "soft-tissue";
    choice->is_air = strcmp(word, "air") == 0;
    choice->is_helper = !from && !word[0];
    if (choice->is_air || choice->is_helper)
        return true;
    struct material *material = &choice->material;
    bool is_chosen = from && !word[0] ? own_material(from, material, err) : material_of_word(word, material, err);
    material->boron_ppm = from ? from->boron_ppm : 0;
    if (is_chosen && material_check(material, err))
        return true;
    error_prefix(err, "materials: %.60s", region->name);
    return false;
}

static void print_choice(const struct region *region, const struct choice *choice)
{
    fputs("  ", stdout);
    text_print(stdout, region->name, 20);
    if (choice->is_helper)
        puts("  no material of its own: its name is of what shapes a dose");
    else if (choice->is_air)
        printf("  air%s\n", choice->how);
    else
        printf("  %s%s, %g g/cm3, %g ppm of boron-10\n", choice->material.word, choice->how, choice->material.g_cm3,
               choice->material.boron_ppm);
}

static void print_left_out(const struct region *region, const char *why)
{
    fputs("  ", stdout);
    text_print(stdout, region->name, 20);
    printf("  left out: %s\n", why);
}

enum { AIR_OF_REGION = 255 }; /* while regions are painted: air, where a region says so, and not for want of one */
_Static_assert((int)AIR_OF_REGION > (int)MATERIAL_MAX, "it is no material's value");

/* Gives a region's voxels its value: by label where the layer is on the grid, else by the place of each voxel.
 *
 *   is_bare_only  those that no region has */
static void paint(struct transport_scene *scene, const struct region_set *set, const struct region *region,
                  uint8_t value, bool is_bare_only)
{
    const struct volume *layer = set->layers[region->layer];
    bool is_same = grid_is_same(&layer->grid, scene->grid);
    uint8_t *at = scene->voxels;
    for (uint32_t k = 0; k < scene->grid->size[2]; k++)
        for (uint32_t j = 0; j < scene->grid->size[1]; j++)
            for (uint32_t i = 0; i < scene->grid->size[0]; i++, at++) {
                uint32_t ijk[3] = { i, j, k };
                if (!is_same &&
                    !volume_voxel_at(layer, affine_point(&scene->grid->lps_mm_from_ijk, vec3(i, j, k)), ijk))
                    continue;
                if (volume_label(layer, ijk[0], ijk[1], ijk[2]) == region->label && !(is_bare_only && *at != 0))
                    *at = value;
            }
}

/* Value of a material; equal ones share it. -1: no room */
static int value_of(struct transport_scene *scene, const struct choice *choice, struct error *err)
{
    if (choice->is_air)
        return AIR_OF_REGION;
    for (size_t i = 0; i < scene->n_materials; i++)
        if (memcmp(&scene->materials[i], &choice->material, sizeof choice->material) == 0)
            return (int)(i + 1);
    if (scene->n_materials == MATERIAL_MAX) {
        error_set(err, ERROR_LIMIT, "more than %d materials", MATERIAL_MAX);
        return -1;
    }
    scene->materials[scene->n_materials++] = choice->material;
    return (int)scene->n_materials;
}

/* A structure that shapes a dose changes nothing, but where its label displaced that of the region around it.
 *
 *   values  of the regions before it */
static bool paint_region(struct transport_scene *scene, const struct plan *plan, const struct beam_file *file, size_t r,
                         uint8_t values[REGION_MAX], struct error *err)
{
    const struct region *region = &plan->regions.regions[r];
    struct choice choice;
    if (fit_is_of_other(plan, fit_part_of_region(plan, r))) {
        print_left_out(region, "of another patient");
        return true;
    }
    if (!choose(file, region, &choice, err))
        return false;
    int around = region->parent >= 0 ? values[region->parent] : 0,
        value = choice.is_helper ? around : value_of(scene, &choice, err);
    if (value < 0)
        return false;
    values[r] = (uint8_t)value;
    paint(scene, &plan->regions, region, values[r], choice.is_helper);
    print_choice(region, &choice);
    return true;
}

bool transport_scene_init(struct transport_scene *scene, const struct plan *plan, const struct beam_file *file,
                          struct error *err)
{
    const struct region_set *set = &plan->regions;
    *scene = (struct transport_scene){ 0 };
    int first = transport_first_region(plan);
    if (set->n_layers == 0 || first < 0)
        return error_set(err, ERROR_NOT_FOUND, "the plan has no regions, so nothing says what the patient is made of");
    if (!check_names(plan, file, err) || !check_sources(plan, err))
        return false;
    scene->grid = &set->layers[set->regions[first].layer]->grid;
    if (!(scene->voxels = mem_array(grid_n_voxels(scene->grid), 1, VOLUME_MAX_BYTES, err)))
        return false;
    puts("materials:");
    uint8_t values[REGION_MAX] = { 0 };
    size_t n_left = set->n_regions;
    for (int depth = 0; n_left > 0; depth++)
        for (size_t r = 0; r < set->n_regions; r++) {
            if (region_depth(set, r) != depth)
                continue;
            n_left--;
            if (!paint_region(scene, plan, file, r, values, err)) {
                transport_scene_finish(scene);
                return false;
            }
        }
    size_t n = grid_n_voxels(scene->grid);
    for (size_t i = 0; i < n; i++)
        scene->voxels[i] = scene->voxels[i] == AIR_OF_REGION ? 0 : scene->voxels[i];
    return true;
}

void transport_scene_finish(struct transport_scene *scene)
{
    free(scene->voxels);
    scene->voxels = NULL;
}

/* ---- the dose ----------------------------------------------------------------------------------------------------- */

static const enum dose_quantity meaning[TRANSPORT_N_QUANTITIES] = {
    [TRANSPORT_BORON] = DOSE_BORON,
    [TRANSPORT_NITROGEN] = DOSE_NITROGEN,
    [TRANSPORT_FAST] = DOSE_FAST,
    [TRANSPORT_GAMMA] = DOSE_GAMMA,
    [TRANSPORT_FAST_FLUENCE] = DOSE_FAST_FLUENCE,
    [TRANSPORT_EPITHERMAL_FLUENCE] = DOSE_EPITHERMAL_FLUENCE,
    [TRANSPORT_THERMAL_FLUENCE] = DOSE_THERMAL_FLUENCE,
};

static void scale(struct volume *volume, double factor)
{
    float *values = volume->voxels;
    for (size_t i = 0; i < grid_n_voxels(&volume->grid); i++)
        values[i] = (float)((double)values[i] * factor);
    volume_measure(volume);
}

/* An id that no dose of the plan has. */
static void make_id(const struct plan *plan, char id[64])
{
    snprintf(id, 64, "simulated-here");
    for (int n = 2; n <= PLAN_MAX_DOSES + 1; n++) {
        bool is_taken = false;
        for (size_t i = 0; i < plan->n_doses; i++)
            is_taken |= strcmp(plan->doses[i].id, id) == 0;
        if (!is_taken)
            return;
        snprintf(id, 64, "simulated-here-%d", n);
    }
}

/* A long note is cut, and not what is said of the dose. */
static void add_note(struct plan *plan, const char *id, enum transport_mode mode, uint64_t n_histories, uint64_t seed)
{
    char note[256];
    size_t added = (size_t)snprintf(note, sizeof note,
                                    "Dose '%s': beamroom %s, transport model %s%s, %" PRIu64 " histories, seed %" PRIu64
                                    "; approximate, not for treatment.",
                                    id, BEAMROOM_VERSION, TRANSPORT_MODEL,
                                    mode == TRANSPORT_HYBRID ? " in hybrid mode" : "", n_histories, seed);
    size_t used = strlen(plan->note), room = sizeof plan->note - added - 5;
    bool is_cut = used > room;
    for (used = is_cut ? room : used; is_cut && used > 0 && ((unsigned char)plan->note[used] & 0xc0) == 0x80;)
        used--; /* not within a letter */
    snprintf(plan->note + used, sizeof plan->note - used, "%s%s%s", is_cut ? "..." : "", used > 0 ? " " : "", note);
}

bool transport_add_dose(struct plan *plan, struct transport_result *result, const char *per, enum transport_mode mode,
                        uint64_t seed, struct error *err)
{
    if (plan->n_doses == PLAN_MAX_DOSES)
        return error_set(err, ERROR_LIMIT, "the plan has %d doses already, at most %d", PLAN_MAX_DOSES, PLAN_MAX_DOSES);
    struct dose *dose = &plan->doses[plan->n_doses];
    bool is_cgy = plan->n_doses > 0 && strcmp(plan->doses[0].unit, "cGy") == 0;
    *dose = (struct dose){ 0 };
    make_id(plan, dose->id);
    snprintf(dose->name, sizeof dose->name, "Simulated here, approximate");
    snprintf(dose->unit, sizeof dose->unit, is_cgy ? "cGy" : "Gy");
    snprintf(dose->per, sizeof dose->per, "%s", per);
    for (int i = 0; i < TRANSPORT_N_QUANTITIES; i++) {
        struct dose_component *component = &dose->components[dose->n_components++];
        *component = (struct dose_component){ .quantity = meaning[i],
                                              .is_per_ppm = i == TRANSPORT_BORON,
                                              .values = result->values[i],
                                              .error = result->errors[i] };
        if (is_cgy && !dose_quantity_is_fluence(meaning[i])) {
            scale(component->values, 100);
            scale(component->error, 100);
        }
        result->values[i] = result->errors[i] = NULL;
    }
    dose->mask = result->mask;
    result->mask = NULL;
    /* It is of the person and the frame that the regions are of. */
    struct part_origin origin = { .patient = -1, .treatment_plan = -1 };
    int first = transport_first_region(plan);
    size_t source = first >= 0 ? fit_part_of_region(plan, (size_t)first).index : 0;
    if (source > 0)
        origin = plan->region_origins[source - 1];
    origin.path[0] = origin.set_label[0] = '\0';
    plan->dose_origins[plan->n_doses] = origin;
    plan->n_doses++;
    add_note(plan, dose->id, mode, result->n_histories, seed);
    return true;
}

/* Builds the plan from the files that were read. */
#include "core/load/assemble.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/formats/hierarchy.h"
#include "core/formats/text.h"
#include "core/load/alike.h"
#include "core/load/assemble_dicom.h"
#include "core/load/assemble_dicom_doses.h"
#include "core/load/assemble_tracks.h"
#include "core/load/curves_and_preferences.h"
#include "core/load/dose_entry.h"
#include "core/load/dose_maximum.h"
#include "core/load/image_window.h"
#include "core/load/origin_notes.h"
#include "core/load/origins.h"
#include "core/load/part_names.h"
#include "core/load/plan_ids.h"
#include "core/load/reader_table.h"
#include "core/load/region_builder.h"
#include "core/load/region_hierarchy.h"
#include "core/load/registrations.h"
#include "core/load/settle_parts.h"
#include "core/plan/fit.h"
#include "core/plan/plan_bounds.h"

/* Lists of the plan file are copied into the plan's without a check of their length. */
_Static_assert((int)PLAN_FILE_MAX_IMAGES == (int)PLAN_MAX_IMAGES, "every image of a plan file has its place");
_Static_assert((int)PLAN_FILE_MAX_DOSES == (int)PLAN_MAX_DOSES, "every dose of a plan file has its place");
_Static_assert((int)PLAN_FILE_MAX_BEAMS == (int)PLAN_MAX_BEAMS, "every beam of a plan file has its place");
_Static_assert((int)PLAN_FILE_MAX_CURVES == (int)PLAN_MAX_CURVES, "every curve of a plan file has its place");

static struct volume *take_volume(struct part_reading *reading)
{
    struct volume *volume = reading->volume;
    reading->volume = NULL;
    return volume;
}

/* Reports an image that may be a mask or a label map. The sentence says how to make it regions: by a file name with
 * _mask or _seg, or by a plan.json, which must name the other files too. */
static void note_labels(struct loading *loading, const struct part_reading *reading, double high)
{
    const char *base = part_base_name(reading->path);
    int stem = part_stem_length(base);
    bool is_mask = reading->content.n_values == 1;
    if (!reading->is_label_like)
        return;
    char rename[160] = "";
    if (!text_has_ending(base, ".hdr") && !text_has_ending(base, ".hdr.gz"))
        snprintf(rename, sizeof rename, "call the file %.*s_%s%.20s, or ", stem < 80 ? stem : 80, base,
                 is_mask ? "mask" : "seg", base + stem);
    char what[80] = "Every voxel is 0 or 1, so this may be a mask";
    if (!is_mask || high != 1)
        snprintf(what, sizeof what, "It holds %zu whole numbers besides 0, so this may be a label map",
                 reading->content.n_values);
    report_add(
        &loading->plan->report, REPORT_WARNING, "image.may-be-region", reading->path,
        "%s. To show it as %s %swrite a plan.json that names it in \"regions\" and the folder's other files as well.",
        what, is_mask ? "a region" : "regions", rename);
}

static bool has_number(const struct volume *volume)
{
    const uint32_t *size = volume->grid.size;
    for (uint32_t k = 0; k < size[2]; k++)
        for (uint32_t j = 0; j < size[1]; j++)
            for (uint32_t i = 0; i < size[0]; i++)
                if (isfinite(volume_value(volume, i, j, k)))
                    return true;
    return false;
}

static void note_constant(const struct volume *volume, const char *where, struct report *report)
{
    if (volume->low != volume->high)
        return;
    if (volume->low == 0 && !has_number(volume)) /* low and high of no number are 0, too */
        report_add(report, REPORT_WARNING, "image.constant", where, "No voxel holds a number.");
    else
        report_add(report, REPORT_WARNING, "image.constant", where, "Every voxel is %g.", volume->low);
}

static void add_image(struct loading *loading, struct part_reading *reading)
{
    struct plan *plan = loading->plan;
    const struct plan_file_image *entry = &loading->file->images[reading->index];
    struct plan_image *image = &plan->images[plan->n_images];
    const char *others[PLAN_MAX_IMAGES];
    for (size_t i = 0; i < plan->n_images; i++)
        others[i] = plan->images[i].id;
    plan_make_id(image->id, entry->id, entry->path, others, plan->n_images);
    reading->image = plan->n_images;
    plan->image_origins[plan->n_images] = origin_of_reading(loading, reading);
    loading->image_stacks[plan->n_images++] = reading->reader == &part_dicom ? reading->stack : -1;
    memcpy(image->name, entry->name, sizeof image->name);
    snprintf(image->modality, sizeof image->modality, "%s", entry->modality[0] ? entry->modality : reading->modality);
    image->volume = take_volume(reading);
    note_labels(loading, reading, image->volume->high);
    note_constant(image->volume, reading->path, &plan->report);
    if (text_equal(image->modality, "CT")) {
        snprintf(image->unit, sizeof image->unit, "HU");
        if (image->volume->low >= 0 && image->volume->high > 0)
            report_add(&plan->report, REPORT_WARNING, "image.hu-doubtful", entry->path,
                       "The CT's values run from %g to %g; HU of a patient begin below 0.", image->volume->low,
                       image->volume->high);
    }
    image->is_inverted = entry->is_inverted || reading->facts.is_inverted;
    plan_image_window(image);
    if (!image->unit[0])
        snprintf(image->unit, sizeof image->unit, "%.7s", reading->facts.unit);
    if (entry->value_unit[0])
        memcpy(image->unit, entry->value_unit, sizeof image->unit);
    if (entry->window_width > 0) {
        image->window_center = entry->window_center;
        image->window_width = entry->window_width;
    } else if (reading->facts.n_windows > 0 &&
               !text_equal(image->modality, "CT")) { /* every CT starts with the same window */
        image->window_center = reading->facts.windows[0].center;
        image->window_width = reading->facts.windows[0].width;
    }
    plan_image_window_limit(image);
}

/* Adds the images: in the order of plan.json, else those that are most likely wanted first before the others. */
static void add_images(struct loading *loading)
{
    for (int rank = 0; rank < PLAN_IMAGE_RANKS; rank++)
        for (size_t i = 0; i < loading->n_readings; i++) {
            struct part_reading *reading = &loading->readings[i];
            if (reading->kind == PART_KIND_IMAGE && !reading->is_failed && plan_image_rank(loading, reading) == rank)
                add_image(loading, reading);
        }
}

/* Replaces the grid of an image whose header describes another image by the grid of univels of the same size, which are
 * made from the same scan. */
static void borrow_grid(struct loading *loading, const struct part_reading *reading)
{
    struct plan *plan = loading->plan;
    struct volume *volume = plan->images[reading->image].volume;
    for (size_t i = 0; reading->is_grid_doubtful && i < loading->n_readings; i++) {
        const struct part_reading *other = &loading->readings[i];
        if (!other->uvh.bodies || memcmp(other->uvh.grid.size, volume->grid.size, sizeof volume->grid.size) != 0)
            continue;
        volume->grid = other->uvh.grid;
        report_add(
            &plan->report, REPORT_WARNING, "geometry.borrowed", reading->path,
            "The image's header describes another image; %s has as many univels as this has pixels, and its grid was taken.",
            other->path);
        return;
    }
}

static bool add_regions(struct loading *loading, struct region_builder *builder, struct part_reading *reading,
                        struct error *err)
{
    const struct plan_file_region *entry = &loading->file->regions[reading->index];
    if (reading->layers && reading->reader == &part_dicom)
        plan_dicom_check_segmentation(loading, reading);
    for (size_t i = 0; reading->layers && i < reading->layers->n; i++) {
        struct volume *layer = reading->layers->volumes[i];
        reading->layers->volumes[i] = NULL;
        if (!region_builder_add_labels(builder, layer,
                                       reading->names.n > 0 ? &reading->names : &reading->layers->names[i],
                                       reading->path, err))
            return false;
    }
    if (reading->layers)
        return true;
    if (reading->structs)
        return plan_dicom_add_regions(loading, builder, reading, err);
    struct volume *volume = take_volume(reading);
    if (reading->uvh.bodies)
        return region_builder_add_univels(builder, volume, &reading->uvh, reading->path, err);
    if (entry->name[0])
        return region_builder_add_mask(builder, volume, entry, err);
    return region_builder_add_labels(builder, volume, &reading->names, reading->path, err);
}

/* Adds the regions of one file with their origin; a file whose regions are beyond a limit is reported and left out. */
static bool add_regions_of(struct loading *loading, struct region_builder *builder, struct part_reading *reading,
                           struct error *err)
{
    size_t first = loading->plan->regions.n_regions;
    struct part_origin origin = origin_of_reading(loading, reading);
    struct error why = { 0 };
    if (!add_regions(loading, builder, reading, &why)) {
        if (!loading_may_leave_out(&why)) {
            if (err)
                *err = why;
            return false;
        }
        loading_leave_out(loading, "part.unreadable", reading->path, &why);
    }
    return origins_add_regions(loading->plan, &origin, first, err); /* of those that have no origin of their own */
}

/* Adds the dose of an entry of the plan file, without components yet. NULL: the plan has no room for it. */
static struct dose *start_dose(struct loading *loading, const struct part_reading *reading, size_t index)
{
    struct plan *plan = loading->plan;
    const struct plan_file_dose *entry = &loading->file->doses[index];
    const char *others[PLAN_MAX_DOSES], *path = entry->components[0].path;
    char id[64];
    if (!plan_has_room_for_dose(plan, entry->id[0] ? entry->id : path, path))
        return NULL;
    for (size_t i = 0; i < plan->n_doses; i++)
        others[i] = plan->doses[i].id;
    plan_make_id(id, entry->id, path, others, plan->n_doses);
    struct part_origin *origin = &plan->dose_origins[plan->n_doses];
    struct dose *dose = &plan->doses[plan->n_doses++];
    *origin = origin_of_reading(loading, reading);
    origin_state(origin, entry);
    memcpy(dose->id, id, sizeof dose->id);
    memcpy(dose->name, entry->name, sizeof dose->name);
    plan_dose_units(dose, entry, part_is_sera_dose(reading->reader), &plan->report);
    plan_dose_frame(dose, entry, entry->components[0].path, &plan->report);
    return dose;
}

/* False, and reported, if the file is of another patient than the dose's first file. */
static bool is_of_dose(struct loading *loading, const struct dose *dose, const struct part_reading *reading)
{
    struct plan *plan = loading->plan;
    const struct part_origin origin = origin_of_reading(loading, reading);
    if (origin_join(&plan->dose_origins[dose - plan->doses], &origin))
        return true;
    report_add(&plan->report, REPORT_ERROR, "dose.left-out", reading->path,
               "This file is of another patient than the first file of the dose \"%s\"; it is left out.", dose->id);
    return false;
}

static void add_component(struct loading *loading, struct dose *dose, struct part_reading *reading)
{
    const struct plan_file_dose *entry = &loading->file->doses[reading->index];
    if (part_is_sera_dose(reading->reader))
        plan_add_sera(dose, entry, reading->component, &reading->doses, &loading->plan->report);
    else if (reading->reader == &part_dicom)
        plan_dicom_add_component(loading, dose, reading);
    else
        plan_add_component(dose, entry, reading->component, take_volume(reading), &loading->plan->report);
}

static void add_dose_mask(struct loading *loading, struct dose *dose, struct part_reading *reading)
{
    volume_unref(dose->mask); /* the mask that plan.json names replaces the SERA file's own */
    dose->mask = take_volume(reading);
    if (dose->n_components > 0 &&
        memcmp(dose->mask->grid.size, dose->components[0].values->grid.size, sizeof dose->mask->grid.size) != 0)
        report_add(&loading->plan->report, REPORT_NOTE, "dose.mask-grid", reading->path,
                   "The mask of the dose \"%s\" lies on another grid; it is looked up by position.", dose->id);
}

/* Adds the statistical error of a component; it is dropped where the component's file did not have the quantity. */
static void add_dose_error(struct dose *dose, const struct plan_file_dose *entry, struct part_reading *reading)
{
    struct volume *error = take_volume(reading);
    for (size_t c = 0; c < dose->n_components; c++)
        if (dose->components[c].quantity == entry->components[reading->component].quantity &&
            !dose->components[c].error) {
            dose->components[c].error = error;
            return;
        }
    volume_unref(error);
}

/* Takes the plan's last dose out again: no file of its entry held a quantity that the entry names. */
static void leave_out_empty_dose(struct loading *loading, const char *path)
{
    struct plan *plan = loading->plan;
    struct dose *dose = &plan->doses[--plan->n_doses];
    report_add(&plan->report, REPORT_ERROR, "dose.left-out", path,
               "The dose \"%s\" holds no quantity that the plan names; it is left out.", dose->id);
    volume_unref(dose->mask);
    *dose = (struct dose){ 0 };
}

/* Adds the dose of an entry of the plan file; a file or folder of DICOM doses may give several. */
static void add_dose(struct loading *loading, size_t index)
{
    struct plan *plan = loading->plan;
    const struct plan_file_dose *entry = &loading->file->doses[index];
    struct dose *dose = NULL;
    size_t before = plan->n_doses;
    bool is_grouped = false;
    for (size_t i = 0; i < loading->n_readings; i++) {
        struct part_reading *reading = &loading->readings[i];
        if (reading->kind != PART_KIND_DOSE || reading->index != index || reading->is_failed || is_grouped)
            continue;
        if (reading->reader == &part_dicom && entry->n_components == 1) {
            plan_dicom_add_doses(loading, index, entry);
            dose = plan->n_doses > before ? &plan->doses[before] : NULL;
            is_grouped = true;
            continue;
        }
        if (!dose)
            dose = start_dose(loading, reading, index);
        if (!dose)
            return;
        if (is_of_dose(loading, dose, reading))
            add_component(loading, dose, reading);
    }
    if (dose && dose->n_components == 0) {
        leave_out_empty_dose(loading, entry->components[0].path);
        return;
    }
    for (size_t i = 0; dose && i < loading->n_readings; i++) {
        struct part_reading *reading = &loading->readings[i];
        if (reading->index != index || reading->is_failed)
            continue;
        if (reading->kind == PART_KIND_DOSE_MASK)
            add_dose_mask(loading, dose, reading);
        else if (reading->kind == PART_KIND_DOSE_ERROR)
            add_dose_error(dose, entry, reading);
    }
}

static void add_doses(struct loading *loading)
{
    for (size_t i = 0; i < loading->file->n_doses; i++)
        add_dose(loading, i);
    if (loading->parts.is_all_dicom)
        plan_dicom_add_doses(loading, PART_WITHOUT_ENTRY, NULL);
    if (loading->parts.is_recognised) {
        plan_name_alike_doses(loading->plan);
        plan_order_doses(loading->plan);
    }
}

static bool apply_hierarchy_file(struct loading *loading, const char *path, struct error *err)
{
    struct plan *plan = loading->plan;
    struct bytes bytes;
    if (!folder_read(&loading->folder, path, TEXT_FILE_MAX_BYTES, UINT64_MAX, &bytes, err))
        return false;
    struct plan_file_pair *pairs = mem_new(PLAN_FILE_MAX_PAIRS * sizeof *pairs);
    size_t n = hierarchy_parse(bytes.data, bytes.size, path, pairs, PLAN_FILE_MAX_PAIRS, &plan->report);
    bytes_free(&bytes);
    region_set_apply_pairs(&plan->regions, pairs, n, false, path, &plan->report);
    free(pairs);
    return true;
}

static bool apply_hierarchy(struct loading *loading, const struct region_builder *builder, struct error *err)
{
    struct plan *plan = loading->plan;
    const struct plan_file *file = loading->file;
    struct error why = { 0 };
    if (file->hierarchy[0] && !apply_hierarchy_file(loading, file->hierarchy, &why)) {
        if (!loading_may_leave_out(&why)) {
            if (err)
                *err = why;
            return false;
        }
        loading_leave_out(loading, "part.unreadable", file->hierarchy, &why);
    }
    if (file->hierarchy[0]) {
        /* applied, or reported */
    } else if (file->n_pairs > 0) {
        region_set_apply_pairs(&plan->regions, file->pairs, file->n_pairs, true, "plan.json", &plan->report);
    } else if (builder->n_pairs > 0) {
        region_set_apply_pairs(&plan->regions, builder->pairs, builder->n_pairs, true, "", &plan->report);
    }
    if (plan->regions.hierarchy == HIERARCHY_NONE) {
        region_set_derive_hierarchy(&plan->regions);
        if (plan->regions.hierarchy == HIERARCHY_DERIVED)
            report_add(&plan->report, REPORT_NOTE, "hierarchy.derived", "",
                       "No file says what lies inside what; the tree was derived from which region encloses which.");
    }
    return true;
}

static void note_empty_regions(struct plan *plan)
{
    for (size_t i = 0; i < plan->regions.n_regions; i++)
        if (plan->regions.regions[i].n_voxels == 0)
            report_add(&plan->report, REPORT_WARNING, "region.empty", "", "The region \"%s\" has no voxel.",
                       plan->regions.regions[i].name);
}

/* A region lies in none of another frame of reference or patient, whatever encloses it: in the next one around that. */
static void cut_hierarchy(struct plan *plan)
{
    struct region *regions = plan->regions.regions;
    for (size_t r = 0; r < plan->regions.n_regions; r++)
        while (regions[r].parent >= 0) {
            struct fit fit =
                fit_of(plan, fit_part_of_region(plan, r), fit_part_of_region(plan, (size_t)regions[r].parent));
            if (!(fit.reasons & (1U << FIT_FRAME | 1U << FIT_PATIENT)))
                break;
            regions[r].parent = regions[regions[r].parent].parent;
        }
}

static void add_beams(struct loading *loading)
{
    struct plan *plan = loading->plan;
    for (size_t i = 0; i < loading->file->n_beams; i++) {
        const char *others[PLAN_MAX_BEAMS];
        for (size_t b = 0; b < plan->n_beams; b++)
            others[b] = plan->beams[b].id;
        plan->beams[i] = loading->file->beams[i];
        plan_make_id(plan->beams[i].id, loading->file->beams[i].id, "beam", others, plan->n_beams);
        snprintf(plan->beam_origins[i].path, sizeof plan->beam_origins[i].path, "plan.json");
        plan->n_beams++;
    }
    plan_dicom_add_beams(loading);
    if (loading->parts.is_recognised)
        plan_name_alike_beams(loading->plan);
}

bool plan_assemble(struct loading *loading, struct error *err)
{
    struct plan *plan = loading->plan;
    struct region_builder builder;
    bool is_whole = true;
    uint64_t n_rois = 0;
    origins_begin(loading);
    registrations_read(loading);
    for (size_t i = 0; i < loading->n_readings; i++)
        n_rois += loading->readings[i].structs ? loading->readings[i].structs->n_rois : 0;
    loading_begin(loading, n_rois);
    region_builder_init(&builder, &plan->regions, &plan->report);
    add_images(loading);
    for (size_t i = 0; is_whole && i < loading->n_readings; i++) {
        struct part_reading *reading = &loading->readings[i];
        if (reading->kind == PART_KIND_REGION && !reading->is_failed)
            is_whole = add_regions_of(loading, &builder, reading, err);
    }
    for (size_t i = 0; i < loading->n_readings; i++)
        if (is_whole && loading->readings[i].kind == PART_KIND_IMAGE && !loading->readings[i].is_failed)
            borrow_grid(loading, &loading->readings[i]);
    if (is_whole) {
        loading_phase(loading, "measuring regions", "", 95, 100);
        region_builder_order(&builder);
        registrations_move_images_and_regions(plan);
        registrations_warn(plan);
        region_set_measure(&plan->regions);
        note_empty_regions(plan);
        is_whole = apply_hierarchy(loading, &builder, err);
        cut_hierarchy(plan);
    }
    region_builder_finish(&builder);
    if (!is_whole)
        return false;
    plan_add_preferences(plan, &loading->folder, loading->file);
    add_doses(loading);
    registrations_move_doses(plan);
    plan_add_curves(plan, &loading->folder, loading->file);
    plan_measure_body(plan);
    add_beams(loading);
    plan_measure_bounds(plan);
    plan_note_origins(loading);
    if (loading->file->n_tracks > 0)
        snprintf(plan->tracks_origin.path, sizeof plan->tracks_origin.path, "%s", loading->file->tracks[0].path);
    return plan_add_tracks(loading, err);
}

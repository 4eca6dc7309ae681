/* Compares two plans field by field. */
#include "tests/unit/same_plan.h"

#include "core/region/mask.h"
#include "tests/check.h"

/* A new field of a plan does not compile here until it is compared below: else nobody would notice a conversion or a
 * cache that loses it. */
#define IS_COMPARED_UP_TO(type, bytes) \
    _Static_assert(sizeof(void *) != 8 || sizeof(type) == (bytes), "compare the new field of " #type)
IS_COMPARED_UP_TO(struct plan, 1257872);
IS_COMPARED_UP_TO(struct part_origin, 992);
IS_COMPARED_UP_TO(struct plan_patient, 422);
IS_COMPARED_UP_TO(struct treatment_plan, 416);
IS_COMPARED_UP_TO(struct plan_registration, 240);
IS_COMPARED_UP_TO(struct plan_image, 248);
IS_COMPARED_UP_TO(struct plan_preferences, 1296);
IS_COMPARED_UP_TO(struct region, 336);
IS_COMPARED_UP_TO(struct region_set, 2080);
IS_COMPARED_UP_TO(struct dose, 11608);
IS_COMPARED_UP_TO(struct dose_component, 40);
IS_COMPARED_UP_TO(struct dose_curve, 480);
IS_COMPARED_UP_TO(struct beam, 14072);
IS_COMPARED_UP_TO(struct track_segment, 32);
IS_COMPARED_UP_TO(struct volume, 264);

static void same_number(double found, double expected)
{
    if (!(isnan(found) && isnan(expected)) && found != expected)
        fail_msg("%.17g instead of %.17g", found, expected);
}

static void same_vector(struct vec3 found, struct vec3 expected)
{
    same_number(found.x, expected.x);
    same_number(found.y, expected.y);
    same_number(found.z, expected.z);
}

static void same_grid(const struct grid *found, const struct grid *expected, double mm)
{
    assert_memory_equal(found->size, expected->size, sizeof found->size);
    for (int corner = 0; corner < 8; corner++) {
        struct vec3 at = vec3(corner & 1 ? found->size[0] - 1 : 0, corner & 2 ? found->size[1] - 1 : 0,
                              corner & 4 ? found->size[2] - 1 : 0);
        struct vec3 a = affine_point(&found->lps_mm_from_ijk, at), b = affine_point(&expected->lps_mm_from_ijk, at);
        assert_close(vec3_length(vec3_sub(a, b)), 0, mm);
    }
}

static void same_volume(const struct volume *found, const struct volume *expected, double mm)
{
    same_grid(&found->grid, &expected->grid, mm);
    same_number(found->low, expected->low);
    same_number(found->high, expected->high);
    size_t n = grid_n_voxels(&found->grid);
    if (found->type == expected->type && found->slope == expected->slope && found->offset == expected->offset) {
        if (memcmp(found->voxels, expected->voxels, n * voxel_size(found->type)) == 0)
            return;
    }
    const uint32_t *size = found->grid.size;
    for (uint32_t k = 0; k < size[2]; k++)
        for (uint32_t j = 0; j < size[1]; j++)
            for (uint32_t i = 0; i < size[0]; i++) {
                double a = volume_value(found, i, j, k), b = volume_value(expected, i, j, k);
                if (!(isnan(a) && isnan(b)) && a != b)
                    fail_msg("voxel %u %u %u is %.17g instead of %.17g", i, j, k, a, b);
            }
}

static void same_mask(const struct region_set *found, const struct region_set *expected, size_t region)
{
    struct error err = { 0 };
    const struct region *a = &found->regions[region], *b = &expected->regions[region];
    struct mask *mask_a = mask_from_labels(found->layers[a->layer], &a->label, 1, 2, &err);
    struct mask *mask_b = mask_from_labels(expected->layers[b->layer], &b->label, 1, 2, &err);
    assert_string_equal(err.text, "");
    assert_memory_equal(mask_a->bits, mask_b->bits,
                        (size_t)mask_a->words * mask_a->size[1] * mask_a->size[2] * sizeof(uint64_t));
    mask_destroy(mask_a);
    mask_destroy(mask_b);
}

static void same_regions(const struct region_set *found, const struct region_set *expected, double mm)
{
    assert_int_equal(found->n_regions, expected->n_regions);
    assert_int_equal(found->hierarchy, expected->hierarchy);
    for (size_t r = 0; r < found->n_regions; r++) {
        const struct region *a = &found->regions[r], *b = &expected->regions[r];
        assert_string_equal(a->id, b->id);
        assert_string_equal(a->name, b->name);
        assert_memory_equal(a->rgb, b->rgb, 3);
        assert_int_equal(a->has_file_color, b->has_file_color);
        assert_int_equal(a->parent, b->parent);
        assert_int_equal(a->label, b->label);
        assert_int_equal(a->n_voxels, b->n_voxels);
        assert_close(a->volume_cm3, b->volume_cm3, mm * b->volume_cm3);
        assert_memory_equal(a->low_ijk, b->low_ijk, sizeof a->low_ijk);
        assert_memory_equal(a->high_ijk, b->high_ijk, sizeof a->high_ijk);
        assert_close(vec3_length(vec3_sub(a->centre_lps_mm, b->centre_lps_mm)), 0, mm);
        assert_int_equal(a->touches_edge, b->touches_edge);
        assert_int_equal(a->is_target, b->is_target);
        same_number(a->file_opacity, b->file_opacity);
        same_number(a->boron_ratio, b->boron_ratio);
        same_number(a->cbe_boron, b->cbe_boron);
        same_number(a->rbe_nitrogen, b->rbe_nitrogen);
        same_number(a->rbe_fast, b->rbe_fast);
        same_number(a->rbe_gamma, b->rbe_gamma);
        same_grid(&found->layers[a->layer]->grid, &expected->layers[b->layer]->grid, mm);
        same_mask(found, expected, r);
    }
}

static void same_doses(const struct plan *found, const struct plan *expected, double mm)
{
    assert_int_equal(found->n_doses, expected->n_doses);
    for (size_t d = 0; d < found->n_doses; d++) {
        const struct dose *a = &found->doses[d], *b = &expected->doses[d];
        assert_string_equal(a->id, b->id);
        assert_string_equal(a->name, b->name);
        assert_string_equal(a->unit, b->unit);
        assert_string_equal(a->per, b->per);
        assert_int_equal(a->has_frame, b->has_frame);
        assert_int_equal(a->frame, b->frame);
        for (int q = 0; q < DOSE_N_QUANTITIES; q++) {
            same_number(a->reference[q], b->reference[q]);
            same_number(a->body_high[q], b->body_high[q]);
        }
        assert_int_equal(a->n_stated, b->n_stated);
        for (size_t s = 0; s < a->n_stated; s++) {
            assert_string_equal(a->stated[s].region, b->stated[s].region);
            assert_int_equal(a->stated[s].number, b->stated[s].number);
            same_number(a->stated[s].low, b->stated[s].low);
            same_number(a->stated[s].mean, b->stated[s].mean);
            same_number(a->stated[s].high, b->stated[s].high);
            same_number(a->stated[s].volume_cm3, b->stated[s].volume_cm3);
        }
        assert_int_equal(a->n_components, b->n_components);
        for (size_t c = 0; c < a->n_components; c++) {
            assert_int_equal(a->components[c].quantity, b->components[c].quantity);
            assert_int_equal(a->components[c].is_per_ppm, b->components[c].is_per_ppm);
            assert_int_equal(a->components[c].has_boron_ppm, b->components[c].has_boron_ppm);
            same_number(a->components[c].boron_ppm, b->components[c].boron_ppm);
            same_volume(a->components[c].values, b->components[c].values, mm);
            assert_int_equal(a->components[c].error != NULL, b->components[c].error != NULL);
            if (a->components[c].error)
                same_volume(a->components[c].error, b->components[c].error, mm);
        }
        assert_int_equal(a->mask != NULL, b->mask != NULL);
        if (a->mask)
            same_volume(a->mask, b->mask, mm);
    }
}

static void same_delivery(const struct beam_delivery *a, const struct beam_delivery *b)
{
    assert_int_equal(a->number, b->number);
    assert_string_equal(a->radiation, b->radiation);
    assert_string_equal(a->machine, b->machine);
    assert_int_equal(a->patient_position, b->patient_position);
    same_number(a->gantry_deg, b->gantry_deg);
    same_number(a->collimator_deg, b->collimator_deg);
    same_number(a->couch_deg, b->couch_deg);
    same_number(a->energy_mev, b->energy_mev);
    same_number(a->gantry_stop_deg, b->gantry_stop_deg);
    same_number(a->gantry_travel_deg, b->gantry_travel_deg);
    assert_int_equal(a->n_control_points, b->n_control_points);
    same_number(a->sad_mm, b->sad_mm);
    same_number(a->ssd_mm, b->ssd_mm);
    for (int i = 0; i < 2; i++) {
        same_number(a->jaws_x_mm[i], b->jaws_x_mm[i]);
        same_number(a->jaws_y_mm[i], b->jaws_y_mm[i]);
        same_number(a->opening_x_mm[i], b->opening_x_mm[i]);
        same_number(a->opening_y_mm[i], b->opening_y_mm[i]);
    }
    same_number(a->opening_cm2, b->opening_cm2);
    assert_int_equal(a->outline.kind, b->outline.kind);
    assert_int_equal(a->outline.n_polygons, b->outline.n_polygons);
    for (size_t i = 0; i < a->outline.n_polygons; i++)
        assert_int_equal(a->outline.ends[i], b->outline.ends[i]);
    assert_memory_equal(a->outline.points_mm, b->outline.points_mm,
                        beam_outline_n_points(&a->outline) * sizeof *a->outline.points_mm);
    same_vector(a->collimator_x_lps, b->collimator_x_lps);
    same_vector(a->collimator_y_lps, b->collimator_y_lps);
    same_number(a->dose_gy, b->dose_gy);
    same_number(a->meterset, b->meterset);
    assert_string_equal(a->meterset_unit, b->meterset_unit);
    assert_int_equal(a->n_fractions, b->n_fractions);
}

static void same_beams(const struct plan *found, const struct plan *expected)
{
    assert_int_equal(found->n_beams, expected->n_beams);
    for (size_t i = 0; i < found->n_beams; i++) {
        const struct beam *a = &found->beams[i], *b = &expected->beams[i];
        assert_string_equal(a->id, b->id);
        same_vector(a->entry_lps_mm, b->entry_lps_mm);
        same_vector(a->target_lps_mm, b->target_lps_mm);
        same_number(a->aperture_mm, b->aperture_mm);
        assert_string_equal(a->name, b->name);
        assert_int_equal(a->has_delivery, b->has_delivery);
        if (a->has_delivery)
            same_delivery(&a->delivery, &b->delivery);
    }
}

static void same_curves(const struct plan *found, const struct plan *expected)
{
    assert_int_equal(found->n_curves, expected->n_curves);
    for (size_t i = 0; i < found->n_curves; i++) {
        const struct dose_curve *a = &found->curves[i], *b = &expected->curves[i];
        assert_string_equal(a->id, b->id);
        assert_string_equal(a->name, b->name);
        assert_string_equal(a->unit, b->unit);
        assert_string_equal(a->per, b->per);
        assert_int_equal(a->n_depths, b->n_depths);
        assert_int_equal(a->n_radii, b->n_radii);
        assert_int_equal(a->n_columns, b->n_columns);
        same_vector(a->center_lps_mm, b->center_lps_mm);
        for (size_t d = 0; d < a->n_depths; d++)
            same_number(a->depths_mm[d], b->depths_mm[d]);
        for (size_t r = 0; r < a->n_radii; r++)
            same_number(a->radii_mm[r], b->radii_mm[r]);
        for (size_t c = 0; c < a->n_columns; c++) {
            assert_int_equal(a->quantities[c], b->quantities[c]);
            assert_int_equal(a->is_per_ppm[c], b->is_per_ppm[c]);
            for (size_t p = 0; p < a->n_depths * a->n_radii; p++)
                same_number((double)a->values[c][p], (double)b->values[c][p]);
        }
    }
    const struct plan_preferences *a = &found->preferences, *b = &expected->preferences;
    assert_int_equal(a->n_levels, b->n_levels);
    assert_int_equal(a->n_colors, b->n_colors);
    assert_memory_equal(a->colors, b->colors, sizeof a->colors);
    for (size_t i = 0; i < a->n_levels; i++) {
        assert_memory_equal(a->levels[i].rgb, b->levels[i].rgb, 3);
        same_number(a->levels[i].percent, b->levels[i].percent);
    }
}

void assert_same_plan(const struct plan *found, const struct plan *expected, double mm)
{
    assert_string_equal(found->name, expected->name);
    assert_string_equal(found->note, expected->note);
    assert_int_equal(found->is_phantom, expected->is_phantom);
    assert_int_equal(found->n_images, expected->n_images);
    for (size_t i = 0; i < found->n_images; i++) {
        assert_string_equal(found->images[i].id, expected->images[i].id);
        assert_string_equal(found->images[i].name, expected->images[i].name);
        assert_string_equal(found->images[i].modality, expected->images[i].modality);
        assert_string_equal(found->images[i].unit, expected->images[i].unit);
        assert_int_equal(found->images[i].is_inverted, expected->images[i].is_inverted);
        same_number(found->images[i].window_center, expected->images[i].window_center);
        same_number(found->images[i].window_width, expected->images[i].window_width);
        same_volume(found->images[i].volume, expected->images[i].volume, mm);
    }
    same_regions(&found->regions, &expected->regions, mm);
    same_doses(found, expected, mm);
    same_beams(found, expected);
    same_curves(found, expected);
    assert_int_equal(found->tracks.n_segments, expected->tracks.n_segments);
    assert_memory_equal(found->tracks.n_of_class, expected->tracks.n_of_class, sizeof found->tracks.n_of_class);
    for (size_t i = 0; i < found->tracks.n_segments; i++) {
        const struct track_segment *a = &found->tracks.segments[i], *b = &expected->tracks.segments[i];
        assert_memory_equal(a->from_lps_mm, b->from_lps_mm, sizeof a->from_lps_mm);
        assert_memory_equal(a->to_lps_mm, b->to_lps_mm, sizeof a->to_lps_mm);
        assert_int_equal(a->class, b->class);
        same_number((double)a->energy_mev, (double)b->energy_mev);
    }
    assert_close(vec3_length(vec3_sub(found->body_lps_mm.low, expected->body_lps_mm.low)), 0, mm);
    assert_close(vec3_length(vec3_sub(found->body_lps_mm.high, expected->body_lps_mm.high)), 0, mm);
    assert_close(vec3_length(vec3_sub(found->bounds_lps_mm.low, expected->bounds_lps_mm.low)), 0, mm);
    assert_close(vec3_length(vec3_sub(found->bounds_lps_mm.high, expected->bounds_lps_mm.high)), 0, mm);
}

static void same_origin(const struct part_origin *a, const struct part_origin *b)
{
    assert_int_equal(a->patient, b->patient);
    assert_int_equal(a->treatment_plan, b->treatment_plan);
    assert_int_equal(a->beam, b->beam);
    assert_string_equal(a->frame_uid, b->frame_uid);
    assert_string_equal(a->study_uid, b->study_uid);
    assert_string_equal(a->series_uid, b->series_uid);
    assert_string_equal(a->plan_uid, b->plan_uid);
    assert_string_equal(a->structs_uid, b->structs_uid);
    assert_string_equal(a->set_label, b->set_label);
    assert_string_equal(a->path, b->path);
    assert_int_equal(a->is_registered, b->is_registered);
    assert_int_equal(a->is_stated_same, b->is_stated_same);
    assert_int_equal(a->is_stated_other, b->is_stated_other);
}

static void same_patients(const struct plan *found, const struct plan *expected)
{
    assert_int_equal(found->n_patients, expected->n_patients);
    for (size_t i = 0; i < found->n_patients; i++) {
        const struct plan_patient *a = &found->patients[i], *b = &expected->patients[i];
        assert_string_equal(a->id, b->id);
        assert_string_equal(a->issuer, b->issuer);
        assert_string_equal(a->name, b->name);
        assert_string_equal(a->birth_date, b->birth_date);
        assert_string_equal(a->sex, b->sex);
        assert_int_equal(a->has_conflict, b->has_conflict);
    }
}

static void same_treatment_plans(const struct plan *found, const struct plan *expected)
{
    assert_int_equal(found->n_treatment_plans, expected->n_treatment_plans);
    for (size_t i = 0; i < found->n_treatment_plans; i++) {
        const struct treatment_plan *a = &found->treatment_plans[i], *b = &expected->treatment_plans[i];
        assert_string_equal(a->uid, b->uid);
        assert_string_equal(a->structs_uid, b->structs_uid);
        assert_int_equal(a->n_beams, b->n_beams);
        assert_string_equal(a->label, b->label);
        assert_string_equal(a->name, b->name);
        assert_string_equal(a->date, b->date);
        assert_string_equal(a->time, b->time);
        assert_string_equal(a->approval, b->approval);
        assert_string_equal(a->review_date, b->review_date);
        assert_string_equal(a->reviewer, b->reviewer);
        assert_int_equal(a->n_fractions, b->n_fractions);
        same_number(a->prescription_gy, b->prescription_gy);
        assert_int_equal(a->patient, b->patient);
    }
}

void assert_same_origins(const struct plan *found, const struct plan *expected)
{
    same_patients(found, expected);
    assert_int_equal(found->statement.kind, expected->statement.kind);
    same_treatment_plans(found, expected);
    assert_int_equal(found->n_registrations, expected->n_registrations);
    for (size_t i = 0; i < found->n_registrations; i++) {
        const struct plan_registration *a = &found->registrations[i], *b = &expected->registrations[i];
        assert_string_equal(a->from_uid, b->from_uid);
        assert_string_equal(a->to_uid, b->to_uid);
        assert_int_equal(a->patient, b->patient);
        for (int c = 0; c < 3; c++)
            same_vector(a->to_from_lps_mm.columns[c], b->to_from_lps_mm.columns[c]);
        same_vector(a->to_from_lps_mm.origin, b->to_from_lps_mm.origin);
    }
    for (size_t i = 0; i < found->n_images; i++)
        same_origin(&found->image_origins[i], &expected->image_origins[i]);
    for (size_t i = 0; i < found->n_doses; i++)
        same_origin(&found->dose_origins[i], &expected->dose_origins[i]);
    for (size_t i = 0; i < found->n_beams; i++)
        same_origin(&found->beam_origins[i], &expected->beam_origins[i]);
    same_origin(&found->tracks_origin, &expected->tracks_origin);
    assert_int_equal(found->n_region_origins, expected->n_region_origins);
    for (size_t i = 0; i < found->n_region_origins; i++)
        same_origin(&found->region_origins[i], &expected->region_origins[i]);
    for (size_t r = 0; r < found->regions.n_regions; r++)
        assert_int_equal(found->regions.regions[r].origin, expected->regions.regions[r].origin);
}

/* Writes and reads the fields of a plan as bytes, without the voxels. */
#include "core/load/cache_fields.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/volume/window.h"

void fields_bytes(struct fields *fields, void *value, size_t size)
{
    if (fields->is_reading) {
        if (fields->is_bad || fields->size - fields->at < size) {
            fields->is_bad = true;
            memset(value, 0, size);
            return;
        }
        memcpy(value, fields->data + fields->at, size);
        fields->at += size;
        return;
    }
    if (fields->is_bad || size == 0) /* value may be NULL then */
        return;
    if (fields->capacity - fields->size < size) {
        size_t capacity = 2 * fields->capacity + size + 4096;
        uint8_t *data = realloc(fields->data, capacity);
        if (!data) {
            fields->is_bad = fields->lacks_memory = true;
            return;
        }
        fields->data = data;
        fields->capacity = capacity;
    }
    memcpy(fields->data + fields->size, value, size);
    fields->size += size;
}

void fields_u64(struct fields *fields, uint64_t *value)
{
    fields_bytes(fields, value, sizeof *value);
}

static void require(struct fields *fields, bool is_good)
{
    fields->is_bad |= !is_good;
}

/* A length and that many bytes. Reading fills the rest of text with zeros. */
void fields_text(struct fields *fields, char *text, size_t size)
{
    uint64_t n = fields->is_reading ? 0 : strlen(text);
    fields_u64(fields, &n);
    require(fields, n < size);
    if (fields->is_bad)
        return;
    fields_bytes(fields, text, (size_t)n);
    if (fields->is_reading) {
        text[n] = 0;
        require(fields, strlen(text) == n);
    }
}

static void fields_bool(struct fields *fields, bool *value)
{
    uint8_t byte = *value;
    fields_bytes(fields, &byte, 1);
    require(fields, byte <= 1);
    if (fields->is_reading)
        *value = byte == 1;
}

static void fields_size(struct fields *fields, size_t *value, size_t most)
{
    uint64_t wide = *value;
    fields_u64(fields, &wide);
    require(fields, wide <= most);
    if (fields->is_reading)
        *value = fields->is_bad ? 0 : (size_t)wide;
}

/* An enum with n values. Stores only when reading: a plan being written is shared and frozen, and even storing the same
 * value would be a data race. */
#define FIELDS_ENUM(fields, place, type, n) \
    do { \
        uint8_t byte_ = (uint8_t)(place); \
        fields_bytes(fields, &byte_, 1); \
        require(fields, byte_ < (n)); \
        if ((fields)->is_reading) \
            (place) = (type)((fields)->is_bad ? 0 : byte_); \
    } while (0)

static void fields_number(struct fields *fields, double *value) /* not-a-number is allowed */
{
    fields_bytes(fields, value, sizeof *value);
    require(fields, !isinf(*value));
}

static void fields_finite(struct fields *fields, double *value)
{
    fields_bytes(fields, value, sizeof *value);
    require(fields, isfinite(*value));
}

static void fields_point(struct fields *fields, struct vec3 *p)
{
    fields_finite(fields, &p->x);
    fields_finite(fields, &p->y);
    fields_finite(fields, &p->z);
}

static void fields_grid(struct fields *fields, struct grid *grid)
{
    uint32_t size[3] = { grid->size[0], grid->size[1], grid->size[2] };
    struct affine map = grid->lps_mm_from_ijk;
    fields_bytes(fields, size, sizeof size);
    for (int i = 0; i < 3; i++)
        fields_point(fields, &map.columns[i]);
    fields_point(fields, &map.origin);
    if (fields->is_reading && !fields->is_bad)
        require(fields, grid_init(grid, size, &map, NULL));
}

/* A volume without its voxels; NULL is allowed. */
static void fields_volume(struct fields *fields, struct volume **volume, bool is_label_layer)
{
    bool is_there = *volume != NULL;
    fields_bool(fields, &is_there);
    if (!is_there || fields->is_bad)
        return;
    if (fields->is_reading) {
        *volume = mem_new(sizeof **volume);
        atomic_init(&(*volume)->references, 1);
    }
    struct volume *v = *volume;
    FIELDS_ENUM(fields, v->type, enum voxel_type, VOXEL_F32 + 1);
    require(fields, !is_label_layer || v->type == VOXEL_U8 || v->type == VOXEL_U16);
    fields_finite(fields, &v->slope);
    fields_finite(fields, &v->offset);
    fields_finite(fields, &v->low);
    fields_finite(fields, &v->high);
    fields_grid(fields, &v->grid);
    require(fields, fields->n_volumes < FIELDS_MAX_VOLUMES);
    if (!fields->is_bad)
        fields->volumes[fields->n_volumes++] = v;
}

static void fields_images(struct fields *fields, struct plan *plan)
{
    fields_size(fields, &plan->n_images, PLAN_MAX_IMAGES);
    for (size_t i = 0; i < plan->n_images; i++) {
        struct plan_image *image = &plan->images[i];
        fields_text(fields, image->id, sizeof image->id);
        fields_text(fields, image->name, sizeof image->name);
        fields_text(fields, image->modality, sizeof image->modality);
        fields_text(fields, image->unit, sizeof image->unit);
        fields_volume(fields, &image->volume, false);
        require(fields, image->volume != NULL);
        fields_finite(fields, &image->window_center);
        fields_finite(fields, &image->window_width);
        require(fields, fabs(image->window_center) <= WINDOW_CENTER_FARTHEST &&
                            image->window_width >= WINDOW_NARROWEST && image->window_width <= WINDOW_WIDEST);
        fields_bool(fields, &image->is_inverted);
    }
}

/* Counts, boxes and centres are not written: they are measured again after reading. */
static void fields_region(struct fields *fields, struct region *region, const struct region_set *set)
{
    uint64_t layer = region->layer, label = region->label, origin = region->origin;
    int64_t parent = region->parent;
    fields_text(fields, region->id, sizeof region->id);
    fields_text(fields, region->name, sizeof region->name);
    fields_bytes(fields, region->rgb, sizeof region->rgb);
    fields_bool(fields, &region->has_file_color);
    fields_bool(fields, &region->is_target);
    fields_finite(fields, &region->file_opacity);
    require(fields, region->file_opacity >= 0 && region->file_opacity <= 1);
    fields_bytes(fields, &parent, sizeof parent);
    fields_u64(fields, &layer);
    fields_u64(fields, &label);
    fields_u64(fields, &origin);
    require(fields, parent >= -1 && parent < (int64_t)set->n_regions && layer < set->n_layers && label >= 1 &&
                        label <= UINT16_MAX && origin <= REGION_MAX);
    if (fields->is_reading) {
        region->parent = fields->is_bad ? -1 : (int)parent;
        region->layer = fields->is_bad ? 0 : (uint32_t)layer;
        region->label = (uint16_t)label;
        region->origin = fields->is_bad ? 0 : (uint16_t)origin;
    }
    fields_number(fields, &region->boron_ratio);
    fields_number(fields, &region->cbe_boron);
    fields_number(fields, &region->rbe_nitrogen);
    fields_number(fields, &region->rbe_fast);
    fields_number(fields, &region->rbe_gamma);
}

static bool has_cycle(const struct region_set *set)
{
    for (size_t r = 0; r < set->n_regions; r++) {
        size_t n = 0;
        for (int up = set->regions[r].parent; up >= 0; up = set->regions[up].parent)
            if (++n > set->n_regions)
                return true;
    }
    return false;
}

static bool ids_are_good(const struct region_set *set)
{
    for (size_t r = 0; r < set->n_regions; r++) {
        const char *id = set->regions[r].id;
        if (!id[0] || strspn(id, "abcdefghijklmnopqrstuvwxyz0123456789-") != strlen(id) ||
            region_find(set, id) != &set->regions[r])
            return false;
    }
    return true;
}

static void fields_regions(struct fields *fields, struct region_set *set)
{
    fields_size(fields, &set->n_layers, REGION_MAX_LAYERS);
    for (size_t i = 0; i < set->n_layers; i++) {
        fields_volume(fields, &set->layers[i], true);
        require(fields, set->layers[i] != NULL);
    }
    fields_size(fields, &set->n_regions, REGION_MAX);
    if (fields->is_reading)
        set->regions = mem_new(REGION_MAX * sizeof *set->regions);
    for (size_t r = 0; r < set->n_regions; r++)
        fields_region(fields, &set->regions[r], set);
    FIELDS_ENUM(fields, set->hierarchy, enum hierarchy_source, HIERARCHY_DERIVED + 1);
    if (fields->is_reading && !fields->is_bad)
        require(fields, !has_cycle(set) && ids_are_good(set));
}

static void fields_dose(struct fields *fields, struct dose *dose)
{
    fields_text(fields, dose->id, sizeof dose->id);
    fields_text(fields, dose->name, sizeof dose->name);
    fields_text(fields, dose->unit, sizeof dose->unit);
    fields_text(fields, dose->per, sizeof dose->per);
    fields_bool(fields, &dose->has_frame);
    FIELDS_ENUM(fields, dose->frame, enum dose_frame, DOSE_N_FRAMES);
    fields_size(fields, &dose->n_components, DOSE_N_QUANTITIES);
    require(fields, dose->n_components > 0);
    for (size_t c = 0; c < dose->n_components; c++) {
        struct dose_component *component = &dose->components[c];
        FIELDS_ENUM(fields, component->quantity, enum dose_quantity, DOSE_N_QUANTITIES);
        fields_bool(fields, &component->is_per_ppm);
        fields_bool(fields, &component->has_boron_ppm);
        fields_finite(fields, &component->boron_ppm);
        fields_volume(fields, &component->values, false);
        require(fields, component->values != NULL);
        fields_volume(fields, &component->error, false);
    }
    fields_volume(fields, &dose->mask, true);
    for (int q = 0; q < DOSE_N_QUANTITIES; q++) {
        fields_finite(fields, &dose->reference[q]);
        fields_finite(fields, &dose->body_high[q]);
    }
    fields_size(fields, &dose->n_stated, DOSE_MAX_STATED);
    for (size_t i = 0; i < dose->n_stated; i++) {
        struct dose_stated *stated = &dose->stated[i];
        uint64_t number = (uint64_t)stated->number;
        fields_text(fields, stated->region, sizeof stated->region);
        fields_u64(fields, &number);
        if (fields->is_reading)
            stated->number = (int64_t)number;
        fields_number(fields, &stated->low);
        fields_number(fields, &stated->mean);
        fields_number(fields, &stated->high);
        fields_number(fields, &stated->volume_cm3);
    }
}

static void fields_outline(struct fields *fields, struct beam_outline *outline)
{
    size_t n_polygons = outline->n_polygons, before = 0;
    FIELDS_ENUM(fields, outline->kind, enum beam_outline_kind, BEAM_OUTLINE_BLOCKS + 1);
    fields_size(fields, &n_polygons, BEAM_OUTLINE_MAX_POLYGONS);
    require(fields, (n_polygons == 0) == (outline->kind == BEAM_OUTLINE_NONE));
    for (size_t i = 0; i < n_polygons; i++) {
        size_t end = outline->ends[i];
        fields_size(fields, &end, BEAM_OUTLINE_MAX_POINTS);
        require(fields, end >= before + 3);
        if (fields->is_bad)
            return;
        for (size_t point = before; point < end; point++)
            for (int axis = 0; axis < 2; axis++) {
                fields_bytes(fields, &outline->points_mm[point][axis], sizeof(float));
                require(fields, isfinite(outline->points_mm[point][axis]));
            }
        before = end;
        if (fields->is_reading) {
            outline->ends[i] = (uint16_t)end;
            outline->n_polygons = (uint16_t)(i + 1);
        }
    }
}

static void fields_delivery(struct fields *fields, struct beam_delivery *d)
{
    double *const numbers[] = { &d->gantry_deg,
                                &d->collimator_deg,
                                &d->couch_deg,
                                &d->energy_mev,
                                &d->gantry_stop_deg,
                                &d->gantry_travel_deg,
                                &d->sad_mm,
                                &d->ssd_mm,
                                &d->jaws_x_mm[0],
                                &d->jaws_x_mm[1],
                                &d->jaws_y_mm[0],
                                &d->jaws_y_mm[1],
                                &d->opening_x_mm[0],
                                &d->opening_x_mm[1],
                                &d->opening_y_mm[0],
                                &d->opening_y_mm[1],
                                &d->opening_cm2,
                                &d->collimator_x_lps.x,
                                &d->collimator_x_lps.y,
                                &d->collimator_x_lps.z,
                                &d->collimator_y_lps.x,
                                &d->collimator_y_lps.y,
                                &d->collimator_y_lps.z,
                                &d->dose_gy,
                                &d->meterset };
    fields_bytes(fields, &d->number, sizeof d->number);
    fields_bytes(fields, &d->n_fractions, sizeof d->n_fractions);
    fields_text(fields, d->radiation, sizeof d->radiation);
    fields_text(fields, d->machine, sizeof d->machine);
    fields_text(fields, d->meterset_unit, sizeof d->meterset_unit);
    FIELDS_ENUM(fields, d->patient_position, enum patient_position, PATIENT_FFDL + 1);
    fields_size(fields, &d->n_control_points, UINT32_MAX);
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++)
        fields_number(fields, numbers[i]);
    fields_outline(fields, &d->outline);
}

static void fields_beam(struct fields *fields, struct beam *beam)
{
    fields_text(fields, beam->id, sizeof beam->id);
    fields_text(fields, beam->name, sizeof beam->name);
    fields_point(fields, &beam->entry_lps_mm);
    fields_point(fields, &beam->target_lps_mm);
    require(fields, vec3_length(vec3_sub(beam->entry_lps_mm, beam->target_lps_mm)) > 0);
    fields_number(fields, &beam->aperture_mm);
    fields_bool(fields, &beam->has_delivery);
    fields_delivery(fields, &beam->delivery);
}

static void fields_tracks(struct fields *fields, struct track_set *tracks)
{
    enum { SEGMENT_BYTES = 7 * sizeof(float) + 1 };
    fields_size(fields, &tracks->n_segments, TRACK_MAX_SEGMENTS);
    if (fields->is_reading && !fields->is_bad) {
        require(fields, tracks->n_segments <= (fields->size - fields->at) / SEGMENT_BYTES);
        tracks->n_segments = fields->is_bad ? 0 : tracks->n_segments;
        tracks->segments = mem_array(tracks->n_segments + 1, sizeof *tracks->segments, UINT64_MAX, NULL);
        require(fields, tracks->segments != NULL);
        tracks->n_segments = tracks->segments ? tracks->n_segments : 0;
    }
    for (size_t i = 0; i < tracks->n_segments; i++) {
        struct track_segment *segment = &tracks->segments[i];
        fields_bytes(fields, segment->from_lps_mm, sizeof segment->from_lps_mm);
        fields_bytes(fields, segment->to_lps_mm, sizeof segment->to_lps_mm);
        FIELDS_ENUM(fields, segment->class, uint8_t, TRACK_N_CLASSES);
        fields_bytes(fields, &segment->energy_mev, sizeof segment->energy_mev);
        require(fields, isnan(segment->energy_mev) || (isfinite(segment->energy_mev) && segment->energy_mev >= 0));
        for (int axis = 0; axis < 3; axis++)
            require(fields, isfinite(segment->from_lps_mm[axis]) && isfinite(segment->to_lps_mm[axis]));
        if (fields->is_reading)
            tracks->n_of_class[segment->class]++;
    }
    size_t n_left = tracks->n_segments;
    fields_size(fields, &tracks->n_files, TRACK_MAX_FILES);
    for (size_t i = 0; i < tracks->n_files; i++) {
        struct track_file *file = &tracks->files[i];
        fields_text(fields, file->path, sizeof file->path);
        fields_size(fields, &file->n_segments, n_left);
        n_left -= file->n_segments;
        fields_finite(fields, &file->unit_mm);
        require(fields, file->unit_mm > 0);
    }
    require(fields, n_left == 0);
}

/* The n points along an axis of a curve, strictly rising. */
static void fields_axis(struct fields *fields, double **axis, size_t *n)
{
    fields_size(fields, n, CURVE_MAX_POINTS);
    require(fields, *n >= 1);
    if (fields->is_reading)
        *axis = mem_new((*n + 1) * sizeof **axis);
    for (size_t i = 0; i < *n; i++) {
        fields_finite(fields, &(*axis)[i]);
        require(fields, i == 0 || (*axis)[i] > (*axis)[i - 1]);
    }
}

static void fields_curve(struct fields *fields, struct dose_curve *curve)
{
    fields_text(fields, curve->id, sizeof curve->id);
    fields_text(fields, curve->name, sizeof curve->name);
    fields_text(fields, curve->unit, sizeof curve->unit);
    fields_text(fields, curve->per, sizeof curve->per);
    fields_point(fields, &curve->center_lps_mm);
    fields_axis(fields, &curve->depths_mm, &curve->n_depths);
    fields_axis(fields, &curve->radii_mm, &curve->n_radii);
    fields_size(fields, &curve->n_columns, DOSE_N_QUANTITIES);
    size_t n_points = curve->n_depths * curve->n_radii;
    for (size_t c = 0; c < curve->n_columns; c++) {
        FIELDS_ENUM(fields, curve->quantities[c], enum dose_quantity, DOSE_N_QUANTITIES);
        fields_bool(fields, &curve->is_per_ppm[c]);
        if (fields->is_reading) {
            require(fields, n_points * sizeof(float) <= fields->size - fields->at);
            curve->values[c] = mem_array(fields->is_bad ? 1 : n_points, sizeof(float), UINT64_MAX, NULL);
            require(fields, curve->values[c] != NULL);
        }
        if (!fields->is_bad)
            fields_bytes(fields, curve->values[c], n_points * sizeof(float));
    }
}

static void fields_preferences(struct fields *fields, struct plan_preferences *preferences)
{
    fields_size(fields, &preferences->n_levels, PLAN_MAX_LEVELS);
    for (size_t i = 0; i < preferences->n_levels; i++) {
        fields_finite(fields, &preferences->levels[i].percent);
        fields_bytes(fields, preferences->levels[i].rgb, sizeof preferences->levels[i].rgb);
    }
    fields_size(fields, &preferences->n_colors, PLAN_MAX_COLORS);
    for (size_t i = 0; i < preferences->n_colors; i++)
        fields_bytes(fields, preferences->colors[i], sizeof preferences->colors[i]);
}

static void fields_report(struct fields *fields, struct report *report)
{
    struct report read = { 0 };
    struct report *all = fields->is_reading ? &read : report;
    fields_size(fields, &all->n_lines, REPORT_MAX);
    fields_size(fields, &all->n_dropped, SIZE_MAX);
    for (size_t i = 0; i < all->n_lines && !fields->is_bad; i++) {
        static const struct report_line none;
        struct report_line line = fields->is_reading ? none : report->lines[i];
        FIELDS_ENUM(fields, line.severity, enum report_severity, REPORT_ERROR + 1);
        fields_text(fields, line.code, sizeof line.code);
        fields_text(fields, line.where, sizeof line.where);
        fields_text(fields, line.sentence, sizeof line.sentence);
        fields_text(fields, line.facts.code, sizeof line.facts.code);
        fields_text(fields, line.facts.values, sizeof line.facts.values);
        require(fields, report_code_is_known(line.code));
        if (fields->is_reading && !fields->is_bad)
            report_add_line(report, &line);
    }
    if (fields->is_reading)
        report->n_dropped = all->n_dropped;
}

/* An index below n, or -1. */
static void fields_index(struct fields *fields, int *index, size_t n)
{
    int64_t wide = *index;
    fields_bytes(fields, &wide, sizeof wide);
    require(fields, wide >= -1 && wide < (int64_t)n);
    if (fields->is_reading)
        *index = fields->is_bad ? -1 : (int)wide;
}

static void fields_origin(struct fields *fields, struct part_origin *origin, const struct plan *plan)
{
    fields_index(fields, &origin->patient, plan->n_patients);
    fields_index(fields, &origin->treatment_plan, plan->n_treatment_plans);
    fields_size(fields, &origin->beam, PLAN_MAX_BEAMS);
    fields_text(fields, origin->frame_uid, sizeof origin->frame_uid);
    fields_text(fields, origin->study_uid, sizeof origin->study_uid);
    fields_text(fields, origin->series_uid, sizeof origin->series_uid);
    fields_text(fields, origin->plan_uid, sizeof origin->plan_uid);
    fields_text(fields, origin->structs_uid, sizeof origin->structs_uid);
    fields_text(fields, origin->set_label, sizeof origin->set_label);
    fields_text(fields, origin->path, sizeof origin->path);
    fields_bool(fields, &origin->is_registered);
    fields_bool(fields, &origin->is_stated_same);
    fields_bool(fields, &origin->is_stated_other);
}

static void fields_patient(struct fields *fields, struct plan_patient *patient)
{
    fields_text(fields, patient->id, sizeof patient->id);
    fields_text(fields, patient->issuer, sizeof patient->issuer);
    fields_text(fields, patient->name, sizeof patient->name);
    fields_text(fields, patient->birth_date, sizeof patient->birth_date);
    fields_text(fields, patient->sex, sizeof patient->sex);
    fields_bool(fields, &patient->has_conflict);
}

static void fields_treatment_plan(struct fields *fields, struct treatment_plan *treatment, const struct plan *plan)
{
    fields_text(fields, treatment->uid, sizeof treatment->uid);
    fields_text(fields, treatment->structs_uid, sizeof treatment->structs_uid);
    fields_text(fields, treatment->label, sizeof treatment->label);
    fields_text(fields, treatment->name, sizeof treatment->name);
    fields_text(fields, treatment->date, sizeof treatment->date);
    fields_text(fields, treatment->time, sizeof treatment->time);
    fields_text(fields, treatment->approval, sizeof treatment->approval);
    fields_text(fields, treatment->review_date, sizeof treatment->review_date);
    fields_text(fields, treatment->reviewer, sizeof treatment->reviewer);
    fields_bytes(fields, &treatment->n_fractions, sizeof treatment->n_fractions);
    fields_size(fields, &treatment->n_beams, PLAN_MAX_BEAMS);
    fields_number(fields, &treatment->prescription_gy);
    fields_index(fields, &treatment->patient, plan->n_patients);
}

static void fields_registration(struct fields *fields, struct plan_registration *registration, const struct plan *plan)
{
    fields_text(fields, registration->from_uid, sizeof registration->from_uid);
    fields_text(fields, registration->to_uid, sizeof registration->to_uid);
    for (int i = 0; i < 3; i++)
        fields_point(fields, &registration->to_from_lps_mm.columns[i]);
    fields_point(fields, &registration->to_from_lps_mm.origin);
    fields_index(fields, &registration->patient, plan->n_patients);
}

static void fields_box(struct fields *fields, struct box3 *box)
{
    for (struct vec3 *end = &box->low; end; end = end == &box->low ? &box->high : NULL) {
        fields_finite(fields, &end->x);
        fields_finite(fields, &end->y);
        fields_finite(fields, &end->z);
    }
}

/* After images, regions, doses and beams, which it counts. */
static void fields_origins(struct fields *fields, struct plan *plan)
{
    fields_size(fields, &plan->n_patients, ORIGIN_MAX_PATIENTS);
    for (size_t i = 0; i < plan->n_patients; i++)
        fields_patient(fields, &plan->patients[i]);
    fields_size(fields, &plan->n_treatment_plans, ORIGIN_MAX_TREATMENT_PLANS);
    for (size_t i = 0; i < plan->n_treatment_plans; i++)
        fields_treatment_plan(fields, &plan->treatment_plans[i], plan);
    fields_size(fields, &plan->n_registrations, ORIGIN_MAX_REGISTRATIONS);
    for (size_t i = 0; i < plan->n_registrations; i++)
        fields_registration(fields, &plan->registrations[i], plan);
    for (size_t i = 0; i < plan->n_images; i++)
        fields_origin(fields, &plan->image_origins[i], plan);
    for (size_t i = 0; i < plan->n_doses; i++)
        fields_origin(fields, &plan->dose_origins[i], plan);
    for (size_t i = 0; i < plan->n_beams; i++)
        fields_origin(fields, &plan->beam_origins[i], plan);
    fields_origin(fields, &plan->tracks_origin, plan);
    fields_size(fields, &plan->n_region_origins, REGION_MAX);
    if (fields->is_reading) {
        plan->region_origins = mem_array(plan->n_region_origins, sizeof *plan->region_origins, UINT64_MAX, NULL);
        require(fields, plan->region_origins != NULL);
        plan->n_region_origins = plan->region_origins ? plan->n_region_origins : 0;
    }
    for (size_t i = 0; i < plan->n_region_origins; i++)
        fields_origin(fields, &plan->region_origins[i], plan);
    for (size_t i = 0; i < plan->regions.n_regions; i++)
        require(fields, plan->regions.regions[i].origin <= plan->n_region_origins);
}

void fields_plan(struct fields *fields, struct plan *plan)
{
    fields_text(fields, plan->name, sizeof plan->name);
    fields_text(fields, plan->note, sizeof plan->note);
    fields_bool(fields, &plan->is_phantom);
    fields_images(fields, plan);
    fields_regions(fields, &plan->regions);
    fields_size(fields, &plan->n_doses, PLAN_MAX_DOSES);
    for (size_t d = 0; d < plan->n_doses; d++)
        fields_dose(fields, &plan->doses[d]);
    fields_size(fields, &plan->n_beams, PLAN_MAX_BEAMS);
    for (size_t b = 0; b < plan->n_beams; b++)
        fields_beam(fields, &plan->beams[b]);
    fields_origins(fields, plan);
    fields_tracks(fields, &plan->tracks);
    fields_size(fields, &plan->n_curves, PLAN_MAX_CURVES);
    for (size_t c = 0; c < plan->n_curves; c++)
        fields_curve(fields, &plan->curves[c]);
    fields_preferences(fields, &plan->preferences);
    fields_report(fields, &plan->report);
    fields_box(fields, &plan->bounds_lps_mm);
    fields_box(fields, &plan->body_lps_mm);
    if (fields->is_reading)
        require(fields, fields->at == fields->size);
}

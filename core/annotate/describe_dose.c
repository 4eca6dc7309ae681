/* Words for the dose of a snapshot, and the labels of its lines. */
#include "core/annotate/describe_dose.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/annotate/words.h"
#include "core/plan/fit.h"
#include "core/region/body.h"
#include "core/render/visible/draw_compare.h"
#include "core/render/visible/isoline_labels.h"
#include "core/scene/dose_coverage_choice.h"
#include "core/scene/dose_scale.h"
#include "dose_presets.h"

static char *add_text(struct annotations *annotations, enum annotation_row row)
{
    return annotation_add(annotations, row)->text;
}

bool dose_is_described(const struct snapshot *snapshot)
{
    const struct scene_dose_style *style = &snapshot->scene.dose;
    bool is_wanted = style->lines.visible || style->wash.visible || style->surfaces.visible ||
                     style->coverage.visible || style->compare.mode != SCENE_DOSE_COMPARISON_NONE;
    for (size_t i = 0; i < snapshot->plan->regions.n_regions; i++)
        is_wanted |= snapshot->styles[i].visible && snapshot->styles[i].texture == SCENE_TEXTURE_DOSE;
    return is_wanted && snapshot->dose >= 0;
}

static const char *name_of(const struct dose *dose)
{
    return dose->name[0] ? dose->name : dose->id;
}

static const char *quantity_words(enum scene_dose_quantity quantity)
{
    switch (quantity) {
    case SCENE_DOSE_QUANTITY_WEIGHTED: return "weighted dose";
    case SCENE_DOSE_QUANTITY_TOTAL: return "physical dose";
    case SCENE_DOSE_QUANTITY_ISOEFFECTIVE: return "photon-isoeffective dose";
    case SCENE_DOSE_QUANTITY_BORON: return "boron dose";
    case SCENE_DOSE_QUANTITY_NITROGEN: return "nitrogen dose";
    case SCENE_DOSE_QUANTITY_FAST: return "fast neutron dose";
    case SCENE_DOSE_QUANTITY_GAMMA: return "photon dose";
    case SCENE_DOSE_QUANTITY_OTHER: return "dose of other recoils and captures";
    case SCENE_DOSE_QUANTITY_FAST_FLUENCE: return "fluence of fast neutrons";
    case SCENE_DOSE_QUANTITY_EPITHERMAL_FLUENCE: return "fluence of epithermal neutrons";
    case SCENE_DOSE_QUANTITY_THERMAL_FLUENCE: return "fluence of thermal neutrons";
    case SCENE_DOSE_QUANTITY_BLOOD_BORON: return "boron dose of the file, per ppm in blood";
    case SCENE_DOSE_QUANTITY_WEIGHTED_TOTAL: return "weighted dose of the file";
    }
    return "dose";
}

/* "Dose A x 30": with a factor other than 1. */
static void add_part(struct annotations *annotations, const char *before, const struct dose *dose, double factor)
{
    char *text = add_text(annotations, ANNOTATION_DOSE);
    int n = snprintf(text, ANNOTATION_TEXT_SIZE, "%s%.64s", before, name_of(dose));
    if (factor < 1 || factor > 1)
        (void)snprintf(text + n, ANNOTATION_TEXT_SIZE - (size_t)n, " \u00d7 %.6g", factor);
}

static void add_parts(struct annotations *annotations, const struct snapshot *snapshot)
{
    const struct dose_choice *choice = &snapshot->dose_choice;
    for (size_t i = 0; i < choice->n_parts; i++)
        add_part(annotations, i == 0 ? "Dose " : "plus ", &snapshot->plan->doses[choice->parts[i].dose],
                 choice->parts[i].factor);
}

static void add_weights(struct annotations *annotations, const struct snapshot *snapshot)
{
    const struct scene_dose_style *style = &snapshot->scene.dose;
    const struct region *tissue = style->tissue[0] ? region_find(&snapshot->plan->regions, style->tissue) : NULL;
    bool is_weighted = style->quantity == SCENE_DOSE_QUANTITY_WEIGHTED;
    if (snapshot->dose_choice.blood_ppm > 0)
        (void)snprintf(add_text(annotations, ANNOTATION_DOSE), ANNOTATION_TEXT_SIZE, "%.4g ppm boron in blood",
                       snapshot->dose_choice.blood_ppm);
    if (is_weighted)
        (void)snprintf(add_text(annotations, ANNOTATION_DOSE), ANNOTATION_TEXT_SIZE, "weights: %.200s",
                       style->weights_name[0] ? style->weights_name : "edited");
    if (tissue && (is_weighted || !snapshot->dose_choice.is_everywhere || snapshot->dose_choice.blood_ppm > 0))
        (void)snprintf(add_text(annotations, ANNOTATION_DOSE), ANNOTATION_TEXT_SIZE, "everywhere as in %.64s",
                       tissue->name[0] ? tissue->name : tissue->id);
}

/* Says which quantities a total lacks. */
static void add_doubts(struct annotations *annotations, uint32_t missing)
{
    for (int quantity = 0; quantity < DOSE_N_QUANTITIES; quantity++)
        if (missing >> quantity & 1)
            (void)snprintf(add_text(annotations, ANNOTATION_DOSE), ANNOTATION_TEXT_SIZE, "without %s",
                           dose_quantity_word((enum dose_quantity)quantity));
}

static void add_reference(struct annotations *annotations, const struct dose_scale *scale)
{
    char value[40], *text = add_text(annotations, ANNOTATION_DOSE);
    if (isnan(scale->reference)) {
        (void)snprintf(text, ANNOTATION_TEXT_SIZE, "100 %% unknown: %.200s", scale->why_no_reference.text);
        return;
    }
    words_significant(value, scale->reference);
    (void)snprintf(text, ANNOTATION_TEXT_SIZE, "100 %% = %s %s, %s", value, scale->field->unit, scale->words);
}

/* Kinds of wash: levels, or instead of them a comparison or the statistical error (draw_wash_shown). */
enum wash_kind { WASH_NONE, WASH_LEVELS, WASH_ERROR, WASH_DIFFERENCE, WASH_GAMMA };

static enum wash_kind wash_kind(const struct scene_dose_style *style, bool is_compared)
{
    if (draw_compare_is_asked(style))
        return !is_compared                                              ? WASH_NONE
               : style->compare.mode == SCENE_DOSE_COMPARISON_DIFFERENCE ? WASH_DIFFERENCE
                                                                         : WASH_GAMMA;
    return !style->wash.visible ? WASH_NONE : style->error ? WASH_ERROR : WASH_LEVELS;
}

/* The text of a new item of the row of levels, with a square of the colour; ANNOTATION_TEXT_SIZE. */
static char *add_color(struct annotations *annotations, uint32_t rgb)
{
    struct annotation_item *item = annotation_add(annotations, ANNOTATION_LEVELS);
    item->has_chip = true;
    for (int channel = 0; channel < 3; channel++)
        item->rgb[channel] = (uint8_t)(rgb >> (16 - 8 * channel));
    return item->text;
}

static void add_difference_scale(struct annotations *annotations, const struct snapshot *snapshot,
                                 const struct dose_scale *scale)
{
    const struct color_stop *stops = difference_scale.stops;
    const char *unit = scale->field->unit;
    char span[40];
    words_significant(span, scale->reference * snapshot->scene.dose.compare.span_percent / 100);
    (void)snprintf(add_color(annotations, stops[0].color_rgb), ANNOTATION_TEXT_SIZE, "\u2264 \u2212%s %s", span, unit);
    (void)snprintf(add_color(annotations, stops[1].color_rgb), ANNOTATION_TEXT_SIZE, "0 %s", unit);
    (void)snprintf(add_color(annotations, stops[2].color_rgb), ANNOTATION_TEXT_SIZE, "\u2265 +%s %s", span, unit);
}

/* The colours of a wash that is not one of levels. */
static void add_scale(struct annotations *annotations, const struct snapshot *snapshot, const struct dose_scale *scale,
                      enum wash_kind kind)
{
    static const char *const indices[] = { "gamma 0", "up to 1: passes", "above 1", "\u2265 2" };
    if (kind == WASH_DIFFERENCE)
        add_difference_scale(annotations, snapshot, scale);
    for (size_t i = 0; kind == WASH_GAMMA && i < sizeof indices / sizeof *indices; i++)
        (void)snprintf(add_color(annotations, gamma_scale.stops[i].color_rgb), ANNOTATION_TEXT_SIZE, "%s", indices[i]);
    for (size_t i = 0; kind == WASH_ERROR && i < error_scale.n_stops; i++)
        (void)snprintf(add_color(annotations, error_scale.stops[i].color_rgb), ANNOTATION_TEXT_SIZE, "%s%g %%%s",
                       i + 1 < error_scale.n_stops ? "" : "\u2265 ", error_scale.stops[i].at,
                       i == 0 ? " statistical error" : "");
}

static void add_levels(struct annotations *annotations, const struct snapshot *snapshot, const struct dose_scale *scale,
                       bool is_compared, bool has_wash)
{
    const struct scene_dose_style *style = &snapshot->scene.dose;
    bool has_lines = style->lines.visible || (is_compared && style->compare.mode != SCENE_DOSE_COMPARISON_GAMMA);
    bool has_any = has_lines || has_wash || style->surfaces.visible;
    for (size_t i = 0; has_any && i < style->n_levels; i++) {
        const struct scene_dose_level *level = &style->levels[i].value;
        bool is_drawn =
            (level->line && has_lines) || (level->wash && has_wash) || (level->surface && style->surfaces.visible);
        double value = dose_level_value(scale, level->unit, level->value);
        char number[40], percent[40];
        if (!level->visible || !is_drawn || isnan(value))
            continue;
        words_significant(number, value);
        words_significant(percent, 100 * value / scale->reference);
        if (level->unit == SCENE_DOSE_UNIT_PERCENT)
            (void)snprintf(percent, sizeof percent, "%.6g", level->value);
        char *text = add_color(annotations, level->color_rgb);
        if (isnan(scale->reference))
            (void)snprintf(text, ANNOTATION_TEXT_SIZE, "%s %s", number, scale->field->unit);
        else
            (void)snprintf(text, ANNOTATION_TEXT_SIZE, "%s %% = %s %s", percent, number, scale->field->unit);
    }
}

/* "second less first, colours to ±10 % of the reference", "gamma index, 3 % of the reference and 2 mm, from 10 %" */
static void comparison_words(char text[WORDS_SIZE], const struct scene_dose_compare *compare, const char *where)
{
    switch (compare->mode) {
    case SCENE_DOSE_COMPARISON_NONE: text[0] = 0; return;
    case SCENE_DOSE_COMPARISON_LINES: (void)snprintf(text, WORDS_SIZE, "its lines dashed"); return;
    case SCENE_DOSE_COMPARISON_DIFFERENCE:
        (void)snprintf(text, WORDS_SIZE,
                       "second less first%s where the first is at least %.6g %%, colours to \u00b1%.6g %% of the "
                       "reference, its lines dashed",
                       where, compare->threshold_percent, compare->span_percent);
        return;
    case SCENE_DOSE_COMPARISON_GAMMA:
        (void)snprintf(text, WORDS_SIZE,
                       "gamma index, %.6g %% of the %s and %.6g mm,%s where the first is at least %.6g %%",
                       compare->dose_percent,
                       compare->normalization == SCENE_GAMMA_NORMALIZATION_LOCAL ? "dose at the point" : "reference",
                       compare->distance_mm, where, compare->threshold_percent);
    }
}

/* False: there is no comparison. */
static bool add_comparison(struct annotations *annotations, const struct snapshot *snapshot)
{
    const struct scene_dose_compare *compare = &snapshot->scene.dose.compare;
    int second = compare->id[0] ? dose_index_of(snapshot->plan, compare->id) : -1;
    if (compare->mode == SCENE_DOSE_COMPARISON_NONE || second < 0)
        return false;
    char way[WORDS_SIZE], why[FIT_WHY_SIZE];
    struct fit_use use = dose_compared_use(snapshot, (size_t)second);
    if (fit_is_used(&use)) {
        struct body body;
        bool is_in_body = compare->domain == SCENE_COMPARE_DOMAIN_BODY && body_find(&snapshot->fits.used, &body);
        comparison_words(way, compare, is_in_body ? " in the body" : "");
        (void)snprintf(add_text(annotations, ANNOTATION_DOSE), ANNOTATION_TEXT_SIZE, "Compared with %.64s: %.150s",
                       name_of(&snapshot->plan->doses[second]), way);
        return true;
    }
    fit_use_sentence(&snapshot->fits, (struct fit_part){ FIT_DOSE, (size_t)second }, &use, why);
    annotation_add_sentence(annotations, ANNOTATION_DOSE, why);
    return false;
}

/* The part of a region that is highlighted: "brain, univels of at least 5.00 Gy(w): own univels, without regions
 * inside, each region's own weights". */
static void add_coverage(struct annotations *annotations, const struct snapshot *snapshot,
                         const struct dose_scale *scale)
{
    const struct scene_dose_coverage *coverage = &snapshot->scene.dose.coverage;
    struct dose_coverage_choice choice;
    struct error why = { 0 };
    char low[48] = "", high[48] = "", words[96], unit[DOSE_UNIT_SIZE];
    if (!coverage->visible || !dose_coverage_choice_of(snapshot, scale, &choice, &why))
        return;
    const struct region *region = &snapshot->plan->regions.regions[choice.region];
    const char *basis = dose_basis_words(snapshot->plan, &choice.dose, coverage->tissue, words);
    dose_shown_unit(&snapshot->plan->doses[snapshot->dose], choice.dose.shown, choice.dose.quantity, unit);
    words_significant(low, choice.low);
    words_significant(high, choice.high);
    (void)snprintf(add_color(annotations, coverage->color_rgb), ANNOTATION_TEXT_SIZE,
                   "%.40s, univels%s%.20s%s%.20s %.20s%s%.20s: %.40s%s%.40s",
                   region->name[0] ? region->name : region->id, isfinite(choice.low) ? " of at least " : "",
                   isfinite(choice.low) ? low : "", isfinite(choice.high) ? " below " : "",
                   isfinite(choice.high) ? high : "", unit, coverage->quantity[0] ? " of " : "",
                   coverage->quantity[0] ? coverage->quantity : "", population_words(choice.population),
                   basis ? ", " : "", basis ? basis : "");
}

/* Doses of several beams together are per none of them. */
static const char *per_of(const struct snapshot *snapshot, const struct dose_field *field)
{
    char word[FIT_PER_SIZE];
    const struct dose_choice *choice = &snapshot->dose_choice;
    const bool is_of_beams =
        choice->n_parts > 1 && strcmp(fit_per(&snapshot->plan->doses[choice->parts[0].dose], word), "beam") == 0;
    return is_of_beams ? "" : field->per;
}

void dose_describe(struct annotations *annotations, const struct snapshot *snapshot)
{
    struct dose_scale scale;
    if (!dose_is_described(snapshot))
        return;
    if (!dose_scale_of(snapshot, &scale)) {
        char sentence[sizeof scale.why.text + 20];
        (void)snprintf(sentence, sizeof sentence, "Dose not drawn: %s", scale.why.text);
        annotation_add_sentence(annotations, ANNOTATION_DOSE, sentence);
        dose_scale_finish(&scale);
        return;
    }
    const char *per = per_of(snapshot, scale.field), *unit = scale.field->unit;
    add_parts(annotations, snapshot);
    (void)snprintf(add_text(annotations, ANNOTATION_DOSE), ANNOTATION_TEXT_SIZE, "%s%s%s%s%s",
                   quantity_words(snapshot->scene.dose.quantity), unit[0] ? " in " : ", unit not known", unit,
                   per[0] == 0                    ? ""
                   : strncmp(per, "per ", 4) == 0 ? " "
                                                  : " per ",
                   per);
    add_reference(annotations, &scale);
    add_weights(annotations, snapshot);
    add_doubts(annotations, scale.field->missing);
    const bool is_compared = add_comparison(annotations, snapshot);
    const enum wash_kind wash = wash_kind(&snapshot->scene.dose, is_compared);
    add_scale(annotations, snapshot, &scale, wash);
    add_levels(annotations, snapshot, &scale, is_compared, wash == WASH_LEVELS);
    add_coverage(annotations, snapshot, &scale);
    dose_scale_finish(&scale);
}

bool dose_label(struct annotations *annotations, const struct snapshot *snapshot, int width_px, struct error *err)
{
    struct isoline_scene lines;
    struct isoline_labels labels = { .n = 0 };
    double scale = (double)snapshot->view.size_px[0] / width_px;
    if (!snapshot_is_pane(snapshot) || !isoline_scene_init(&lines, snapshot))
        return true;
    /* upright words in the font of the picture */
    bool is_good = isoline_labels_place(&labels, snapshot, &lines, annotate_text_px(width_px) * scale,
                                        ISOLINE_LABELS_UPRIGHT, err);
    struct annotation_label *grown =
        is_good ? realloc(annotations->labels, (annotations->n_labels + labels.n + 1) * sizeof *grown) : NULL;
    if (is_good && !grown)
        is_good = error_set(err, ERROR_MEMORY, "no memory for the labels of isodose lines");
    annotations->labels = grown ? grown : annotations->labels;
    for (size_t i = 0; is_good && i < labels.n; i++) {
        const struct isoline_label *label = &labels.labels[i];
        const struct scene_dose_level *level = &snapshot->scene.dose.levels[label->level].value;
        struct annotation_label *added = &annotations->labels[annotations->n_labels++];
        *added = (struct annotation_label){ .is_centred = true,
                                            .at = { label->place.x_px / snapshot->view.size_px[0],
                                                    label->place.y_px / snapshot->view.size_px[1] } };
        isoline_text(added->text, level, lines.doses[0].field->unit);
    }
    isoline_scene_finish(&lines);
    return is_good;
}

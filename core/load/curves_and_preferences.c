/* Adds reference curves, and the preferences of SERA's programs, to a plan. */
#include "core/load/curves_and_preferences.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/formats/sera/sera_rsc.h"
#include "core/formats/sera/sera_table.h"
#include "core/formats/text.h"
#include "core/formats/zlib_stream.h"
#include "core/load/part_names.h"
#include "core/load/reader_table.h"

static bool read_curve(const struct folder *folder, const char *path, struct dose_curve *curve, struct report *report,
                       struct error *err)
{
    struct bytes file, text;
    bool is_packed;
    if (!folder_read(folder, path, SERA_TABLE_MAX_BYTES, UINT64_MAX, &file, err))
        return false;
    bool is_read = sera_unpack(&file, path, SERA_TABLE_MAX_BYTES, &is_packed, &text, err);
    if (is_read) {
        const struct bytes *from = is_packed ? &text : &file;
        is_read = sera_table_parse(from->data, from->size, path, curve, report, err);
    }
    bytes_free(&text);
    bytes_free(&file);
    return is_read;
}

static void make_id(const struct plan *plan, const char *given, const char *stem, char id[64])
{
    struct region_set taken = { .regions = mem_new((plan->n_curves + 1) * sizeof *taken.regions),
                                .n_regions = plan->n_curves };
    for (size_t i = 0; i < plan->n_curves; i++)
        memcpy(taken.regions[i].id, plan->curves[i].id, sizeof plan->curves[i].id);
    region_make_id(&taken, given[0] ? given : stem, id);
    free(taken.regions);
}

void plan_add_curves(struct plan *plan, const struct folder *folder, const struct plan_file *file)
{
    for (size_t i = 0; i < file->n_curves; i++) {
        const struct plan_file_curve *entry = &file->curves[i];
        struct dose_curve curve;
        struct error err = { 0 };
        char stem[128], id[64];
        if (!read_curve(folder, entry->path, &curve, &plan->report, &err)) {
            report_add(&plan->report, REPORT_WARNING, "curve.unread", entry->path,
                       "%s. The plan is shown without this curve.", err.text);
            continue;
        }
        const char *base = part_base_name(entry->path);
        snprintf(stem, sizeof stem, "%.*s", part_stem_length(base), base);
        make_id(plan, entry->id, stem, id);
        memcpy(curve.id, id, sizeof curve.id);
        text_clean(entry->name[0] ? entry->name : stem[0] ? stem : id, curve.name, sizeof curve.name);
        snprintf(curve.per, sizeof curve.per, "%s", entry->per[0] ? entry->per : "unit of the source");
        if (!entry->per[0])
            report_add(
                &plan->report, REPORT_NOTE, "dose.no-per", entry->path,
                "The curve \"%s\" is for one unit of the source; neither the plan nor the file says what that unit is, for instance "
                "250 kW-min.",
                curve.id);
        plan->curves[plan->n_curves++] = curve;
    }
}

static size_t fill_regions(struct plan *plan, const struct rsc *rsc, size_t *n_tissues)
{
    const struct rsc_body *other = rsc_find(rsc, "Default");
    size_t n_colors = 0;
    *n_tissues = 0;
    for (size_t r = 0; r < plan->regions.n_regions; r++) {
        struct region *region = &plan->regions.regions[r];
        const struct rsc_body *body = rsc_find(rsc, region->name);
        if (!body)
            body = other;
        if (!body)
            continue;
        if (body->has_color && !region->has_file_color) {
            memcpy(region->rgb, body->rgb, sizeof region->rgb);
            region->has_file_color = true;
            region->file_opacity = body->opacity;
            n_colors++;
        }
        const struct {
            double *to, from;
        } tissue[] = { { &region->boron_ratio, body->boron_ratio },
                       { &region->cbe_boron, body->cbe_boron },
                       { &region->rbe_nitrogen, body->rbe_nitrogen },
                       { &region->rbe_fast, body->rbe_fast },
                       { &region->rbe_gamma, body->rbe_gamma } };
        bool is_any = false;
        for (size_t t = 0; t < sizeof tissue / sizeof tissue[0]; t++)
            if (isnan(*tissue[t].to) && !isnan(tissue[t].from)) {
                *tissue[t].to = tissue[t].from;
                is_any = true;
            }
        *n_tissues += is_any;
    }
    return n_colors;
}

static void apply(struct plan *plan, const struct rsc *rsc, const char *path)
{
    size_t n_tissues, n_colors = fill_regions(plan, rsc, &n_tissues);
    struct plan_preferences *kept = &plan->preferences;
    if (n_colors > 0)
        report_add(&plan->report, REPORT_NOTE, "preferences.colors", path,
                   "%zu regions without a colour of their own took colour and opacity from these preferences.",
                   n_colors);
    if (n_tissues > 0)
        report_add(
            &plan->report, REPORT_NOTE, "preferences.tissues", path,
            "%zu regions took tissue data (boron ratio, weights) that their own file does not give from this table, by their names.",
            n_tissues);
    if (rsc->n_levels > 0 && kept->n_levels > 0)
        report_add(&plan->report, REPORT_NOTE, "preferences.levels", path,
                   "Contour levels are there already, from a file before it; its own "
                   "were not taken.");
    else if (rsc->n_levels > 0)
        for (; kept->n_levels < rsc->n_levels; kept->n_levels++) {
            const struct rsc_level *level = &rsc->levels[kept->n_levels];
            kept->levels[kept->n_levels] =
                (struct plan_level){ level->percent, { level->rgb[0], level->rgb[1], level->rgb[2] } };
        }
    if (rsc->n_colors > 0 && kept->n_colors > 0) {
        report_add(&plan->report, REPORT_NOTE, "preferences.map", path,
                   "A colour map is there already, from a file before it; this one was "
                   "not taken.");
    } else if (rsc->n_colors > 0) {
        kept->n_colors = rsc->n_colors;
        memcpy(kept->colors, rsc->colors, sizeof kept->colors);
    }
}

void plan_add_preferences(struct plan *plan, const struct folder *folder, const struct plan_file *file)
{
    _Static_assert((int)RSC_MAX_LEVELS <= (int)PLAN_MAX_LEVELS && (int)RSC_MAX_COLORS == (int)PLAN_MAX_COLORS,
                   "all of it has room");
    struct rsc *rsc = mem_new(sizeof *rsc);
    for (size_t i = 0; i < file->n_preferences; i++) {
        const char *path = file->preferences[i];
        struct bytes text;
        struct error err = { 0 };
        bool is_read = folder_read(folder, path, RSC_MAX_BYTES, UINT64_MAX, &text, &err);
        if (is_read) {
            is_read = rsc_parse(text.data, text.size, path, rsc, &plan->report, &err);
            bytes_free(&text);
        }
        if (is_read)
            apply(plan, rsc, path);
        else
            report_add(&plan->report, REPORT_WARNING, "preferences.unread", path,
                       "%s. The plan is shown without these preferences.", err.text);
    }
    free(rsc);
}

/* Settles what the files of a folder without plan.json are, by their values. */
#include "core/load/settle_parts.h"

#include <stdio.h>

#include "core/load/part_names.h"
#include "core/load/reader_table.h"

static void make_image(struct loading *loading, struct part_reading *reading, const char *why)
{
    struct plan_file *file = loading->file;
    struct error err = { 0 };
    if (file->n_images >= PLAN_MAX_IMAGES) {
        error_set(&err, ERROR_LIMIT, "%s, and there are %d images already", why, PLAN_MAX_IMAGES);
        loading_leave_out(loading, "part.unreadable", reading->path, &err);
        reading->is_failed = true;
        return;
    }
    struct plan_file_image *image = &file->images[file->n_images];
    snprintf(image->path, sizeof image->path, "%s", reading->path);
    reading->path = image->path;
    reading->kind = PART_KIND_IMAGE;
    reading->index = file->n_images++;
    report_add(&loading->plan->report, REPORT_WARNING, "image.by-content", image->path, "%s: it is shown as an image.",
               why);
}

static void settle_regions(struct loading *loading, struct part_reading *reading)
{
    char why[300];
    if (!reading->is_no_labels)
        return;
    if (reading->content.is_whole)
        snprintf(why, sizeof why,
                 "By its name a label map, but it holds %zu different values, and only %.0f %% of neighbours are equal",
                 reading->content.n_values, 100 * reading->content.alike);
    else
        snprintf(why, sizeof why,
                 "By its name a label map, but its values from %g to %g are not whole numbers from 0 on",
                 reading->volume->low, reading->volume->high);
    make_image(loading, reading, why);
}

static void settle_dose(struct loading *loading, struct part_reading *reading)
{
    const struct volume *volume = reading->volume;
    char why[200];
    if (!grid_content_may_be_dose(volume)) {
        snprintf(why, sizeof why, "By its name a dose, but its values go from %g to %g", volume->low, volume->high);
        make_image(loading, reading, why);
    } else if (volume->low == 0 && volume->high == 0) {
        bool is_alone = loading->file->doses[reading->index].n_components == 1;
        report_add(&loading->plan->report, REPORT_WARNING, "dose.all-zero", reading->path,
                   is_alone ? "The dose is 0 everywhere and is not listed."
                            : "This component of the dose is 0 everywhere.");
        reading->is_failed = is_alone;
    }
}

void plan_settle_parts(struct loading *loading)
{
    if (!loading->parts.is_recognised)
        return;
    for (size_t i = 0; i < loading->n_readings; i++) {
        struct part_reading *reading = &loading->readings[i];
        if (reading->is_failed || !reading->volume || !reading->reader->grid)
            continue;
        if (reading->kind == PART_KIND_REGION)
            settle_regions(loading, reading);
        else if (reading->kind == PART_KIND_DOSE)
            settle_dose(loading, reading);
    }
}

int plan_image_rank(const struct loading *loading, const struct part_reading *reading)
{
    if (!loading->parts.is_recognised || reading->reader == &part_dicom)
        return 0;
    if (reading->is_label_like)
        return PLAN_IMAGE_RANKS - 1;
    return part_name_has_whole_word(part_base_name(reading->path), "ct") ? 1 : 2;
}

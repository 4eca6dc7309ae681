/* Adds recognised files to the parts of a plan. */
#include "core/load/recognition.h"

#include <stdio.h>

#include "core/plan/plan.h"

/* The very bytes, so that the file opens, in whatever encoding its name is. */
static void set_path(char *out, size_t size, const char *name)
{
    snprintf(out, size, "%s", name);
}

void recognition_ignore(struct recognition *all, const char *name, const char *why)
{
    report_add(all->report, REPORT_WARNING, "plan.ignored-file", name, "%s", why);
}

void recognition_add_image(struct recognition *all, const char *name, const char *header)
{
    struct plan_file *file = all->file;
    if (file->n_images >= PLAN_MAX_IMAGES) {
        report_add(all->report, REPORT_WARNING, "plan.ignored-file", name,
                   "More than %d images; this one was not read.", PLAN_MAX_IMAGES);
        return;
    }
    struct plan_file_image *image = &file->images[file->n_images++];
    set_path(image->path, sizeof image->path, name);
    set_path(image->header, sizeof image->header, header);
}

void recognition_add_regions(struct recognition *all, const char *name)
{
    struct plan_file *file = all->file;
    if (file->n_regions >= PLAN_FILE_MAX_PARTS) {
        report_add(all->report, REPORT_WARNING, "plan.ignored-file", name,
                   "More than %d files of regions; this one was not read.", PLAN_FILE_MAX_PARTS);
        return;
    }
    struct plan_file_region *region = &file->regions[file->n_regions++];
    set_path(region->path, sizeof region->path, name);
}

void recognition_add_dose(struct recognition *all, const char *name)
{
    struct plan_file *file = all->file;
    if (file->n_doses >= PLAN_MAX_DOSES) {
        report_add(all->report, REPORT_WARNING, "plan.ignored-file", name, "More than %d doses; this one was not read.",
                   PLAN_MAX_DOSES);
        return;
    }
    struct plan_file_dose *dose = &file->doses[file->n_doses++];
    set_path(dose->components[0].path, FOLDER_NAME_SIZE, name);
    dose->components[0].quantity = DOSE_TOTAL;
    dose->n_components = 1;
}

void recognition_add_tracks(struct recognition *all, char *name)
{
    struct plan_file *file = all->file;
    if (file->n_tracks < PLAN_FILE_MAX_TRACKS)
        set_path(file->tracks[file->n_tracks++].path, FOLDER_NAME_SIZE, name);
    else
        recognition_ignore(all, name, "More files of tracks than are read.");
}

void recognition_add_curve(struct recognition *all, char *name)
{
    struct plan_file *file = all->file;
    if (file->n_curves < PLAN_MAX_CURVES)
        set_path(file->curves[file->n_curves++].path, FOLDER_NAME_SIZE, name);
    else
        recognition_ignore(all, name, "More curves than are read.");
}

void recognition_add_preferences(struct recognition *all, char *name)
{
    struct plan_file *file = all->file;
    if (file->n_preferences < PLAN_FILE_MAX_PREFERENCES)
        set_path(file->preferences[file->n_preferences++], FOLDER_NAME_SIZE, name);
    else
        recognition_ignore(all, name, "More files of preferences than are read.");
}

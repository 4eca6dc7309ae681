#pragma once
/* The parts of a folder without plan.json, as its files are looked at one after the other. What is beyond a limit is
 * reported and left out. */
#include "core/formats/folder.h"
#include "core/formats/plan_file.h"
#include "core/report/report.h"

struct recognition {
    const struct folder *folder;
    struct plan_file *file;
    struct report *report;
    char **dicom; /* [n_dicom] names of files that may be DICOM; borrowed from the folder's tree */
    size_t n_dicom;
};

/* header: of an image whose header is another file; else "". */
void recognition_add_image(struct recognition *all, const char *name, const char *header);
void recognition_add_regions(struct recognition *all, const char *name);
void recognition_add_dose(struct recognition *all, const char *name);
void recognition_add_tracks(struct recognition *all, char *name);
void recognition_add_curve(struct recognition *all, char *name);
void recognition_add_preferences(struct recognition *all, char *name);
/* Reports a file that is not used. */
void recognition_ignore(struct recognition *all, const char *name, const char *why);

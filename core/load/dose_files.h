#pragma once
/* The dose files of a folder without plan.json: joins the files of a BNCT dose's components, and their statistical
 * errors, by the words in their names. */
#include "core/formats/dose_words.h"
#include "core/formats/plan_file.h"
#include "core/report/report.h"
#include "core/volume/volume.h"

/* A file that is a dose, or a component of one, by its name. */
struct dose_file {
    char path[FOLDER_NAME_SIZE];
    struct grid grid;
    struct dose_words words;
    bool is_taken;
};

struct dose_files {
    struct dose_file *files;
    size_t n;
};

/* True if the name is that of a dose or a component: "dose" is in it, or it ends with B10, N14, n, g or the like. A low
 * or high dose of an image ("lowdose_ct") is none. */
bool dose_files_is_name(const char *path, struct dose_words *words);
/* Adds a file; returns false when there are too many. */
bool dose_files_add(struct dose_files *files, const char *path, const struct grid *grid,
                    const struct dose_words *words);
/* Makes doses of the plan file from the files that belong together: names that are equal but for the words of the
 * component, in one folder and on one grid, boron or nitrogen among them. Files with "dose" in their name that belong
 * to no other become doses alone; is_taken stays false for the rest, and for doses beyond the limit, which are
 * reported. */
void dose_files_join(struct dose_files *files, struct plan_file *file, struct report *report);
void dose_files_finish(struct dose_files *files);

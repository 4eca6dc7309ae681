/* Finds the parts of a folder without plan.json by the names and headers of its files. */
#include "core/load/recognise.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/formats/text.h"
#include "core/load/dicom_parts.h"
#include "core/load/dicom_scan.h"
#include "core/load/dose_files.h"
#include "core/load/label_lists.h"
#include "core/load/part_names.h"
#include "core/load/reader_table.h"

/* Facts of the folder beside the parts found so far. */
struct looked {
    struct recognition all;
    struct name_lists *lists;
    struct dose_files doses;
    struct error reason; /* why the first file that looked like a part was not used */
};

/* True if nnU-Net's images of the same case lie beside a file: case_0000.nii.gz beside case.nii.gz, its prediction. */
static bool has_channels_beside(const struct folder *folder, const char *name)
{
    char channel[FOLDER_NAME_SIZE];
    const char *base = part_base_name(name);
    int stem = (int)(base - name) + part_stem_length(base);
    int n = snprintf(channel, sizeof channel, "%.*s_0000%s", stem, name, name + stem);
    return n > 0 && n < (int)sizeof channel && folder_look(folder, channel, NULL) == FOLDER_FILE;
}

/* True for a grid that names its own segments, or whose name hints at labels; its values decide when they are read. */
static bool is_label_map(const struct folder *folder, const char *name, const struct grid_facts *facts)
{
    static const char *const words[] = { "label", "seg", "univel", "mask" };
    return facts->has_segments || part_name_has_word(name, words, sizeof words / sizeof words[0]) ||
           has_channels_beside(folder, name);
}

/* Reports a grid whose header cannot be read; it is left out. The first reason is kept: it becomes the error when the
 * folder holds nothing else. */
static bool has_good_header(struct looked *looked, const char *name, const struct grid_reader *grid,
                            struct grid_facts *facts)
{
    struct error err = { 0 };
    if (grid->peek(looked->all.folder, name, facts, &err))
        return true;
    report_add(looked->all.report, REPORT_ERROR, "plan.ignored-file", name, "Left out: %s", err.text);
    if (!looked->reason.text[0])
        looked->reason = err;
    return false;
}

static void add_grid(struct looked *looked, const char *name, const struct grid_reader *grid)
{
    struct recognition *all = &looked->all;
    struct grid_facts facts;
    if ((grid->is_passed_over && grid->is_passed_over(all->folder, name)) ||
        !has_good_header(looked, name, grid, &facts))
        return;
    struct dose_words words;
    if (name_lists_has_map(looked->lists, name) || is_label_map(all->folder, name, &facts))
        recognition_add_regions(all, name);
    else if (!dose_files_is_name(name, &words) || !dose_files_add(&looked->doses, name, &facts.grid, &words))
        recognition_add_image(all, name, "");
}

/* Joins the files that are doses by their names; those that are none after all become images. */
static void add_doses(struct looked *looked)
{
    dose_files_join(&looked->doses, looked->all.file, looked->all.report);
    for (size_t i = 0; i < looked->doses.n; i++)
        if (!looked->doses.files[i].is_taken)
            recognition_add_image(&looked->all, looked->doses.files[i].path, "");
    dose_files_finish(&looked->doses);
}

static void recognise_file(struct looked *looked, char *name)
{
    struct plan_file *file = looked->all.file;
    const struct part_reader *reader = part_reader_of(looked->all.folder, name);
    if (reader->grid)
        add_grid(looked, name, reader->grid);
    else if (reader->recognise)
        reader->recognise(&looked->all, name);
    else if (text_has_ending(name, ".info") && !file->hierarchy[0])
        snprintf(file->hierarchy, sizeof file->hierarchy, "%s", name);
}

/* The first line, from this index on, about a DICOM file that could not be read. */
static const struct report_line *find_unreadable(const struct report *report, size_t from)
{
    for (size_t i = from; report && i < report->n_lines; i++)
        if (strcmp(report->lines[i].code, "dicom.unreadable") == 0 && report->lines[i].where[0])
            return &report->lines[i];
    return NULL;
}

/* Sets the error that says why nothing was recognised. unreadable: the line about a damaged DICOM file; NULL: none. */
static void explain_nothing(const struct folder *folder, const struct folder_tree *tree,
                            const struct dicom_index *dicom, const struct report_line *unreadable, struct error *err)
{
    static const char *const archives[] = { ".tar", ".tar.gz", ".tgz", ".tar.xz", ".zip" };
    char **names = NULL, inner[FOLDER_NAME_SIZE];
    size_t n_names = 0;
    for (size_t i = 0; dicom && i < dicom->n_objects; i++)
        if (dicom->objects[i].reason[0]) {
            error_set(err, ERROR_UNSUPPORTED, "%zu DICOM files, none of which can be shown; %s: %s", dicom->n_objects,
                      dicom->objects[i].path, dicom->objects[i].reason);
            return;
        }
    for (size_t i = 0; i < tree->n_files; i++)
        for (size_t a = 0; a < sizeof archives / sizeof archives[0]; a++)
            if (text_has_ending(tree->files[i].name, archives[a])) {
                error_set(err, ERROR_UNSUPPORTED,
                          "%s is an archive: unpack it first; nothing else in the folder is a plan",
                          tree->files[i].name);
                return;
            }
    if (unreadable) {
        error_set(err, ERROR_NOT_FOUND, "no plan.json, and nothing to show in the folder; %s: %s", unreadable->where,
                  unreadable->sentence);
        return;
    }
    error_set(err, ERROR_NOT_FOUND,
              "no plan.json, and no file in the folder is an image, regions or a dose that this version reads");
    if (!folder_list(folder, &names, &n_names, NULL))
        return;
    for (size_t i = 0; i < n_names; i++) {
        int n = snprintf(inner, sizeof inner, "%s/plan.json", names[i]);
        if (n > 0 && n < (int)sizeof inner && folder_look(folder, inner, NULL) == FOLDER_FILE) {
            error_set(err, ERROR_NOT_FOUND, "no plan itself, but the folder %s in it is one", names[i]);
            break;
        }
    }
    folder_free_names(names, n_names);
}

/* Recognises all files of the tree: by name one after the other, then those that may be DICOM together. */
static bool recognise_tree(const struct folder *folder, const struct folder_tree *tree,
                           const struct dicom_progress *progress, struct plan_parts *parts, struct error *reason,
                           struct report *report, struct error *err)
{
    const atomic_bool *cancel = progress ? progress->cancel : NULL;
    struct looked looked = { .all = { .folder = folder,
                                      .file = parts->file,
                                      .report = report,
                                      .dicom = mem_new((tree->n_files + 1) * sizeof(char *)) },
                             .lists = name_lists_find(folder, tree, cancel, report) };
    for (size_t i = 0; i < tree->n_files && !(cancel && atomic_load(cancel)); i++)
        recognise_file(&looked, tree->files[i].name);
    add_doses(&looked);
    name_lists_assign(looked.lists, folder, parts->file, report);
    name_lists_destroy(looked.lists);
    bool is_scanned = plan_dicom_recognise(folder, looked.all.dicom, looked.all.n_dicom, parts, progress, report, err);
    free(looked.all.dicom);
    *reason = looked.reason;
    return is_scanned;
}

bool plan_recognise(const struct folder *folder, const struct dicom_progress *progress, struct plan_parts *parts,
                    struct report *report, struct error *err)
{
    struct folder_tree tree;
    struct error reason = { 0 };
    if (!folder_walk(folder, "", part_is_plan_folder, &tree, err)) {
        folder_tree_finish(&tree);
        return false;
    }
    struct plan_file *file = parts->file = mem_new(sizeof *file);
    parts->is_recognised = true;
    file->regions = mem_new(PLAN_FILE_MAX_PARTS * sizeof *file->regions);
    plan_folder_name(folder->path, file->name, sizeof file->name);
    size_t n_before = report ? report->n_lines : 0;
    if (tree.is_cut)
        report_add(report, REPORT_WARNING, "plan.too-many-files", "",
                   "Of the folder the first %d files down to %d folders deep were looked "
                   "at; there are more.",
                   FOLDER_MAX_FILES, FOLDER_MAX_DEPTH);
    bool is_known = recognise_tree(folder, &tree, progress, parts, &reason, report, err);
    bool has_more = plan_dicom_object(parts->dicom, DICOM_KIND_DOSE, "", 0) ||
                    plan_dicom_object(parts->dicom, DICOM_KIND_PLAN, "", 0);
    if (is_known && file->n_images + file->n_regions + file->n_doses == 0 && !has_more) {
        explain_nothing(folder, &tree, parts->dicom, find_unreadable(report, n_before), err);
        if (reason.text[0] && err)
            *err = reason;
        is_known = false;
    } else if (is_known) {
        report_add(report, REPORT_NOTE, "plan.recognised", "",
                   "The folder has no plan.json; its parts were found by names and contents.");
    }
    folder_tree_finish(&tree);
    return is_known;
}

/* Finds the parts of a folder without plan.json by the names and headers of its files. */
#include "core/load/recognise.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/formats/gzip.h"
#include "core/formats/sera/sera_rst.h"
#include "core/formats/text.h"
#include "core/load/dicom_parts.h"
#include "core/load/dose_files.h"
#include "core/load/label_lists.h"
#include "core/load/nifti_parts.h"
#include "core/load/nrrd_parts.h"
#include "core/load/part_format.h"
#include "core/load/part_names.h"
#include "core/plan/plan.h"

/* The folder being recognised, and the parts found so far. */
struct recognition {
    const struct folder *folder;
    struct plan_file *file;
    struct report *report;
    char **dicom; /* [n_dicom] names of files that may be DICOM; borrowed from the tree */
    size_t n_dicom;
    struct name_lists *lists;
    struct dose_files doses;
    struct error reason; /* why the first file that looked like a part was not used */
};

/* Properties of a grid, from its header. */
struct grid_facts {
    struct grid grid;
    bool has_segments;
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

static bool is_rst(const struct folder *folder, const char *name)
{
    struct bytes head;
    uint8_t text[RST_HEAD_BYTES];
    struct rst_header header;
    if (!folder_read(folder, name, UINT64_MAX, sizeof text, &head, NULL))
        return false;
    size_t n = head.size;
    if (gzip_is(head.data, head.size))
        n = gzip_head(head.data, head.size, text, sizeof text);
    else
        memcpy(text, head.data, n);
    bytes_free(&head);
    return rst_parse_header(text, n, name, &header, NULL);
}

/* The very bytes, so that the file opens, in whatever encoding its name is. */
static void set_path(char *out, size_t size, const char *name)
{
    snprintf(out, size, "%s", name);
}

static void ignore_one(struct recognition *all, const char *name, const char *why)
{
    report_add(all->report, REPORT_WARNING, "plan.ignored-file", name, "%s", why);
}

static void add_image(struct recognition *all, const char *name, const char *header)
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

static struct plan_file_region *add_region(struct recognition *all, const char *name)
{
    struct plan_file *file = all->file;
    if (file->n_regions >= PLAN_FILE_MAX_PARTS) {
        report_add(all->report, REPORT_WARNING, "plan.ignored-file", name,
                   "More than %d files of regions; this one was not read.", PLAN_FILE_MAX_PARTS);
        return NULL;
    }
    struct plan_file_region *region = &file->regions[file->n_regions++];
    set_path(region->path, sizeof region->path, name);
    return region;
}

static void add_dose(struct recognition *all, const char *name)
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

/* Reports a grid whose header cannot be read; it is left out. The first reason is kept: it becomes the error when the
 * folder holds nothing else. */
static bool has_good_header(struct recognition *all, const char *name, enum part_format format,
                            struct grid_facts *facts)
{
    struct error err = { 0 };
    struct nifti_header nifti;
    struct nrrd_header nrrd = { 0 };
    bool is_good = false;
    if (format == PART_NRRD) {
        is_good = plan_nrrd_peek(all->folder, name, &nrrd, &err);
        *facts = (struct grid_facts){ nrrd.grid, nrrd.n_segments > 0 };
        nrrd_header_finish(&nrrd);
    } else {
        is_good = plan_nifti_peek(all->folder, name, &nifti, &err);
        *facts = (struct grid_facts){ .has_segments = false };
        if (is_good)
            facts->grid = nifti.grid;
    }
    if (is_good)
        return true;
    report_add(all->report, REPORT_ERROR, "plan.ignored-file", name, "Left out: %s", err.text);
    if (!all->reason.text[0])
        all->reason = err;
    return false;
}

/* True if this file of a NIfTI pair must be passed over: a pair is taken once, by its header, and by the unpacked
 * header where there are two. */
static bool is_second_of_pair(const struct folder *folder, const char *name)
{
    struct nifti_pair pair, other;
    if (!plan_nifti_is_pair(name) || !plan_nifti_find_pair(folder, name, &pair, NULL))
        return false;
    if (strcmp(pair.head, name) != 0)
        return true;
    return text_has_ending(name, ".gz") && plan_nifti_find_pair(folder, pair.voxels, &other, NULL) &&
           strcmp(other.head, name) != 0;
}

static void add_grid(struct recognition *all, const char *name, enum part_format format)
{
    struct grid_facts facts;
    if (is_second_of_pair(all->folder, name) || !has_good_header(all, name, format, &facts))
        return;
    struct dose_words words;
    if (name_lists_has_map(all->lists, name) || is_label_map(all->folder, name, &facts))
        (void)add_region(all, name);
    else if (!dose_files_is_name(name, &words) || !dose_files_add(&all->doses, name, &facts.grid, &words))
        add_image(all, name, "");
}

/* Joins the files that are doses by their names; those that are none after all become images. */
static void add_doses(struct recognition *all)
{
    dose_files_join(&all->doses, all->file, all->report);
    for (size_t i = 0; i < all->doses.n; i++)
        if (!all->doses.files[i].is_taken)
            add_image(all, all->doses.files[i].path, "");
    dose_files_finish(&all->doses);
}

static void add_qsh(struct recognition *all, const char *name)
{
    char data[FOLDER_NAME_SIZE];
    if (!text_has_ending(name, ".qhd"))
        return;
    if (part_find_data(all->folder, name, ".qim", data))
        add_image(all, data, name);
    else
        ignore_one(all, name, "There is no file of pixels beside it.");
}

static void recognise_file(struct recognition *all, char *name)
{
    struct plan_file *file = all->file;
    char data[FOLDER_NAME_SIZE];
    enum part_format format = part_format_of(all->folder, name);
    switch (format) {
    case PART_NIFTI:
    case PART_NRRD: add_grid(all, name, format); break;
    case PART_UVH:
        if (part_find_data(all->folder, name, ".uv", data))
            (void)add_region(all, name);
        else
            ignore_one(all, name, "There is no file of univels beside it.");
        break;
    case PART_QSH: add_qsh(all, name); break;
    case PART_PP:
    case PART_TRACK_CSV:
        if (file->n_tracks < PLAN_FILE_MAX_TRACKS)
            set_path(file->tracks[file->n_tracks++].path, FOLDER_NAME_SIZE, name);
        else
            ignore_one(all, name, "More files of tracks than are read.");
        break;
    case PART_SERA_RST:
        if (is_rst(all->folder, name))
            add_dose(all, name);
        else
            ignore_one(all, name, "Named like a dose of SERA, but its header is another one's.");
        break;
    case PART_SERA_DOSE:
        if (part_find_data(all->folder, name, ".cdf", data))
            add_dose(all, name);
        else
            ignore_one(all, name, "There is no table of points, .cdf.sz or .cdf, beside it.");
        break;
    case PART_SERA_CURVE:
        if (file->n_curves < PLAN_MAX_CURVES)
            set_path(file->curves[file->n_curves++].path, FOLDER_NAME_SIZE, name);
        else
            ignore_one(all, name, "More curves than are read.");
        break;
    case PART_SERA_PREFERENCES:
        if (file->n_preferences < PLAN_FILE_MAX_PREFERENCES)
            set_path(file->preferences[file->n_preferences++], FOLDER_NAME_SIZE, name);
        else
            ignore_one(all, name, "More files of preferences than are read.");
        break;
    case PART_DICOM: all->dicom[all->n_dicom++] = name; break;
    default:
        if (text_has_ending(name, ".info") && !file->hierarchy[0])
            set_path(file->hierarchy, sizeof file->hierarchy, name);
    }
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
    struct recognition all = { folder, parts->file,
                               report, mem_new((tree->n_files + 1) * sizeof(char *)),
                               0,      name_lists_find(folder, tree, progress ? progress->cancel : NULL, report),
                               { 0 },  { 0 } };
    for (size_t i = 0; i < tree->n_files && !(progress && progress->cancel && atomic_load(progress->cancel)); i++)
        recognise_file(&all, tree->files[i].name);
    add_doses(&all);
    name_lists_assign(all.lists, folder, parts->file, report);
    name_lists_destroy(all.lists);
    bool is_scanned = plan_dicom_recognise(folder, all.dicom, all.n_dicom, parts, progress, report, err);
    free(all.dicom);
    *reason = all.reason;
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

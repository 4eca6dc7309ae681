/* Gives every file of a plan's folder its line in the report. */
#include "core/load/file_notes.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/load/file_kind.h"
#include "core/load/part_names.h"
#include "core/load/reader_table.h"

/* A file whose use is known. */
struct known {
    const char *path; /* borrowed from the plan file, the DICOM index or the report, or owned */
    char *owned;      /* path, when it is this one's own copy */
    const char *as;   /* "an image"; NULL: the report has a line about it, or about a group that it is in */
    size_t n_others;  /* further files that the line is about: slices of the same series */
};

struct notes {
    struct loading *loading;
    struct known *known;
    size_t n_known, room;
    size_t n_read, n_not_read;
};

static bool add(struct notes *notes, const char *path, const char *as, size_t n_others, struct error *err)
{
    if (!path[0])
        return true;
    if (notes->n_known == notes->room) {
        size_t room = notes->room ? 2 * notes->room : 256;
        struct known *more = realloc(notes->known, room * sizeof *more);
        if (!more)
            return error_set(err, ERROR_MEMORY, "no memory for the names of %zu files", room);
        notes->known = more;
        notes->room = room;
    }
    notes->known[notes->n_known++] = (struct known){ .path = path, .as = as, .n_others = n_others };
    return true;
}

/* Like add, with a path that does not last. */
static bool add_copy(struct notes *notes, const char *path, const char *as, struct error *err)
{
    if (!path[0])
        return true;
    if (!add(notes, path, as, 0, err))
        return false;
    struct known *known = &notes->known[notes->n_known - 1];
    known->path = known->owned = mem_copy_text(path);
    return true;
}

static const char *words_of(const struct part_reading *reading)
{
    switch (reading->kind) {
    case PART_KIND_IMAGE: return "an image";
    case PART_KIND_REGION: return "regions";
    case PART_KIND_DOSE: return "a dose";
    case PART_KIND_DOSE_MASK: return "the mask of a dose";
    case PART_KIND_DOSE_ERROR: return "the statistical error of a dose";
    case PART_KIND_BEAMS: break;
    }
    return "beams";
}

/* The slices of a series have one line, at the first in the order of names. */
static bool add_stack(struct notes *notes, const struct dicom_stack *stack, struct error *err)
{
    const struct dicom_object *objects = notes->loading->parts.dicom->objects;
    size_t first = 0;
    for (size_t i = 1; i < stack->n_objects; i++)
        if (strcmp(objects[stack->objects[i]].path, objects[stack->objects[first]].path) < 0)
            first = i;
    for (size_t i = 0; i < stack->n_objects; i++)
        if (!add(notes, objects[stack->objects[i]].path, i == first ? "an image" : NULL,
                 i == first ? stack->n_objects - 1 : 0, err))
            return false;
    return true;
}

static bool add_reading(struct notes *notes, const struct part_reading *reading, struct error *err)
{
    struct loading *loading = notes->loading;
    char other[FOLDER_NAME_SIZE] = "";
    if (reading->is_failed)
        return add(notes, reading->path, NULL, 0, err);
    if (reading->kind == PART_KIND_IMAGE && reading->reader == &part_dicom)
        return add_stack(notes, &loading->parts.dicom->stacks[reading->stack], err);
    if (reading->reader->find_companion)
        reading->reader->find_companion(&loading->folder, reading->path, other);
    bool is_added =
        add(notes, reading->path, words_of(reading), 0, err) && add_copy(notes, other, words_of(reading), err);
    if (reading->kind == PART_KIND_IMAGE && reading->reader == &part_qsh)
        is_added = is_added && add(notes, loading->file->images[reading->index].header, "an image", 0, err);
    if (reading->reader == &part_sera_chd && part_find_data(&loading->folder, reading->path, ".cmf", other))
        is_added = is_added && add_copy(notes, other, "the mask of a dose", err);
    if (reading->kind == PART_KIND_REGION && reading->index < loading->file->n_regions)
        is_added = is_added && add(notes, loading->file->regions[reading->index].names, "names of labels", 0, err);
    return is_added;
}

/* Adds everything that was read, and the files that lines of the report are about. */
static bool add_known(struct notes *notes, struct error *err)
{
    const struct loading *loading = notes->loading;
    const struct plan_file *file = loading->file;
    const struct dicom_index *dicom = loading->parts.dicom;
    const struct report *report = &loading->plan->report;
    bool is_added = add(notes, "plan.json", "the description of the plan", 0, err) &&
                    add(notes, file->hierarchy, "the hierarchy of regions", 0, err);
    for (size_t i = 0; is_added && i < loading->n_readings; i++)
        is_added = add_reading(notes, &loading->readings[i], err);
    for (size_t i = 0; is_added && i < file->n_tracks; i++)
        is_added = add(notes, file->tracks[i].path, "tracks", 0, err);
    for (size_t i = 0; is_added && i < file->n_curves; i++)
        is_added = add(notes, file->curves[i].path, "a reference curve", 0, err);
    for (size_t i = 0; is_added && i < file->n_preferences; i++)
        is_added = add(notes, file->preferences[i], "preferences", 0, err);
    for (size_t i = 0; is_added && i < report->n_lines; i++)
        is_added = add(notes, report->lines[i].where, NULL, 0, err);
    for (size_t i = 0; is_added && dicom && i < dicom->n_objects; i++)
        is_added = add(notes, dicom->objects[i].path, NULL, 0, err);
    return is_added;
}

/* Orders by path; the entry that says most of a file comes first. */
static int compare_known(const void *a, const void *b)
{
    const struct known *one = a, *other = b;
    int order = strcmp(one->path, other->path);
    return order ? order : (one->as == NULL) - (other->as == NULL);
}

static void note_read(struct notes *notes, const struct known *known)
{
    struct report *report = &notes->loading->plan->report;
    if (notes->n_read++ >= FILE_NOTES_MAX)
        return;
    if (known->n_others > 0)
        report_add(report, REPORT_NOTE, "file.read", known->path, "Read as %s, with %zu more files of its series.",
                   known->as, known->n_others);
    else
        report_add(report, REPORT_NOTE, "file.read", known->path, "Read as %s.", known->as);
}

static void note_not_read(struct notes *notes, const char *path)
{
    struct loading *loading = notes->loading;
    if (notes->n_not_read++ >= FILE_NOTES_MAX)
        return;
    struct error unread = { 0 };
    const struct part_reader *reader = part_reader_ask(&loading->folder, path, &unread);
    bool is_known = reader != &part_unknown && reader != &part_absent;
    report_add(&loading->plan->report, REPORT_NOTE, "file.not-read", path, "Not read%s: %s.",
               loading->parts.is_recognised ? "" : ", as plan.json does not name it",
               unread.code == ERROR_IO ? unread.text
               : is_known              ? reader->word
                                       : file_kind_words(&loading->folder, path));
}

static void note_rest(struct notes *notes)
{
    struct report *report = &notes->loading->plan->report;
    if (notes->n_read > FILE_NOTES_MAX)
        report_add(report, REPORT_NOTE, "file.read", "", "%zu more files were read.", notes->n_read - FILE_NOTES_MAX);
    if (notes->n_not_read > FILE_NOTES_MAX)
        report_add(report, REPORT_NOTE, "file.not-read", "", "%zu more files were not read.",
                   notes->n_not_read - FILE_NOTES_MAX);
}

static void note_tree(struct notes *notes, const struct folder_tree *tree)
{
    size_t at = 0;
    for (size_t i = 0; i < tree->n_files; i++) { /* both are sorted */
        const char *path = tree->files[i].name;
        while (at < notes->n_known && strcmp(notes->known[at].path, path) < 0)
            at++;
        if (at >= notes->n_known || strcmp(notes->known[at].path, path) != 0)
            note_not_read(notes, path);
        else if (notes->known[at].as)
            note_read(notes, &notes->known[at]);
    }
    note_rest(notes);
    if (tree->n_passed > 0)
        report_add(
            &notes->loading->plan->report, REPORT_WARNING, "file.not-read", "",
            "%zu name%s of the folder %s not followed: links that lead out of it, to nothing or to a folder, what is "
            "no plain file, or names that are too long or hold control characters; the first is \"%s\".",
            tree->n_passed, tree->n_passed == 1 ? "" : "s", tree->n_passed == 1 ? "was" : "were", tree->passed);
}

bool plan_note_files(struct loading *loading, struct error *err)
{
    struct notes notes = { .loading = loading };
    struct folder_tree tree;
    if (!folder_walk(&loading->folder, "", part_is_plan_folder, &tree, err)) {
        folder_tree_finish(&tree);
        return false;
    }
    bool is_added = add_known(&notes, err);
    if (is_added) {
        qsort(notes.known, notes.n_known, sizeof *notes.known, compare_known);
        note_tree(&notes, &tree);
    }
    for (size_t i = 0; i < notes.n_known; i++)
        free(notes.known[i].owned);
    free(notes.known);
    folder_tree_finish(&tree);
    return is_added;
}

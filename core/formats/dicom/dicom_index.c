/* Scans files for DICOM on several threads; drops duplicates; reports what is unreadable or not used. */
#include "core/formats/dicom/dicom_index.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/formats/dicom/dicom_head.h"
#include "core/formats/dicom/dicom_patients.h"
#include "core/formats/dicom/dicom_same.h"
#include "core/formats/dicom/dicom_stacks.h"
#include "core/formats/text.h"

/* One file of the scan with its result. */
struct scanned_file {
    char *path; /* moves into object on success */
    enum dicom_head_result result;
    struct dicom_object object;
    char *why; /* error sentence: BROKEN, or FOREIGN with a name that ends in .dcm */
};

struct scan {
    const struct folder *folder;
    const struct dicom_progress *progress;
    struct scanned_file *files;
    size_t n_files;
    atomic_size_t next, n_done, n_kept;
    atomic_bool is_cancelled, lacks_memory;
    size_t n_reported; /* files reported to progress->step, by the calling thread alone */
};

static void scan_file(struct scan *scan, struct scanned_file *file, struct bytes *scratch)
{
    struct error err = { 0 };
    size_t n_lacked = error_n_memory();
    file->result = dicom_head_read(scan->folder, file->path, &file->object, scratch, &err);
    if (error_n_memory() != n_lacked) /* says nothing of the file */
        atomic_store(&scan->lacks_memory, true);
    bool is_misnamed = file->result == DICOM_HEAD_FOREIGN && text_has_ending(file->path, ".dcm");
    if (file->result == DICOM_HEAD_BROKEN)
        dicom_object_finish(&file->object);
    if (file->result == DICOM_HEAD_BROKEN || is_misnamed) {
        size_t n = strlen(file->path); /* drop the file name in front: the report line names the file itself */
        file->why = mem_copy_text(
            strncmp(err.text, file->path, n) == 0 && strncmp(err.text + n, ": ", 2) == 0 ? err.text + n + 2 : err.text);
    }
    if (file->result == DICOM_HEAD_READ && atomic_fetch_add(&scan->n_kept, 1) >= DICOM_MAX_OBJECTS) {
        dicom_object_finish(&file->object);
        file->why = NULL;
        file->result = DICOM_HEAD_BROKEN;
    }
}

/* Reports every 32nd file, and the last one, that is done since the last call. On the calling thread alone. */
static void report_progress(struct scan *scan)
{
    enum { EVERY = 32 };
    size_t n_done = atomic_load(&scan->n_done);
    while (scan->n_reported + EVERY <= n_done || (n_done == scan->n_files && scan->n_reported < n_done)) {
        scan->n_reported = scan->n_reported + EVERY < n_done ? scan->n_reported + EVERY : n_done;
        if (scan->progress->step)
            scan->progress->step(scan->progress->context, scan->n_reported, scan->n_files);
    }
}

static void scan_part(void *context, int part, int n_parts)
{
    struct scan *scan = context;
    struct bytes scratch = { 0 };
    (void)n_parts;
    for (size_t i; (i = atomic_fetch_add(&scan->next, 1)) < scan->n_files;) {
        if (scan->progress->cancel && atomic_load(scan->progress->cancel))
            atomic_store(&scan->is_cancelled, true);
        if (atomic_load(&scan->is_cancelled))
            break;
        scan_file(scan, &scan->files[i], &scratch);
        atomic_fetch_add(&scan->n_done, 1);
        if (part == 0)
            report_progress(scan);
    }
    free(scratch.data);
}

static int compare_paths(const void *a, const void *b)
{
    return strcmp(((const struct scanned_file *)a)->path, ((const struct scanned_file *)b)->path);
}

/* Collects the files to look at: each name that is a file, and all files below each name that is a folder. */
static bool list_files(const struct folder *folder, char *const *names, size_t n_names, struct scan *scan,
                       struct report *report, struct error *err)
{
    static char whole[] = "";
    char *all[] = { whole };
    if (!names || n_names == 0) {
        names = all;
        n_names = 1;
    }
    size_t room = 0;
    for (size_t i = 0; i < n_names; i++) {
        struct folder_tree tree = { 0 };
        bool is_file = names[i][0] && folder_look(folder, names[i], NULL) == FOLDER_FILE;
        if (!is_file && !folder_walk(folder, names[i], NULL, &tree, err)) {
            folder_tree_finish(&tree);
            return false;
        }
        if (tree.is_cut)
            report_add(report, REPORT_WARNING, "dicom.too-many", names[i],
                       "Of this folder the first %d files down to %d folders deep were "
                       "looked at; there are more.",
                       FOLDER_MAX_FILES, FOLDER_MAX_DEPTH);
        size_t n = is_file ? 1 : tree.n_files;
        if (scan->n_files + n > room) {
            room = 2 * (scan->n_files + n);
            struct scanned_file *larger = realloc(scan->files, room * sizeof *larger);
            if (!larger) {
                folder_tree_finish(&tree);
                return error_set(err, ERROR_MEMORY, "no memory for the names of %zu files", room);
            }
            scan->files = larger;
        }
        for (size_t f = 0; f < n; f++) {
            struct scanned_file *file = &scan->files[scan->n_files++];
            *file = (struct scanned_file){ .path = mem_copy_text(is_file ? names[i] : tree.files[f].name) };
        }
        folder_tree_finish(&tree);
    }
    if (scan->n_files == 0)
        return true;
    qsort(scan->files, scan->n_files, sizeof *scan->files, compare_paths);
    size_t n = 1;
    for (size_t i = 1; i < scan->n_files; i++) { /* drop files that were named twice */
        if (strcmp(scan->files[i].path, scan->files[n - 1].path) == 0)
            free(scan->files[i].path);
        else
            scan->files[n++] = scan->files[i];
    }
    scan->n_files = n;
    return true;
}

enum { MOST_LINES = 20 };     /* per kind of problem; further ones are counted */
enum { MOST_OF_ONE_UID = 8 }; /* objects of one SOP Instance UID that another is compared with */

/* Gives the object the number of its patient. */
static void number_patient(struct dicom_index *index, struct dicom_object *object)
{
    object->patient = object->named ? dicom_patients_add(index, object->named) : -1;
    if (object->named && object->patient < 0) {
        object->kind = DICOM_KIND_OTHER;
        free(object->image);
        object->image = NULL;
        snprintf(object->reason, sizeof object->reason, "it is of one more patient than the first %d",
                 DICOM_MAX_PATIENTS);
    }
    free(object->named);
    object->named = NULL;
}

/* Moves the objects that were read into the index; reports the files that could not be read. */
static bool collect(struct scan *scan, struct dicom_index *index, struct report *report, struct error *err)
{
    size_t n = 0, n_broken = 0, n_misnamed = 0, n_too_many = 0;
    for (size_t i = 0; i < scan->n_files; i++)
        n += scan->files[i].result == DICOM_HEAD_READ;
    index->objects = mem_array(n, sizeof *index->objects, UINT64_MAX, err);
    if (!index->objects)
        return false;
    index->n_files = scan->n_files;
    for (size_t i = 0; i < scan->n_files; i++) {
        struct scanned_file *file = &scan->files[i];
        if (file->result == DICOM_HEAD_READ) {
            struct dicom_object *object = &index->objects[index->n_objects++];
            *object = file->object;
            object->path = file->path;
            file->object = (struct dicom_object){ 0 };
            file->path = NULL;
            number_patient(index, object);
        } else if (file->result == DICOM_HEAD_FOREIGN) {
            index->n_foreign++;
            if (file->why && n_misnamed++ < MOST_LINES)
                report_add(report, REPORT_WARNING, "dicom.unreadable", file->path, "Named like DICOM, and is none: %s",
                           file->why);
        } else if (file->result == DICOM_HEAD_BROKEN && !file->why) {
            n_too_many++;
        } else if (file->result == DICOM_HEAD_BROKEN && n_broken++ < MOST_LINES) {
            report_add(report, REPORT_ERROR, "dicom.unreadable", file->path, "%s", file->why);
        }
    }
    if (n_broken > MOST_LINES)
        report_add(report, REPORT_ERROR, "dicom.unreadable", "", "%zu more files cannot be read.",
                   n_broken - MOST_LINES);
    if (n_too_many > 0)
        report_add(report, REPORT_WARNING, "dicom.too-many", "", "%zu DICOM objects beyond the first %d were left out.",
                   n_too_many, DICOM_MAX_OBJECTS);
    return true;
}

static int compare_instances(const void *a, const void *b)
{
    const struct dicom_object *const *left = a, *const *right = b;
    int order = strcmp((*left)->sop_instance, (*right)->sop_instance);
    return order ? order : strcmp((*left)->path, (*right)->path);
}

/* Returns true if the second object may be a copy of the first. Images that share a SOP Instance UID by mistake differ
 * in instance number or position. */
static bool may_be_copy(const struct dicom_object *a, const struct dicom_object *b)
{
    if (!a->sop_instance[0] || strcmp(a->sop_instance, b->sop_instance) != 0 || a->kind != b->kind ||
        a->patient != b->patient)
        return false;
    return a->kind != DICOM_KIND_IMAGE ||
           (a->image->instance == b->image->instance &&
            memcmp(a->image->position_mm, b->image->position_mm, sizeof a->image->position_mm) == 0);
}

/* Objects that the report tells about by their number and one of them, the first by path. */
struct told {
    size_t n;
    const struct dicom_object *example, *other;
};

static void tell(struct told *told, const struct dicom_object *object, const struct dicom_object *other)
{
    if (!told->example || strcmp(object->path, told->example->path) < 0) {
        told->example = object;
        told->other = other;
    }
    told->n++;
}

static void drop(struct dicom_object *copy, const struct dicom_object *first)
{
    copy->kind = DICOM_KIND_OTHER;
    free(copy->image);
    copy->image = NULL;
    snprintf(copy->reason, sizeof copy->reason, "it is a copy of %.120s", first->path);
}

static void report_copies(const struct told *copies, const struct told *others, struct report *report)
{
    if (copies->n > 0)
        report_add(report, REPORT_WARNING, "dicom.duplicate", copies->example->path,
                   "%zu object%s more than once in the folder; this file: %s.", copies->n,
                   copies->n == 1 ? " is there" : "s are there", copies->example->reason);
    if (others->n > 0)
        report_add(report, REPORT_WARNING, "dicom.same-uid", others->example->path,
                   "%zu object%s the SOP Instance UID (0008,0018) of another, but not its contents; all are used. This "
                   "file has that of %.120s.",
                   others->n, others->n == 1 ? " has" : "s have", others->other->path);
}

/* The different objects of one SOP Instance UID. */
struct namesakes {
    const struct dicom_object *objects[MOST_OF_ONE_UID];
    size_t n;
};

/* Compares an object with those before it. A copy is dropped; any other is added to them. */
static bool compare_with(struct namesakes *before, const struct folder *folder, struct dicom_object *object,
                         struct told *copies, struct told *others, struct error *err)
{
    const struct dicom_object *different = NULL;
    for (size_t i = 0; i < before->n; i++) {
        bool is_same = false;
        if (!may_be_copy(before->objects[i], object))
            continue;
        if (!dicom_same_content(folder, before->objects[i], object, &is_same, err))
            return false;
        if (is_same) {
            drop(object, before->objects[i]);
            tell(copies, object, NULL);
            return true;
        }
        different = before->objects[i];
    }
    if (different)
        tell(others, object, different);
    if (before->n < MOST_OF_ONE_UID)
        before->objects[before->n++] = object;
    return true;
}

/* Drops objects whose contents are there already. Objects that only share their SOP Instance UID stay. */
static bool drop_copies(const struct folder *folder, struct dicom_index *index, struct report *report,
                        struct error *err)
{
    struct dicom_object **order = mem_array(index->n_objects, sizeof *order, UINT64_MAX, err);
    if (!order)
        return false;
    for (size_t i = 0; i < index->n_objects; i++)
        order[i] = &index->objects[i];
    qsort(order, index->n_objects, sizeof *order, compare_instances);
    struct told copies = { 0 }, others = { 0 };
    struct namesakes before = { .n = 0 };
    bool is_compared = true;
    for (size_t i = 0; is_compared && i < index->n_objects; i++) {
        if (before.n > 0 && strcmp(before.objects[0]->sop_instance, order[i]->sop_instance) != 0)
            before.n = 0;
        if (order[i]->kind != DICOM_KIND_OTHER)
            is_compared = compare_with(&before, folder, order[i], &copies, &others, err);
    }
    free(order);
    report_copies(&copies, &others, report);
    return is_compared;
}

/* Reports one line per reason: how many objects, and the path of the first. */
static void report_unused(const struct dicom_index *index, struct report *report)
{
    enum { MOST_REASONS = 32 };
    const struct dicom_object *first[MOST_REASONS];
    size_t count[MOST_REASONS], n_reasons = 0, n_more = 0;
    for (size_t i = 0; i < index->n_objects; i++) {
        const struct dicom_object *object = &index->objects[i];
        if (object->kind != DICOM_KIND_OTHER || strncmp(object->reason, "it is a copy", 12) == 0)
            continue;
        size_t r = 0;
        while (r < n_reasons && strcmp(first[r]->reason, object->reason) != 0)
            r++;
        if (r == MOST_REASONS) {
            n_more++;
            continue;
        }
        if (r == n_reasons) {
            first[n_reasons] = object;
            count[n_reasons++] = 0;
        }
        count[r]++;
    }
    for (size_t r = 0; r < n_reasons; r++) {
        const char *reason = first[r]->reason;
        bool is_damage =
            strncmp(reason, "it ", 3) != 0; /* damage of an image; reasons starting with "it " only say what it is */
        bool is_usual = strcmp(reason, "it is a localizer") == 0;
        const char *code = is_damage ? "dicom.unreadable" : "dicom.not-used";
        enum report_severity severity = is_damage ? REPORT_ERROR : is_usual ? REPORT_NOTE : REPORT_WARNING;
        if (count[r] == 1)
            report_add(report, severity, code, first[r]->path, "Not used: %s.", reason);
        else
            report_add(report, severity, code, first[r]->path, "%zu objects are not used; this one: %s.", count[r],
                       reason);
    }
    if (n_more > 0)
        report_add(report, REPORT_WARNING, "dicom.not-used", "", "%zu more objects are not used, for other reasons.",
                   n_more);
}

/* Reports one line per tag: images that are used although an optional element is malformed. */
static void report_bad_numbers(const struct dicom_index *index, struct report *report)
{
    enum { MOST_TAGS = 16 };
    const struct dicom_object *first[MOST_TAGS];
    size_t count[MOST_TAGS], n_tags = 0;
    for (size_t i = 0; i < index->n_objects; i++) {
        const struct dicom_object *object = &index->objects[i];
        if (!object->image || object->image->bad_tag == 0)
            continue;
        size_t t = 0;
        while (t < n_tags && first[t]->image->bad_tag != object->image->bad_tag)
            t++;
        if (t == MOST_TAGS)
            continue; /* cannot happen: fewer tags than MOST_TAGS are checked */
        if (t == n_tags) {
            first[n_tags] = object;
            count[n_tags++] = 0;
        }
        count[t]++;
    }
    for (size_t t = 0; t < n_tags; t++) {
        uint32_t tag = first[t]->image->bad_tag;
        report_add(report, REPORT_WARNING, "dicom.bad-number", first[t]->path,
                   "Element (%04X,%04X): expected numbers, found \"%s\"; it is not "
                   "used (in %zu pictures).",
                   tag >> 16, tag & 0xFFFF, first[t]->image->bad_found, count[t]);
    }
}

static void scan_finish(struct scan *scan)
{
    for (size_t i = 0; i < scan->n_files; i++) {
        free(scan->files[i].path);
        free(scan->files[i].why);
        dicom_object_finish(&scan->files[i].object);
    }
    free(scan->files);
}

struct dicom_index *dicom_index_scan(const struct folder *folder, char *const *names, size_t n_names,
                                     const struct dicom_progress *progress, struct report *report, struct error *err)
{
    static const struct dicom_progress quiet;
    struct scan scan = { .folder = folder, .progress = progress ? progress : &quiet };
    struct dicom_index *index = mem_new(sizeof *index);
    if (!list_files(folder, names, n_names, &scan, report, err))
        goto fail;
    int n_threads = scan.progress->n_threads > 0 ? scan.progress->n_threads : parallel_cores();
    n_threads = n_threads < 8 ? n_threads : 8;
    parallel_run((size_t)n_threads < scan.n_files ? n_threads : (int)scan.n_files, scan_part, &scan);
    report_progress(&scan);
    if (atomic_load(&scan.is_cancelled)) {
        error_set(err, ERROR_CANCELLED, "looking for DICOM was cancelled");
        goto fail;
    }
    if (atomic_load(&scan.lacks_memory)) {
        error_set(err, ERROR_MEMORY, "no memory to look at %zu files", scan.n_files);
        goto fail;
    }
    if (!collect(&scan, index, report, err) || !drop_copies(folder, index, report, err))
        goto fail;
    report_unused(index, report);
    report_bad_numbers(index, report);
    size_t n_lacked = error_n_memory();
    if (!dicom_stacks_find(index, report, err))
        goto fail;
    if (error_n_memory() != n_lacked) {
        error_set(err, ERROR_MEMORY, "no memory to put %zu DICOM objects in order", index->n_objects);
        goto fail;
    }
    scan_finish(&scan);
    return index;
fail:
    scan_finish(&scan);
    dicom_index_destroy(index);
    return NULL;
}

void dicom_index_destroy(struct dicom_index *index)
{
    if (!index)
        return;
    for (size_t i = 0; i < index->n_objects; i++)
        dicom_object_finish(&index->objects[i]);
    for (size_t i = 0; i < index->n_stacks; i++)
        free(index->stacks[i].objects);
    free(index->objects);
    free(index->stacks);
    free(index);
}

const struct dicom_object *dicom_index_find(const struct dicom_index *index, const char *sop_instance)
{
    for (size_t i = 0; sop_instance[0] && i < index->n_objects; i++)
        if (strcmp(index->objects[i].sop_instance, sop_instance) == 0)
            return &index->objects[i];
    return NULL;
}

static int compare_path(const void *path, const void *object)
{
    return strcmp(path, ((const struct dicom_object *)object)->path);
}

const struct dicom_object *dicom_index_at(const struct dicom_index *index, const char *path)
{
    return index->n_objects ? bsearch(path, index->objects, index->n_objects, sizeof *index->objects, compare_path)
                            : NULL;
}

/* Joins the dose files of a folder without plan.json by the words in their names. */
#include "core/load/dose_files.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/formats/text.h"
#include "core/load/part_names.h"
#include "core/load/reader_table.h"
#include "core/plan/plan.h"

enum { MOST_FILES = 256 };

/* True if the word is one of rest's. */
static bool has_word(const char *rest, const char *word)
{
    size_t n = strlen(word);
    for (const char *at = strstr(rest, word); at; at = strstr(at + 1, word))
        if ((at == rest || at[-1] == ' ') && (at[n] == 0 || at[n] == ' '))
            return true;
    return false;
}

/* True for "lowdose_ct", "high-dose-CT": the dose of making the picture, not one that was planned. */
static bool is_dose_of_image(const char *rest)
{
    static const char *const amounts[] = { "low",   "high",     "full",    "half",   "quarter",
                                           "ultra", "ultralow", "reduced", "normal", "standard" };
    static const char *const kinds[] = { "ct", "cbct", "ldct", "pet", "spect", "mr", "mri", "xray", "t1", "t2" };
    bool has_amount = false, has_kind = false;
    for (size_t i = 0; i < sizeof amounts / sizeof amounts[0]; i++)
        has_amount |= has_word(rest, amounts[i]);
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++)
        has_kind |= has_word(rest, kinds[i]);
    return has_amount && has_kind;
}

bool dose_files_is_name(const char *path, struct dose_words *words)
{
    char stem[FOLDER_NAME_SIZE];
    const char *base = part_base_name(path);
    snprintf(stem, sizeof stem, "%.*s", part_stem_length(base), base);
    dose_words_read_name(stem, words);
    if (words->says_dose)
        return !is_dose_of_image(words->rest);
    return words->has_quantity && words->quantity != DOSE_TOTAL;
}

bool dose_files_add(struct dose_files *files, const char *path, const struct grid *grid, const struct dose_words *words)
{
    if (files->n >= MOST_FILES)
        return false;
    if (!files->files)
        files->files = mem_new(MOST_FILES * sizeof *files->files);
    struct dose_file *file = &files->files[files->n++];
    snprintf(file->path, sizeof file->path, "%s", path);
    file->grid = *grid;
    file->words = *words;
    return true;
}

void dose_files_finish(struct dose_files *files)
{
    free(files->files);
    *files = (struct dose_files){ 0 };
}

/* Same folder, same other words. */
static bool names_agree(const struct dose_file *a, const struct dose_file *b)
{
    size_t folder = (size_t)(part_base_name(a->path) - a->path);
    return folder == (size_t)(part_base_name(b->path) - b->path) && strncmp(a->path, b->path, folder) == 0 &&
           strcmp(a->words.rest, b->words.rest) == 0;
}

static bool belong_together(const struct dose_file *a, const struct dose_file *b)
{
    return names_agree(a, b) && grid_is_same(&a->grid, &b->grid);
}

static bool is_of_bnct(const struct dose_file *file)
{
    return file->words.has_quantity && (file->words.quantity == DOSE_BORON || file->words.quantity == DOSE_NITROGEN);
}

static bool is_component(const struct dose_file *file)
{
    return !file->is_taken && file->words.has_quantity && !file->words.is_error && file->words.quantity != DOSE_TOTAL;
}

/* Collects the components that belong to the first, each quantity once. Returns how many. */
static size_t collect(const struct dose_files *files, size_t first, size_t members[DOSE_N_QUANTITIES], bool *is_bnct)
{
    bool has[DOSE_N_QUANTITIES] = { false };
    size_t n = 0;
    *is_bnct = false;
    for (size_t i = first; i < files->n; i++) {
        const struct dose_file *file = &files->files[i];
        if (!is_component(file) || has[file->words.quantity] || !belong_together(&files->files[first], file))
            continue;
        has[file->words.quantity] = true;
        members[n++] = i;
        *is_bnct |= is_of_bnct(file);
    }
    return n;
}

static struct plan_file_dose *new_dose(const struct dose_file *file, struct plan_file *plan, struct report *report)
{
    if (plan->n_doses >= PLAN_MAX_DOSES) {
        report_add(report, REPORT_WARNING, "plan.ignored-file", file->path,
                   "More than %d doses; this one was not read.", PLAN_MAX_DOSES);
        return NULL;
    }
    return &plan->doses[plan->n_doses++];
}

static void note_ppm(const struct dose_file *file, struct report *report)
{
    if (file->words.is_per_ppm || file->words.ppm == 1)
        return;
    if (file->words.ppm > 0)
        report_add(report, REPORT_WARNING, "dose.no-ppm", file->path,
                   "By its name the boron dose holds for %g ppm; it is shown as it is, and does not follow the "
                   "concentration that is set.",
                   file->words.ppm);
    else
        report_add(report, REPORT_WARNING, "dose.no-ppm", file->path,
                   "Nothing says for how much boron-10 the boron dose holds; it is shown as it is.");
}

/* The component that a file is of; a dose without further words is the total. */
static enum dose_quantity quantity_of(const struct dose_file *file)
{
    return file->words.has_quantity ? file->words.quantity : DOSE_TOTAL;
}

/* Finds the file with the statistical error of a component. */
static void add_error(struct dose_files *files, const struct dose_file *of, struct plan_file_component *component,
                      struct report *report)
{
    for (size_t i = 0; i < files->n; i++) {
        struct dose_file *file = &files->files[i];
        if (file->is_taken || !file->words.is_error || quantity_of(file) != of->words.quantity ||
            !belong_together(of, file))
            continue;
        file->is_taken = true;
        if (file->words.is_relative) {
            report_add(report, REPORT_WARNING, "plan.ignored-file", file->path,
                       "Left out: by its name a relative error; the error of a dose is read in the dose's unit.");
            continue;
        }
        if (!component->error[0])
            memcpy(component->error, file->path, sizeof component->error);
    }
}

static void add_component(struct dose_files *files, struct dose_file *file, struct plan_file_dose *dose,
                          struct report *report)
{
    struct plan_file_component *component = &dose->components[dose->n_components++];
    memcpy(component->path, file->path, sizeof component->path);
    component->quantity = file->words.quantity;
    if (component->quantity == DOSE_BORON) {
        component->is_per_ppm = file->words.is_per_ppm || file->words.ppm == 1;
        note_ppm(file, report);
    }
    file->is_taken = true;
    add_error(files, file, component, report);
}

static void join(struct dose_files *files, const size_t *members, size_t n, struct plan_file *plan,
                 struct report *report)
{
    struct dose_file *first = &files->files[members[0]];
    struct plan_file_dose *dose = new_dose(first, plan, report);
    char list[240] = "", what[160];
    size_t at = 0, n_errors = 0;
    if (!dose) {
        for (size_t i = 0; i < n; i++)
            files->files[members[i]].is_taken = true;
        return;
    }
    snprintf(dose->name, sizeof dose->name, "%.50s%sdose", first->words.rest, first->words.rest[0] ? " " : "");
    memcpy(dose->id, dose->name, sizeof dose->id);
    for (size_t i = 0; i < n; i++) {
        struct dose_file *file = &files->files[members[i]];
        add_component(files, file, dose, report);
        n_errors += dose->components[i].error[0] != 0;
        snprintf(what, sizeof what, "%s%s %.80s", i ? ", " : "", dose_quantity_word(file->words.quantity),
                 part_base_name(file->path));
        if (at + strlen(what) < sizeof list)
            at += (size_t)snprintf(list + at, sizeof list - at, "%s", what);
    }
    char errors[64] = "";
    if (n_errors > 0)
        snprintf(errors, sizeof errors, ", with %zu files of their statistical errors", n_errors);
    report_add(
        report, REPORT_NOTE, "dose.components", first->path,
        "\"%.40s\" is put together by the names of %zu files (%s)%s. A plan.json that names each as a dose keeps "
        "them apart.",
        dose->name, n, list, errors);
}

/* The boron or nitrogen file that a component would be joined with if both had one grid; NULL: none. */
static const struct dose_file *find_on_other_grid(const struct dose_files *files, const struct dose_file *file)
{
    for (size_t i = 0; i < files->n; i++) {
        const struct dose_file *other = &files->files[i];
        if (is_of_bnct(other) && !other->words.is_error && other->words.quantity != file->words.quantity &&
            names_agree(file, other) && !grid_is_same(&file->grid, &other->grid))
            return other;
    }
    return NULL;
}

/* A dose file that no other belongs to. Boron and nitrogen say what they are also alone; the rest does beside them. */
static void add_alone(struct dose_files *files, struct dose_file *file, struct plan_file *plan, struct report *report)
{
    struct plan_file_dose *dose = new_dose(file, plan, report);
    const struct dose_file *other = is_component(file) ? find_on_other_grid(files, file) : NULL;
    if (dose && other)
        report_add(
            report, REPORT_WARNING, "dose.words-not-joined", file->path,
            "By their names this and %.80s are %s and %s of one dose, but they lie on different grids: each is a "
            "dose of its own. If they are one, name them as \"components\" in a plan.json.",
            part_base_name(other->path), dose_quantity_word(file->words.quantity),
            dose_quantity_word(other->words.quantity));
    if (!is_of_bnct(file) && !other) {
        file->words.has_quantity = true;
        file->words.quantity = DOSE_TOTAL;
    }
    if (dose)
        add_component(files, file, dose, report);
    file->is_taken = true;
}

/* Reports two files whose words are of two components but that were not joined. */
static void report_not_joined(const struct dose_files *files, size_t first, const size_t *members, size_t n,
                              struct report *report)
{
    const struct dose_file *a = &files->files[first];
    if (n > 1 && a->words.says_dose)
        report_add(
            report, REPORT_WARNING, "dose.words-not-joined", a->path,
            "By their names this and %.80s are %s and %s of one dose, but nothing else says so: each is a dose of its "
            "own. If they are one, name them as \"components\" in a plan.json.",
            part_base_name(files->files[members[1]].path), dose_quantity_word(a->words.quantity),
            dose_quantity_word(files->files[members[1]].words.quantity));
}

void dose_files_join(struct dose_files *files, struct plan_file *file, struct report *report)
{
    for (size_t i = 0; i < files->n; i++) {
        size_t members[DOSE_N_QUANTITIES];
        bool is_bnct;
        if (!is_component(&files->files[i]))
            continue;
        size_t n = collect(files, i, members, &is_bnct);
        if (n > 1 && is_bnct)
            join(files, members, n, file, report);
        else
            report_not_joined(files, i, members, n, report);
    }
    for (size_t i = 0; i < files->n; i++)
        if (!files->files[i].is_taken && files->files[i].words.says_dose && !files->files[i].words.is_error)
            add_alone(files, &files->files[i], file, report);
}

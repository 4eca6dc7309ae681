/* Groups the images of a series into stacks: by size, spacing and orientation, and by what distinguishes images at the
 * same position (echo, time, ...). */
#include "core/formats/dicom/dicom_stacks.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/volume/volume.h"

bool dicom_axes(const double row[3], const double column[3], struct vec3 axes[3], double *error)
{
    struct vec3 r = vec3(row[0], row[1], row[2]), c = vec3(column[0], column[1], column[2]);
    double row_length = vec3_length(r), column_length = vec3_length(c);
    if (!(row_length > 0.5 && row_length < 2 && column_length > 0.5 && column_length < 2))
        return false;
    r = vec3_scale(r, 1 / row_length);
    c = vec3_scale(c, 1 / column_length);
    double cosine = vec3_dot(r, c);
    if (!(fabs(cosine) < 0.5))
        return false;
    *error = fmax(fabs(cosine), fmax(fabs(row_length - 1), fabs(column_length - 1)));
    axes[0] = r;
    axes[1] = vec3_normalize(vec3_sub(c, vec3_scale(r, cosine)));
    axes[2] = vec3_cross(axes[0], axes[1]);
    return true;
}

/* One image of a stack under construction. */
struct member {
    size_t object;
    const struct dicom_image *image;
    double along_mm; /* position along the slice normal */
};

struct group {
    struct member *members;
    size_t n, room;
};

/* Without memory the member is left out, and counted: dicom_index_scan then fails. */
static void group_add(struct group *group, struct member member)
{
    enum { FIRST_ROOM = 64 };
    if (group->room == 0) {
        group->members = mem_new(FIRST_ROOM * sizeof *group->members);
        group->room = FIRST_ROOM;
    } else if (group->n == group->room) {
        struct member *larger = realloc(group->members, 2 * group->room * sizeof *larger);
        if (!larger) {
            error_set(NULL, ERROR_MEMORY, "no memory for %zu pictures of a series", 2 * group->room);
            return;
        }
        group->members = larger;
        group->room *= 2;
    }
    group->members[group->n++] = member;
}

static bool are_close(const double *a, const double *b, size_t n, double tolerance)
{
    for (size_t i = 0; i < n; i++)
        if (!(fabs(a[i] - b[i]) <= tolerance))
            return false;
    return true;
}

/* Returns true if two images of one series fit on one grid. */
static bool fit_together(const struct dicom_image *a, const struct dicom_image *b)
{
    return a->has_place && b->has_place && a->pixels.rows == b->pixels.rows && a->pixels.columns == b->pixels.columns &&
           are_close(a->row, b->row, 3, 1e-3) && are_close(a->column, b->column, 3, 1e-3) &&
           are_close(a->spacing_mm, b->spacing_mm, 2, 1e-3 * fmin(a->spacing_mm[0], a->spacing_mm[1]));
}

static int by_place(const void *a, const void *b)
{
    const struct member *left = a, *right = b;
    if (left->along_mm != right->along_mm)
        return left->along_mm < right->along_mm ? -1 : 1;
    if (left->image->instance != right->image->instance)
        return left->image->instance < right->image->instance ? -1 : 1;
    return left->object < right->object ? -1 : 1;
}

/* Sorts by position, at equal positions by number. Returns how many images share the position of another. */
static size_t sort_by_place(struct group *group)
{
    if (group->n > 1)
        qsort(group->members, group->n, sizeof *group->members, by_place);
    size_t n_repeated = 0;
    for (size_t i = 1; i < group->n; i++)
        n_repeated += group->members[i].along_mm - group->members[i - 1].along_mm < DICOM_SAME_PLACE_MM;
    return n_repeated;
}

/* The elements that may distinguish images at the same position; their values go into the stack's name. */
enum trait {
    TRAIT_ECHO,
    TRAIT_ECHO_TIME,
    TRAIT_B_VALUE,
    TRAIT_TIME,
    TRAIT_ACQUISITION,
    TRAIT_TRIGGER,
    TRAIT_TYPE,
    N_TRAITS
};

static void trait_of(const struct dicom_image *image, enum trait trait, char out[80])
{
    out[0] = 0;
    switch (trait) {
    case TRAIT_ECHO:
        if (image->echo != INT64_MIN)
            snprintf(out, 80, "echo %lld", (long long)image->echo);
        break;
    case TRAIT_ECHO_TIME:
        if (isfinite(image->echo_ms))
            snprintf(out, 80, "echo time %.6g ms", image->echo_ms);
        break;
    case TRAIT_B_VALUE:
        if (isfinite(image->b_value))
            snprintf(out, 80, "b %.6g", image->b_value);
        break;
    case TRAIT_TIME:
        if (image->temporal != INT64_MIN)
            snprintf(out, 80, "time %lld", (long long)image->temporal);
        break;
    case TRAIT_ACQUISITION:
        if (image->acquisition != INT64_MIN)
            snprintf(out, 80, "acquisition %lld", (long long)image->acquisition);
        break;
    case TRAIT_TRIGGER:
        if (isfinite(image->trigger_ms))
            snprintf(out, 80, "trigger %.6g ms", image->trigger_ms);
        break;
    case TRAIT_TYPE: snprintf(out, 80, "%.70s", image->image_type); break;
    case N_TRAITS: break;
    }
}

enum { MOST_PARTS = 64 }; /* parts of one group */

struct parts {
    struct group groups[MOST_PARTS];
    char names[MOST_PARTS][80];
    size_t n;
};

static void parts_finish(struct parts *parts)
{
    for (size_t i = 0; i < parts->n; i++)
        free(parts->groups[i].members);
    parts->n = 0;
}

/* Splits by one trait: into several parts, in none of which two images share a position. */
static bool part_by_trait(const struct group *group, enum trait trait, struct parts *parts)
{
    for (size_t i = 0; i < group->n; i++) {
        char name[80];
        trait_of(group->members[i].image, trait, name);
        size_t p = 0;
        while (p < parts->n && strcmp(parts->names[p], name) != 0)
            p++;
        if (p == MOST_PARTS)
            return false;
        if (p == parts->n) {
            parts->groups[p] = (struct group){ 0 };
            snprintf(parts->names[parts->n++], sizeof parts->names[0], "%s", name);
        }
        group_add(&parts->groups[p], group->members[i]);
    }
    if (parts->n < 2)
        return false;
    for (size_t p = 0; p < parts->n; p++)
        if (sort_by_place(&parts->groups[p]) > 0)
            return false;
    return true;
}

/* Splits by sequence: if every position is used equally often, the first images of all positions make one part, the
 * second ones another. */
static bool part_by_order(const struct group *group, struct parts *parts)
{
    size_t times = 0;
    for (size_t i = 0, run = 0; i < group->n; i++) {
        run = i > 0 && group->members[i].along_mm - group->members[i - 1].along_mm < DICOM_SAME_PLACE_MM ? run + 1 : 0;
        bool is_last =
            i + 1 == group->n || group->members[i + 1].along_mm - group->members[i].along_mm >= DICOM_SAME_PLACE_MM;
        if (is_last && times == 0)
            times = run + 1;
        if (is_last && run + 1 != times)
            return false;
        if (run >= MOST_PARTS)
            return false;
    }
    if (times < 2 || group->n / times < 2)
        return false;
    for (parts->n = 0; parts->n < times; parts->n++) {
        parts->groups[parts->n] = (struct group){ 0 };
        snprintf(parts->names[parts->n], sizeof parts->names[0], "pass %zu", parts->n + 1);
    }
    for (size_t i = 0; i < group->n; i++)
        group_add(&parts->groups[i % times], group->members[i]);
    return true;
}

static uint64_t bytes_of(const struct group *group)
{
    const struct dicom_image *first = group->members[0].image;
    uint64_t voxels = 0;
    bool is_wide = first->pixels.bits_allocated == 32 || !first->has_place, is_padded = false;
    for (size_t i = 0; i < group->n; i++) {
        const struct dicom_image *image = group->members[i].image;
        voxels += (uint64_t)image->pixels.rows * image->pixels.columns * image->pixels.n_frames;
        is_padded |= image->padding.is_given;
        is_wide = is_wide || image->slope != first->slope || image->offset != first->offset ||
                  image->pixels.is_signed != first->pixels.is_signed ||
                  image->pixels.bits_allocated != first->pixels.bits_allocated;
    }
    bool is_bytes = first->pixels.bits_allocated == 8 && !first->pixels.is_signed;
    uint64_t stored = is_wide ? 4 : is_bytes ? 1 : 2;
    return voxels * (is_padded && !is_wide ? stored + 4 : stored); /* values are made beside the stored cells */
}

static void add_stack(struct dicom_index *index, const struct group *group, const char *apart, size_t *n_left_out)
{
    if (index->n_stacks == DICOM_MAX_STACKS || group->n > DICOM_MAX_SLICES) {
        *n_left_out += group->n;
        return;
    }
    const struct dicom_object *first = &index->objects[group->members[0].object];
    struct dicom_stack *stack = &index->stacks[index->n_stacks++];
    *stack = (struct dicom_stack){ .rows = first->image->pixels.rows,
                                   .columns = first->image->pixels.columns,
                                   .n_objects = group->n,
                                   .patient = first->patient };
    memcpy(stack->series, first->series, sizeof stack->series);
    memcpy(stack->study, first->study, sizeof stack->study);
    memcpy(stack->frame_of_reference, first->frame_of_reference, sizeof stack->frame_of_reference);
    memcpy(stack->modality, first->modality, sizeof stack->modality);
    if (apart[0] && snprintf(stack->description, sizeof stack->description, "%s%s(%s)", first->description,
                             first->description[0] ? " " : "", apart) >= (int)sizeof stack->description)
        snprintf(stack->description, sizeof stack->description, "%s", apart);
    else if (!apart[0])
        memcpy(stack->description, first->description, sizeof stack->description);
    stack->objects = mem_new(group->n * sizeof *stack->objects);
    for (size_t i = 0; i < group->n; i++) {
        stack->objects[i] = group->members[i].object;
        stack->n_slices += group->members[i].image->pixels.n_frames;
    }
    stack->n_bytes = bytes_of(group);
}

/* Turns one group into stacks: one, or several where images share positions. */
static void close_group(struct dicom_index *index, struct group *group, const char *apart, size_t *n_left_out,
                        struct report *report)
{
    const struct dicom_object *first = &index->objects[group->members[0].object];
    size_t n_repeated = sort_by_place(group);
    if (n_repeated == 0) {
        add_stack(index, group, apart, n_left_out);
        return;
    }
    struct parts *parts = mem_new(sizeof *parts);
    bool is_parted = false;
    for (int trait = 0; trait < N_TRAITS && !is_parted; trait++) {
        parts_finish(parts);
        is_parted = part_by_trait(group, (enum trait)trait, parts);
    }
    if (!is_parted) {
        parts_finish(parts);
        is_parted = part_by_order(group, parts);
    }
    if (is_parted) {
        report_add(report, REPORT_NOTE, "image.split", first->path,
                   "The series \"%s\" holds %zu stacks at the same places (%s, %s, ...); "
                   "each became an image.",
                   first->description, parts->n, parts->names[0], parts->names[1]);
        for (size_t p = 0; p < parts->n; p++)
            add_stack(index, &parts->groups[p], parts->names[p], n_left_out);
    } else {
        size_t n = 1;
        for (size_t i = 1; i < group->n; i++)
            if (group->members[i].along_mm - group->members[n - 1].along_mm >= DICOM_SAME_PLACE_MM)
                group->members[n++] = group->members[i];
        report_add(report, REPORT_WARNING, "image.slices-repeated", first->path,
                   "%zu of %zu slices of the series \"%s\" lie where another "
                   "one does; of each place the one with the lowest number was used.",
                   group->n - n, group->n, first->description);
        group->n = n;
        add_stack(index, group, apart, n_left_out);
    }
    parts_finish(parts);
    free(parts);
}

static int by_size(const void *a, const void *b)
{
    const struct dicom_stack *left = a, *right = b;
    if (left->n_slices != right->n_slices)
        return left->n_slices > right->n_slices ? -1 : 1;
    int order = strcmp(left->series, right->series);
    return order ? order : left->objects[0] < right->objects[0] ? -1 : 1;
}

struct grouping {
    struct group groups[DICOM_MAX_STACKS];
    size_t n;
};

/* The group of the same series that the image fits into, or a new one; NULL if there are too many. */
static struct group *group_for(struct grouping *all, const struct dicom_index *index, size_t object)
{
    const struct dicom_object *one = &index->objects[object];
    for (size_t g = 0; g < all->n; g++) {
        const struct member *first = &all->groups[g].members[0];
        const struct dicom_object *other = &index->objects[first->object];
        if (strcmp(one->series, other->series) == 0 &&
            strcmp(one->frame_of_reference, other->frame_of_reference) == 0 &&
            strcmp(one->modality, other->modality) == 0 && one->patient == other->patient &&
            fit_together(one->image, other->image))
            return &all->groups[g];
    }
    return all->n < DICOM_MAX_STACKS ? &all->groups[all->n++] : NULL;
}

/* Names what distinguishes images of one series, for the report. */
static void name_difference(const struct dicom_object *a, const struct dicom_object *b, char out[240])
{
    const struct dicom_image *found = a->image, *expected = b->image;
    if (found->has_place != expected->has_place)
        snprintf(out, 240, "frames of its own");
    else if (found->pixels.rows != expected->pixels.rows || found->pixels.columns != expected->pixels.columns)
        snprintf(out, 240, "(0028,0011) and (0028,0010), size: found %u x %u, expected %u x %u", found->pixels.columns,
                 found->pixels.rows, expected->pixels.columns, expected->pixels.rows);
    else if (!are_close(found->spacing_mm, expected->spacing_mm, 2,
                        1e-3 * fmin(expected->spacing_mm[0], expected->spacing_mm[1])))
        snprintf(out, 240, "(0028,0030), pixel spacing: found %g\\%g, expected %g\\%g", found->spacing_mm[0],
                 found->spacing_mm[1], expected->spacing_mm[0], expected->spacing_mm[1]);
    else if (!are_close(found->row, expected->row, 3, 1e-3) || !are_close(found->column, expected->column, 3, 1e-3))
        snprintf(
            out, 240,
            "(0020,0037), orientation: found %.4g\\%.4g\\%.4g\\%.4g\\%.4g\\%.4g, expected %.4g\\%.4g\\%.4g\\%.4g\\%.4g\\%.4g",
            found->row[0], found->row[1], found->row[2], found->column[0], found->column[1], found->column[2],
            expected->row[0], expected->row[1], expected->row[2], expected->column[0], expected->column[1],
            expected->column[2]);
    else if (strcmp(a->frame_of_reference, b->frame_of_reference) != 0)
        snprintf(out, 240, "(0020,0052), frame of reference");
    else if (a->patient != b->patient)
        snprintf(out, 240, "(0010,0020) or (0010,0010), patient");
    else
        snprintf(out, 240, "(0008,0060), modality: found %s, expected %s", a->modality, b->modality);
}

/* Reports a few images that do not fit to the many others of their series: they may be damaged, and are missing
 * there. */
static void report_stray(const struct grouping *all, const struct dicom_index *index, size_t group,
                         struct report *report)
{
    const struct group *few = &all->groups[group], *most = few;
    const struct dicom_object *stray = &index->objects[few->members[0].object];
    for (size_t g = 0; g < all->n; g++)
        if (all->groups[g].n > most->n &&
            strcmp(index->objects[all->groups[g].members[0].object].series, stray->series) == 0)
            most = &all->groups[g];
    if (4 * few->n > most->n)
        return;
    char difference[240];
    name_difference(stray, &index->objects[most->members[0].object], difference);
    report_add(report, REPORT_WARNING, "image.slices-stray", stray->path,
               "%zu of %zu pictures of the series \"%.60s\" cannot lie in one volume "
               "with the others: %s. They became an image of their own and are missing among the others.",
               few->n, few->n + most->n, stray->description, difference);
}

/* Writes the number of a group in its series, "2 of 3", so that names differ; "" if it is the only one. */
static void name_group(const struct grouping *all, const struct dicom_index *index, size_t group, char out[80])
{
    const char *series = index->objects[all->groups[group].members[0].object].series;
    size_t n = 0, at = 0;
    for (size_t g = 0; g < all->n; g++)
        if (strcmp(index->objects[all->groups[g].members[0].object].series, series) == 0) {
            at = g == group ? n : at;
            n++;
        }
    out[0] = 0;
    if (n > 1)
        snprintf(out, 80, "%zu of %zu", at + 1, n);
}

bool dicom_stacks_find(struct dicom_index *index, struct report *report, struct error *err)
{
    struct grouping *all = mem_new(sizeof *all);
    size_t n_left_out = 0;
    index->stacks = mem_array(DICOM_MAX_STACKS, sizeof *index->stacks, UINT64_MAX, err);
    if (!index->stacks) {
        free(all);
        return false;
    }
    for (size_t i = 0; i < index->n_objects; i++) {
        struct dicom_object *object = &index->objects[i];
        if (object->kind != DICOM_KIND_IMAGE)
            continue;
        struct vec3 axes[3];
        double off, along_mm = 0;
        if (object->image->has_place) {
            if (!dicom_axes(object->image->row, object->image->column, axes, &off)) {
                report_add(report, REPORT_ERROR, "dicom.unreadable", object->path,
                           "The directions of its rows and columns (0020,0037) do not span a plane.");
                continue;
            }
            along_mm = vec3_dot(axes[2], vec3(object->image->position_mm[0], object->image->position_mm[1],
                                              object->image->position_mm[2]));
        }
        struct group *group = group_for(all, index, i);
        if (group)
            group_add(group, (struct member){ i, object->image, along_mm });
        else
            n_left_out++;
    }
    for (size_t g = 0; g < all->n; g++) {
        char apart[80];
        name_group(all, index, g, apart);
        if (strncmp(apart, "1 of ", 5) == 0)
            report_add(
                report, REPORT_NOTE, "image.split", index->objects[all->groups[g].members[0].object].path,
                "The series \"%s\" holds pictures of different orientation, size or kind; it was split, this is %s.",
                index->objects[all->groups[g].members[0].object].description, apart);
        if (apart[0])
            report_stray(all, index, g, report);
        close_group(index, &all->groups[g], apart, &n_left_out, report);
    }
    if (n_left_out > 0)
        report_add(report, REPORT_WARNING, "dicom.too-many", "",
                   "%zu pictures were left out: at most %d stacks of %d slices are kept.", n_left_out, DICOM_MAX_STACKS,
                   DICOM_MAX_SLICES);
    if (index->n_stacks > 1)
        qsort(index->stacks, index->n_stacks, sizeof *index->stacks, by_size);
    for (size_t g = 0; g < all->n; g++)
        free(all->groups[g].members);
    free(all);
    return true;
}

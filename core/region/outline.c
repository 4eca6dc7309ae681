/* Follows the sides of border pixels around the pieces of each slice.
 *
 * A side is a border pixel and a direction, 0..3 counter-clockwise from right, in which it has an outside neighbour. A
 * step along the side keeps the pixel to the left and that neighbour to the right, so it goes a quarter turn
 * counter-clockwise from the side's direction. */
#include "core/region/outline.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/base/parallel.h"

enum { MAX_THREADS = 64, RIGHT = 0, UP = 1, LEFT = 2, DOWN = 3, INSIDE = 16 };

/* Geometry of the slices across an axis: pixel (x, y) has voxel index x along axes[0] and y along axes[1]. */
struct slicing {
    const struct mask *mask;
    int axes[2], across;
    uint32_t size[2];
    struct outline_rule rule;
};

/* Growing array; doubles its room. */
struct numbers {
    uint32_t *at;
    size_t n, room;
};

/* The lines of one slice; points and lines are numbered from 0. */
struct lines {
    struct numbers halves; /* x, y of each point in half pixels, plus 1 so that none is negative */
    struct numbers walk, line;
};

/* Buffers of a thread, reused from slice to slice. */
struct slice_buffer {
    uint8_t *pixels; /* [size[1] + 2][size[0] + 2], with a margin of outside: INSIDE, and bit d for a side of direction
                        d that was visited */
    uint32_t
        *numbers; /* [size[1]][size[0]] 1 + index of the pixel's point, or 0; NULL when points are between pixels */
    ptrdiff_t step[4]; /* offset of the neighbour in each direction */
    ptrdiff_t width;
};

struct outline_job {
    struct slicing slicing;
    uint32_t first_slice, n_slices;
    struct lines *lines; /* [n_slices] */
    atomic_uint next;
    atomic_size_t n_walk; /* total of all slices so far, so that noise is refused before it fills the memory */
    struct error errors[MAX_THREADS];
};

static bool within_limit(uint64_t n_walk, struct error *err)
{
    return n_walk <= OUTLINE_MAX_POINTS ||
           error_set(err, ERROR_LIMIT, "outlines of more than %llu points", (unsigned long long)OUTLINE_MAX_POINTS);
}

static bool numbers_add(struct numbers *numbers, uint32_t value, struct error *err)
{
    if (numbers->n == numbers->room) {
        size_t room = numbers->room ? 2 * numbers->room : 64;
        uint32_t *more = realloc(numbers->at, room * sizeof *more);
        if (!more)
            return error_set(err, ERROR_MEMORY, "no memory for %zu points of an outline", room);
        numbers->at = more;
        numbers->room = room;
    }
    numbers->at[numbers->n++] = value;
    return true;
}

static void lines_finish(struct lines *lines)
{
    free(lines->halves.at);
    free(lines->walk.at);
    free(lines->line.at);
}

/* ---- the pixels of a slice -------------------------------------------------------------------------------------- */

static bool slicing_init(struct slicing *slicing, const struct mask *mask, int axis, struct outline_rule rule,
                         struct error *err)
{
    if (axis < 0 || axis > 2)
        return error_set(err, ERROR_RANGE, "outlines across axis %d: expected 0, 1 or 2", axis);
    *slicing = (struct slicing){
        .mask = mask, .axes = { axis == 0 ? 1 : 0, axis == 2 ? 1 : 2 }, .across = axis, .rule = rule
    };
    for (int side = 0; side < 2; side++)
        slicing->size[side] = mask->size[slicing->axes[side]];
    return true;
}

static bool buffer_init(struct slice_buffer *buffer, const struct slicing *slicing, struct error *err)
{
    size_t width = (size_t)slicing->size[0] + 2, height = (size_t)slicing->size[1] + 2;
    *buffer =
        (struct slice_buffer){ .step = { 1, (ptrdiff_t)width, -1, -(ptrdiff_t)width }, .width = (ptrdiff_t)width };
    buffer->pixels = mem_array(width * height, 1, UINT64_MAX, err);
    if (buffer->pixels && !slicing->rule.is_between)
        buffer->numbers =
            mem_array((size_t)slicing->size[0] * slicing->size[1], sizeof *buffer->numbers, UINT64_MAX, err);
    return buffer->pixels && (slicing->rule.is_between || buffer->numbers);
}

static void buffer_finish(struct slice_buffer *buffer)
{
    free(buffer->pixels);
    free(buffer->numbers);
}

/* Reads the pixels of slice `index`; returns false if all are outside. */
static bool buffer_fill(struct slice_buffer *buffer, const struct slicing *slicing, uint32_t index)
{
    const struct mask *mask = slicing->mask;
    bool has_any = false;
    memset(buffer->pixels, 0, (size_t)buffer->width * (slicing->size[1] + 2));
    for (uint32_t y = 0; y < slicing->size[1]; y++) {
        uint8_t *out = buffer->pixels + (y + 1) * (size_t)buffer->width + 1;
        if (slicing->across == 0) { /* rows of pixels run across the words: each pixel is a bit of another row */
            const uint64_t *bits = mask->bits + (size_t)y * mask->size[1] * mask->words + index / 64;
            for (uint32_t x = 0; x < slicing->size[0]; x++)
                out[x] = bits[(size_t)x * mask->words] >> index % 64 & 1 ? INSIDE : 0;
        } else {
            size_t row = slicing->across == 1 ? (size_t)y * mask->size[1] + index : (size_t)index * mask->size[1] + y;
            for (uint32_t w = 0; w < mask->words; w++)
                for (uint64_t left = mask->bits[row * mask->words + w]; left; left &= left - 1)
                    out[64 * w + (uint32_t)__builtin_ctzll(left)] = INSIDE;
        }
        has_any = has_any || memchr(out, INSIDE, slicing->size[0]);
    }
    return has_any;
}

/* ---- following lines -------------------------------------------------------------------------------------------- */

struct side {
    size_t pixel; /* index in buffer->pixels */
    int direction;
};

static struct side side_after(const struct slice_buffer *buffer, struct side side, bool is_joined)
{
    int ahead = (side.direction + 1) & 3;
    /* inner: the pixel ahead on the left; outer: ahead on the right */
    size_t inner = side.pixel + (size_t)buffer->step[ahead];
    size_t outer = inner + (size_t)buffer->step[side.direction];
    bool has_inner = buffer->pixels[inner] & INSIDE, has_outer = buffer->pixels[outer] & INSIDE;
    if (has_outer && (has_inner || is_joined))
        return (struct side){ outer, (side.direction + 3) & 3 }; /* around a concave corner */
    if (has_inner)
        return (struct side){ inner, side.direction };
    return (struct side){ side.pixel, ahead }; /* around a convex corner */
}

/* Finds the index of the side's point; adds the point at its first occurrence. */
static bool point_of(struct slice_buffer *buffer, const struct slicing *slicing, struct side side, struct lines *lines,
                     uint32_t *number, struct error *err)
{
    static const int right[4] = { 1, 0, -1, 0 }, up[4] = { 0, 1, 0, -1 };
    uint32_t x = (uint32_t)(side.pixel % (size_t)buffer->width) - 1,
             y = (uint32_t)(side.pixel / (size_t)buffer->width) - 1;
    uint32_t *known = buffer->numbers ? &buffer->numbers[(size_t)y * slicing->size[0] + x] : NULL;
    *number = known && *known ? *known - 1 : (uint32_t)(lines->halves.n / 2);
    if (known && *known)
        return true;
    if (known)
        *known = *number + 1;
    int off_x = known ? 0 : right[side.direction], off_y = known ? 0 : up[side.direction];
    return numbers_add(&lines->halves, (uint32_t)((int)(2 * x) + off_x + 1), err) &&
           numbers_add(&lines->halves, (uint32_t)((int)(2 * y) + off_y + 1), err);
}

static bool walk_line(struct slice_buffer *buffer, const struct slicing *slicing, struct side start,
                      struct lines *lines, struct error *err)
{
    size_t first = lines->walk.n;
    if (!numbers_add(&lines->line, (uint32_t)first, err))
        return false;
    struct side side = start;
    do {
        uint32_t number;
        buffer->pixels[side.pixel] |= (uint8_t)(1 << side.direction);
        if (!point_of(buffer, slicing, side, lines, &number, err))
            return false;
        if ((lines->walk.n == first || lines->walk.at[lines->walk.n - 1] != number) &&
            !numbers_add(&lines->walk, number, err))
            return false;
        side = side_after(buffer, side, slicing->rule.is_joined);
    } while (side.pixel != start.pixel || side.direction != start.direction);
    if (lines->walk.n > first + 1 && lines->walk.at[lines->walk.n - 1] == lines->walk.at[first])
        lines->walk.n--; /* the walk came back to the point where it began */
    return true;
}

/* Every closed line goes to the right somewhere, below a pixel: starting at each unvisited lower side finds all
 * lines. */
static bool walk_slice(struct outline_job *job, struct slice_buffer *buffer, struct lines *lines, struct error *err)
{
    const struct slicing *slicing = &job->slicing;
    for (uint32_t y = 0; y < slicing->size[1]; y++) {
        size_t row = (y + 1) * (size_t)buffer->width + 1;
        for (uint32_t x = 0; x < slicing->size[0]; x++) {
            size_t at = row + x;
            if ((buffer->pixels[at] & (INSIDE | 1 << DOWN)) != INSIDE ||
                (buffer->pixels[at - (size_t)buffer->width] & INSIDE))
                continue;
            size_t before = lines->walk.n;
            if (!walk_line(buffer, slicing, (struct side){ at, DOWN }, lines, err))
                return false;
            size_t n = lines->walk.n - before;
            if (!within_limit(atomic_fetch_add(&job->n_walk, n) + n, err))
                return false;
        }
    }
    for (size_t at = 0; buffer->numbers && at < lines->halves.n; at += 2) /* reset for the next slice */
        buffer->numbers[(size_t)(lines->halves.at[at + 1] / 2) * slicing->size[0] + lines->halves.at[at] / 2] = 0;
    return true;
}

static void walk_part(void *context, int part, int n_parts)
{
    (void)n_parts;
    struct outline_job *job = context;
    struct slice_buffer buffer;
    bool good = buffer_init(&buffer, &job->slicing, &job->errors[part]);
    for (uint32_t at; good && (at = atomic_fetch_add(&job->next, 1)) < job->n_slices;)
        if (buffer_fill(&buffer, &job->slicing, job->first_slice + at))
            good = walk_slice(job, &buffer, &job->lines[at], &job->errors[part]);
    buffer_finish(&buffer);
}

/* ---- joining the slices ----------------------------------------------------------------------------------------- */

static struct outline_set *set_create(const struct outline_job *job, struct error *err)
{
    uint64_t n_points = 0, n_walk = 0, n_lines = 0;
    for (uint32_t at = 0; at < job->n_slices; at++) {
        n_points += job->lines[at].halves.n / 2;
        n_walk += job->lines[at].walk.n;
        n_lines += job->lines[at].line.n;
    }
    struct outline_set *set = mem_new(sizeof *set);
    *set =
        (struct outline_set){ .n_points = n_points, .n_walk = n_walk, .n_lines = n_lines, .n_slices = job->n_slices };
    set->points_ijk = mem_array(set->n_points, 3 * sizeof *set->points_ijk, UINT64_MAX, err);
    set->walk = set->points_ijk ? mem_array(set->n_walk, sizeof *set->walk, UINT64_MAX, err) : NULL;
    set->line = set->walk ? mem_array(set->n_lines + 1, sizeof *set->line, UINT64_MAX, err) : NULL;
    set->slice = set->line ? mem_array(set->n_slices + 1, sizeof *set->slice, UINT64_MAX, err) : NULL;
    if (!set->slice) {
        outline_set_destroy(set);
        return NULL;
    }
    return set;
}

static struct outline_set *set_join(const struct outline_job *job, struct error *err)
{
    struct outline_set *set = set_create(job, err);
    if (!set)
        return NULL;
    uint32_t points = 0, walk = 0, line = 0;
    for (uint32_t at = 0; at < job->n_slices; at++) {
        const struct lines *lines = &job->lines[at];
        set->slice[at] = line;
        for (size_t l = 0; l < lines->line.n; l++)
            set->line[line++] = walk + lines->line.at[l];
        for (size_t w = 0; w < lines->walk.n; w++)
            set->walk[walk++] = points + lines->walk.at[w];
        for (size_t p = 0; p < lines->halves.n; p += 2, points++) {
            float *ijk = set->points_ijk + 3 * (size_t)points;
            for (int side = 0; side < 2; side++)
                ijk[job->slicing.axes[side]] = ((float)lines->halves.at[p + (size_t)side] - 1) / 2;
            ijk[job->slicing.across] = (float)(job->first_slice + at);
        }
    }
    set->line[line] = walk;
    set->slice[job->n_slices] = line;
    return set;
}

static struct outline_set *outline_slices(const struct mask *mask, int axis, struct outline_rule rule, uint32_t first,
                                          uint32_t n, int n_threads, struct error *err)
{
    struct outline_job job = { .first_slice = first, .n_slices = n };
    struct outline_set *set = NULL;
    if (!slicing_init(&job.slicing, mask, axis, rule, err))
        return NULL;
    job.lines = mem_array(n, sizeof *job.lines, UINT64_MAX, err);
    if (!job.lines)
        return NULL;
    int wanted = n_threads > 0 ? n_threads : parallel_cores();
    int n_parts = wanted < MAX_THREADS ? wanted : MAX_THREADS;
    n_parts = (uint32_t)n_parts < n ? n_parts : (int)n;
    atomic_init(&job.next, 0);
    atomic_init(&job.n_walk, 0);
    parallel_run(n_parts, walk_part, &job);
    const struct error *failed = NULL;
    for (int part = 0; part < n_parts; part++)
        failed = job.errors[part].code ? &job.errors[part] : failed;
    if (failed)
        error_set(err, failed->code, "%s", failed->text);
    else
        set = set_join(&job, err);
    for (uint32_t at = 0; at < n; at++)
        lines_finish(&job.lines[at]);
    free(job.lines);
    return set;
}

struct outline_set *outline_walk(const struct mask *mask, int axis, struct outline_rule rule, int n_threads,
                                 struct error *err)
{
    return outline_slices(mask, axis, rule, 0, axis >= 0 && axis <= 2 ? mask->size[axis] : 0, n_threads, err);
}

static struct outline_rule rule_of(enum outline_method method)
{
    return (struct outline_rule){ .is_joined = method == OUTLINE_TRACED,
                                  .is_between = method == OUTLINE_MARCHING_SQUARES };
}

struct outline_set *outline_stack(const struct mask *mask, int axis, enum outline_method method, int n_threads,
                                  struct error *err)
{
    return outline_walk(mask, axis, rule_of(method), n_threads, err);
}

struct outline_set *outline_slice(const struct mask *mask, int axis, uint32_t index, enum outline_method method,
                                  struct error *err)
{
    if (axis >= 0 && axis <= 2 && index >= mask->size[axis]) {
        error_set(err, ERROR_RANGE, "an outline on slice %u: axis %d has %u", index, axis, mask->size[axis]);
        return NULL;
    }
    return outline_slices(mask, axis, rule_of(method), index, 1, 1, err);
}

void outline_set_destroy(struct outline_set *set)
{
    if (!set)
        return;
    free(set->points_ijk);
    free(set->walk);
    free(set->line);
    free(set->slice);
    free(set);
}

/* ---- mask_cut --------------------------------------------------------------------------------------------------- */

struct mask *mask_cut(const struct mask *mask, const struct affine *lps_mm_from_pixel, const uint32_t size[2],
                      struct error *err)
{
    struct affine ijk_from_lps_mm, check;
    for (int side = 0; side < 2; side++)
        if (size[side] < 1 || size[side] > VOLUME_MAX_SIDE) {
            error_set(err, ERROR_RANGE, "a cut of %u x %u pixels: expected 1 to %d each way", size[0], size[1],
                      VOLUME_MAX_SIDE);
            return NULL;
        }
    if (!affine_invert(&mask->lps_mm_from_ijk, &ijk_from_lps_mm) || !affine_invert(lps_mm_from_pixel, &check)) {
        error_set(err, ERROR_RANGE, "a cut whose pixels or voxels have no extent");
        return NULL;
    }
    struct mask *cut = mask_create((uint32_t[3]){ size[0], size[1], 1 }, lps_mm_from_pixel, err);
    if (!cut)
        return NULL;
    struct affine ijk_from_pixel = affine_compose(&ijk_from_lps_mm, lps_mm_from_pixel);
    memset(cut->bits, 0, (size_t)cut->words * size[1] * sizeof *cut->bits);
    for (uint32_t y = 0; y < size[1]; y++)
        for (uint32_t x = 0; x < size[0]; x++) {
            struct vec3 at = affine_point(&ijk_from_pixel, vec3(x, y, 0));
            double i = floor(at.x + 0.5), j = floor(at.y + 0.5), k = floor(at.z + 0.5);
            if (!(i >= 0 && j >= 0 && k >= 0 && i < mask->size[0] && j < mask->size[1] && k < mask->size[2]))
                continue;
            size_t row = (size_t)k * mask->size[1] + (size_t)j;
            if (mask->bits[row * mask->words + (size_t)i / 64] >> (size_t)i % 64 & 1)
                cut->bits[y * (size_t)cut->words + x / 64] |= (uint64_t)1 << x % 64;
        }
    return cut;
}

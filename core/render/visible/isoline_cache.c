/* Samples doses on planes, traces their lines, and keeps both. */
#include "core/render/visible/isoline_cache.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/render/visible/kept.h"

/* Limits of the cache: planes with their samples and lines, and bytes. */
enum { MAX_ENTRIES = 24, MAX_BYTES = 64 << 20 };
/* More is sampled on each side, as part of the window, for pictures that are panned. */
static const double roomy = 0.1;
static const double tolerance_px = 0.1, dash_px = 7, gap_px = 5;

/* The lines of a value. */
struct traced {
    struct cut_lines lines; /* first: a pointer to it is one to this */
    double level, mm_per_px;
    bool is_dashed;
    int n_uses;
    struct traced *next;
};

/* A dose on a plane. */
struct entry {
    struct kept kept;
    struct dose_choice choice;
    struct plane plane;
    struct isoline_lattice lattice;
    uint64_t outlines;               /* hash of the outlines that it is limited to; 0: none */
    struct dose_plane *plane_values; /* NULL: the plane misses the dose */
    struct traced *first;
};

struct isoline_cache {
    struct kept *first;
};

struct isoline_cache *isoline_cache_create(void)
{
    return mem_new(sizeof(struct isoline_cache));
}

static void entry_destroy(struct kept *kept)
{
    struct entry *entry = (struct entry *)kept;
    while (entry->first) {
        struct traced *traced = entry->first;
        assert(traced->n_uses == 0);
        entry->first = traced->next;
        cut_lines_finish(&traced->lines);
        free(traced);
    }
    dose_plane_destroy(entry->plane_values);
    free(entry);
}

static bool entry_is_used(const struct kept *kept)
{
    for (const struct traced *traced = ((const struct entry *)kept)->first; traced; traced = traced->next)
        if (traced->n_uses > 0)
            return true;
    return false;
}

static size_t entry_n_bytes(const struct kept *kept)
{
    const struct entry *entry = (const struct entry *)kept;
    size_t n = sizeof *entry + (entry->plane_values ? dose_plane_n_bytes(entry->plane_values) : 0);
    for (const struct traced *traced = entry->first; traced; traced = traced->next)
        n += sizeof *traced + traced->lines.capacity * sizeof *traced->lines.ends_lps_mm;
    return n;
}

static const struct kept_type entries = { entry_destroy, entry_is_used, entry_n_bytes, MAX_ENTRIES, MAX_BYTES };

void isoline_cache_forget(struct isoline_cache *cache, const struct plan *plan)
{
    kept_forget(&cache->first, &entries, plan);
}

void isoline_cache_destroy(struct isoline_cache *cache)
{
    if (!cache)
        return;
    isoline_cache_forget(cache, NULL);
    free(cache);
}

void isoline_cache_trim(struct isoline_cache *cache)
{
    kept_trim(&cache->first, &entries);
}

void isoline_cache_release(const struct cut_lines *lines)
{
    ((struct traced *)(void *)lines)->n_uses--;
}

/* ---- samples ---------------------------------------------------------------------------------------------------- */

/* FNV-1a over the coordinates, eight bytes at a time. */
static uint64_t hash_of(const struct isoline_place *place)
{
    uint64_t hash = 14695981039346656037u;
    for (size_t i = 0; i < place->n_outlines; i++)
        for (size_t l = 0; l < place->outlines[i]->n; l++) {
            uint64_t words[6];
            memcpy(words, place->outlines[i]->ends_lps_mm[l], sizeof words);
            for (int w = 0; w < 6; w++)
                hash = (hash ^ words[w]) * 1099511628211u;
        }
    return place->outlines ? hash | 1 : 0;
}

/* Marks the samples inside of an outline: each of its lines that crosses a row turns what is behind it over. */
static void mark_inside(const struct cut_lines *outline, const struct affine *uv_from_lps, const uint32_t size[2],
                        uint8_t *turned, uint8_t *inside)
{
    size_t width = size[0];
    memset(turned, 0, width * size[1]);
    for (size_t l = 0; l < outline->n; l++) {
        const double(*ends)[3] = (const double(*)[3])outline->ends_lps_mm[l];
        struct vec3 a = affine_point(uv_from_lps, vec3(ends[0][0], ends[0][1], ends[0][2])),
                    b = affine_point(uv_from_lps, vec3(ends[1][0], ends[1][1], ends[1][2]));
        if (a.y > b.y) {
            struct vec3 c = a;
            a = b;
            b = c;
        }
        for (double v = fmax(ceil(a.y), 0); v < b.y && v < size[1]; v++) { /* a.y <= v < b.y */
            double u = fmax(ceil(a.x + (b.x - a.x) * (v - a.y) / (b.y - a.y)), 0);
            if (u < size[0])
                turned[(size_t)v * width + (size_t)u] ^= 1;
        }
    }
    for (size_t v = 0; v < size[1]; v++)
        for (size_t u = 0, is_inside = 0; u < width; u++) {
            is_inside ^= turned[v * width + u];
            inside[v * width + u] |= (uint8_t)is_inside;
        }
}

/* Takes the values outside of all outlines away. */
static bool keep_inside(struct dose_plane *values, const struct isoline_place *place, struct error *err)
{
    const uint32_t *size = values->lattice.size;
    size_t n = (size_t)size[0] * size[1];
    struct affine full = values->lattice.lps_mm_from_uv, uv_from_lps;
    full.columns[2] = place->plane.normal;
    uint8_t *inside = mem_array(n, 1, UINT64_MAX, err), *turned = inside ? mem_array(n, 1, UINT64_MAX, err) : NULL;
    bool is_good = turned && affine_invert(&full, &uv_from_lps);
    for (size_t i = 0; is_good && i < place->n_outlines; i++)
        mark_inside(place->outlines[i], &uv_from_lps, size, turned, inside);
    for (size_t i = 0; is_good && i < n; i++)
        if (!inside[i])
            values->values[i] = NAN;
    free(inside);
    free(turned);
    return is_good;
}

static struct isoline_window roomy_window(const struct isoline_window *window)
{
    struct isoline_window larger = *window;
    for (int i = 0; i < 2; i++) {
        double more = roomy * (window->high_mm[i] - window->low_mm[i]);
        larger.low_mm[i] -= more;
        larger.high_mm[i] += more;
    }
    return larger;
}

/* The samples of a place, kept or taken now. NULL on failure. */
static struct entry *entry_of(struct isoline_cache *cache, const struct isoline_place *place, struct error *err)
{
    const struct grid *grid = &place->dose->field->rows[0]->grid;
    struct isoline_lattice lattice = { .first = { 0 } };
    uint64_t outlines = hash_of(place);
    const double mm_per_px = (place->is_coarse ? 2 : 1) * place->mm_per_px;
    bool is_met = isoline_lattice_of(grid, &place->plane, &place->window, mm_per_px, &lattice);
    lattice.is_by_slice = place->is_by_slice;
    for (struct kept **at = &cache->first; *at; at = &(*at)->next) {
        struct entry *entry = (struct entry *)*at;
        if (entry->kept.plan != place->plan || entry->outlines != outlines || (entry->plane_values != NULL) != is_met ||
            (is_met && !isoline_lattice_holds(&entry->lattice, &lattice)) ||
            !plane_equal(&entry->plane, &place->plane) ||
            memcmp(&entry->choice, &place->dose->choice, sizeof entry->choice) != 0)
            continue;
        kept_use_again(&cache->first, at);
        return entry;
    }
    struct isoline_window window = roomy_window(&place->window);
    struct entry *made = mem_new(sizeof *made);
    made->kept.plan = place->plan;
    made->plane = place->plane;
    made->choice = place->dose->choice;
    made->outlines = outlines;
    if (is_met && isoline_lattice_of(grid, &place->plane, &window, mm_per_px, &made->lattice)) {
        made->lattice.is_by_slice = place->is_by_slice;
        struct dose_lattice samples = isoline_lattice_samples(&made->lattice);
        made->plane_values = dose_plane_create(place->dose->field, &samples, err);
        if (!made->plane_values || (place->outlines && !keep_inside(made->plane_values, place, err))) {
            entry_destroy(&made->kept);
            return NULL;
        }
    }
    kept_put_first(&cache->first, &made->kept);
    return made;
}

/* ---- lines ------------------------------------------------------------------------------------------------------ */

/* Where dashes of a line are. */
struct pen {
    struct cut_lines *lines;
    bool is_dashed;
    double dash_mm, period_mm, along_mm; /* along_mm: the length of line drawn so far */
};

static void put(struct pen *pen, struct vec3 a, struct vec3 b)
{
    const double ends[2][3] = { { a.x, a.y, a.z }, { b.x, b.y, b.z } };
    assert(pen->lines->n < pen->lines->capacity);
    memcpy(pen->lines->ends_lps_mm[pen->lines->n++], ends, sizeof ends);
}

static bool reserve(struct cut_lines *lines, size_t n, struct error *err)
{
    if (lines->n + n <= lines->capacity)
        return true;
    size_t capacity = 2 * (lines->n + n);
    double(*grown)[2][3] = realloc(lines->ends_lps_mm, capacity * sizeof *grown);
    if (!grown)
        return error_set(err, ERROR_MEMORY, "no memory for %zu isodose lines", capacity);
    lines->ends_lps_mm = grown;
    lines->capacity = capacity;
    return true;
}

static bool draw_segment(struct pen *pen, struct vec3 a, struct vec3 b, struct error *err)
{
    struct vec3 along = vec3_sub(b, a);
    double length = vec3_length(along);
    if (!pen->is_dashed) {
        if (!reserve(pen->lines, 1, err))
            return false;
        put(pen, a, b);
        return true;
    }
    if (!reserve(pen->lines, (size_t)(length / pen->period_mm) + 2, err))
        return false;
    for (double at = 0; at < length;) {
        double phase = fmod(pen->along_mm + at, pen->period_mm), left = pen->dash_mm - phase;
        if (left > 1e-9 * pen->period_mm) {
            double end = fmin(at + left, length);
            put(pen, vec3_add(a, vec3_scale(along, at / length)), vec3_add(a, vec3_scale(along, end / length)));
            at = end;
        } else
            at += fmax(pen->period_mm - phase, 1e-6 * pen->period_mm);
    }
    pen->along_mm += length;
    return true;
}

/* True if the points first + 1 .. last - 1 are within the tolerance of the line from first to last. */
static bool is_straight(const struct vec3 *points, size_t first, size_t last, double tolerance_mm)
{
    struct vec3 chord = vec3_sub(points[last], points[first]);
    double square = vec3_dot(chord, chord);
    for (size_t i = first + 1; i < last; i++) {
        struct vec3 from = vec3_sub(points[i], points[first]);
        double part = square > 0 ? vec3_dot(from, chord) / square : 0;
        struct vec3 off = vec3_sub(from, vec3_scale(chord, fmin(fmax(part, 0), 1)));
        if (vec3_dot(off, off) > tolerance_mm * tolerance_mm)
            return false;
    }
    return true;
}

/* A polyline with fewer points: each segment goes as far as it can, over at most MOST points. */
static bool draw_line(struct pen *pen, const struct vec3 *points, size_t n, double tolerance_mm, struct error *err)
{
    enum { MOST = 16 };
    for (size_t at = 0; at + 1 < n;) {
        size_t next = at + 1;
        while (next + 1 < n && next - at < MOST && is_straight(points, at, next + 1, tolerance_mm))
            next++;
        if (!draw_segment(pen, points[at], points[next], err))
            return false;
        at = next;
    }
    return true;
}

static bool trace(struct traced *traced, const struct entry *entry, const struct dose_field *field, struct error *err)
{
    struct isolines lines = { 0 };
    const struct dose_plane *values = entry->plane_values;
    if (!values)
        return true;
    bool is_good = dose_plane_trace(values, field, traced->level, &lines, err);
    struct vec3 *points = is_good ? mem_array(lines.n_points, sizeof *points, UINT64_MAX, err) : NULL;
    is_good = points && reserve(&traced->lines, lines.n_points / 4, err);
    const struct affine *map = &values->lattice.lps_mm_from_uv;
    for (size_t i = 0; is_good && i < lines.n_points; i++)
        points[i] = affine_point(map, vec3(lines.points[i][0], lines.points[i][1], 0));
    double dash_mm = dash_px * traced->mm_per_px, gap_mm = gap_px * traced->mm_per_px;
    for (size_t l = 0, at = 0; is_good && l < lines.n_lines; at = lines.ends[l++]) {
        struct pen pen = { &traced->lines, traced->is_dashed, dash_mm, dash_mm + gap_mm, 0 };
        is_good = draw_line(&pen, points + at, lines.ends[l] - at, tolerance_px * traced->mm_per_px, err);
    }
    free(points);
    isolines_finish(&lines);
    return is_good;
}

const struct cut_lines *isoline_cache_lines(struct isoline_cache *cache, const struct isoline_place *place,
                                            double level, struct error *err)
{
    struct entry *entry = entry_of(cache, place, err);
    /* dashes and tolerance keep their length while a view is zoomed by less than a factor of two */
    double mm_per_px = exp2(floor(log2(place->mm_per_px)));
    for (struct traced *traced = entry ? entry->first : NULL; traced; traced = traced->next)
        if (!(traced->level < level || traced->level > level) && traced->is_dashed == place->is_dashed &&
            !(traced->mm_per_px < mm_per_px || traced->mm_per_px > mm_per_px)) {
            traced->n_uses++;
            return &traced->lines;
        }
    if (!entry)
        return NULL;
    struct traced *made = mem_new(sizeof *made);
    made->level = level;
    made->mm_per_px = mm_per_px;
    made->is_dashed = place->is_dashed;
    if (!trace(made, entry, place->dose->field, err)) {
        cut_lines_finish(&made->lines);
        free(made);
        return NULL;
    }
    made->n_uses = 1;
    made->next = entry->first;
    entry->first = made;
    return &made->lines;
}

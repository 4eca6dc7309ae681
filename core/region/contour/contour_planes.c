/* Sorts the contours of a region into parallel planes: common normal, plane positions, slabs; counts bad contours. */
#include "core/region/contour/contour_planes.h"

#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"

#define SAME_PLANE_MM 0.05 /* rounding of decimals in files; closer planes are one plane */
#define FLAT_MM 0.01
#define THIN_MM 1e-4                         /* a contour within this distance of a line has no area */
#define MOST_TILT_COSINE 0.99619469809174555 /* cosine of 5 degrees */
#define SNAP_COSINE 0.9999984769132877       /* cosine of 0.1 degree */
#define GAP_FACTOR 1.5
#define CLOSE_SHARE 0.18 /* of the upper quartile of the distances: closer planes are one, drawn twice and shifted */
enum { FEW_PLANES = 4 };

enum verdict { GOOD, NOT_FINITE, DEGENERATE, NOT_PARALLEL };

/* One contour while it is sorted into its plane. */
struct entry {
    double at_mm;
    uint64_t hash;
    size_t index;
    struct vec3 area; /* vector area, mm2: direction of the normal, length of the area */
    struct vec3 normal;
    enum verdict verdict;
};

static struct vec3 point_at(const struct contour *contour, size_t i)
{
    const double *p = contour->points_lps_mm + 3 * i;
    return vec3(p[0], p[1], p[2]);
}

static bool is_in_reach(const struct contour *contour)
{
    for (size_t i = 0; i < 3 * contour->n_points; i++)
        if (!(fabs(contour->points_lps_mm[i]) <= CONTOUR_MAX_MM))
            return false;
    return true;
}

/* FNV-1a hash of the points' bytes. */
static uint64_t hash_of(const struct contour *contour)
{
    const uint8_t *bytes = (const uint8_t *)contour->points_lps_mm;
    uint64_t hash = 0xcbf29ce484222325u;
    for (size_t i = 0; i < contour->n_points * 3 * sizeof(double); i++)
        hash = (hash ^ bytes[i]) * 0x100000001b3u;
    return hash;
}

/* Normal of the triangle of the first point, the point furthest from it, and the point furthest from their line. For
 * contours whose two halves turn opposite ways, so that their vector area is 0. Zero vector for a thin contour. */
static struct vec3 normal_of_spread(const struct contour *contour)
{
    struct vec3 first = point_at(contour, 0), along = vec3(0, 0, 0), normal = vec3(0, 0, 0);
    double most = 0;
    for (size_t i = 1; i < contour->n_points; i++) {
        struct vec3 to = vec3_sub(point_at(contour, i), first);
        if (vec3_length(to) > most) {
            most = vec3_length(to);
            along = vec3_scale(to, 1 / most);
        }
    }
    most = THIN_MM;
    for (size_t i = 1; i < contour->n_points; i++) {
        struct vec3 across = vec3_cross(along, vec3_sub(point_at(contour, i), first));
        if (vec3_length(across) > most) {
            most = vec3_length(across);
            normal = across;
        }
    }
    return vec3_normalize(normal);
}

static void look_at(struct entry *entry, const struct contour *contour)
{
    if (contour->n_points < 3) {
        entry->verdict = DEGENERATE;
        return;
    }
    if (!is_in_reach(contour)) {
        entry->verdict = NOT_FINITE;
        return;
    }
    entry->normal = normal_of_spread(contour);
    if (vec3_length(entry->normal) < 0.5) {
        entry->verdict = DEGENERATE;
        return;
    }
    struct vec3 first = point_at(contour, 0), sum = vec3(0, 0, 0);
    double way_mm = 0;
    for (size_t i = 1; i < contour->n_points; i++) {
        struct vec3 a = vec3_sub(point_at(contour, i), first);
        struct vec3 b = i + 1 < contour->n_points ? vec3_sub(point_at(contour, i + 1), first) : vec3(0, 0, 0);
        sum = vec3_add(sum, vec3_cross(a, b));
        way_mm += vec3_length(vec3_sub(b, a));
    }
    entry->area = vec3_scale(sum, 0.5);
    if (vec3_length(entry->area) > 1e-6 * way_mm * way_mm)
        entry->normal = vec3_normalize(entry->area);
}

static struct vec3 snapped(struct vec3 normal, const struct grid *likely)
{
    for (int axis = 0; axis < 3; axis++) {
        struct vec3 own = vec3(axis == 0, axis == 1, axis == 2);
        if (likely) {
            const struct vec3 *columns = likely->lps_mm_from_ijk.columns;
            own = vec3_normalize(vec3_cross(columns[(axis + 1) % 3], columns[(axis + 2) % 3]));
        }
        double cosine = vec3_dot(normal, own);
        if (fabs(cosine) > SNAP_COSINE)
            return cosine < 0 ? vec3_scale(own, -1) : own;
    }
    return normal;
}

/* Normal of the largest contour, then the mean over all contours nearly parallel to it. */
static struct vec3 common_normal(const struct entry *entries, size_t n, const struct grid *likely)
{
    const struct entry *largest = NULL;
    for (size_t i = 0; i < n; i++)
        if (entries[i].verdict == GOOD && (!largest || vec3_length(entries[i].area) > vec3_length(largest->area)))
            largest = &entries[i];
    if (!largest)
        return vec3(0, 0, 1);
    struct vec3 sum = vec3(0, 0, 0);
    for (size_t i = 0; i < n; i++) {
        double cosine = vec3_dot(entries[i].normal, largest->normal);
        if (entries[i].verdict == GOOD && fabs(cosine) > MOST_TILT_COSINE)
            sum = vec3_add(sum, vec3_scale(entries[i].area, cosine < 0 ? -1 : 1));
    }
    struct vec3 normal = vec3_length(sum) > 0 ? vec3_normalize(sum) : largest->normal;
    /* same sign for either winding, so that planes come in the same sequence */
    double most = fmax(fabs(normal.x), fmax(fabs(normal.y), fabs(normal.z)));
    double sign = fabs(normal.z) == most ? normal.z : fabs(normal.y) == most ? normal.y : normal.x;
    return snapped(sign < 0 ? vec3_scale(normal, -1) : normal, likely);
}

static int by_distance(const void *a, const void *b)
{
    const struct entry *one = a, *other = b;
    if (one->at_mm != other->at_mm)
        return one->at_mm < other->at_mm ? -1 : 1;
    return one->index < other->index ? -1 : one->index > other->index;
}

static int by_hash(const void *a, const void *b)
{
    const struct entry *one = a, *other = b;
    if (one->hash != other->hash)
        return one->hash < other->hash ? -1 : 1;
    return one->index < other->index ? -1 : one->index > other->index;
}

static int by_value(const void *a, const void *b)
{
    double one = *(const double *)a, other = *(const double *)b;
    return one < other ? -1 : one > other;
}

/* Computes positions along the normal and counts bad contours; entries that stay come first. Returns how many stay. */
static size_t place(struct contour_planes *planes, struct entry *entries, const struct contour_set *set)
{
    size_t n_good = 0;
    for (size_t i = 0; i < set->n_contours; i++) {
        struct entry entry = entries[i];
        if (entry.verdict == GOOD && fabs(vec3_dot(entry.normal, planes->normal_lps)) < MOST_TILT_COSINE)
            entry.verdict = NOT_PARALLEL;
        planes->facts.n_not_finite += entry.verdict == NOT_FINITE;
        planes->facts.n_degenerate += entry.verdict == DEGENERATE;
        planes->facts.n_not_parallel += entry.verdict == NOT_PARALLEL;
        if (entry.verdict != GOOD)
            continue;
        const struct contour *contour = &set->contours[i];
        double sum = 0, low = INFINITY, high = -INFINITY;
        for (size_t p = 0; p < contour->n_points; p++) {
            double at_mm = vec3_dot(planes->normal_lps, point_at(contour, p));
            sum += at_mm;
            low = fmin(low, at_mm);
            high = fmax(high, at_mm);
        }
        entry.at_mm = sum / (double)contour->n_points;
        entry.hash = hash_of(contour);
        planes->facts.n_not_planar += high - low > 2 * FLAT_MM;
        entries[n_good++] = entry;
    }
    return n_good;
}

static bool is_repeated(const struct contour *a, const struct contour *b)
{
    return a->n_points == b->n_points &&
           memcmp(a->points_lps_mm, b->points_lps_mm, a->n_points * 3 * sizeof(double)) == 0;
}

/* Largest distance of contours on one plane. Where copies of contours lie a little beside the first ones, it is more
 * than the rounding of decimals. */
static bool find_same_plane_mm(const struct entry *entries, size_t n, double *same_mm, struct error *err)
{
    size_t n_gaps = 0;
    *same_mm = SAME_PLANE_MM;
    double *gaps_mm = mem_array(n, sizeof *gaps_mm, UINT64_MAX, err);
    if (!gaps_mm)
        return false;
    for (size_t i = 1; i < n; i++)
        if (entries[i].at_mm - entries[i - 1].at_mm > SAME_PLANE_MM)
            gaps_mm[n_gaps++] = entries[i].at_mm - entries[i - 1].at_mm;
    if (n_gaps >= FEW_PLANES) {
        qsort(gaps_mm, n_gaps, sizeof *gaps_mm, by_value);
        *same_mm = fmax(SAME_PLANE_MM, CLOSE_SHARE * gaps_mm[3 * n_gaps / 4]);
    }
    free(gaps_mm);
    return true;
}

/* Returns true if an entry is on the plane that entries[first] begins. */
static bool is_same_plane(const struct entry *entries, size_t first, size_t i, double same_mm)
{
    return entries[i].at_mm - entries[i - 1].at_mm <= SAME_PLANE_MM ||
           entries[i].at_mm - entries[first].at_mm <= same_mm;
}

static bool make_planes(struct contour_planes *planes, struct entry *entries, size_t n, const struct contour_set *set,
                        struct error *err)
{
    size_t most = 0;
    double same_mm;
    if (!find_same_plane_mm(entries, n, &same_mm, err))
        return false;
    for (size_t i = 0; i < n; i++)
        most += i == 0 || entries[i].at_mm - entries[i - 1].at_mm > SAME_PLANE_MM;
    if (most > CONTOUR_MAX_PLANES)
        return error_set(err, ERROR_LIMIT, "contours on %zu planes; the limit is %d", most, CONTOUR_MAX_PLANES);
    planes->planes = mem_array(most, sizeof *planes->planes, UINT64_MAX, err);
    planes->contours = mem_array(n, sizeof *planes->contours, UINT64_MAX, err);
    if (!planes->planes || !planes->contours)
        return false;
    for (size_t first = 0, end; first < n; first = end) {
        double sum = 0;
        for (end = first; end < n && (end == first || is_same_plane(entries, first, end, same_mm)); end++) {
            sum += entries[end].at_mm;
            planes->facts.n_close_planes += end > first && entries[end].at_mm - entries[end - 1].at_mm > SAME_PLANE_MM;
        }
        struct contour_plane *plane = &planes->planes[planes->n_planes++];
        plane->at_mm = sum / (double)(end - first);
        plane->first = planes->n_contours;
        qsort(entries + first, end - first, sizeof *entries, by_hash);
        for (size_t i = first; i < end; i++) {
            const struct contour *contour = &set->contours[entries[i].index];
            if (i > first && entries[i].hash == entries[i - 1].hash &&
                is_repeated(contour, &set->contours[entries[i - 1].index]))
                planes->facts.n_repeated++;
            else
                planes->contours[planes->n_contours++] = contour;
        }
        plane->end = planes->n_contours;
    }
    return true;
}

/* Usual distance of neighbouring planes: the lower median, so that one gap among three planes does not become the
 * rule. */
static bool find_spacing(struct contour_planes *planes, double spacing_mm, const struct grid *likely, struct error *err)
{
    size_t n = planes->n_planes;
    planes->facts.spacing_mm = spacing_mm > 0 ? spacing_mm
                               : likely       ? contour_grid_spacing_mm(likely, planes->normal_lps)
                                              : 1;
    if (n < 2)
        return true;
    double *gaps_mm = mem_array(n - 1, sizeof *gaps_mm, UINT64_MAX, err);
    if (!gaps_mm)
        return false;
    for (size_t i = 0; i + 1 < n; i++)
        gaps_mm[i] = planes->planes[i + 1].at_mm - planes->planes[i].at_mm;
    qsort(gaps_mm, n - 1, sizeof *gaps_mm, by_value);
    double median_mm = gaps_mm[(n - 2) / 2];
    free(gaps_mm);
    if (n >= FEW_PLANES || !(spacing_mm > 0) || median_mm <= GAP_FACTOR * spacing_mm)
        planes->facts.spacing_mm = median_mm;
    return true;
}

static void make_slabs(struct contour_planes *planes)
{
    double spacing_mm = planes->facts.spacing_mm;
    for (size_t i = 0; i < planes->n_planes; i++) {
        struct contour_plane *plane = &planes->planes[i], *next = plane + 1;
        if (i == 0)
            plane->low_mm = plane->at_mm - spacing_mm / 2;
        if (i + 1 == planes->n_planes) {
            plane->high_mm = plane->at_mm + spacing_mm / 2;
            break;
        }
        double gap_mm = next->at_mm - plane->at_mm;
        if (gap_mm <= GAP_FACTOR * spacing_mm) {
            plane->high_mm = next->low_mm = plane->at_mm + gap_mm / 2;
        } else {
            plane->high_mm = plane->at_mm + spacing_mm / 2;
            next->low_mm = next->at_mm - spacing_mm / 2;
            planes->facts.n_gaps++;
            planes->facts.widest_gap_mm = fmax(planes->facts.widest_gap_mm, gap_mm);
        }
    }
}

bool contour_planes_init(struct contour_planes *planes, const struct contour_set *set, double spacing_mm,
                         const struct grid *likely, struct error *err)
{
    *planes = (struct contour_planes){ .normal_lps = { 0, 0, 1 } };
    uint64_t n_points = 0;
    for (size_t i = 0; i < set->n_contours; i++)
        n_points += set->contours[i].n_points;
    if (n_points > CONTOUR_MAX_POINTS)
        return error_set(err, ERROR_LIMIT, "contours of %llu points; the limit is %d", (unsigned long long)n_points,
                         CONTOUR_MAX_POINTS);
    struct entry *entries = mem_array(set->n_contours, sizeof *entries, UINT64_MAX, err);
    if (!entries)
        return false;
    for (size_t i = 0; i < set->n_contours; i++) {
        entries[i].index = i;
        look_at(&entries[i], &set->contours[i]);
    }
    planes->normal_lps = common_normal(entries, set->n_contours, likely);
    size_t n = place(planes, entries, set);
    qsort(entries, n, sizeof *entries, by_distance);
    bool is_made = make_planes(planes, entries, n, set, err) && find_spacing(planes, spacing_mm, likely, err);
    free(entries);
    if (!is_made) {
        contour_planes_finish(planes);
        return false;
    }
    make_slabs(planes);
    planes->facts.n_planes = planes->n_planes;
    return true;
}

void contour_planes_finish(struct contour_planes *planes)
{
    free(planes->planes);
    free(planes->contours);
    planes->planes = NULL;
    planes->contours = NULL;
    planes->n_planes = planes->n_contours = 0;
}

double contour_grid_spacing_mm(const struct grid *grid, struct vec3 normal_lps)
{
    double most = 0;
    for (int axis = 0; axis < 3; axis++)
        most = fmax(most, fabs(vec3_dot(grid->lps_mm_from_ijk.columns[axis], normal_lps)));
    return most;
}

/* Computes the field opening from jaws, leaves, blocks and applicator, in the plane of the isocentre. */
#include "core/formats/dicom/dicom_rtplan_opening.h"

#include <stdio.h>
#include <string.h>

enum {
    DEVICE_SEQUENCE = DICOM_TAG(0x300a, 0x00b6),
    DEVICE_TYPE = DICOM_TAG(0x300a, 0x00b8),
    DEVICE_N_PAIRS = DICOM_TAG(0x300a, 0x00bc),
    LEAF_BOUNDARIES = DICOM_TAG(0x300a, 0x00be),
    BLOCK_SEQUENCE = DICOM_TAG(0x300a, 0x00f4),
    BLOCK_TYPE = DICOM_TAG(0x300a, 0x00f8),
    BLOCK_N_POINTS = DICOM_TAG(0x300a, 0x0104),
    BLOCK_DATA = DICOM_TAG(0x300a, 0x0106),
    APPLICATOR_SEQUENCE = DICOM_TAG(0x300a, 0x0107),
    POSITION_SEQUENCE = DICOM_TAG(0x300a, 0x011a),
    LEAF_POSITIONS = DICOM_TAG(0x300a, 0x011c),
    APPLICATOR_GEOMETRY = DICOM_TAG(0x300a, 0x0431),
    APPLICATOR_SHAPE = DICOM_TAG(0x300a, 0x0432),
    APPLICATOR_OPENING = DICOM_TAG(0x300a, 0x0433),
    ION_DEVICE_SEQUENCE = DICOM_TAG(0x300a, 0x03a4),
    ION_BLOCK_SEQUENCE = DICOM_TAG(0x300a, 0x0436)
};
enum { MOST_BLOCK_POINTS = 5000, LEAST_ROUND_POINTS = 12 };
#define ROUND_SHARE \
    0.02 /* share of the radius by which the points of a block may miss a circle and still count as round */
static struct opening_rectangle everything(void)
{
    return (struct opening_rectangle){ { -OPENING_WIDE_MM, OPENING_WIDE_MM }, { -OPENING_WIDE_MM, OPENING_WIDE_MM } };
}

static void widen(double side[2], const double by[2])
{
    side[0] = isnan(side[0]) ? by[0] : fmin(side[0], by[0]);
    side[1] = isnan(side[1]) ? by[1] : fmax(side[1], by[1]);
}

bool opening_is_leaves(const struct opening_device *device)
{
    return strncmp(device->type, "MLC", 3) == 0;
}

/* The direction of movement is the last letter of the type: "X", "ASYMY", "MLCX". */
bool opening_moves_along_x(const struct opening_device *device)
{
    size_t n = strlen(device->type);
    return n > 0 && device->type[n - 1] == 'X';
}

#define CLOSED_MM 1.0 /* leaves that overlap by up to this count as closed */

static bool are_within(const double *values, size_t n, double most, size_t *which)
{
    for (size_t i = 0; i < n; i++)
        if (!(fabs(values[i]) <= most)) {
            *which = i;
            return false;
        }
    return true;
}

static bool is_known_type(const char *type)
{
    static const char *const known[] = { "X", "ASYMX", "Y", "ASYMY", "MLCX", "MLCY" };
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
        if (strcmp(type, known[i]) == 0)
            return true;
    return false;
}

/* Reads the n_pairs + 1 boundaries between leaves, which must increase. */
static bool read_boundaries(struct opening *opening, struct opening_device *device, const struct dicom_item *item,
                            int64_t n_pairs)
{
    size_t n = dicom_numbers(item, LEAF_BOUNDARIES, device->boundaries_mm, OPENING_MAX_LEAVES + 1), which;
    if (n_pairs > 0 ? n != (size_t)n_pairs + 1 : n < 2 || n > OPENING_MAX_LEAVES + 1) {
        char expected[60];
        if (n_pairs > 0)
            snprintf(expected, sizeof expected, "%lld for %lld pairs of leaves", (long long)n_pairs + 1,
                     (long long)n_pairs);
        else
            snprintf(expected, sizeof expected, "2 to %d", OPENING_MAX_LEAVES + 1);
        dicom_doubt(opening->doubts, "%s: leaf position boundaries (300A,00BE) are %zu, expected %s", device->type, n,
                    expected);
        return false;
    }
    if (!are_within(device->boundaries_mm, n, OPENING_MOST_MM, &which)) {
        dicom_doubt(opening->doubts, "%s: leaf position boundary %zu (300A,00BE) is %g mm, expected at most %g",
                    device->type, which + 1, device->boundaries_mm[which], OPENING_MOST_MM);
        return false;
    }
    for (size_t i = 1; i < n; i++)
        if (!(device->boundaries_mm[i] > device->boundaries_mm[i - 1])) {
            dicom_doubt(
                opening->doubts,
                "%s: leaf position boundary %zu (300A,00BE) is %g mm, expected more than the %g mm of the one before",
                device->type, i + 1, device->boundaries_mm[i], device->boundaries_mm[i - 1]);
            return false;
        }
    device->n_pairs = n - 1;
    return true;
}

static bool add_device(struct opening *opening, const struct dicom_item *item, struct error *err)
{
    int64_t n_pairs = 0;
    if (opening->n_devices >= OPENING_MAX_DEVICES)
        return error_set(err, ERROR_LIMIT, "more than %d beam limiting devices", OPENING_MAX_DEVICES);
    struct opening_device *device = &opening->devices[opening->n_devices];
    *device = (struct opening_device){ .n_pairs = 1 };
    (void)dicom_text(item, DEVICE_TYPE, device->type, sizeof device->type);
    if (!is_known_type(device->type)) {
        dicom_doubt(opening->doubts,
                    "type of a beam limiting device (300A,00B8) is \"%s\", expected X, ASYMX, Y, ASYMY, MLCX or MLCY",
                    device->type);
        return true;
    }
    bool has_pairs = dicom_integer(item, DEVICE_N_PAIRS, &n_pairs);
    if (n_pairs > OPENING_MAX_LEAVES)
        return error_set(err, ERROR_LIMIT, "a collimator of %lld pairs of leaves; the limit is %d", (long long)n_pairs,
                         OPENING_MAX_LEAVES);
    if (has_pairs && (n_pairs < 1 || (!opening_is_leaves(device) && n_pairs != 1)))
        dicom_doubt(opening->doubts, "%s: number of pairs (300A,00BC) is %lld, expected %s", device->type,
                    (long long)n_pairs, opening_is_leaves(device) ? "1 or more" : "1");
    if (opening_is_leaves(device) && !read_boundaries(opening, device, item, n_pairs))
        return true;
    opening->n_devices++;
    return true;
}

/* Adds the outline of a block: area, extents and, if its points are on a circle, the diameter. xy in mm, in the plane
 * of the isocentre. */
static void add_block(struct opening *opening, const double *xy, size_t n)
{
    double doubled = 0, sum_x = 0, sum_y = 0, radius = 0;
    struct opening_rectangle box = { { INFINITY, -INFINITY }, { INFINITY, -INFINITY } };
    for (size_t i = 0; i < n; i++) {
        const double *a = xy + 2 * i, *b = xy + 2 * ((i + 1) % n);
        doubled += a[0] * b[1] - b[0] * a[1];
        sum_x += (a[0] + b[0]) * (a[0] * b[1] - b[0] * a[1]);
        sum_y += (a[1] + b[1]) * (a[0] * b[1] - b[0] * a[1]);
        box.x[0] = fmin(box.x[0], a[0]);
        box.x[1] = fmax(box.x[1], a[0]);
        box.y[0] = fmin(box.y[0], a[1]);
        box.y[1] = fmax(box.y[1], a[1]);
    }
    if (!(fabs(doubled) > 0))
        return;
    bool is_another = !isnan(opening->block_cm2);
    widen(opening->block_x_mm, box.x);
    widen(opening->block_y_mm, box.y);
    opening->block_cm2 = fabs(doubled) / 2 / 100 + (is_another ? opening->block_cm2 : 0);
    double x = sum_x / (3 * doubled), y = sum_y / (3 * doubled), least = INFINITY, most = 0;
    for (size_t i = 0; i < n; i++) {
        double r = hypot(xy[2 * i] - x, xy[2 * i + 1] - y);
        radius += r / (double)n;
        least = fmin(least, r);
        most = fmax(most, r);
    }
    bool is_round = !is_another && n >= LEAST_ROUND_POINTS && most - least <= 2 * ROUND_SHARE * radius &&
                    fabs(fabs(doubled) / 2 - MATH_PI * radius * radius) <= 0.1 * MATH_PI * radius * radius;
    opening->round_mm = is_round ? 2 * radius : NAN;
}

/* Keeps the outline of a block, n points in the plane of the isocentre. Of blocks with too many points, or too many
 * blocks, none is kept. */
static void keep_block(struct opening *opening, const double *xy, size_t n)
{
    struct beam_outline *blocks = &opening->blocks;
    size_t at = beam_outline_n_points(blocks);
    if (opening->has_lost_blocks || n >= BEAM_OUTLINE_MAX_POINTS - at ||
        blocks->n_polygons >= BEAM_OUTLINE_MAX_POLYGONS) {
        if (!opening->has_lost_blocks)
            dicom_doubt(opening->doubts,
                        "blocks (300A,00F4): %d points or more, or more than %d blocks; their outline is not shown",
                        BEAM_OUTLINE_MAX_POINTS, BEAM_OUTLINE_MAX_POLYGONS);
        opening->has_lost_blocks = true;
        blocks->kind = BEAM_OUTLINE_NONE;
        blocks->n_polygons = 0;
        return;
    }
    for (size_t i = 0; i < n; i++) {
        blocks->points_mm[at + i][0] = (float)xy[2 * i];
        blocks->points_mm[at + i][1] = (float)xy[2 * i + 1];
    }
    blocks->kind = BEAM_OUTLINE_BLOCKS;
    blocks->ends[blocks->n_polygons++] = (uint16_t)(at + n);
}

static void add_blocks(struct opening *opening, const struct dicom_item *beam, uint32_t sequence)
{
    size_t n = dicom_n_items(beam, sequence);
    for (size_t i = 0; i < n; i++) {
        const struct dicom_item *item = dicom_item_at(beam, sequence, i);
        char type[17];
        double xy[2 * MOST_BLOCK_POINTS];
        if (!dicom_text(item, BLOCK_TYPE, type, sizeof type) || strcmp(type, "APERTURE") != 0)
            continue;
        size_t n_values = dicom_numbers(item, BLOCK_DATA, xy, 2 * MOST_BLOCK_POINTS), which;
        int64_t n_said;
        if (n_values < 6 || n_values > 2 * MOST_BLOCK_POINTS || n_values % 2) {
            dicom_doubt(opening->doubts, "block data (300A,0106) has %zu values, expected 6 to %d, two a point",
                        n_values, 2 * MOST_BLOCK_POINTS);
            continue;
        }
        if (!are_within(xy, n_values, OPENING_WIDE_MM, &which)) {
            dicom_doubt(opening->doubts, "block data (300A,0106): value %zu is %g mm, expected at most %g", which + 1,
                        xy[which], OPENING_WIDE_MM);
            continue;
        }
        if (dicom_integer(item, BLOCK_N_POINTS, &n_said) && n_said != (int64_t)(n_values / 2))
            dicom_doubt(opening->doubts, "block data (300A,0106) has %zu points, expected the %lld of (300A,0104)",
                        n_values / 2, (long long)n_said);
        add_block(opening, xy, n_values / 2);
        keep_block(opening, xy, n_values / 2);
    }
}

bool opening_init(struct opening *opening, const struct dicom_item *beam, struct error *err)
{
    opening->n_devices = 0;
    opening->blocks.kind = BEAM_OUTLINE_NONE;
    opening->blocks.n_polygons = 0;
    opening->has_lost_blocks = false;
    opening->block_x_mm[0] = opening->block_x_mm[1] = opening->block_y_mm[0] = opening->block_y_mm[1] = NAN;
    opening->block_cm2 = opening->round_mm = NAN;
    static const uint32_t sequences[] = { DEVICE_SEQUENCE, ION_DEVICE_SEQUENCE };
    for (int s = 0; s < 2; s++) {
        size_t n = dicom_n_items(beam, sequences[s]);
        for (size_t i = 0; i < n; i++)
            if (!add_device(opening, dicom_item_at(beam, sequences[s], i), err))
                return false;
    }
    add_blocks(opening, beam, BLOCK_SEQUENCE);
    add_blocks(opening, beam, ION_BLOCK_SEQUENCE);
    const struct dicom_item *applicator = dicom_item_at(beam, APPLICATOR_SEQUENCE, 0);
    const struct dicom_item *geometry = applicator ? dicom_item_at(applicator, APPLICATOR_GEOMETRY, 0) : NULL;
    char shape[17];
    double diameter_mm;
    if (geometry && dicom_text(geometry, APPLICATOR_SHAPE, shape, sizeof shape) && strcmp(shape, "SYM_CIRCULAR") == 0 &&
        dicom_number_within(geometry, APPLICATOR_OPENING, "applicator opening", 1, 2 * OPENING_MOST_MM, &diameter_mm,
                            opening->doubts))
        opening->round_mm = diameter_mm;
    return true;
}

/* Checks the positions of one device at one control point. Returns false, with a doubt, if they cannot be used. */
static bool check_positions(struct opening *opening, const struct opening_device *device, const double *mm, size_t n,
                            size_t number)
{
    size_t which;
    if (n != 2 * device->n_pairs) {
        dicom_doubt(opening->doubts, "control point %zu, %s: leaf/jaw positions (300A,011C) are %zu, expected %zu",
                    number, device->type, n, 2 * device->n_pairs);
        return false;
    }
    if (!are_within(mm, n, OPENING_MOST_MM, &which)) {
        dicom_doubt(opening->doubts,
                    "control point %zu, %s: leaf/jaw position %zu (300A,011C) is %g mm, expected at most %g", number,
                    device->type, which + 1, mm[which], OPENING_MOST_MM);
        return false;
    }
    for (size_t i = 0; i < device->n_pairs; i++)
        if (mm[i] > mm[device->n_pairs + i] + CLOSED_MM)
            dicom_doubt(
                opening->doubts,
                "control point %zu, %s: positions of pair %zu (300A,011C) are %g and %g mm, the first beyond the second",
                number, device->type, i + 1, mm[i], mm[device->n_pairs + i]);
    return true;
}

void opening_move(struct opening *opening, const struct dicom_item *control_point, size_t number)
{
    size_t n = dicom_n_items(control_point, POSITION_SEQUENCE);
    for (size_t i = 0; i < n; i++) {
        const struct dicom_item *item = dicom_item_at(control_point, POSITION_SEQUENCE, i);
        char type[17];
        double positions[2 * OPENING_MAX_LEAVES];
        bool is_known = false;
        dicom_text(item, DEVICE_TYPE, type, sizeof type);
        for (size_t d = 0; d < opening->n_devices; d++) {
            struct opening_device *device = &opening->devices[d];
            if (strcmp(type, device->type) != 0)
                continue;
            is_known = true;
            size_t n_values = dicom_numbers(item, LEAF_POSITIONS, positions, 2 * OPENING_MAX_LEAVES);
            if (!check_positions(opening, device, positions, n_values, number))
                continue;
            memcpy(device->positions_mm, positions, n_values * sizeof *positions);
            device->is_placed = true;
        }
        if (!is_known)
            dicom_doubt(opening->doubts,
                        "control point %zu: positions of a device \"%s\" (300A,00B8) that the beam does not have",
                        number, type);
    }
}

struct opening_rectangle opening_jaws(const struct opening *opening, bool *has_x, bool *has_y)
{
    struct opening_rectangle jaws = everything();
    *has_x = *has_y = false;
    for (size_t d = 0; d < opening->n_devices; d++) {
        const struct opening_device *device = &opening->devices[d];
        if (opening_is_leaves(device) || !device->is_placed)
            continue;
        bool is_x = opening_moves_along_x(device);
        opening_narrow(is_x ? jaws.x : jaws.y, device->positions_mm[0], device->positions_mm[1]);
        *(is_x ? has_x : has_y) = true;
    }
    return jaws;
}

bool opening_between(const struct opening_device *device, size_t pair, const struct opening_rectangle *jaws,
                     struct opening_rectangle *gap)
{
    bool is_x = opening_moves_along_x(device);
    *gap = *jaws;
    opening_narrow(is_x ? gap->x : gap->y, device->positions_mm[pair], device->positions_mm[device->n_pairs + pair]);
    opening_narrow(is_x ? gap->y : gap->x, device->boundaries_mm[pair], device->boundaries_mm[pair + 1]);
    return gap->x[0] < gap->x[1] && gap->y[0] < gap->y[1];
}

/* The hull and the area of what the leaves leave open inside the jaws. */
static struct opening_rectangle open_between_leaves(const struct opening_device *device,
                                                    const struct opening_rectangle *jaws, double *mm2)
{
    struct opening_rectangle hull = { { INFINITY, -INFINITY }, { INFINITY, -INFINITY } };
    *mm2 = 0;
    for (size_t pair = 0; pair < device->n_pairs; pair++) {
        struct opening_rectangle gap;
        if (!opening_between(device, pair, jaws, &gap))
            continue;
        *mm2 += (gap.x[1] - gap.x[0]) * (gap.y[1] - gap.y[0]);
        hull.x[0] = fmin(hull.x[0], gap.x[0]);
        hull.x[1] = fmax(hull.x[1], gap.x[1]);
        hull.y[0] = fmin(hull.y[0], gap.y[0]);
        hull.y[1] = fmax(hull.y[1], gap.y[1]);
    }
    return hull;
}

/* Stores the current opening. Returns false if it is closed, or if no device states it. */
static bool opening_now(const struct opening *opening, struct opening_rectangle *open, double *cm2)
{
    bool has_x, has_y;
    *open = opening_jaws(opening, &has_x, &has_y);
    struct opening_rectangle jaws = *open;
    double least_mm2 = (jaws.x[1] - jaws.x[0]) * (jaws.y[1] - jaws.y[0]);
    for (size_t d = 0; d < opening->n_devices; d++) {
        if (!opening_is_leaves(&opening->devices[d]) || !opening->devices[d].is_placed)
            continue;
        double mm2;
        struct opening_rectangle hull = open_between_leaves(&opening->devices[d], &jaws, &mm2);
        opening_narrow(open->x, hull.x[0], hull.x[1]);
        opening_narrow(open->y, hull.y[0], hull.y[1]);
        least_mm2 = fmin(least_mm2, mm2);
        has_x = has_y = true;
    }
    if (!isnan(opening->block_cm2)) {
        opening_narrow(open->x, opening->block_x_mm[0], opening->block_x_mm[1]);
        opening_narrow(open->y, opening->block_y_mm[0], opening->block_y_mm[1]);
        least_mm2 = fmin(least_mm2, opening->block_cm2 * 100);
        has_x = has_y = true;
    }
    *cm2 = least_mm2 / 100;
    return has_x && has_y && open->x[0] < open->x[1] && open->y[0] < open->y[1];
}

void opening_measure(const struct opening *opening, bool is_first, struct beam_delivery *delivery)
{
    struct opening_rectangle open;
    double cm2;
    bool is_open = opening_now(opening, &open, &cm2);
    if (is_open) {
        widen(delivery->opening_x_mm, open.x);
        widen(delivery->opening_y_mm, open.y);
    }
    if (!is_first)
        return;
    bool has_x, has_y;
    struct opening_rectangle jaws = opening_jaws(opening, &has_x, &has_y);
    if (has_x)
        memcpy(delivery->jaws_x_mm, jaws.x, sizeof jaws.x);
    if (has_y)
        memcpy(delivery->jaws_y_mm, jaws.y, sizeof jaws.y);
    if (is_open)
        delivery->opening_cm2 = cm2;
}

double opening_diameter_mm(const struct opening *opening, const struct beam_delivery *delivery)
{
    double least_mm = INFINITY;
    const double *sides[] = { delivery->opening_x_mm, delivery->opening_y_mm };
    for (int i = 0; i < 2; i++)
        if (!isnan(sides[i][0]))
            least_mm = fmin(least_mm, sides[i][1] - sides[i][0]);
    return least_mm >= opening->round_mm * (1 - ROUND_SHARE) ? opening->round_mm : NAN;
}

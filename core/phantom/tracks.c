/* Makes the phantom's particle tracks by a random walk. */
#include "core/phantom/tracks.h"

#include <stdio.h>
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/phantom/depth_dose.h"
#include "core/phantom/head.h"

/* Made-up values in plausible proportion: mean free paths in soft tissue by energy class (high, medium, low); those of
 * gammas follow from attenuation in water at about 2.2, 1 and 0.5 MeV. */
static const double neutron_path_mm[3] = { 35, 18, 10 };
static const double gamma_path_mm[3] = { 210, 140, 100 };
static const double capture_chance = 0.20;                /* of a low-energy neutron, per collision */
static const double slow_down_chance[2] = { 0.55, 0.35 }; /* high to medium, medium to low, per collision */
static const double beyond_head_mm = 40;                  /* length drawn outside the head for particles that leave */
static const double lost_mm = 10;
enum { MAX_COLLISIONS = 40, HIGH = 0, MEDIUM = 1, LOW = 2 };

struct walk {
    uint64_t seed, n_drawn;
    struct track_segment *segments;
    size_t n_segments, n_limit;
};

static double draw(struct walk *walk) /* uniform, above 0, at most 1 */
{
    return ((double)(phantom_mix(walk->seed + walk->n_drawn++) >> 11) + 1) / 9007199254740992.0; /* 2^53 */
}

static double draw_path(struct walk *walk, double mean_mm)
{
    return -log(draw(walk)) * mean_mm;
}

static struct vec3 draw_direction(struct walk *walk)
{
    double z = 2 * draw(walk) - 1, angle = 2 * MATH_PI * draw(walk), r = sqrt(fmax(1 - z * z, 0));
    return vec3(r * cos(angle), r * sin(angle), z);
}

/* false when the segments are full */
static bool add_segment(struct walk *walk, struct vec3 from, struct vec3 to, enum track_class class)
{
    if (walk->n_segments >= walk->n_limit)
        return false;
    walk->segments[walk->n_segments++] = (struct track_segment){
        { (float)from.x, (float)from.y, (float)from.z }, { (float)to.x, (float)to.y, (float)to.z }, (uint8_t) class, NAN
    };
    return true;
}

static bool is_in_head(struct vec3 p)
{
    return phantom_label_at(p) != PHANTOM_AIR;
}

/* One free flight; moves *at. Returns false when the particle has left the head or the segments are full. */
static bool fly(struct walk *walk, struct vec3 *at, struct vec3 direction, double path_mm, int class)
{
    struct vec3 to = vec3_add(*at, vec3_scale(direction, path_mm));
    bool stays = is_in_head(to);
    if (!stays) { /* draw to a little beyond the surface; bisection finds it, because the head is convex */
        double inside_mm = 0, outside_mm = path_mm;
        for (int i = 0; i < 30; i++) {
            double middle_mm = (inside_mm + outside_mm) / 2;
            *(is_in_head(vec3_add(*at, vec3_scale(direction, middle_mm))) ? &inside_mm : &outside_mm) = middle_mm;
        }
        to = vec3_add(*at, vec3_scale(direction, outside_mm + beyond_head_mm));
    }
    bool has_room = add_segment(walk, *at, to, (enum track_class) class);
    *at = to;
    return stays && has_room;
}

static void walk_gamma(struct walk *walk, struct vec3 at, int energy)
{
    for (int i = 0; i < MAX_COLLISIONS; i++) {
        if (!fly(walk, &at, draw_direction(walk), draw_path(walk, gamma_path_mm[energy]), TRACK_GAMMA_HIGH + energy))
            return;
        if (energy == LOW && draw(walk) < 0.5)
            return; /* absorbed */
        energy += energy < LOW;
    }
}

static void walk_neutron(struct walk *walk, int energy)
{
    double radius_mm = phantom_beam_radius_mm * sqrt(draw(walk)), angle = 2 * MATH_PI * draw(walk);
    struct vec3 start = vec3(radius_mm * cos(angle), radius_mm * sin(angle), phantom_source_z_lps_mm);
    struct vec3 at = start;
    double top_mm = phantom_scalp_top_mm(at.x, at.y); /* the bottom is the negative of the top: the head is symmetric */
    at.z = fmax(top_mm - draw_path(walk, neutron_path_mm[energy]), -top_mm - beyond_head_mm);
    if (!add_segment(walk, start, at, (enum track_class)(TRACK_NEUTRON_HIGH + energy)) || !is_in_head(at))
        return;
    struct vec3 direction = vec3(0, 0, -1);
    for (int i = 0; i < MAX_COLLISIONS; i++) {
        if (energy == LOW && draw(walk) < capture_chance) {
            walk_gamma(walk, at, draw(walk) < 0.6 ? HIGH : MEDIUM); /* 2.2 MeV from hydrogen, or 0.48 MeV from boron */
            return;
        }
        if (energy < LOW && draw(walk) < slow_down_chance[energy])
            energy++;
        /* the higher the energy, the more of the direction is kept */
        double keep = energy == HIGH ? 1.5 : energy == MEDIUM ? 0.6 : 0.1;
        direction = vec3_normalize(vec3_add(vec3_scale(direction, keep), draw_direction(walk)));
        if (!fly(walk, &at, direction, draw_path(walk, neutron_path_mm[energy]), TRACK_NEUTRON_HIGH + energy))
            return;
    }
}

/* A short segment outward from a point of the scalp. */
static void add_lost(struct walk *walk)
{
    struct vec3 unit = draw_direction(walk), axes = phantom_tissues[PHANTOM_SCALP].shape.semi_axes_mm;
    struct vec3 at = vec3(unit.x * axes.x, unit.y * axes.y, unit.z * axes.z);
    struct vec3 outward = vec3_normalize(vec3(unit.x / axes.x, unit.y / axes.y, unit.z / axes.z));
    add_segment(walk, at, vec3_add(at, vec3_scale(outward, lost_mm)), TRACK_LOST);
}

size_t phantom_make_tracks(uint64_t seed, struct track_segment segments[PHANTOM_MAX_TRACKS])
{
    struct walk walk = { phantom_mix(seed ^ 0x747261636b73u), 0, segments, 0, PHANTOM_MAX_TRACKS - PHANTOM_N_LOST };
    add_segment(&walk, vec3(0, 0, phantom_source_z_lps_mm), phantom_tissues[PHANTOM_BRAIN].shape.centre_lps_mm,
                TRACK_BEAM_LINE);
    /* the paper's beam is 1 % fast, 89 % epithermal, 10 % thermal; fast ones are made more often, to be visible */
    for (int history = 0; walk.n_segments < walk.n_limit; history++)
        walk_neutron(&walk, history % 10 == 0 ? LOW : history % 5 == 2 ? HIGH : MEDIUM);
    walk.n_limit = PHANTOM_MAX_TRACKS;
    for (int i = 0; i < PHANTOM_N_LOST; i++)
        add_lost(&walk);
    return walk.n_segments;
}

char *phantom_tracks_text(const struct track_segment *segments, size_t n_segments, size_t *n_bytes, struct error *err)
{
    static const struct {
        int type, energy;
    } codes[TRACK_N_CLASSES] = {
        [TRACK_NEUTRON_HIGH] = { 0, 1 }, [TRACK_NEUTRON_MEDIUM] = { 0, 2 }, [TRACK_NEUTRON_LOW] = { 0, 3 },
        [TRACK_GAMMA_HIGH] = { 1, 1 },   [TRACK_GAMMA_MEDIUM] = { 1, 2 },   [TRACK_GAMMA_LOW] = { 1, 3 },
        [TRACK_LOST] = { 3, 0 },         [TRACK_BEAM_LINE] = { 2, 0 },
    };
    static const char head[] = "# made up, no transport: from RL PA IS, to RL PA IS in mm, type, energy\n"
                               "# type    0 neutron  1 gamma  2 beam line  3 lost\n"
                               "# energy  1 high  2 medium  3 low (gammas too)  0 none\n";
    enum { LINE_BYTES = 80 };
    size_t n_room = sizeof head + n_segments * LINE_BYTES;
    char *text = mem_array(n_room, 1, (uint64_t)TRACK_MAX_SEGMENTS * LINE_BYTES, err);
    if (!text)
        return NULL;
    size_t at = (size_t)snprintf(text, n_room, "%s", head);
    for (size_t i = 0; i < n_segments; i++) {
        const float *a = segments[i].from_lps_mm, *b = segments[i].to_lps_mm;
        uint8_t class = segments[i].class;
        int n = snprintf(text + at, n_room - at, "%9.4f %9.4f %9.4f %9.4f %9.4f %9.4f%3d%3d\n", (double)a[0],
                         0 - (double)a[1], (double)a[2], (double)b[0], 0 - (double)b[1], (double)b[2],
                         codes[class].type, codes[class].energy);
        at += (size_t)n;
    }
    *n_bytes = at;
    return text;
}

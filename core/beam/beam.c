/* Patient positions, and the rotation from gantry coordinates to patient axes. */
#include "core/beam/beam.h"

#include <string.h>

static const char *const position_words[] = { "", "HFS", "HFP", "FFS", "FFP", "HFDR", "HFDL", "FFDR", "FFDL" };
enum { N_POSITIONS = sizeof position_words / sizeof position_words[0] };

const char *patient_position_word(enum patient_position position)
{
    return position_words[position];
}

bool patient_position_from_word(const char *word, enum patient_position *position)
{
    for (int i = 1; i < N_POSITIONS; i++)
        if (strcmp(word, position_words[i]) == 0) {
            *position = (enum patient_position)i;
            return true;
        }
    return false;
}

static const char *const outline_words[] = { "", "jaws", "leaves", "blocks" };

const char *beam_outline_word(enum beam_outline_kind kind)
{
    return outline_words[kind];
}

bool beam_outline_kind_from_word(const char *word, enum beam_outline_kind *kind)
{
    for (int i = 1; i <= BEAM_OUTLINE_BLOCKS; i++)
        if (strcmp(word, outline_words[i]) == 0) {
            *kind = (enum beam_outline_kind)i;
            return true;
        }
    return false;
}

static double cosine(double deg)
{
    return cos(deg * MATH_PI / 180);
}

static double sine(double deg)
{
    return sin(deg * MATH_PI / 180);
}

/* Rotates by the right-hand rule. */
static struct vec3 about_x(struct vec3 p, double deg)
{
    return vec3(p.x, p.y * cosine(deg) - p.z * sine(deg), p.y * sine(deg) + p.z * cosine(deg));
}

static struct vec3 about_y(struct vec3 p, double deg)
{
    return vec3(p.x * cosine(deg) + p.z * sine(deg), p.y, p.z * cosine(deg) - p.x * sine(deg));
}

static struct vec3 about_z(struct vec3 p, double deg)
{
    return vec3(p.x * cosine(deg) - p.y * sine(deg), p.x * sine(deg) + p.y * cosine(deg), p.z);
}

/* Directions of the patient's left, back and head in table coordinates: +x to the right of a person at the foot of the
 * table who looks to the gantry, +y to the gantry, +z up. Always left = head x front. */
static void patient_axes(enum patient_position position, struct vec3 *left, struct vec3 *back, struct vec3 *head)
{
    bool is_feet_first =
        position == PATIENT_FFS || position == PATIENT_FFP || position == PATIENT_FFDR || position == PATIENT_FFDL;
    *head = vec3(0, is_feet_first ? -1 : 1, 0);
    switch (position) {
    case PATIENT_HFP:
    case PATIENT_FFP: *back = vec3(0, 0, 1); break;
    case PATIENT_HFDR: /* lying on the right side, the front is to the left of that person */
    case PATIENT_FFDL: *back = vec3(1, 0, 0); break;
    case PATIENT_HFDL:
    case PATIENT_FFDR: *back = vec3(-1, 0, 0); break;
    default: *back = vec3(0, 0, -1);
    }
    *left = vec3_cross(*back, *head);
}

struct vec3 beam_patient_from_gantry(struct vec3 point_gantry_mm, const struct beam_angles *angles,
                                     enum patient_position position)
{
    struct vec3 room = about_y(point_gantry_mm, angles->gantry_deg);
    struct vec3 table = about_z(room, -(angles->couch_deg + angles->eccentric_deg));
    struct vec3 top = about_y(about_x(table, -angles->pitch_deg), -angles->roll_deg);
    struct vec3 left, back, head;
    patient_axes(position, &left, &back, &head);
    return vec3(vec3_dot(top, left), vec3_dot(top, back), vec3_dot(top, head));
}

static double whole_turn(double deg)
{
    double turned = fmod(deg, 360);
    return turned < 0 ? turned + 360 : turned;
}

static double turn_between(double a_deg, double b_deg)
{
    double turn = whole_turn(a_deg - b_deg);
    return fmin(turn, 360 - turn);
}

struct beam_angles beam_angles_from_direction(struct vec3 towards_source_lps, enum patient_position position,
                                              const struct beam_angles *near)
{
    struct vec3 left, back, head;
    patient_axes(position, &left, &back, &head);
    /* table coordinates of the gantry's (0, 0, 1): (sin gantry cos couch, -sin gantry sin couch, cos gantry) */
    struct vec3 table =
        vec3_add(vec3_add(vec3_scale(left, towards_source_lps.x), vec3_scale(back, towards_source_lps.y)),
                 vec3_scale(head, towards_source_lps.z));
    double level = hypot(table.x, table.y), gantry = atan2(level, table.z) * 180 / MATH_PI;
    if (level < 1e-9)
        return (struct beam_angles){ .gantry_deg = whole_turn(gantry), .couch_deg = whole_turn(near->couch_deg) };
    double couch = atan2(-table.y, table.x) * 180 / MATH_PI;
    double one = turn_between(gantry, near->gantry_deg) + turn_between(couch, near->couch_deg),
           other = turn_between(-gantry, near->gantry_deg) + turn_between(couch + 180, near->couch_deg);
    if (other < one)
        return (struct beam_angles){ .gantry_deg = whole_turn(-gantry), .couch_deg = whole_turn(couch + 180) };
    return (struct beam_angles){ .gantry_deg = whole_turn(gantry), .couch_deg = whole_turn(couch) };
}

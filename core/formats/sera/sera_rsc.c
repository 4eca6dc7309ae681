/* Reads the preferences of SERA's programs, colour maps and tissue data. */
#include "core/formats/sera/sera_rsc.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/formats/text.h"

enum { MAX_WORDS = 6 };

struct parser {
    struct text text;
    const char *name;
    struct rsc *rsc;
    size_t n_bad, first_bad_line;
    struct error *err;
};

static void note_bad(struct parser *p)
{
    if (p->n_bad++ == 0)
        p->first_bad_line = p->text.line;
}

/* Reads the numbers at the start of a value; returns how many. */
static size_t numbers_of(const char *value, double *out, size_t most)
{
    char copy[TEXT_LINE_SIZE], *rest = NULL;
    size_t n = 0;
    snprintf(copy, sizeof copy, "%s", value);
    for (char *word = strtok_r(copy, " \t,", &rest); word && n < most; word = strtok_r(NULL, " \t,", &rest)) {
        if (!text_number(word, &out[n]))
            break;
        n++;
    }
    return n;
}

/* Scales a colour to 8 bits. most: the largest component value, 65535 for X11 colours. */
static bool get_color(const double v[3], double most, uint8_t rgb[3])
{
    for (int i = 0; i < 3; i++) {
        if (!(v[i] >= 0 && v[i] <= most))
            return false;
        rgb[i] = (uint8_t)(v[i] * 255 / most + 0.5);
    }
    return true;
}

static bool add_body(struct parser *p, const char *name, size_t length, struct rsc_body **body)
{
    struct rsc *rsc = p->rsc;
    char word[REGION_NAME_SIZE];
    if (rsc->n_bodies >= RSC_MAX_BODIES)
        return error_set(p->err, ERROR_LIMIT, "%s: line %zu: more than %d bodies", p->name, p->text.line,
                         RSC_MAX_BODIES);
    *body = &rsc->bodies[rsc->n_bodies++];
    **body = (struct rsc_body){
        .opacity = 1, .boron_ratio = NAN, .cbe_boron = NAN, .rbe_nitrogen = NAN, .rbe_fast = NAN, .rbe_gamma = NAN
    };
    snprintf(word, sizeof word, "%.*s", (int)(length < sizeof word ? length : sizeof word - 1), name);
    text_clean(word, (*body)->name, sizeof(*body)->name);
    return true;
}

static bool set_body_color(struct parser *p, const char *key, size_t length, const char *value)
{
    double v[4] = { 0, 0, 0, 100 };
    uint8_t rgb[3];
    struct rsc_body *body;
    if (numbers_of(value, v, 4) < 3 || !get_color(v, 65535, rgb) || !(v[3] >= 0 && v[3] <= 100)) {
        note_bad(p);
        return true;
    }
    if (!add_body(p, key, length, &body))
        return false;
    memcpy(body->rgb, rgb, sizeof rgb);
    body->has_color = true;
    body->opacity = v[3] / 100;
    return true;
}

static bool add_level(struct parser *p, double percent, const uint8_t rgb[3])
{
    struct rsc *rsc = p->rsc;
    if (!(percent > 0 && percent <= 1000)) {
        note_bad(p);
        return true;
    }
    if (rsc->n_levels >= RSC_MAX_LEVELS)
        return error_set(p->err, ERROR_LIMIT, "%s: line %zu: more than %d contour levels", p->name, p->text.line,
                         RSC_MAX_LEVELS);
    struct rsc_level *level = &rsc->levels[rsc->n_levels++];
    level->percent = percent;
    memcpy(level->rgb, rgb, 3);
    return true;
}

/* The eight colour names of SERA. */
static bool color_from_name(const char *word, uint8_t rgb[3])
{
    static const char *const names[] = { "black", "red", "green", "yellow", "blue", "magenta", "cyan", "white" };
    for (int i = 0; i < 8; i++)
        if (text_equal(word, names[i])) {
            for (int c = 0; c < 3; c++)
                rgb[c] = i >> c & 1 ? 255 : 0;
            return true;
        }
    return false;
}

static bool set_preference(struct parser *p, const char *key, const char *value)
{
    static const char ending[] = "_color";
    double v[4], percent;
    uint8_t rgb[3];
    if (text_equal(key, "contour_level")) {
        if (numbers_of(value, v, 4) == 4 && get_color(v + 1, 65535, rgb))
            return add_level(p, v[0], rgb);
        note_bad(p);
        return true;
    }
    if (text_has_ending(key, ending))
        return set_body_color(p, key, strlen(key) - strlen(ending), value);
    if (text_number(key, &percent) && color_from_name(value, rgb))
        return add_level(p, percent, rgb);
    return true;
}

static bool parse_preferences(struct parser *p)
{
    char line[TEXT_LINE_SIZE], *key, *value;
    while (text_line(&p->text, line))
        if (line[0] && text_split(line, ":", &key, &value) && key[0] && !set_preference(p, key, value))
            return false;
    return p->rsc->n_bodies + p->rsc->n_levels > 0 ||
           error_set(p->err, ERROR_FORMAT, "%s: not one of %zu lines is a body's colour or a contour level", p->name,
                     p->text.line);
}

static bool parse_colors(struct parser *p)
{
    char line[TEXT_LINE_SIZE];
    struct rsc *rsc = p->rsc;
    while (text_line(&p->text, line)) {
        double v[4];
        if (!line[0])
            continue;
        if (rsc->n_colors >= RSC_MAX_COLORS)
            return error_set(p->err, ERROR_LIMIT, "%s: line %zu: more than %d colours", p->name, p->text.line,
                             RSC_MAX_COLORS);
        if (numbers_of(line, v, 4) != 3 || !get_color(v, 255, rsc->colors[rsc->n_colors]))
            return error_set(p->err, ERROR_FORMAT, "%s: line %zu: expected three numbers from 0 to 255", p->name,
                             p->text.line);
        rsc->n_colors++;
    }
    return rsc->n_colors >= 2 ||
           error_set(p->err, ERROR_FORMAT, "%s: %zu colours, a map needs two", p->name, rsc->n_colors);
}

static void set_tissue(struct parser *p, struct rsc_body *body, const char *key, const char *value)
{
    const struct {
        const char *word;
        double *value;
    } tissue[] = { { "tissue_to_blood", &body->boron_ratio },
                   { "boron_CF", &body->cbe_boron },
                   { "nitrogen_RBE", &body->rbe_nitrogen },
                   { "hydrogen_RBE", &body->rbe_fast },
                   { "gamma_RBE", &body->rbe_gamma } };
    double number;
    for (size_t i = 0; i < sizeof tissue / sizeof tissue[0]; i++) {
        if (!text_equal(key, tissue[i].word))
            continue;
        if (text_number(value, &number) && number >= 0 && number <= 1e6)
            *tissue[i].value = number;
        else
            note_bad(p);
    }
}

static bool parse_tissues(struct parser *p)
{
    char line[TEXT_LINE_SIZE], *key, *value;
    struct rsc_body *body = NULL;
    while (text_line(&p->text, line)) {
        if (!line[0] || line[0] == '*' || !text_split(line, ":", &key, &value))
            continue;
        if (text_equal(key, "begin")) {
            if (!add_body(p, value, strlen(value), &body))
                return false;
        } else if (text_equal(key, "end")) {
            body = NULL;
        } else if (body) {
            set_tissue(p, body, key, value);
        }
    }
    return p->rsc->n_bodies > 0 ||
           error_set(p->err, ERROR_FORMAT, "%s: no tissue begins in %zu lines", p->name, p->text.line);
}

bool rsc_parse(const uint8_t *data, size_t size, const char *name, struct rsc *rsc, struct report *report,
               struct error *err)
{
    struct parser p = { .name = name, .rsc = rsc, .err = err };
    *rsc = (struct rsc){ 0 };
    text_start(&p.text, data, size);
    bool is_read = text_has_ending(name, ".cmap")  ? parse_colors(&p)
                   : text_has_ending(name, ".txt") ? parse_tissues(&p)
                                                   : parse_preferences(&p);
    if (!is_read) {
        *rsc = (struct rsc){ 0 };
        return false;
    }
    if (p.n_bad > 0)
        report_add(report, REPORT_WARNING, "header.bad-number", name,
                   "%zu values are not numbers in range, the first in line %zu; ignored.", p.n_bad, p.first_bad_line);
    return true;
}

static char folded(char c)
{
    return c == '-' || c == '_' || c == ' ' ? '-' : c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c;
}

const struct rsc_body *rsc_find(const struct rsc *rsc, const char *name)
{
    for (size_t i = 0; i < rsc->n_bodies; i++) {
        const char *a = rsc->bodies[i].name, *b = name;
        while (*a && folded(*a) == folded(*b)) {
            a++;
            b++;
        }
        if (*a == *b)
            return &rsc->bodies[i];
    }
    return NULL;
}

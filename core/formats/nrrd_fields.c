/* Splits an NRRD header into fields, and their values into words, numbers and vectors. */
#include "core/formats/nrrd_fields.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "core/formats/text.h"

static const char *const nrrd_field_names[NRRD_N_FIELDS] = {
    "type",         "dimension",   "sizes",           "encoding",
    "endian",       "space",       "space dimension", "space directions",
    "space origin", "space units", "spacings",        "kinds",
    "data file",    "line skip",   "byte skip"
};
static const struct {
    const char *name;
    enum nrrd_field field;
} other_names[] = { { "datafile", NRRD_DATA_FILE }, { "lineskip", NRRD_LINE_SKIP }, { "byteskip", NRRD_BYTE_SKIP } };
/* Fields of the format that we do not need. */
static const char *const passed_over[] = { "content",     "number",       "min",         "max",
                                           "old min",     "oldmin",       "old max",     "oldmax",
                                           "thicknesses", "axis mins",    "axismins",    "axis maxs",
                                           "axismaxs",    "centers",      "centerings",  "labels",
                                           "units",       "sample units", "sampleunits", "measurement frame",
                                           "block size",  "blocksize" };

bool nrrd_refuse(const struct nrrd_fields *head, size_t line, enum error_code code, const char *format, ...)
{
    char what[200];
    va_list args;
    va_start(args, format);
    vsnprintf(what, sizeof what, format, args);
    va_end(args);
    return error_set(head->err, code, "%s: line %zu: %s", head->name, line, what);
}

bool nrrd_refuse_value(const struct nrrd_fields *head, enum nrrd_field field, enum error_code code,
                       const char *expected)
{
    const struct nrrd_value *value = &head->values[field];
    char found[44], clean[44];
    if (value->line == 0)
        return error_set(head->err, code, "%s: the header has no \"%s\", expected %s", head->name,
                         nrrd_field_names[field], expected);
    snprintf(found, sizeof found, "%.*s", (int)(value->n < 40 ? value->n : 40), value->at);
    text_clean(found, clean, sizeof clean);
    return nrrd_refuse(head, value->line, code, "%s is \"%s%s\", expected %s", nrrd_field_names[field], clean,
                       value->n > 40 ? "..." : "", expected);
}

/* ---- lines ------------------------------------------------------------------------------------------------------ */

/* Reads the next line without its end; false at the end of the header's bytes. */
static bool next_line(struct nrrd_fields *head, struct nrrd_value *line)
{
    if (head->at >= head->end)
        return false;
    const char *end = memchr(head->at, '\n', (size_t)(head->end - head->at));
    const char *stop = end ? end : head->end;
    head->line++;
    *line = (struct nrrd_value){ head->at, (size_t)(stop - head->at), head->line };
    if (line->n > 0 && line->at[line->n - 1] == '\r')
        line->n--;
    head->at = end ? end + 1 : head->end;
    return true;
}

static bool is_blank(char c)
{
    return c == ' ' || c == '\t';
}

void nrrd_copy(const char *at, size_t n, char *out, size_t size)
{
    n = n < size - 1 ? n : size - 1;
    memcpy(out, at, n);
    out[n] = 0;
}

static bool keep_field(struct nrrd_fields *head, const char *key, const struct nrrd_value *value)
{
    size_t field = 0;
    while (field < NRRD_N_FIELDS && !text_equal(key, nrrd_field_names[field]))
        field++;
    for (size_t i = 0; i < sizeof other_names / sizeof other_names[0]; i++)
        if (text_equal(key, other_names[i].name))
            field = other_names[i].field;
    if (field == NRRD_N_FIELDS) {
        for (size_t i = 0; i < sizeof passed_over / sizeof passed_over[0]; i++)
            if (text_equal(key, passed_over[i]))
                return true;
        char clean[NRRD_WORD_SIZE];
        text_clean(key, clean, sizeof clean);
        report_add(head->report, REPORT_NOTE, "header.unknown-key", head->name,
                   "Line %zu: \"%s\" is not a field that is known; it was "
                   "ignored.",
                   value->line, clean);
        return true;
    }
    if (head->values[field].line != 0)
        return nrrd_refuse(head, value->line, ERROR_FORMAT, "\"%s\" is there twice, first in line %zu",
                           nrrd_field_names[field], head->values[field].line);
    if (value->n >= NRRD_MAX_VALUE)
        return nrrd_refuse(head, value->line, ERROR_LIMIT,
                           "the value of \"%s\" has %zu characters; at most %d are read", nrrd_field_names[field],
                           value->n, NRRD_MAX_VALUE - 1);
    head->values[field] = *value;
    return true;
}

static bool parse_line(struct nrrd_fields *head, const struct nrrd_value *line, struct nrrd_header *header)
{
    const char *colon = memchr(line->at, ':', line->n);
    if (!colon)
        return nrrd_refuse(head, line->line, ERROR_FORMAT, "expected \"field: value\", found a line without a colon");
    struct nrrd_value value = { colon + 1, line->n - (size_t)(colon - line->at) - 1, line->line };
    char key[NRRD_WORD_SIZE];
    nrrd_copy(line->at, (size_t)(colon - line->at), key, sizeof key);
    if (value.n > 0 && *value.at == '=') {
        char text[NRRD_MAX_VALUE];
        nrrd_copy(value.at + 1, value.n - 1, text, sizeof text);
        nrrd_segment_key(header, head->name, line->line, key, text, head->report);
        return true; /* other pairs are free notes of the writing program */
    }
    while (value.n > 0 && is_blank(*value.at)) {
        value.at++;
        value.n--;
    }
    while (value.n > 0 && is_blank(value.at[value.n - 1]))
        value.n--;
    return keep_field(head, key, &value);
}

bool nrrd_fields_read(struct nrrd_fields *head, struct nrrd_header *header, bool is_cut)
{
    struct nrrd_value line;
    if (!next_line(head, &line) || line.n != 8 || memcmp(line.at, "NRRD000", 7) != 0 || line.at[7] < '1' ||
        line.at[7] > '5')
        return error_set(head->err, ERROR_FORMAT, "%s: line 1: expected NRRD0001 to NRRD0005: not a NRRD file",
                         head->name);
    bool has_end = false;
    while (!has_end && next_line(head, &line)) {
        has_end = line.n == 0;
        if (!has_end && *line.at != '#' && !parse_line(head, &line, header))
            return false;
    }
    header->head_bytes = (size_t)(head->at - head->start);
    if (!has_end && is_cut)
        return error_set(head->err, ERROR_LIMIT, "%s: the header does not end within %d bytes", head->name,
                         NRRD_HEAD_BYTES);
    if (!has_end && head->values[NRRD_DATA_FILE].line == 0)
        return nrrd_refuse(head, head->line, ERROR_FORMAT,
                           "the header has no end: expected an empty line and then the voxels, or a \"data file\"");
    return true;
}

/* ---- words and numbers of a value ------------------------------------------------------------------------------- */

void nrrd_next_word(struct nrrd_value *rest, const char *separators, char word[NRRD_WORD_SIZE])
{
    while (rest->n > 0 && strchr(separators, *rest->at)) {
        rest->at++;
        rest->n--;
    }
    size_t n = 0;
    while (n < rest->n && rest->at[n] != 0 && !strchr(separators, rest->at[n]))
        n++;
    nrrd_copy(rest->at, n, word, NRRD_WORD_SIZE);
    rest->at += n;
    rest->n -= n;
}

bool nrrd_next_vector(struct nrrd_value *rest, struct vec3 *vector)
{
    while (rest->n > 0 && is_blank(*rest->at)) {
        rest->at++;
        rest->n--;
    }
    const char *close = rest->n > 0 && *rest->at == '(' ? memchr(rest->at, ')', rest->n) : NULL;
    if (!close)
        return false;
    struct nrrd_value inside = { rest->at + 1, (size_t)(close - rest->at) - 1, rest->line };
    rest->n -= (size_t)(close + 1 - rest->at);
    rest->at = close + 1;
    double v[3];
    char word[NRRD_WORD_SIZE];
    for (int i = 0; i < 3; i++) {
        nrrd_next_word(&inside, ", \t", word);
        if (!text_number(word, &v[i]))
            return false;
    }
    nrrd_next_word(&inside, ", \t", word);
    *vector = vec3(v[0], v[1], v[2]);
    return word[0] == 0;
}

bool nrrd_get_whole(const struct nrrd_fields *head, enum nrrd_field field, double least, double most, int64_t *out)
{
    struct nrrd_value rest = head->values[field];
    char word[NRRD_WORD_SIZE], expected[80];
    double number = 0;
    nrrd_next_word(&rest, " \t", word);
    bool is_number = text_number(word, &number) && rest.n == 0;
    if (!is_number || number < least || number > most || number != (double)(int64_t)number) {
        snprintf(expected, sizeof expected, "a whole number from %.0f to %.0f", least, most);
        return nrrd_refuse_value(head, field, is_number && number > most ? ERROR_LIMIT : ERROR_FORMAT, expected);
    }
    *out = (int64_t)number;
    return true;
}

bool nrrd_value_is(const struct nrrd_fields *head, enum nrrd_field field, const char *word)
{
    const struct nrrd_value *value = &head->values[field];
    char text[NRRD_WORD_SIZE];
    nrrd_copy(value->at, value->line ? value->n : 0, text, sizeof text);
    return value->line != 0 && text_equal(text, word);
}

/* Reads SERA's beam source, .source. */
#include "core/formats/sera/sera_source.h"

#include <string.h>

#include "core/formats/text.h"

struct numbers {
    struct text text;
    char line[TEXT_LINE_SIZE], *at; /* the rest of the line */
    const char *name;
    struct error *err;
};

/* The next line with something in it that is no note to old versions. */
static bool next_line(struct numbers *numbers)
{
    while (text_line(&numbers->text, numbers->line))
        if (numbers->line[0] && strncmp(numbers->line, "@@", 2) != 0) {
            numbers->at = numbers->line;
            return true;
        }
    return error_set(numbers->err, ERROR_FORMAT, "%s: the file ends after line %zu, more numbers expected",
                     numbers->name, numbers->text.line);
}

static char *next_word(struct numbers *numbers)
{
    char *from = numbers->at + strspn(numbers->at, " \t,");
    size_t n = strcspn(from, " \t,");
    numbers->at = from + n + (from[n] != '\0');
    from[n] = '\0';
    return from;
}

/* The next number of this line, or of the following ones. */
static bool next_number(struct numbers *numbers, double low, double high, const char *what, double *value)
{
    char *word = next_word(numbers);
    while (!*word) {
        if (!next_line(numbers))
            return false;
        word = next_word(numbers);
    }
    if (!text_number(word, value))
        return error_set(numbers->err, ERROR_FORMAT, "%s: line %zu: '%.40s' is no number, %s expected", numbers->name,
                         numbers->text.line, word, what);
    if (!(*value >= low && *value <= high))
        return error_set(numbers->err, ERROR_RANGE, "%s: line %zu: %s of %g, %g to %g expected", numbers->name,
                         numbers->text.line, what, *value, low, high);
    return true;
}

static bool next_count(struct numbers *numbers, size_t low, size_t high, const char *what, size_t *count)
{
    double value;
    if (!next_number(numbers, (double)low, (double)high, what, &value))
        return false;
    *count = (size_t)value;
    return true;
}

static bool read_bounds(struct numbers *numbers, struct beam_spectrum *spectrum)
{
    for (size_t i = 0; i <= spectrum->n_groups && spectrum->n_groups > 0; i++) {
        double below = i ? spectrum->bounds_ev[i - 1] : 1e10;
        if (!next_number(numbers, 1e-6, 1e9, "an energy in eV", &spectrum->bounds_ev[i]))
            return false;
        if (!(spectrum->bounds_ev[i] < below))
            return error_set(numbers->err, ERROR_RANGE, "%s: line %zu: energy %g eV does not fall below %g",
                             numbers->name, numbers->text.line, spectrum->bounds_ev[i], below);
    }
    return true;
}

static bool read_shares(struct numbers *numbers, struct beam_spectrum *spectrum)
{
    double sum = 0;
    for (size_t i = 0; i < spectrum->n_groups; i++) {
        if (!next_number(numbers, 0, SOURCE_MAX_PER_CM2, "a group's current", &spectrum->share[i]))
            return false;
        sum += spectrum->share[i];
    }
    return sum > 0 || spectrum->n_groups == 0 || spectrum->per_cm2 <= 0 ||
           error_set(numbers->err, ERROR_RANGE, "%s: line %zu: the groups' currents are all 0", numbers->name,
                     numbers->text.line);
}

static bool read_cuts(struct numbers *numbers, struct beam_spectrum *spectrum, size_t n_cuts)
{
    for (size_t i = 0; i < spectrum->n_groups; i++)
        for (size_t j = 0; j < n_cuts; j++)
            if (!next_number(numbers, 0, j ? spectrum->cuts[i][j - 1] : 1, "a cosine", &spectrum->cuts[i][j]))
                return false;
    return true;
}

static bool read_head(struct numbers *numbers, struct beam_source *source)
{
    double ignored;
    size_t n_sources, n_spectra;
    if (!next_line(numbers) || !next_number(numbers, -SOURCE_MAX_CM, SOURCE_MAX_CM, "a place in cm", &ignored) ||
        !next_number(numbers, -SOURCE_MAX_CM, SOURCE_MAX_CM, "a place in cm", &ignored) ||
        !next_number(numbers, 1e-3, SOURCE_MAX_CM, "the distance to the aperture in cm", &source->to_aperture_cm))
        return false;
    return next_line(numbers) && next_count(numbers, 1, 1, "a number of sources", &n_sources) &&
           next_count(numbers, 1, SOURCE_MAX_GROUPS, "a number of neutron groups", &source->neutrons.n_groups) &&
           next_count(numbers, 0, SOURCE_MAX_GROUPS, "a number of gamma groups", &source->photons.n_groups) &&
           next_count(numbers, 1, 1, "a number of spectra", &n_spectra) &&
           next_count(numbers, 1, SOURCE_MAX_CUTS, "a number of cosines", &source->n_cuts);
}

static bool read_body(struct numbers *numbers, struct beam_source *source)
{
    double number;
    if (!next_line(numbers) || !next_number(numbers, 1, 1, "the source's number", &number) ||
        !next_number(numbers, 1e-30, SOURCE_MAX_PER_CM2, "the neutrons' intensity", &source->neutrons.per_cm2) ||
        !next_number(numbers, 0, SOURCE_MAX_PER_CM2, "the gammas' intensity", &source->photons.per_cm2) ||
        !next_number(numbers, 1e-3, SOURCE_MAX_CM, "the disk's radius in cm", &source->radius_cm))
        return false;
    return next_line(numbers) && read_bounds(numbers, &source->neutrons) && read_bounds(numbers, &source->photons) &&
           read_shares(numbers, &source->neutrons) && read_shares(numbers, &source->photons) &&
           read_cuts(numbers, &source->neutrons, source->n_cuts) &&
           read_cuts(numbers, &source->photons, source->n_cuts);
}

bool sera_source_parse(const uint8_t *data, size_t size, const char *name, struct beam_source *source,
                       struct error *err)
{
    *source = (struct beam_source){ 0 };
    if (size > SERA_SOURCE_MAX_BYTES)
        return error_set(err, ERROR_LIMIT, "%s: %zu bytes, at most %llu expected", name, size,
                         (unsigned long long)SERA_SOURCE_MAX_BYTES);
    struct numbers numbers = { .name = name, .err = err };
    text_start(&numbers.text, data, size);
    if (!next_line(&numbers))
        return false;
    text_clean(numbers.line, source->name, sizeof source->name);
    if (!read_head(&numbers, source) || !read_body(&numbers, source))
        return false;
    if (source->photons.n_groups == 0)
        source->photons.per_cm2 = 0;
    return true;
}

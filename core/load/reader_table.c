/* Finds the format of a file. */
#include "core/load/reader_table.h"

#include <stdio.h>
#include <string.h>

#include "core/formats/text.h"
#include "core/load/part_names.h"

const struct part_reader part_absent = { .word = "a file that is not there" };
const struct part_reader part_unknown = { .word = "an unknown format" };

#define PART_READER_ADDRESS(reader) &reader,
static const struct part_reader *const readers[] = { PART_READERS(PART_READER_ADDRESS) };
enum { N_READERS = sizeof readers / sizeof readers[0] };

static bool has_name(const char *const *names, const char *name)
{
    for (; names && *names; names++)
        if (**names == '.' ? text_has_ending(name, *names) : text_equal(part_base_name(name), *names))
            return true;
    return false;
}

const struct part_reader *part_reader_ask(const struct folder *folder, const char *name, struct error *err)
{
    enum folder_kind kind = folder_look(folder, name, NULL);
    if (kind == FOLDER_ABSENT)
        return &part_absent;
    if (kind == FOLDER_DIRECTORY)
        return &part_dicom;
    for (size_t i = 0; i < N_READERS; i++)
        if (has_name(readers[i]->names, name))
            return readers[i];
    for (size_t i = 0; i < N_READERS; i++)
        if (readers[i]->looks_like && readers[i]->looks_like(folder, name, err))
            return readers[i];
    for (size_t i = 0; i < N_READERS; i++)
        if (has_name(readers[i]->names_in_doubt, name))
            return readers[i];
    return &part_unknown;
}

const struct part_reader *part_reader_of(const struct folder *folder, const char *name)
{
    return part_reader_ask(folder, name, NULL);
}

bool part_is_sera_dose(const struct part_reader *reader)
{
    return reader->n_doses > 1;
}

static const char *const packings[] = { ".gz", ".sz", ".bz2" };

/* Length of the name without the ending of a packing. */
static size_t unpacked_length(const char *name)
{
    for (size_t i = 0; i < sizeof packings / sizeof packings[0]; i++)
        if (text_has_ending(name, packings[i]))
            return strlen(name) - strlen(packings[i]);
    return strlen(name);
}

/* Length of the longest ending, of those without a packing, that the text has; 0: none. */
static size_t ending_length(const char *const *names, const char *text)
{
    size_t longest = 0;
    for (; names && *names; names++) {
        size_t length = strlen(*names);
        if (**names == '.' && length > longest && unpacked_length(*names) == length && text_has_ending(text, *names))
            longest = length;
    }
    return longest;
}

int part_stem_length(const char *base)
{
    static const char *const others[] = { ".uv", ".cdf", ".cmf", ".json", ".ima", ".csv", NULL };
    char stem[FOLDER_NAME_SIZE];
    snprintf(stem, sizeof stem, "%s", base);
    stem[unpacked_length(stem)] = 0;
    size_t longest = ending_length(others, stem);
    for (size_t i = 0; i < N_READERS; i++) {
        size_t of_names = ending_length(readers[i]->names, stem);
        size_t in_doubt = ending_length(readers[i]->names_in_doubt, stem);
        longest = of_names > longest ? of_names : longest;
        longest = in_doubt > longest ? in_doubt : longest;
    }
    return (int)(strlen(stem) - longest);
}

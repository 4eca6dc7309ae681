#pragma once
/* Reads the lines, keys and numbers of SERA's text files, within bounds; understands Fortran's numbers. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { TEXT_LINE_SIZE = 513, TEXT_MAX_LINES = 200000 };

struct text {
    const char *at, *end;
    size_t line;       /* number of the line read last, from 1 */
    size_t most_lines; /* reading ends after this line; text_start sets TEXT_MAX_LINES */
};

void text_start(struct text *text, const uint8_t *data, size_t size);
/* Reads the next line without its end, its comment (from '#' on) and outer blanks; cut at TEXT_LINE_SIZE - 1. Returns
 * false at the end of the text. */
bool text_line(struct text *text, char line[TEXT_LINE_SIZE]);
/* Splits "key separator value" at the first separator, in place, and removes blanks and quotes around the value.
 * Returns false when there is no separator. */
bool text_split(char *line, const char *separator, char **key, char **value);
/* Reads a whole word as a number: "1.5", ".5E+00", "1.0D-3", "1.0-101" (Fortran drops the E). Returns false for
 * anything else, also for not-a-number and infinity. */
bool text_number(const char *word, double *value);
bool text_equal(const char *a, const char *b); /* ignores the case of ASCII letters */
/* True if the name ends so, in any case: text_has_ending("A.NII.GZ", ".nii.gz"). */
bool text_has_ending(const char *name, const char *ending);
/* Copies a string; bytes that are not valid UTF-8, and control characters, become '?'. out is cut at size. */
void text_clean(const char *in, char *out, size_t size);

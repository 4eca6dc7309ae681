#pragma once
/* Reading the line-and-key text files of SERA's time: bounded, tolerant of Fortran's numbers, never past the end. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { TEXT_LINE_SIZE = 513, TEXT_MAX_LINES = 200000 };

struct text {
    const char *at, *end;
    size_t line;       /* number of the line last given, from 1 */
    size_t most_lines; /* reading ends there; text_start gives TEXT_MAX_LINES */
};

void text_start(struct text *text, const uint8_t *data, size_t size);
/* The next line without its end, comment ('#' on) and outer blanks; cut at TEXT_LINE_SIZE - 1. false at the end of the
 * text. */
bool text_line(struct text *text, char line[TEXT_LINE_SIZE]);
/* Splits "key separator value" at the first separator, in place; blanks and quotes around the value are taken off.
 * false when there is no separator. */
bool text_split(char *line, const char *separator, char **key, char **value);
/* A whole word as a number: "1.5", ".5E+00", "1.0D-3", "1.0-101" (Fortran drops the E). false for anything else,
 * not-a-number and infinity included. */
bool text_number(const char *word, double *value);
bool text_equal(const char *a, const char *b); /* ASCII letters of either case are equal */
/* name without its last ending, and lower-case test of that ending: text_has_ending("A.NII.GZ", ".nii.gz"). */
bool text_has_ending(const char *name, const char *ending);
/* The same string when it is valid UTF-8 without control characters; else other bytes become '?'. out is cut at size.
 */
void text_clean(const char *in, char *out, size_t size);

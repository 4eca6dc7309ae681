#pragma once
/* Text on a terminal. Names come from files: control characters, which could steer the terminal, are not printed, and
 * columns are counted in letters, not bytes. Characters that do not show are printed as tags: core/base/invisible.h. */
#include <stdio.h>

/* Prints text with '?' for control characters and broken UTF-8, padded with blanks to at least width letters. */
void text_print(FILE *out, const char *text, int width);
/* Prints the text broken at blanks into lines of at most width letters, each after indent blanks. */
void text_print_wrapped(FILE *out, const char *text, int indent, int width);
/* Prints a whole number with a blank between groups of three digits, right-aligned in width. */
void text_print_count(FILE *out, unsigned long long count, int width);

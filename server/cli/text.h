#pragma once
/* Words on a terminal: names come from files, so nothing that steers a terminal gets through, and columns count
 * letters. */
#include <stdio.h>

/* text, its control characters and broken UTF-8 as '?', padded with blanks to at least width letters */
void text_print(FILE *out, const char *text, int width);
/* Broken at blanks into lines of at most width letters, each after indent blanks. */
void text_print_wrapped(FILE *out, const char *text, int indent, int width);
/* A whole number with blanks between groups of three, right-aligned in width. */
void text_print_count(FILE *out, unsigned long long count, int width);

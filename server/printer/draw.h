#pragma once
/* Draws a paper as PDF. Internal to server/printer. */
#include <stdbool.h>
#include <stddef.h>

#include "server/printer/input.h"
#include "server/wire/json.h"

struct drawing_input {
    const cJSON *paper;
    const unsigned char *pictures[PRINTER_PICTURES]; /* JPEG; NULL: none */
    size_t n_pictures[PRINTER_PICTURES];
    bool is_letter;
};
/* The bytes, for free(), and their number. NULL with a sentence: too many pages or bytes, or Cairo failed. Equal inputs
 * give equal bytes. */
unsigned char *draw_paper(const struct drawing_input *input, size_t *n_bytes, const char **why);

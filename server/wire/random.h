#pragma once
/* Random texts: secrets and ids that nobody can guess. Thread: any. */
#include <stdbool.h>
#include <stddef.h>

#include "core/base/error.h"

enum { RANDOM_MAX_BYTES = 64 };

/* n_bytes random bytes as 2 * n_bytes hexadecimal digits, and a NUL. Aborts when the system gives none: without a
 * random secret anybody could take over a member. */
void random_hex(char *text, size_t n_bytes);
/* n_letters of 32 that are not misread for each other (no i, l, o, 1), and a NUL. False when the system gives none. */
NODISCARD bool random_letters(char *text, size_t n_letters);

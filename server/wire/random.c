/* Random texts from the system's generator. */
#include "server/wire/random.h"

#include <assert.h>
#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/random.h>

static bool fill(uint8_t *bytes, size_t n)
{
    ssize_t n_given;
    assert(n <= RANDOM_MAX_BYTES);
    do
        n_given = getrandom(bytes, n, 0);
    while (n_given < 0 && errno == EINTR);
    return n_given == (ssize_t)n;
}

void random_hex(char *text, size_t n_bytes)
{
    uint8_t bytes[RANDOM_MAX_BYTES];
    if (!fill(bytes, n_bytes))
        abort();
    for (size_t i = 0; i < n_bytes; i++)
        (void)snprintf(text + 2 * i, 3, "%02x", bytes[i]);
}

bool random_letters(char *text, size_t n_letters)
{
    static const char letters[] = "abcdefghjkmnpqrstuvwxyz023456789";
    uint8_t bytes[RANDOM_MAX_BYTES];
    if (!fill(bytes, n_letters))
        return false;
    for (size_t i = 0; i < n_letters; i++)
        text[i] = letters[bytes[i] % 32];
    text[n_letters] = 0;
    return true;
}

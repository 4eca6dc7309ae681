/* Makes and compares secrets. */
#include "server/room/state/secret.h"

#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>

void secret_make(char hex[SECRET_TEXT])
{
    uint8_t bytes[SECRET_BYTES];
    ssize_t n;
    do
        n = getrandom(bytes, sizeof bytes, 0);
    while (n < 0 && errno == EINTR);
    if (n != (ssize_t)sizeof bytes)
        abort(); /* without a random secret anybody could take over the member */
    for (int i = 0; i < SECRET_BYTES; i++)
        (void)snprintf(hex + 2 * i, 3, "%02x", bytes[i]);
}

bool secret_is(const char secret[SECRET_TEXT], const char *given)
{
    if (strlen(given) != SECRET_TEXT - 1)
        return false;
    unsigned char differs = 0;
    for (size_t i = 0; i < SECRET_TEXT - 1; i++)
        differs |= (unsigned char)(given[i] ^ secret[i]);
    return differs == 0;
}

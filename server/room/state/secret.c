/* Makes and compares secrets. */
#include "server/room/state/secret.h"
#include "server/wire/random.h"

#include <string.h>

void secret_make(char hex[SECRET_TEXT])
{
    random_hex(hex, SECRET_BYTES);
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

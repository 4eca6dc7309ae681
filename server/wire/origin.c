/* Compares the Origin of a request with its Host. */
#include "server/wire/origin.h"

#include <stddef.h>
#include <string.h>
#include <strings.h>

bool origin_is_of_host(const char *origin, const char *host, bool is_secure)
{
    static const char *const schemes[] = { "https://", "http://" };
    if (!origin || !host)
        return false;
    for (size_t i = 0; i < (is_secure ? 1 : 2); i++) {
        size_t n = strlen(schemes[i]);
        if (strncasecmp(origin, schemes[i], n) == 0 && origin[n] && strcasecmp(origin + n, host) == 0)
            return true;
    }
    return false;
}

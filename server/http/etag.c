/* Searches a list of entity tags. */
#include "server/http/etag.h"

#include <stddef.h>
#include <string.h>

bool etag_is_listed(const char *list, const char *etag, bool is_weak_allowed)
{
    size_t n_etag = strlen(etag);
    const char *at = list + strspn(list, " \t");
    if (*at == '*')
        return at[1 + strspn(at + 1, " \t")] == 0;
    for (;;) {
        at += strspn(at, " \t,");
        bool is_weak = strncmp(at, "W/", 2) == 0;
        at += is_weak ? 2 : 0;
        const char *end = *at == '"' ? strchr(at + 1, '"') : NULL;
        if (!end) { /* not a tag: skip to the next comma */
            at += strcspn(at, ",");
            if (!*at)
                return false;
            continue;
        }
        size_t n = (size_t)(end + 1 - at);
        if (n == n_etag && memcmp(at, etag, n) == 0 && (is_weak_allowed || !is_weak))
            return true;
        at = end + 1;
    }
}

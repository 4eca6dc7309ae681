#pragma once
/* Lists of entity tags in conditional requests (RFC 9110 13.1). */
#include <stdbool.h>

/* True if list, the value of If-Match or If-None-Match, names etag, a strong tag with its quotes. "*" names every tag.
 * Weak tags, W/"x", match only if is_weak_allowed, as for If-None-Match. Anything else in the list is ignored. */
bool etag_is_listed(const char *list, const char *etag, bool is_weak_allowed);

#pragma once
/* Conditions of requests (RFC 9110 13.1). */
#include <stdbool.h>

/* Whether list, the value of If-Match or If-None-Match, names etag, which is strong and in its quotes: "*" names any, a
 * list names each of its tags. Weak tags, W/"x", count only where weak comparison is allowed, as in If-None-Match. What
 * is no tag names nothing. */
bool etag_is_listed(const char *list, const char *etag, bool is_weak_allowed);

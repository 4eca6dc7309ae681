#pragma once
/* JSON pointers (RFC 6901) to the field a check is at. A chain on the caller's stack: only a refusal makes text of it.
 */
#include <stddef.h>

enum { JSON_POINTER_SIZE = 160 }; /* bytes of the text with the final zero; longer texts are cut */

struct json_pointer {
    const struct json_pointer *outer; /* NULL: this is the whole document */
    const char *name;                 /* of a member; NULL: an element of a list */
    size_t index;                     /* of the element, from 0 */
};

/* "/regions/brain/opacity", "/points/3"; "" is the whole document. ~ and / in names are escaped. */
void json_pointer_write(const struct json_pointer *at, char text[JSON_POINTER_SIZE]);

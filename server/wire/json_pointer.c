/* Text of JSON pointers: json_pointer.h. */
#include "server/wire/json_pointer.h"

#include <stdio.h>
#include <string.h>

static void append(const char *name, char text[JSON_POINTER_SIZE])
{
    size_t used = strlen(text);
    if (used + 1 < JSON_POINTER_SIZE)
        text[used++] = '/';
    for (const char *c = name; *c && used + 2 < JSON_POINTER_SIZE; c++) {
        if (*c == '~' || *c == '/') {
            text[used++] = '~';
            text[used++] = *c == '~' ? '0' : '1';
        } else {
            text[used++] = *c;
        }
    }
    text[used] = 0;
}

void json_pointer_write(const struct json_pointer *at, char text[JSON_POINTER_SIZE])
{
    char index[24];
    if (!at->outer) {
        text[0] = 0;
        return;
    }
    json_pointer_write(at->outer, text);
    (void)snprintf(index, sizeof index, "%zu", at->index);
    append(at->name ? at->name : index, text);
}

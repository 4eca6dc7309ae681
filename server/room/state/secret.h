#pragma once
/* Random words that prove who somebody is: of members and of links. Internal to server/room. */
#include <stdbool.h>

enum { SECRET_BYTES = 16, SECRET_TEXT = 2 * SECRET_BYTES + 1 };

void secret_make(char hex[SECRET_TEXT]);
/* Compares in constant time: the time does not reveal how many digits match. The length is public. */
bool secret_is(const char secret[SECRET_TEXT], const char *given);

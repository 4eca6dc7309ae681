#pragma once
/* SHA-256 of a text or of bytes, as the audit and records name what was decided. Thread: any. */
#include <stddef.h>

enum { DIGEST_TEXT = 65 };

void digest_text(const char *text, char hex[DIGEST_TEXT]); /* 64 lower case hex digits */
void digest_bytes(const void *data, size_t n, char hex[DIGEST_TEXT]);

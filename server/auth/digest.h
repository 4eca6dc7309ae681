#pragma once
/* SHA-256 of a text, as the audit and records name what was decided. Thread: any. */
enum { DIGEST_TEXT = 65 };

void digest_text(const char *text, char hex[DIGEST_TEXT]); /* 64 lower case hex digits */

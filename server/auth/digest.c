/* SHA-256 by libsodium. */
#include "server/auth/digest.h"

#include <sodium.h>
#include <string.h>

void digest_bytes(const void *data, size_t n, char hex[DIGEST_TEXT])
{
    unsigned char bytes[crypto_hash_sha256_BYTES];
    (void)crypto_hash_sha256(bytes, data, n);
    (void)sodium_bin2hex(hex, DIGEST_TEXT, bytes, sizeof bytes);
}

void digest_text(const char *text, char hex[DIGEST_TEXT])
{
    digest_bytes(text, strlen(text), hex);
}

/* SHA-256 by libsodium. */
#include "server/auth/digest.h"

#include <sodium.h>
#include <string.h>

void digest_text(const char *text, char hex[DIGEST_TEXT])
{
    unsigned char bytes[crypto_hash_sha256_BYTES];
    (void)crypto_hash_sha256(bytes, (const unsigned char *)text, strlen(text));
    (void)sodium_bin2hex(hex, DIGEST_TEXT, bytes, sizeof bytes);
}

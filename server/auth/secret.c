/* Hashes of secrets, by libsodium. */
#include "server/auth/secret.h"

#include <sodium.h>
#include <string.h>

void secret_hash(const char *secret, unsigned char hash[SECRET_HASH_BYTES])
{
    (void)crypto_generichash(hash, SECRET_HASH_BYTES, (const unsigned char *)secret, strlen(secret), NULL, 0);
}

bool secret_matches(const char *secret, const unsigned char hash[SECRET_HASH_BYTES])
{
    unsigned char found[SECRET_HASH_BYTES];
    secret_hash(secret, found);
    return sodium_memcmp(found, hash, sizeof found) == 0;
}

#pragma once
/* Secrets of members as hashes: what lies in memory and on disk lets nobody come back as somebody else. A secret is 128
 * random bits, so a plain hash is not searched. Thread: any. */
#include <stdbool.h>

enum { SECRET_HASH_BYTES = 32 };

void secret_hash(const char *secret, unsigned char hash[SECRET_HASH_BYTES]); /* BLAKE2b */
/* In constant time: how long it takes says nothing of the hash. */
bool secret_matches(const char *secret, const unsigned char hash[SECRET_HASH_BYTES]);

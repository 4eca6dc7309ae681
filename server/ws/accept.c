/* SHA-1 (FIPS 180-4) of one short text: libsodium, which writes it as base64, does not have that hash. */
#include "server/ws/accept.h"

#include <assert.h>
#include <sodium.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

enum { N_HASH = 20, N_BLOCK = 64, N_TEXT = 2 * N_BLOCK - 9 /* in two blocks */ };

static uint32_t rotate(uint32_t word, int n)
{
    return word << n | word >> (32 - n);
}

static void add_block(uint32_t hash[5], const uint8_t bytes[N_BLOCK])
{
    uint32_t words[80], a = hash[0], b = hash[1], c = hash[2], d = hash[3], e = hash[4];
    for (int i = 0; i < 16; i++)
        words[i] = (uint32_t)bytes[4 * i] << 24 | (uint32_t)bytes[4 * i + 1] << 16 | (uint32_t)bytes[4 * i + 2] << 8 |
                   bytes[4 * i + 3];
    for (int i = 16; i < 80; i++)
        words[i] = rotate(words[i - 3] ^ words[i - 8] ^ words[i - 14] ^ words[i - 16], 1);
    for (int i = 0; i < 80; i++) {
        uint32_t mixed = i < 20   ? ((b & c) | (~b & d)) + 0x5a827999
                         : i < 40 ? (b ^ c ^ d) + 0x6ed9eba1
                         : i < 60 ? ((b & c) | (b & d) | (c & d)) + 0x8f1bbcdc
                                  : (b ^ c ^ d) + 0xca62c1d6;
        mixed += rotate(a, 5) + e + words[i];
        e = d;
        d = c;
        c = rotate(b, 30);
        b = a;
        a = mixed;
    }
    hash[0] += a;
    hash[1] += b;
    hash[2] += c;
    hash[3] += d;
    hash[4] += e;
}

/* text: 56 to N_TEXT characters, which with their length fill two blocks. */
static void sha1(const char *text, uint8_t out[N_HASH])
{
    uint32_t hash[5] = { 0x67452301, 0xefcdab89, 0x98badcfe, 0x10325476, 0xc3d2e1f0 };
    uint8_t blocks[2 * N_BLOCK] = { 0 };
    size_t n = strlen(text);
    memcpy(blocks, text, n);
    blocks[n] = 0x80;
    blocks[2 * N_BLOCK - 2] = (uint8_t)(n * 8 >> 8); /* the length in bits */
    blocks[2 * N_BLOCK - 1] = (uint8_t)(n * 8);
    add_block(hash, blocks);
    add_block(hash, blocks + N_BLOCK);
    for (int i = 0; i < N_HASH; i++)
        out[i] = (uint8_t)(hash[i / 4] >> (24 - 8 * (i % 4)));
}

void ws_accept_of(const char *key, char accept[WS_ACCEPT_SIZE])
{
    char text[N_TEXT + 1];
    uint8_t hash[N_HASH];
    assert(strlen(key) == WS_KEY_CHARACTERS);
    (void)snprintf(text, sizeof text, "%s258EAFA5-E914-47DA-95CA-C5AB0DC85B11", key);
    sha1(text, hash);
    (void)sodium_bin2base64(accept, WS_ACCEPT_SIZE, hash, sizeof hash, sodium_base64_VARIANT_ORIGINAL);
}

/* A table of hashes of user and address, open to eight places for each. */
#include "server/auth/throttle.h"

#include <arpa/inet.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"

enum { KEY_BYTES = 16, WAYS = 8 };

struct entry {
    unsigned char key[KEY_BYTES];
    int n_failed; /* 0: the place is free */
    int64_t failed_ms, until_ms;
};

struct throttle {
    unsigned char secret[crypto_generichash_KEYBYTES]; /* so that nobody chooses who shares a place */
    struct entry entries[THROTTLE_PLACES];
};

struct throttle *throttle_create(void)
{
    struct throttle *throttle = mem_array(1, sizeof *throttle, 1 << 20, NULL);
    if (throttle)
        randombytes_buf(throttle->secret, sizeof throttle->secret);
    return throttle;
}

void throttle_destroy(struct throttle *throttle)
{
    free(throttle);
}

/* One IPv6 address stands for its network, whose other addresses the same machine may take. */
static size_t network_of(const char *address, unsigned char bytes[64])
{
    struct in6_addr v6;
    if (inet_pton(AF_INET6, address, &v6) == 1) {
        memcpy(bytes, v6.s6_addr, 8);
        return 8;
    }
    const size_t n = strnlen(address, 63);
    memcpy(bytes, address, n);
    return n;
}

static void make_key(const struct throttle *throttle, const char *user, const char *address,
                     unsigned char key[KEY_BYTES])
{
    crypto_generichash_state state;
    unsigned char network[64];
    const size_t n = network_of(address, network);
    (void)crypto_generichash_init(&state, throttle->secret, sizeof throttle->secret, KEY_BYTES);
    (void)crypto_generichash_update(&state, (const unsigned char *)user, strlen(user) + 1);
    (void)crypto_generichash_update(&state, network, n);
    (void)crypto_generichash_final(&state, key, KEY_BYTES);
}

static bool is_forgotten(const struct entry *entry, int64_t now_ms)
{
    const int64_t last_ms = entry->until_ms > entry->failed_ms ? entry->until_ms : entry->failed_ms;
    return now_ms > last_ms + THROTTLE_FORGET_MS || now_ms < entry->failed_ms - THROTTLE_FORGET_MS;
}

/* The entry of the key; NULL: it has none. *free_place: where one may begin. */
static struct entry *find(struct throttle *throttle, const unsigned char key[KEY_BYTES], int64_t now_ms,
                          struct entry **free_place)
{
    const size_t first = ((size_t)key[0] << 8 | key[1]) % (THROTTLE_PLACES / WAYS) * WAYS;
    *free_place = &throttle->entries[first];
    for (size_t i = first; i < first + WAYS; i++) {
        struct entry *entry = &throttle->entries[i];
        if (entry->n_failed && is_forgotten(entry, now_ms))
            *entry = (struct entry){ 0 };
        if (entry->n_failed && memcmp(entry->key, key, KEY_BYTES) == 0)
            return entry;
        if ((*free_place)->n_failed && (!entry->n_failed || entry->failed_ms < (*free_place)->failed_ms))
            *free_place = entry;
    }
    return NULL;
}

static int64_t pause_after(int n_failed)
{
    int64_t pause_ms = THROTTLE_FIRST_MS;
    for (int i = THROTTLE_TRIES; i < n_failed && pause_ms < THROTTLE_MOST_MS; i++)
        pause_ms *= 2;
    return pause_ms < THROTTLE_MOST_MS ? pause_ms : THROTTLE_MOST_MS;
}

static struct throttle_state state_of(const struct entry *entry, int64_t now_ms)
{
    const int n_failed = entry ? entry->n_failed : 0;
    const int n_next = n_failed < THROTTLE_TRIES ? THROTTLE_TRIES : n_failed + 1;
    struct throttle_state state = { .tries_left = n_failed < THROTTLE_TRIES ? THROTTLE_TRIES - n_failed : 1,
                                    .pause_ms = pause_after(n_next) };
    if (entry && entry->until_ms > now_ms) {
        state.waits_ms = entry->until_ms - now_ms;
        state.tries_left = 0;
    }
    return state;
}

struct throttle_state throttle_look(struct throttle *throttle, const char *user, const char *address, int64_t now_ms)
{
    unsigned char key[KEY_BYTES];
    struct entry *free_place;
    make_key(throttle, user, address, key);
    return state_of(find(throttle, key, now_ms, &free_place), now_ms);
}

struct throttle_state throttle_fail(struct throttle *throttle, const char *user, const char *address, int64_t now_ms)
{
    unsigned char key[KEY_BYTES];
    struct entry *free_place;
    make_key(throttle, user, address, key);
    struct entry *entry = find(throttle, key, now_ms, &free_place);
    if (!entry) {
        entry = free_place;
        *entry = (struct entry){ 0 };
        memcpy(entry->key, key, KEY_BYTES);
    }
    entry->n_failed++;
    entry->failed_ms = now_ms;
    if (entry->n_failed >= THROTTLE_TRIES)
        entry->until_ms = now_ms + pause_after(entry->n_failed);
    return state_of(entry, now_ms);
}

void throttle_forget(struct throttle *throttle, const char *user, const char *address, int64_t now_ms)
{
    unsigned char key[KEY_BYTES];
    struct entry *free_place;
    make_key(throttle, user, address, key);
    struct entry *entry = find(throttle, key, now_ms, &free_place);
    if (entry)
        *entry = (struct entry){ 0 };
}

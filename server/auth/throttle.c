/* A table of hashes of user and address, or of a network alone, open to eight places for each. */
#include "server/auth/throttle.h"

#include <arpa/inet.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"

enum { KEY_BYTES = 16, WAYS = 8, HOUR_MS = 60 * 60 * 1000 };

struct entry {
    unsigned char key[KEY_BYTES];
    int n_failed; /* 0: the place is free */
    int64_t failed_ms, until_ms;
    int64_t leaked_ms; /* of a network: up to when failures were forgotten */
    int64_t recent_ms; /* of a network: begin of the time in which n_recent failed */
    int n_recent;
};

struct throttle {
    unsigned char secret[crypto_generichash_KEYBYTES]; /* so that nobody chooses who shares a place */
    struct entry entries[THROTTLE_PLACES];
    unsigned char waiting[THROTTLE_WAITING][KEY_BYTES]; /* networks whose passwords wait */
    size_t n_waiting;
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
    const unsigned char kind = user ? 1 : 0;
    const size_t n = network_of(address, network);
    (void)crypto_generichash_init(&state, throttle->secret, sizeof throttle->secret, KEY_BYTES);
    (void)crypto_generichash_update(&state, &kind, 1);
    if (user)
        (void)crypto_generichash_update(&state, (const unsigned char *)user, strlen(user) + 1);
    (void)crypto_generichash_update(&state, network, n);
    (void)crypto_generichash_final(&state, key, KEY_BYTES);
}

/* Failures before a pause. */
static int tries_of(const char *user, const char *address)
{
    if (user)
        return THROTTLE_TRIES;
    const bool is_shared = !address[0] || strncmp(address, "127.", 4) == 0 || strcmp(address, "::1") == 0;
    return is_shared ? THROTTLE_SHARED_TRIES : THROTTLE_NETWORK_TRIES;
}

static int64_t last_of(const struct entry *entry)
{
    return entry->until_ms > entry->failed_ms ? entry->until_ms : entry->failed_ms;
}

static bool is_forgotten(const struct entry *entry, int64_t now_ms)
{
    return now_ms > last_of(entry) + THROTTLE_FORGET_MS || now_ms < entry->failed_ms - THROTTLE_FORGET_MS;
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
        if ((*free_place)->n_failed && (!entry->n_failed || last_of(entry) < last_of(*free_place)))
            *free_place = entry;
    }
    return NULL;
}

/* Forgets failures of a network for the time that has passed. */
static void leak(struct entry *entry, int tries, int64_t now_ms)
{
    const int64_t each_ms = HOUR_MS / tries, n = (now_ms - entry->leaked_ms) / each_ms;
    if (n < 0) /* the clock was set back */
        entry->leaked_ms = now_ms;
    if (n <= 0)
        return;
    entry->n_failed = n < entry->n_failed ? entry->n_failed - (int)n : 0;
    entry->leaked_ms += n * each_ms;
    if (entry->n_failed == 0)
        *entry = (struct entry){ 0 };
}

/* The entry of user and address, or of the network; NULL: there is none. *free_place: where one may begin. */
static struct entry *look(struct throttle *throttle, const char *user, const char *address, int64_t now_ms,
                          unsigned char key[KEY_BYTES], struct entry **free_place)
{
    make_key(throttle, user, address, key);
    struct entry *entry = find(throttle, key, now_ms, free_place);
    if (!entry || user)
        return entry;
    leak(entry, tries_of(user, address), now_ms);
    if (entry->n_failed == 0)
        *free_place = entry;
    return entry->n_failed ? entry : NULL;
}

static int64_t pause_after(int n_failed, int tries)
{
    int64_t pause_ms = THROTTLE_FIRST_MS;
    for (int i = tries; i < n_failed && pause_ms < THROTTLE_MOST_MS; i++)
        pause_ms *= 2;
    return pause_ms < THROTTLE_MOST_MS ? pause_ms : THROTTLE_MOST_MS;
}

static struct throttle_state state_of(const struct entry *entry, int tries, int64_t now_ms)
{
    const int n_failed = entry ? entry->n_failed : 0;
    const int n_next = n_failed < tries ? tries : n_failed + 1;
    struct throttle_state state = { .tries_left = n_failed < tries ? tries - n_failed : 1,
                                    .pause_ms = pause_after(n_next, tries) };
    if (entry && entry->until_ms > now_ms) {
        state.waits_ms = entry->until_ms - now_ms;
        state.tries_left = 0;
    }
    return state;
}

static bool is_recent(const struct entry *entry, int64_t now_ms)
{
    return entry->n_recent && now_ms >= entry->recent_ms && now_ms <= entry->recent_ms + THROTTLE_RECENT_MS;
}

struct throttle_state throttle_look(struct throttle *throttle, const char *user, const char *address, int64_t now_ms)
{
    unsigned char key[KEY_BYTES];
    struct entry *free_place;
    return state_of(look(throttle, user, address, now_ms, key, &free_place), tries_of(user, address), now_ms);
}

struct throttle_state throttle_fail(struct throttle *throttle, const char *user, const char *address, int64_t now_ms)
{
    unsigned char key[KEY_BYTES];
    const int tries = tries_of(user, address);
    struct entry *free_place, *entry = look(throttle, user, address, now_ms, key, &free_place);
    if (!entry) {
        entry = free_place;
        *entry = (struct entry){ .leaked_ms = now_ms };
        memcpy(entry->key, key, KEY_BYTES);
    }
    entry->n_failed++;
    entry->failed_ms = now_ms;
    if (!is_recent(entry, now_ms)) {
        entry->recent_ms = now_ms;
        entry->n_recent = 0;
    }
    entry->n_recent++;
    if (entry->n_failed >= tries)
        entry->until_ms = now_ms + pause_after(entry->n_failed, tries);
    return state_of(entry, tries, now_ms);
}

void throttle_forget(struct throttle *throttle, const char *user, const char *address, int64_t now_ms)
{
    unsigned char key[KEY_BYTES];
    struct entry *free_place, *entry = look(throttle, user, address, now_ms, key, &free_place);
    if (entry)
        *entry = (struct entry){ 0 };
}

/* ---- passwords that wait ---------------------------------------------------------------------------------------- */

bool throttle_enter(struct throttle *throttle, const char *address, int64_t now_ms)
{
    unsigned char key[KEY_BYTES];
    struct entry *free_place;
    const struct entry *entry = look(throttle, NULL, address, now_ms, key, &free_place);
    const bool is_held = tries_of(NULL, address) == THROTTLE_NETWORK_TRIES && entry && is_recent(entry, now_ms) &&
                         entry->n_recent >= THROTTLE_TRIES;
    int n = 0;
    for (size_t i = 0; i < throttle->n_waiting; i++)
        n += memcmp(throttle->waiting[i], key, KEY_BYTES) == 0;
    if (throttle->n_waiting == THROTTLE_WAITING || (is_held && n >= THROTTLE_NETWORK_WAITING))
        return false;
    memcpy(throttle->waiting[throttle->n_waiting++], key, KEY_BYTES);
    return true;
}

void throttle_leave(struct throttle *throttle, const char *address)
{
    unsigned char key[KEY_BYTES];
    make_key(throttle, NULL, address, key);
    for (size_t i = 0; i < throttle->n_waiting; i++)
        if (memcmp(throttle->waiting[i], key, KEY_BYTES) == 0) {
            memmove(throttle->waiting[i], throttle->waiting[--throttle->n_waiting], KEY_BYTES);
            return;
        }
}

#pragma once
/* Slows down the guessing of passwords: after some failures of one user from one address there is a pause, which
 * doubles with each further failure. Users that do not exist are counted as others are, so nothing tells them apart.
 * Not thread-safe. */
#include <stdbool.h>
#include <stdint.h>

enum {
    THROTTLE_TRIES = 5,
    THROTTLE_FIRST_MS = 60 * 1000,
    THROTTLE_MOST_MS = 15 * 60 * 1000,
    THROTTLE_FORGET_MS = 60 * 60 * 1000, /* without a failure or pause */
    THROTTLE_PLACES = 4096               /* pairs that are remembered; the one longest without a failure is forgotten */
};

struct throttle;

struct throttle_state {
    int tries_left;   /* before the next pause */
    int64_t pause_ms; /* that the failure after the last try would begin */
    int64_t waits_ms; /* what is left of a pause; 0: none */
};

struct throttle *throttle_create(void);
void throttle_destroy(struct throttle *throttle);
/* address: an IPv6 address stands for its network of 64 bits. */
struct throttle_state throttle_look(struct throttle *throttle, const char *user, const char *address, int64_t now_ms);
struct throttle_state throttle_fail(struct throttle *throttle, const char *user, const char *address, int64_t now_ms);
void throttle_forget(struct throttle *throttle, const char *user, const char *address, int64_t now_ms);

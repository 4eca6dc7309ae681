#pragma once
/* Slows down the guessing of passwords: after some failures of one user from one address there is a pause, which
 * doubles with each further failure. Users that do not exist are counted as others are, so nothing tells them apart.
 * A network is counted as well, over all names, so that other names do not help: of its failures some are forgotten
 * with time, none for a right password. Loopback, or an address that is not known, may be a proxy's that is not
 * trusted, and so everybody's: it has a larger number, and as many wait as the queue takes.
 * Not thread-safe. */
#include <stdbool.h>
#include <stdint.h>

enum {
    THROTTLE_TRIES = 5,
    THROTTLE_NETWORK_TRIES = 20, /* of a network; as many are forgotten in an hour */
    THROTTLE_SHARED_TRIES = 100, /* likewise, of loopback and where no address is known */
    THROTTLE_FIRST_MS = 60 * 1000,
    THROTTLE_MOST_MS = 15 * 60 * 1000,
    THROTTLE_FORGET_MS = 60 * 60 * 1000, /* without a failure or pause */
    THROTTLE_PLACES = 4096,              /* remembered; the one longest without a failure or pause is forgotten */
    THROTTLE_WAITING = 64,               /* passwords that wait for their check */
    THROTTLE_NETWORK_WAITING = 4,        /* of a network that failed THROTTLE_TRIES times within THROTTLE_RECENT_MS */
    THROTTLE_RECENT_MS = 60 * 1000
};

struct throttle;

struct throttle_state {
    int tries_left;   /* before the next pause */
    int64_t pause_ms; /* that the failure after the last try would begin */
    int64_t waits_ms; /* what is left of a pause; 0: none */
};

struct throttle *throttle_create(void);
void throttle_destroy(struct throttle *throttle);
/* address: an IPv6 address stands for its network of 64 bits. user: NULL is the network, over all names. */
struct throttle_state throttle_look(struct throttle *throttle, const char *user, const char *address, int64_t now_ms);
struct throttle_state throttle_fail(struct throttle *throttle, const char *user, const char *address, int64_t now_ms);
void throttle_forget(struct throttle *throttle, const char *user, const char *address, int64_t now_ms);
/* A password from this address begins to wait. False: as many of its network wait as may, and it does not. */
bool throttle_enter(struct throttle *throttle, const char *address, int64_t now_ms);
void throttle_leave(struct throttle *throttle, const char *address); /* one that entered was checked */

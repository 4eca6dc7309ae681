#pragma once
/* The names of this server. Requests to other names are refused: by DNS rebinding, a page of another site can give its
 * own name this server's address, and would then count as the same origin. Numeric addresses are always accepted,
 * because they cannot be rebound. A server on which nobody signs in may be for its own machine alone: then only names
 * of the loopback are its own. Frozen after hosts_create: any thread. */
#include <stdbool.h>
#include <stddef.h>

struct hosts;

enum { HOSTS_MAX_NAME = 255 };

/* Creates the list of accepted host names. names: further names, without a port; "*" allows any. Always allowed:
 * numeric addresses, localhost, names below it, and the machine's host name. */
struct hosts *hosts_create(const char *const *names, size_t n_names);
/* Creates the list of a server for its own machine alone: 127.0.0.0/8, [::1], localhost and names below it. */
struct hosts *hosts_create_alone(void);
bool hosts_is_alone(const struct hosts *hosts);
void hosts_destroy(struct hosts *hosts);
/* True if the value of a Host header (n bytes, with or without a port) is allowed. */
bool hosts_allow(const struct hosts *hosts, const char *host, size_t n);

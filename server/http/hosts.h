#pragma once
/* What this server is called. A page of another site can give its own name this server's address (DNS rebinding) and
 * would then be of the same origin as ours: its requests carry its name as Host, and are refused. Addresses cannot be
 * given away like that. Frozen after hosts_create: any thread. */
#include <stdbool.h>
#include <stddef.h>

struct hosts;

enum { HOSTS_MAX_NAME = 255 };

/* names: further ones, without a port; "*" allows any. Always allowed: numeric addresses, localhost, names below it,
 * and what the system is called. */
struct hosts *hosts_create(const char *const *names, size_t n_names);
void hosts_destroy(struct hosts *hosts);
/* Whether a Host header's value (n bytes, with or without a port) is one of ours. */
bool hosts_allow(const struct hosts *hosts, const char *host, size_t n);

#pragma once
/* Decides if a page belongs to this server: the one rule for HTTP requests that change something and for WebSockets. */
#include <stdbool.h>

/* True when origin (RFC 6454: "http://name:port") has the scheme http or https and names exactly what the request's
 * Host header names. A proxy in front may speak https where we hear http, so either scheme is the server's own; but
 * https alone is when is_secure: TLS is decrypted here. NULL is no origin: false. */
bool origin_is_of_host(const char *origin, const char *host, bool is_secure);

#pragma once
/* The public port: a listening socket from the text of --listen. */
#include "core/base/error.h"

enum { LISTENER_MAX_URL = 100 };

/* Listens at "127.0.0.1:8080" or "[::1]:0": a numeric address, port 0 lets the system choose. Returns a socket that
 * does not block, and in url where it listens, as in "http://127.0.0.1:8080", or "https:" when is_secure; -1 on
 * failure. errors  ERROR_FORMAT, ERROR_RANGE  the text ERROR_IO  the address cannot be listened at */
NODISCARD int listener_open(const char *listen_at, bool is_secure, char url[LISTENER_MAX_URL], struct error *err);

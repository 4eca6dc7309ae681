#pragma once
/* Which TLS is spoken: versions, ciphers, the protocol inside. */
#include <stdbool.h>

struct ssl_ctx_st; /* SSL_CTX of OpenSSL */

/* TLS 1.2 and 1.3, ciphers with authenticated encryption and forward secrecy alone, HTTP/1.1 inside (ALPN). */
bool policy_set(struct ssl_ctx_st *ssl_ctx);

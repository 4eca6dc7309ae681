/* Versions by RFC 8996 and RFC 9325; ciphers of TLS 1.2 as RFC 9325 4.2 recommends them. All ciphers of TLS 1.3 that
 * OpenSSL offers are of this kind. */
#include "server/tls/policy.h"

#include <openssl/ssl.h>
#include <string.h>

static const char ciphers[] = "ECDHE-ECDSA-AES128-GCM-SHA256:ECDHE-RSA-AES128-GCM-SHA256:ECDHE-ECDSA-AES256-GCM-SHA384:"
                              "ECDHE-RSA-AES256-GCM-SHA384:ECDHE-ECDSA-CHACHA20-POLY1305:ECDHE-RSA-CHACHA20-POLY1305";

/* Chooses http/1.1 from the client's list (RFC 7301 3.1: names, each after its length). */
static int choose_protocol(SSL *ssl, const unsigned char **chosen, unsigned char *n_chosen, const unsigned char *list,
                           unsigned n_list, void *context)
{
    static const unsigned char http[] = "http/1.1";
    (void)ssl;
    (void)context;
    for (unsigned at = 0; at < n_list && list[at] < n_list - at; at += 1u + list[at])
        if (list[at] == sizeof http - 1 && memcmp(list + at + 1, http, sizeof http - 1) == 0) {
            *chosen = list + at + 1;
            *n_chosen = sizeof http - 1;
            return SSL_TLSEXT_ERR_OK;
        }
    return SSL_TLSEXT_ERR_ALERT_FATAL; /* no_application_protocol */
}

bool policy_set(SSL_CTX *ssl_ctx)
{
    (void)SSL_CTX_set_options(ssl_ctx, SSL_OP_NO_RENEGOTIATION | SSL_OP_NO_COMPRESSION);
    (void)SSL_CTX_set_mode(ssl_ctx, SSL_MODE_RELEASE_BUFFERS | SSL_MODE_ENABLE_PARTIAL_WRITE |
                                        SSL_MODE_ACCEPT_MOVING_WRITE_BUFFER);
    (void)SSL_CTX_set_session_cache_mode(ssl_ctx, SSL_SESS_CACHE_OFF); /* sessions are resumed by tickets */
    SSL_CTX_set_alpn_select_cb(ssl_ctx, choose_protocol, NULL);
    return SSL_CTX_set_min_proto_version(ssl_ctx, TLS1_2_VERSION) == 1 && SSL_CTX_set_max_proto_version(ssl_ctx, 0) &&
           SSL_CTX_set_cipher_list(ssl_ctx, ciphers) == 1;
}

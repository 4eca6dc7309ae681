#pragma once
/* A certificate with its private key: read from two PEM files, checked, put to use. Knows nothing of connections. */
#include "core/base/error.h"

enum { CERTIFICATE_MAX_BYTES = 1 << 20, CERTIFICATE_MAX_CHAIN = 16, CERTIFICATE_TEXT = 160 };

struct certificate;
struct ssl_st; /* SSL of OpenSSL */

/* Reads the certificate of the server, with those between it and a root that its clients know after it, and its
 * unencrypted key. Waits for the disk.
 *
 *   errors   the sentence names --tls-cert or --tls-key, the file, what was found and what was expected
 *            ERROR_IO      a file cannot be read
 *            ERROR_LIMIT   a file is too large, or the chain too long
 *            ERROR_FORMAT  no certificate or key; the key is encrypted, of another certificate, or too weak */
NODISCARD struct certificate *certificate_read(const char *cert_file, const char *key_file, struct error *err);
void certificate_destroy(struct certificate *certificate);
/* This connection gets the certificate, also when it is destroyed. False without memory. */
NODISCARD bool certificate_use(const struct certificate *certificate, struct ssl_st *ssl);
/* "beamroom.example, valid until 2027-01-31": its first name and its last day. */
void certificate_describe(const struct certificate *certificate, char text[CERTIFICATE_TEXT]);
/* True if its time has not come, or is over. */
bool certificate_is_out_of_date(const struct certificate *certificate);

#pragma once
/* Network addresses, and the client address that limits on connections count for, also behind trusted proxies. Opens no
 * sockets. */
#include <stddef.h>
#include <stdint.h>

#include "core/base/error.h"

enum { ADDRESS_MAX_RANGES = 64, ADDRESS_COUNTED_BITS = 64, ADDRESS_TEXT = 46 };

struct sockaddr_storage;

/* An IPv6 address; an IPv4 address a.b.c.d is ::ffff:a.b.c.d (RFC 4291 2.5.5.2). */
struct address {
    uint8_t bytes[16];
};

/* The addresses whose first n_bits bits are those of first. */
struct address_range {
    struct address first;
    int n_bits; /* of 128 */
};

/* Reads "192.0.2.1", "192.0.2.1:80", "2001:db8::1" or "[2001:db8::1]:80", n bytes; the port is not kept. */
NODISCARD bool address_read(const char *text, size_t n, struct address *address);
/* Reads ADDRESS or ADDRESS/BITS; BITS are those of the address's own kind: at most 32 or 128. errors ERROR_FORMAT,
 * ERROR_RANGE */
NODISCARD bool address_range_read(const char *text, struct address_range *range, struct error *err);
/* The address of a socket's peer; all zeros for a socket that is not of IP. */
struct address address_of_peer(const struct sockaddr_storage *peer);
/* "192.0.2.1" or "2001:db8::1"; "" for all zeros, a socket that is not of IP. */
void address_write(const struct address *address, char text[ADDRESS_TEXT]);
bool address_is_in(const struct address *address, const struct address_range *ranges, size_t n_ranges);
bool address_is_loopback(const struct address *address); /* 127.0.0.0/8 or ::1 */
bool address_is_equal(const struct address *a, const struct address *b);

/* The address that limits count for: the whole of an IPv4 address, the first 64 bits of an IPv6 address, because a
 * client has all addresses of such a network. */
struct address address_counted(const struct address *address);

/* The client of a request.
 *
 *   peer       the other end of the connection
 *   trusted    proxies whose X-Forwarded-For is believed
 *   forwarded  value of the last X-Forwarded-For, n bytes; addresses parted by commas, the newest last
 *   returns    peer when it is not trusted. Else the newest address in forwarded that is not a trusted proxy's; when
 * all are, the oldest of them. Addresses before an entry that is no address are ignored. */
struct address address_of_client(const struct address *peer, const struct address_range *trusted, size_t n_trusted,
                                 const char *forwarded, size_t n);
/* Likewise for a connection of the proxy at the Unix socket, which has no address and is trusted. */
struct address address_behind_socket(const struct address_range *trusted, size_t n_trusted, const char *forwarded,
                                     size_t n);

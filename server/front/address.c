/* Reads, compares and counts network addresses, and finds the client behind trusted proxies. */
#include "server/front/address.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>

enum { N_MAPPED = 12 }; /* bytes in front of an IPv4 address */
static const uint8_t mapped[N_MAPPED] = { [10] = 0xff, [11] = 0xff };

static bool is_ipv4(const struct address *address)
{
    return memcmp(address->bytes, mapped, N_MAPPED) == 0;
}

static bool read_bare(const char *text, struct address *address)
{
    struct in_addr four;
    if (inet_pton(AF_INET6, text, address->bytes) == 1)
        return true;
    if (inet_pton(AF_INET, text, &four) != 1)
        return false;
    memcpy(address->bytes, mapped, N_MAPPED);
    memcpy(address->bytes + N_MAPPED, &four, sizeof four);
    return true;
}

static bool is_port(const char *text)
{
    size_t n = strspn(text, "0123456789");
    return n > 0 && n <= 5 && text[n] == 0;
}

bool address_read(const char *text, size_t n, struct address *address)
{
    char copy[80];
    if (n == 0 || n >= sizeof copy || memchr(text, 0, n))
        return false;
    memcpy(copy, text, n);
    copy[n] = 0;
    if (copy[0] == '[') {
        char *end = strchr(copy, ']');
        if (!end || (end[1] && (end[1] != ':' || !is_port(end + 2))))
            return false;
        *end = 0;
        return strchr(copy + 1, ':') && read_bare(copy + 1, address);
    }
    char *colon = strchr(copy, ':');
    if (colon && !strchr(colon + 1, ':')) { /* one colon alone: IPv4 and a port */
        if (!is_port(colon + 1))
            return false;
        *colon = 0;
    }
    return read_bare(copy, address);
}

bool address_range_read(const char *text, struct address_range *range, struct error *err)
{
    const char *slash = strchr(text, '/');
    size_t n = slash ? (size_t)(slash - text) : strlen(text);
    char copy[80] = "";
    if (n < sizeof copy)
        memcpy(copy, text, n);
    if (n >= sizeof copy || !read_bare(copy, &range->first))
        return error_set(err, ERROR_FORMAT,
                         "\"%.80s\" is no address; expected ADDRESS or ADDRESS/BITS, as 127.0.0.1 or 2001:db8::/32",
                         text);
    int most = is_ipv4(&range->first) && !strchr(copy, ':') ? 32 : 128;
    range->n_bits = 128;
    if (!slash)
        return true;
    size_t n_digits = strspn(slash + 1, "0123456789");
    int n_bits = n_digits > 0 && n_digits <= 3 && !slash[1 + n_digits] ? (int)strtol(slash + 1, NULL, 10) : -1;
    if (n_bits < 0 || n_bits > most)
        return error_set(err, ERROR_RANGE, "\"%.80s\": expected 0 to %d bits after the slash", text, most);
    range->n_bits = 128 - most + n_bits;
    return true;
}

struct address address_of_peer(const struct sockaddr_storage *peer)
{
    struct address address = { { 0 } };
    if (peer->ss_family == AF_INET6)
        memcpy(address.bytes, &((const struct sockaddr_in6 *)(const void *)peer)->sin6_addr, sizeof address.bytes);
    if (peer->ss_family == AF_INET) {
        memcpy(address.bytes, mapped, N_MAPPED);
        memcpy(address.bytes + N_MAPPED, &((const struct sockaddr_in *)(const void *)peer)->sin_addr, 4);
    }
    return address;
}

void address_write(const struct address *address, char text[ADDRESS_TEXT])
{
    static const struct address none = { { 0 } };
    const bool is_four = is_ipv4(address);
    text[0] = 0;
    if (!address_is_equal(address, &none) &&
        !inet_ntop(is_four ? AF_INET : AF_INET6, address->bytes + (is_four ? N_MAPPED : 0), text, ADDRESS_TEXT))
        text[0] = 0;
}

bool address_is_loopback(const struct address *address)
{
    static const uint8_t six[16] = { [15] = 1 };
    return memcmp(address->bytes, six, sizeof six) == 0 ||
           (memcmp(address->bytes, mapped, N_MAPPED) == 0 && address->bytes[N_MAPPED] == 127);
}

bool address_is_equal(const struct address *a, const struct address *b)
{
    return memcmp(a->bytes, b->bytes, sizeof a->bytes) == 0;
}

static bool has_first_bits(const struct address *address, const struct address_range *range)
{
    size_t n_bytes = (size_t)range->n_bits / 8;
    unsigned n_rest = (unsigned)range->n_bits % 8, mask = 0xffu << (8 - n_rest) & 0xffu;
    return memcmp(address->bytes, range->first.bytes, n_bytes) == 0 &&
           (n_rest == 0 || (address->bytes[n_bytes] & mask) == (range->first.bytes[n_bytes] & mask));
}

bool address_is_in(const struct address *address, const struct address_range *ranges, size_t n_ranges)
{
    for (size_t i = 0; i < n_ranges; i++)
        if (has_first_bits(address, &ranges[i]))
            return true;
    return false;
}

struct address address_counted(const struct address *address)
{
    struct address counted = *address;
    if (!is_ipv4(address))
        memset(counted.bytes + ADDRESS_COUNTED_BITS / 8, 0, sizeof counted.bytes - ADDRESS_COUNTED_BITS / 8);
    return counted;
}

/* The newest address in the list that is not a trusted proxy's; client: what the list was believed of. */
static struct address newest_of(struct address client, const struct address_range *trusted, size_t n_trusted,
                                const char *forwarded, size_t n)
{
    size_t end = n;
    do {
        size_t begin = end, next;
        while (begin > 0 && forwarded[begin - 1] != ',')
            begin--;
        next = begin > 0 ? begin - 1 : 0;
        while (begin < end && (forwarded[begin] == ' ' || forwarded[begin] == '\t'))
            begin++;
        while (end > begin && (forwarded[end - 1] == ' ' || forwarded[end - 1] == '\t'))
            end--;
        if (!address_read(forwarded + begin, end - begin, &client))
            break;
        end = next;
    } while (address_is_in(&client, trusted, n_trusted) && end > 0);
    return client;
}

struct address address_of_client(const struct address *peer, const struct address_range *trusted, size_t n_trusted,
                                 const char *forwarded, size_t n)
{
    return n > 0 && address_is_in(peer, trusted, n_trusted) ? newest_of(*peer, trusted, n_trusted, forwarded, n)
                                                            : *peer;
}

struct address address_behind_socket(const struct address_range *trusted, size_t n_trusted, const char *forwarded,
                                     size_t n)
{
    static const struct address none = { { 0 } };
    return n > 0 ? newest_of(none, trusted, n_trusted, forwarded, n) : none;
}

/* HTTP bodies: the end of a chunked body, which must not depend on how the bytes are split; and the client's address
 * behind a proxy. */
#include "server/front/address.h"
#include "server/front/body.h"
#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    const char *bytes = (const char *)data;
    struct body whole, parts;
    struct problem problem = { 0 };
    size_t n_whole = 0, n_first = 0, n_second = 0, cut = n ? data[n - 1] % n : 0;
    body_begin(&whole, true, 0);
    body_begin(&parts, true, 0);
    bool is_taken = body_take(&whole, bytes, n, &n_whole, &problem);
    REQUIRE(is_taken || strlen(problem.detail) > 20);
    REQUIRE(!is_taken || n_whole == n || body_is_ended(&whole));
    bool are_taken = body_take(&parts, bytes, cut, &n_first, &problem) &&
                     body_take(&parts, bytes + n_first, n - n_first, &n_second, &problem);
    REQUIRE(is_taken == are_taken);
    REQUIRE(!is_taken || (n_first + n_second == n_whole && body_is_ended(&whole) == body_is_ended(&parts)));

    const struct address_range trusted = { .n_bits = 1 }; /* half of all addresses */
    const struct address peer = { { 0 } };
    struct address client = address_of_client(&peer, &trusted, 1, bytes, n);
    REQUIRE(address_is_in(&client, &trusted, 1) || n > 2);
    return 0;
}

/* The head of a connection's first request. A refusal needs a sentence; an incomplete head must be waited for, or be
 * refused like the whole. */
#include "server/front/head.h"
#include "server/wire/fields.h"
#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    static struct hosts *hosts;
    struct problem whole = { 0 }, part = { 0 };
    if (!hosts)
        hosts = hosts_create(NULL, 0);
    struct head_rules rules = { .hosts = hosts, .identity_names = head_identity_names };
    rules.takes_identity = n % 2 == 0;
    struct head_request request;
    enum head_kind kind = head_read((const char *)data, n, &rules, &request, &whole);
    REQUIRE((kind == HEAD_REFUSED) == (whole.type != PROBLEM_NONE));
    REQUIRE(kind != HEAD_REFUSED || strlen(whole.detail) > 20);
    for (const char *byte = whole.detail; *byte; byte++)
        REQUIRE(*byte >= 32 && *byte < 127);
    if (kind == HEAD_WEBSOCKET) {
        const struct handshake *handshake = &request.handshake;
        REQUIRE(handshake->n_head <= n && handshake->n_head >= 4 && data[handshake->n_head - 1] == '\n');
        REQUIRE(strlen(handshake->key) == 24 && (!handshake->room_id[0] || id_is_valid(handshake->room_id)));
    }
    if (kind == HEAD_WEBSOCKET || kind == HEAD_HTTP) {
        const struct head_text texts[] = { request.cookie,      request.authorization, request.forwarded,
                                           request.identity[0], request.identity[1],   request.identity[2],
                                           request.identity[3] };
        for (int i = 0; i < 7; i++)
            REQUIRE(!texts[i].at ||
                    (texts[i].at > (const char *)data && texts[i].at + texts[i].n < (const char *)data + n &&
                     !memchr(texts[i].at, 0, texts[i].n)));
        for (int i = 0; i < HEAD_N_IDENTITY; i++)
            REQUIRE((!request.identity[i].at || rules.takes_identity) && request.identity[i].n <= HEAD_MAX_GROUPS);
        REQUIRE(request.identity[HEAD_USER].n <= IDENTITY_MAX_USER);
        REQUIRE(request.identity[HEAD_NAME].n <= IDENTITY_MAX_NAME);
        REQUIRE(request.cookie.n <= HEAD_MAX_SECRET && request.authorization.n <= HEAD_MAX_SECRET);
    }
    if (n == 0 || n > HEAD_MAX_BYTES)
        return 0;
    size_t n_part = n > 64 ? n - data[n - 1] % 64 - 1 : n / 2;
    enum head_kind early = head_look((const char *)data, n_part, &rules, &part);
    REQUIRE(early == HEAD_INCOMPLETE || (early == kind && strcmp(part.detail, whole.detail) == 0));
    return 0;
}

/* Gathers the credentials of a request. */
#include "server/front/front_identify.h"

#include <string.h>

struct room { /* for copies of headers, which in the head have no end of their own */
    char bytes[2 * (HEAD_MAX_SECRET + 1) + HEAD_MAX_GROUPS + 1 + IDENTITY_MAX_USER + 1 + IDENTITY_MAX_NAME + 1 + 16];
    size_t n;
};

/* Copies a header that head_read has found to fit; an empty one is as good as none. */
static const char *keep(struct room *room, struct head_text text)
{
    char *copy = room->bytes + room->n;
    if (text.n == 0)
        return NULL;
    memcpy(copy, text.at, text.n);
    copy[text.n] = 0;
    room->n += text.n + 1;
    return copy;
}

bool front_link_is_https(const struct front_link *link)
{
    return (link->front->options.decrypt && !link->is_local) || link->is_from_proxy;
}

bool front_identify(struct front_link *link, const struct head_request *request, const struct address *client,
                    struct problem *problem)
{
    const struct front_options *options = &link->front->options;
    char address[ADDRESS_TEXT];
    struct room room;
    room.n = 0;
    address_write(client, address);
    const struct credentials credentials = { .cookie = keep(&room, request->cookie),
                                             .authorization = keep(&room, request->authorization),
                                             .user = keep(&room, request->identity[HEAD_USER]),
                                             .name = keep(&room, request->identity[HEAD_NAME]),
                                             .groups = keep(&room, request->identity[HEAD_GROUPS]),
                                             .auth_time = keep(&room, request->identity[HEAD_AUTH_TIME]),
                                             .is_from_proxy = link->is_from_proxy,
                                             .is_control = link->is_control,
                                             .is_secure =
                                                 options->decrypt || link->is_local || address_is_loopback(&link->peer),
                                             .is_https = front_link_is_https(link),
                                             .address = address };
    link->identity = (struct identity){ .source = IDENTITY_NOBODY };
    return !options->identify || options->identify(options->context, &credentials, &link->identity, problem);
}

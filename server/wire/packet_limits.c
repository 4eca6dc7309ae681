#include "server/wire/packet_limits.h"

#include <string.h>

static const struct packet_limit limits[] = {
    { "scene", PACKET_TO_RENDERER, PACKET_MAX_DOCUMENT, 0 },
    { "forget", PACKET_TO_RENDERER, PACKET_MAX_WORDS, 0 },
    { "drop", PACKET_TO_RENDERER, PACKET_MAX_WORDS, 0 },
    { "render", PACKET_TO_RENDERER, PACKET_MAX_DOCUMENT, 0 },
    { "query", PACKET_TO_RENDERER, PACKET_MAX_DOCUMENT, 0 },
    { "ping", PACKET_TO_RENDERER, PACKET_MAX_WORDS, 0 },
    { "gl", PACKET_TO_DAEMON, PACKET_MAX_WORDS, 0 },
    { "progress", PACKET_TO_DAEMON, PACKET_MAX_WORDS, 0 },
    { "ready", PACKET_TO_DAEMON, PACKET_MAX_DOCUMENT, 0 },
    { "failed", PACKET_TO_DAEMON, PACKET_MAX_WORDS, 0 },
    { "frame", PACKET_TO_DAEMON, PACKET_MAX_FRAME, PACKET_MAX_PICTURE },
    { "answer", PACKET_TO_DAEMON, PACKET_MAX_DOCUMENT, PACKET_MAX_BLOB },
    { "problem", PACKET_TO_DAEMON, PACKET_MAX_WORDS, 0 },
    { "pong", PACKET_TO_DAEMON, PACKET_MAX_WORDS, 0 },
};
enum { N_LIMITS = sizeof limits / sizeof *limits };

const struct packet_limit *packet_limit_find(const char *type)
{
    for (size_t i = 0; type && i < N_LIMITS; i++)
        if (strcmp(limits[i].type, type) == 0)
            return &limits[i];
    return NULL;
}

struct packet_limit packet_limit_largest(enum packet_direction direction)
{
    struct packet_limit largest = { "any", direction, 0, 0 };
    for (size_t i = 0; i < N_LIMITS; i++) {
        if (limits[i].direction != direction)
            continue;
        if (limits[i].max_json > largest.max_json)
            largest.max_json = limits[i].max_json;
        if (limits[i].max_blob > largest.max_blob)
            largest.max_blob = limits[i].max_blob;
    }
    return largest;
}

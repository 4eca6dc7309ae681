#pragma once
/* How large each packet between daemon and renderer may be. Both ends hold the one table: who writes a larger packet
 * gets an error instead, who reads one closes the stream before memory is taken for it. */
#include <stddef.h>
#include <stdint.h>

enum {
    PACKET_MAX_DOCUMENT =
        8 << 20, /* JSON with a scene or a plan in it: 1024 regions, 500 lines of report, images, doses, beams */
    PACKET_MAX_WORDS = 16 << 10, /* JSON with a few numbers, an id or a problem */
    PACKET_MAX_FRAME =
        64 << 10, /* JSON of a picture: a few numbers, and up to 32 regions that are missing, each with the reason */
    PACKET_MAX_SIDE_PX = 4096, /* as proto/scene.json has it for size_px of a view */
    PACKET_MAX_PICTURE = PACKET_MAX_SIDE_PX * PACKET_MAX_SIDE_PX * 4 +
                         (1 << 20), /* four bytes a pixel, which no codec needs, and its head */
    PACKET_MAX_BLOB = 512 << 20     /* the file of a surface */
};

enum packet_direction { PACKET_TO_RENDERER, PACKET_TO_DAEMON };

struct packet_limit {
    const char *type;
    enum packet_direction direction;
    uint32_t max_json, max_blob; /* bytes */
};

/* NULL: there is no packet of that type. type may be NULL. */
const struct packet_limit *packet_limit_find(const char *type);
/* The largest of a direction: all that can be said before a packet's type is known. */
struct packet_limit packet_limit_largest(enum packet_direction direction);

/* What a renderer taken over by a hostile file could send to the daemon. The first byte says how the stream is cut. */
#include <string.h>

#include "server/wire/packet.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    if (n == 0)
        return 0;
    struct packet_reader *reader = packet_reader_create();
    struct error err;
    size_t step = (size_t)data[0] + 1;
    for (size_t at = 1; at < n;) {
        size_t room;
        uint8_t *space = packet_reader_space(reader, &room, &err);
        size_t part = step < n - at ? step : n - at;
        part = part < room ? part : room;
        memcpy(space, data + at, part);
        packet_reader_added(reader, part);
        at += part;
        struct packet packet;
        int state;
        while ((state = packet_reader_take(reader, &packet, &err)) == 1)
            packet_finish(&packet);
        if (state < 0)
            break;
    }
    packet_reader_destroy(reader);
    return 0;
}

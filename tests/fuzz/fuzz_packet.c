/* The packet stream between daemon and renderer, which a hostile plan may have taken over. The first byte says in what
 * pieces it arrives, and its lowest bit in which direction. */
#include "server/wire/packet.h"
#include "tests/fuzz/fuzz.h"

/* Whatever came whole can be written, and reads back the same. */
static void check(const struct packet *packet)
{
    const struct packet_description *description = &packet_descriptions[packet->type];
    size_t n_bytes = 0;
    struct problem problem = { 0 };
    REQUIRE(packet->json);
    REQUIRE((packet->blob == NULL) == (packet->n_blob == 0));
    REQUIRE(packet->n_blob <= description->max_blob && (packet->n_blob > 0 || !description->needs_blob));
    uint8_t *bytes = packet_encode(packet, packet->blob, packet->n_blob, &n_bytes, &problem);
    /* numbers may be longer than they came, and fields that were left out are written: then it is too large, and
     * nothing else */
    REQUIRE(bytes ? n_bytes >= PACKET_HEAD_BYTES + packet->n_blob : problem.type == PROBLEM_LIMIT);
    REQUIRE(!bytes || packet->n_blob == 0 ||
            memcmp(bytes + n_bytes - packet->n_blob, packet->blob, packet->n_blob) == 0);
    free(bytes);
    if (packet->type == PACKET_FRAME)
        REQUIRE(packet->frame.width_px >= 1 && packet->frame.width_px <= 4096 && packet->frame.pixels_per_mm >= 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    if (n < 1)
        return 0;
    size_t piece = 1 + data[0];
    struct packet_reader *reader = packet_reader_create(data[0] & 1 ? PACKET_TO_RENDERER : PACKET_TO_DAEMON);
    struct error err = { 0 };
    for (size_t at = 1; at < n;) {
        size_t room = 0;
        uint8_t *space = packet_reader_space(reader, &room, &err);
        REQUIRE(space && room > 0);
        size_t here = n - at < piece ? n - at : piece;
        here = here < room ? here : room;
        memcpy(space, data + at, here);
        packet_reader_added(reader, here);
        at += here;

        struct packet packet;
        int taken;
        while ((taken = packet_reader_take(reader, &packet, &err)) == 1) {
            check(&packet);
            packet_finish(&packet);
        }
        if (taken < 0) {
            REQUIRE(err.code != ERROR_NONE && err.text[0] != '\0');
            break;
        }
    }
    packet_reader_destroy(reader);
    return 0;
}

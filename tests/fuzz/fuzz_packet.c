/* The stream between daemon and renderer, which a hostile plan may have taken over: the first byte says in what pieces it
 * arrives. */
#include "server/wire/packet.h"
#include "tests/fuzz/fuzz.h"

/* Whatever came whole comes out of packet_write unchanged. */
static void check(const struct packet *packet)
{
    REQUIRE(packet->json);
    REQUIRE((packet->blob == NULL) == (packet->n_blob == 0));
    size_t n_bytes = 0;
    uint8_t *bytes = packet_write(packet->json, packet->blob, packet->n_blob, &n_bytes);
    REQUIRE(bytes && n_bytes >= PACKET_HEAD_BYTES + packet->n_blob);
    REQUIRE(packet->n_blob == 0 || memcmp(bytes + n_bytes - packet->n_blob, packet->blob, packet->n_blob) == 0);
    free(bytes);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    if (n < 1)
        return 0;
    size_t piece = 1 + data[0];
    struct packet_reader *reader = packet_reader_create();
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

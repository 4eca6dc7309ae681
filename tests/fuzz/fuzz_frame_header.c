/* The header of a frame (proto/frame.md), as a reader outside the project receives it. */
#include "server/wire/frame_header.h"
#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    struct frame_header header;
    size_t header_bytes = 0;
    struct error err = { 0 };
    if (!frame_header_read(data, n, &header, &header_bytes, &err)) {
        REQUIRE(err.code != ERROR_NONE && err.text[0] != '\0');
        return 0;
    }
    REQUIRE(header_bytes >= FRAME_HEADER_BYTES && header_bytes <= n);
    REQUIRE(header.payload_bytes == n - header_bytes);
    REQUIRE(header.width_px > 0 && header.height_px > 0);
    REQUIRE(header.scale_percent >= 10 && header.scale_percent <= 100);

    /* written again it must be the same, except for the length, which is the length we write */
    uint8_t bytes[FRAME_HEADER_BYTES];
    frame_header_write(&header, bytes);
    REQUIRE(memcmp(bytes, data, 6) == 0);
    REQUIRE(memcmp(bytes + 8, data + 8, FRAME_HEADER_BYTES - 8) == 0);
    return 0;
}

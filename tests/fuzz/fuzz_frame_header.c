/* The header before each picture. What is accepted must be written back with the same bytes. */
#include <stdlib.h>
#include <string.h>

#include "server/wire/frame_header.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    struct frame_header header;
    struct error err;
    size_t start;
    if (!frame_header_read(data, n, &header, &start, &err))
        return 0;
    uint8_t bytes[FRAME_HEADER_BYTES];
    frame_header_write(&header, bytes);
    if (start == FRAME_HEADER_BYTES && memcmp(bytes, data, FRAME_HEADER_BYTES) != 0)
        abort();
    return 0;
}

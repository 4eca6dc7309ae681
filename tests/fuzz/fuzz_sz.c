/* Bare zlib streams, and files of SERA that may be compressed or not. */
#include "core/formats/zlib_stream.h"
#include "tests/fuzz/fuzz.h"

enum { LIMIT = 1 << 20 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    struct bytes out, again;
    struct error err = { 0 };
    bool is_packed;
    bool is_read = zlib_all(data, n, "fuzz.sz", LIMIT, &out, &err);
    REQUIRE(is_read ? out.size <= LIMIT && out.data[out.size] == 0
                    : !out.data && err.code != ERROR_NONE && err.text[0] != '\0');
    if (is_read && out.size > 0) { /* a limit of exactly the size is enough, one byte less is not */
        REQUIRE(zlib_all(data, n, "fuzz.sz", out.size, &again, &err) && again.size == out.size);
        bytes_free(&again);
        REQUIRE(!zlib_all(data, n, "fuzz.sz", out.size - 1, &again, &err) && err.code == ERROR_LIMIT);
    }
    bytes_free(&out);
    struct bytes file = { (uint8_t *)(uintptr_t)data, n };
    static const char *const names[] = { "fuzz.sz", "fuzz.uv" };
    for (int i = 0; i < 2; i++) {
        err = (struct error){ 0 };
        is_read = sera_unpack(&file, names[i], LIMIT, &is_packed, &out, &err);
        REQUIRE(is_read ? out.size <= LIMIT && (out.data != NULL) == is_packed : !out.data && err.code != ERROR_NONE);
        bytes_free(&out);
    }
    return 0;
}

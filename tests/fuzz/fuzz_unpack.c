/* An uploaded archive: everything is read and checked, nothing is written. */
#define _GNU_SOURCE
#include <sys/mman.h>
#include <unistd.h>

#include "server/renderer/unpack.h"
#include "tests/fuzz/fuzz.h"

enum { MOST = 1 << 20 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    static int file = -1;
    if (file < 0)
        file = memfd_create("archive", MFD_CLOEXEC);
    REQUIRE(file >= 0 && ftruncate(file, 0) == 0 && pwrite(file, data, n, 0) == (ssize_t)n);
    struct unpack_options options = { .max_bytes = MOST };
    struct unpack_result result;
    struct problem problem = { 0 };
    if (unpack(file, -1, &options, &result, &problem)) {
        REQUIRE(result.n_files > 0 && result.n_files <= UNPACK_MAX_ENTRIES && result.n_bytes <= MOST);
    } else {
        REQUIRE(problem.type != PROBLEM_NONE && problem.detail[0] != '\0' && result.n_files == 0);
        REQUIRE(problem.type != PROBLEM_INTERNAL && problem.type != PROBLEM_CANCELLED);
    }
    return 0;
}

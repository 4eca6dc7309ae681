/* Accept-Encoding. The choice must exist, be the same every time, and not depend on what is not chosen and not there.
 */
#include <stdlib.h>

#include "server/http/coding.h"
#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    char *accept = malloc(n + 1); /* exactly as long as it is, so that reading on is found */
    memcpy(accept, data, n);
    accept[n] = 0;
    enum content_coding both = coding_choose(accept, (bool[N_CODINGS]){ true, true, true });
    enum content_coding gzip = coding_choose(accept, (bool[N_CODINGS]){ true, true, false });
    REQUIRE(both < N_CODINGS && gzip < CODING_BR);
    REQUIRE(both == CODING_BR || both == gzip);
    REQUIRE(coding_choose(accept, (bool[N_CODINGS]){ true, false, false }) == CODING_IDENTITY);
    free(accept);
    return 0;
}

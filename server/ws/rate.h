#pragma once
/* How much may come in a time: so much a second in the long run, and so much at once. Plain arithmetic on times that
 * are handed in. */
#include <stdbool.h>
#include <stdint.h>

struct rate_limit {
    int64_t per_s; /* in the long run, at least 1 */
    int64_t burst; /* at once, after a rest */
};

struct rate {
    int64_t paid_until_ns; /* when what came by now is worked off at per_s; before now: there is nothing to work off */
};

/* Notes that n more have come. False: that is more than the limit allows, as it is for burst + 1 at once. n is at most
 * 2^31. */
static inline bool rate_allows(struct rate *rate, const struct rate_limit *limit, int64_t n, int64_t now_us)
{
    int64_t now_ns = now_us * 1000;
    if (rate->paid_until_ns < now_ns)
        rate->paid_until_ns = now_ns;
    rate->paid_until_ns += n * INT64_C(1000000000) / limit->per_s;
    return rate->paid_until_ns - now_ns <= limit->burst * INT64_C(1000000000) / limit->per_s;
}

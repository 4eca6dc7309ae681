#pragma once
/* Rate limits: so much per second in the long run, and so much at once. Arithmetic on times passed in. */
#include <stdbool.h>
#include <stdint.h>

struct rate_limit {
    int64_t per_s; /* in the long run, at least 1 */
    int64_t burst; /* at once, after a rest */
};

struct rate {
    int64_t paid_until_ns; /* time at which everything counted so far is worked off at per_s */
};

/* Notes that n more have come, n <= 2^31. Returns false when that exceeds the limit; burst + 1 at once always do. */
static inline bool rate_allows(struct rate *rate, const struct rate_limit *limit, int64_t n, int64_t now_us)
{
    int64_t now_ns = now_us * 1000;
    if (rate->paid_until_ns < now_ns)
        rate->paid_until_ns = now_ns;
    rate->paid_until_ns += n * INT64_C(1000000000) / limit->per_s;
    return rate->paid_until_ns - now_ns <= limit->burst * INT64_C(1000000000) / limit->per_s;
}

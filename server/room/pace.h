#pragma once
/* How good moving pictures of one stream may be: as good as renderer and link hold at 25 to 30 a second. Pure
 * arithmetic on measurements handed in; knows no rooms. */
#include <stdbool.h>
#include <stdint.h>

enum {
    PACE_SLOW_US = 33000, /* a picture that costs more is too slow: one step down */
    PACE_FAST_US = 15000, /* cheaper than this for PACE_UP_AFTER_US: one step up */
    PACE_LAG_US = 50000,  /* acknowledgements this much later than the best seen: the link is the limit */
    PACE_UP_AFTER_US = 1000000,
    PACE_UP_AT_MOST_US = 30000000, /* a step up that failed is tried again after twice the time, at most this */
};

struct pace {
    int step; /* 0 the best */
    bool is_software;
    int n_drawn;            /* since the last step */
    double cost_us, lag_us; /* smoothed */
    double render_us;       /* smoothed; when the next request is worth making */
    int64_t drawn_us;       /* when the last picture came */
    int64_t good_since_us;  /* 0: not good */
    int64_t stepped_up_us, up_after_us;
};

struct pace_choice {
    int scale_percent, quality;
    bool light; /* lighter surfaces */
};

/* Starts at the best; three slow pictures bring it down. */
void pace_start(struct pace *pace, bool is_software);
struct pace_choice pace_choose(const struct pace *pace);
/* A moving picture came: what it cost, how long after it was asked for, how many were outstanding then. */
void pace_drawn(struct pace *pace, int64_t render_us, int64_t encode_us, int64_t turnaround_us, int n_outstanding,
                int64_t now_us);
/* How much later than the best seen the acknowledgements come, of the subscriber with the best link. */
void pace_lagged(struct pace *pace, int64_t excess_us);

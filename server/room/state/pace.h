#pragma once
/* Scale and quality of one stream's moving pictures: the best that renderer and link hold at 25 to 30 pictures a
 * second. Arithmetic on measurements passed in; knows no rooms and no clock. */
#include <stdbool.h>
#include <stdint.h>

enum {
    PACE_SLOW_US = 33000, /* cost of a picture above which quality goes one step down */
    PACE_FAST_US = 15000, /* cost below which, for PACE_UP_AFTER_US, it goes one step up */
    PACE_LAG_US = 50000,  /* acknowledgements later than the best seen by this: the link is too slow, one step down */
    PACE_UP_AFTER_US = 1000000,
    PACE_UP_AT_MOST_US = 30000000, /* a step up that did not hold is tried again after twice the time, at most this */
};

struct pace {
    int step; /* index into the ladder; 0: the best */
    bool is_software;
    int n_drawn;            /* since the last step */
    double cost_us, lag_us; /* smoothed */
    double render_us;       /* smoothed; a second request is made after this much of the first */
    int64_t drawn_us;       /* time when the last picture came */
    int64_t good_since_us;  /* since when cost and lag are low; 0: they are not */
    int64_t stepped_up_us, up_after_us;
};

struct pace_choice {
    int scale_percent, quality;
    bool coarse; /* coarse surfaces */
};

/* Starts at the best step; three slow pictures bring it down. */
void pace_start(struct pace *pace, bool is_software);
struct pace_choice pace_choose(const struct pace *pace);
/* A moving picture came. turnaround_us: from request to arrival; n_outstanding: requests of the stream when it was
 * made. */
void pace_drawn(struct pace *pace, int64_t render_us, int64_t encode_us, int64_t turnaround_us, int n_outstanding,
                int64_t now_us);
/* excess_us: how much later than the best seen the acknowledgements come, for the viewer with the best link. */
void pace_lagged(struct pace *pace, int64_t excess_us);

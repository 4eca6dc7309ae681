#pragma once
/* Time. What passes is measured by the monotonic clock; the wall clock, which may be set, is for what people read and
 * for what outlives the process. */
#include <stdint.h>

int64_t clock_now_us(void);  /* monotonic, from an arbitrary start */
int64_t clock_wall_ms(void); /* since 1970, UTC */

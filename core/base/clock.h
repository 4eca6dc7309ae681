#pragma once
/* Monotonic time. Wall time is for logs only. */
#include <stdint.h>

int64_t clock_now_us(void);

#pragma once
/* Monotonic time in microseconds, from an arbitrary start. Wall-clock time is used in logs only (log.c). */
#include <stdint.h>

int64_t clock_now_us(void);

#pragma once
/* What every cmocka test includes: the library with its prerequisites, and comparisons of doubles. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* |value - expected| <= tolerance, in the value's own unit */
#define assert_close(value, expected, tolerance)                                                                   \
    do {                                                                                                           \
        double value_ = (double)(value), expected_ = (double)(expected), tolerance_ = (double)(tolerance);         \
        if (!(fabs(value_ - expected_) <= tolerance_))                                                             \
            fail_msg("%s is %.9g, expected %.9g within %.3g", #value, value_, expected_, tolerance_);              \
    } while (0)

/* relative: |value - expected| <= share * |expected| */
#define assert_near(value, expected, share) assert_close(value, expected, (share) * fabs((double)(expected)))

#pragma once
/* Header of every cmocka test: the library with its prerequisites, and comparisons of doubles. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#include <cmocka.h>

/* How often work of several threads is tried: the thread sanitizer makes it a hundred times slower. */
#ifdef __SANITIZE_THREAD__
#define CHECK_THREADED(n) 1
#else
#define CHECK_THREADED(n) (n)
#endif

/* |value - expected| <= tolerance, in the value's own unit */
#define assert_close(value, expected, tolerance) \
    do { \
        double value_ = (double)(value), expected_ = (double)(expected), tolerance_ = (double)(tolerance); \
        if (!(fabs(value_ - expected_) <= tolerance_)) \
            fail_msg("%s is %.9g, expected %.9g within %.3g", #value, value_, expected_, tolerance_); \
    } while (0)

/* relative: |value - expected| <= share * |expected| */
#define assert_near(value, expected, share) assert_close(value, expected, (share)*fabs((double)(expected)))

/* Each coordinate of a point (x, y, z) */
#define assert_point(point, x_, y_, z_, tolerance) \
    do { \
        double found_[3] = { (point).x, (point).y, (point).z }, expected_[3] = { x_, y_, z_ }; \
        for (int axis_ = 0; axis_ < 3; axis_++) \
            if (!(fabs(found_[axis_] - expected_[axis_]) <= (tolerance))) \
                fail_msg("%s is (%.9g, %.9g, %.9g), expected (%.9g, %.9g, %.9g) within %.3g", #point, found_[0], \
                         found_[1], found_[2], expected_[0], expected_[1], expected_[2], (double)(tolerance)); \
    } while (0)

/* Processor time of this program and its ended children, s: a limit on it holds on a busy machine too. */
static inline double cpu_s(void)
{
    double sum_s = 0;
    for (int i = 0; i < 2; i++) {
        struct rusage usage;
        if (getrusage(i ? RUSAGE_CHILDREN : RUSAGE_SELF, &usage) == 0)
            sum_s += (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
                     1e-6 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
    }
    return sum_s;
}

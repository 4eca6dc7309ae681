/* The vector types of volume_kernels.inc, included with it once for each processor: NAME makes their names. */
#include <math.h>
#include <string.h>

typedef int32_t NAME(ints) __attribute__((vector_size(32), aligned(4), may_alias));
typedef uint32_t NAME(words) __attribute__((vector_size(32), aligned(4), may_alias));
typedef float NAME(floats) __attribute__((vector_size(32), aligned(4), may_alias));
typedef int64_t NAME(longs) __attribute__((vector_size(32), aligned(4), may_alias));
#define INTS NAME(ints)
#define WORDS NAME(words)
#define FLOATS NAME(floats)
#define LONGS NAME(longs)

/* Converts label rows to bits: portable and AVX2 loops, chosen at run time. */
#include "core/region/mask_pack.h"

#include <string.h>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

void label_test_init(struct label_test *test, const uint16_t *labels, size_t n_labels)
{
    memset(test, 0, sizeof *test);
    uint32_t low = UINT16_MAX, high = 0;
    for (size_t i = 0; i < n_labels; i++) {
        test->has[labels[i]] = 1;
        low = labels[i] < low ? labels[i] : low;
        high = labels[i] > high ? labels[i] : high;
    }
    for (uint32_t label = 0; label < 256; label++)
        if (test->has[label]) {
            uint8_t *row = &test->nibbles[label / 128][label % 16];
            *row = (uint8_t)(*row | 1u << label / 16 % 8);
        }
    size_t n = 0;
    for (uint32_t label = low, end; label <= high; label = end) {
        for (end = label; end <= high && test->has[end]; end++)
            ;
        if (end > label && ++n <= LABEL_MAX_RUNS) {
            test->first[n - 1] = (uint16_t)label;
            test->length_less_1[n - 1] = (uint16_t)(end - label - 1);
        }
        end += end == label;
    }
    test->n_runs = n <= LABEL_MAX_RUNS ? n : 0;
}

#define PACK(labels, n, bits) \
    do { \
        for (uint32_t at = 0; at < (n); at += 64) { \
            uint32_t n_here = (n)-at < 64 ? (n)-at : 64; \
            uint64_t word = 0; \
            for (uint32_t bit = 0; bit < n_here; bit++) \
                word |= (uint64_t)test->has[(labels)[at + bit]] << bit; \
            (bits)[at / 64] = word; \
        } \
    } while (0)

static void pack_u8_portable(const struct label_test *test, const uint8_t *labels, uint32_t n, uint64_t *bits)
{
    PACK(labels, n, bits);
}

static void pack_u16_portable(const struct label_test *test, const uint16_t *labels, uint32_t n, uint64_t *bits)
{
    PACK(labels, n, bits);
}

const struct mask_packer mask_packer_portable = { pack_u8_portable, pack_u16_portable };

#if defined(__x86_64__)
#define AVX2 __attribute__((target("avx2")))

/* Prefetch distance in bytes: rows follow each other, so labels far ahead are needed soon. The address may be past the
 * end of the labels, because a prefetch does not read. */
enum { AHEAD = 4096 };
AVX2 static inline void prefetch(const void *at)
{
    _mm_prefetch((const char *)((uintptr_t)at + AHEAD), _MM_HINT_T0);
}

/* Tests 32 bytes against any set of labels: the low half of a byte is looked up in the table that its highest bit
 * selects; the entry says which high halves are in the set. PSHUFB gives 0 where the index has bit 7, so the other
 * table contributes nothing. */
AVX2 static inline uint32_t test_32_u8(__m256i low_table, __m256i high_table, __m256i labels)
{
    const __m256i bit_of_half = _mm256_set1_epi64x((long long)0x8040201008040201u);
    __m256i low = _mm256_and_si256(labels, _mm256_set1_epi8((char)0x8f));
    __m256i halves =
        _mm256_or_si256(_mm256_shuffle_epi8(low_table, low),
                        _mm256_shuffle_epi8(high_table, _mm256_xor_si256(low, _mm256_set1_epi8((char)0x80))));
    __m256i high = _mm256_and_si256(_mm256_srli_epi16(labels, 4), _mm256_set1_epi8(0x0f));
    __m256i wanted = _mm256_shuffle_epi8(bit_of_half, high);
    return (uint32_t)_mm256_movemask_epi8(_mm256_cmpeq_epi8(_mm256_and_si256(halves, wanted), wanted));
}

AVX2 static void pack_u8_avx2(const struct label_test *test, const uint8_t *labels, uint32_t n, uint64_t *bits)
{
    __m256i low_table = _mm256_broadcastsi128_si256(_mm_loadu_si128((const __m128i *)test->nibbles[0]));
    __m256i high_table = _mm256_broadcastsi128_si256(_mm_loadu_si128((const __m128i *)test->nibbles[1]));
    uint32_t at = 0;
    for (; n - at >= 64; at += 64) {
        prefetch(labels + at);
        uint64_t low = test_32_u8(low_table, high_table, _mm256_loadu_si256((const __m256i *)(labels + at)));
        uint64_t high = test_32_u8(low_table, high_table, _mm256_loadu_si256((const __m256i *)(labels + at + 32)));
        bits[at / 64] = low | high << 32;
    }
    if (at < n) {
        uint8_t rest[64] = { 0 };
        memcpy(rest, labels + at, n - at);
        uint64_t low = test_32_u8(low_table, high_table, _mm256_loadu_si256((const __m256i *)rest));
        uint64_t high = test_32_u8(low_table, high_table, _mm256_loadu_si256((const __m256i *)(rest + 32)));
        bits[at / 64] = (low | high << 32) & (((uint64_t)1 << (n - at)) - 1);
    }
}

AVX2 static inline uint32_t test_32_u16(const struct label_test *test, const uint16_t *labels)
{
    __m256i a = _mm256_loadu_si256((const __m256i *)labels), b = _mm256_loadu_si256((const __m256i *)(labels + 16));
    __m256i in_a = _mm256_setzero_si256(), in_b = in_a;
    for (size_t run = 0; run < test->n_runs; run++) {
        /* unsigned (label - first) <= length - 1, tested as a saturated difference of 0 */
        __m256i first = _mm256_set1_epi16((short)test->first[run]),
                length = _mm256_set1_epi16((short)test->length_less_1[run]);
        in_a = _mm256_or_si256(in_a, _mm256_cmpeq_epi16(_mm256_subs_epu16(_mm256_sub_epi16(a, first), length),
                                                        _mm256_setzero_si256()));
        in_b = _mm256_or_si256(in_b, _mm256_cmpeq_epi16(_mm256_subs_epu16(_mm256_sub_epi16(b, first), length),
                                                        _mm256_setzero_si256()));
    }
    /* packing works within halves of 128 bits: restore the sequence of the quarters */
    return (uint32_t)_mm256_movemask_epi8(_mm256_permute4x64_epi64(_mm256_packs_epi16(in_a, in_b), 0xd8));
}

AVX2 static void pack_u16_avx2(const struct label_test *test, const uint16_t *labels, uint32_t n, uint64_t *bits)
{
    if (test->n_runs == 0) {
        pack_u16_portable(test, labels, n, bits);
        return;
    }
    uint32_t at = 0;
    for (; n - at >= 64; at += 64) {
        prefetch(labels + at);
        prefetch(labels + at + 32);
        bits[at / 64] = test_32_u16(test, labels + at) | (uint64_t)test_32_u16(test, labels + at + 32) << 32;
    }
    if (at < n) {
        uint16_t rest[64] = { 0 };
        memcpy(rest, labels + at, (n - at) * sizeof *labels);
        uint64_t word = test_32_u16(test, rest) | (uint64_t)test_32_u16(test, rest + 32) << 32;
        bits[at / 64] = word & (((uint64_t)1 << (n - at)) - 1);
    }
}

static const struct mask_packer avx2 = { pack_u8_avx2, pack_u16_avx2 };

const struct mask_packer *mask_packer_best(void)
{
    return __builtin_cpu_supports("avx2") ? &avx2 : &mask_packer_portable;
}
#else
const struct mask_packer *mask_packer_best(void)
{
    return &mask_packer_portable;
}
#endif

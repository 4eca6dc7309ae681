#pragma once
/* Inside of mask_from_labels: rows of labels to rows of bits. Knows nothing of grids. For any processor, and for one
 * with AVX2. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { LABEL_MAX_RUNS = 8 };

/* Which labels count as inside. */
struct label_test {
    uint8_t has[65536];     /* 0 or 1 by label */
    uint8_t nibbles[2][16]; /* labels below 256: bit (l / 16 % 8) of nibbles[l / 128][l % 16] */
    size_t n_runs; /* runs of neighbouring labels in ascending order; 0 when there are more than LABEL_MAX_RUNS */
    uint16_t first[LABEL_MAX_RUNS], length_less_1[LABEL_MAX_RUNS];
};

void label_test_init(struct label_test *test, const uint16_t *labels, size_t n_labels);

/* Writes (n + 63) / 64 words: bit i is set when labels[i] counts as inside; bits from n on are 0. */
struct mask_packer {
    void (*pack_u8)(const struct label_test *test, const uint8_t *labels, uint32_t n, uint64_t *bits);
    void (*pack_u16)(const struct label_test *test, const uint16_t *labels, uint32_t n, uint64_t *bits);
};
extern const struct mask_packer mask_packer_portable;
const struct mask_packer *mask_packer_best(void); /* on this processor; the same bits */

#pragma once
/* Inside of mask_from_labels: converts rows of labels to rows of bits, with AVX2 or portably. Knows nothing of grids.
 * Any thread. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { LABEL_MAX_RUNS = 8 };

/* The labels that count as inside. */
struct label_test {
    uint8_t has[65536];     /* 1 for an inside label, else 0 */
    uint8_t nibbles[2][16]; /* labels below 256: bit l / 16 % 8 of nibbles[l / 128][l % 16] is set if inside */
    size_t n_runs;          /* runs of consecutive labels, ascending; 0 if there are more than LABEL_MAX_RUNS */
    uint16_t first[LABEL_MAX_RUNS], length_less_1[LABEL_MAX_RUNS];
};

void label_test_init(struct label_test *test, const uint16_t *labels, size_t n_labels);

/* Writes (n + 63) / 64 words: bit i is set if labels[i] is inside; bits from n on are 0. */
struct mask_packer {
    void (*pack_u8)(const struct label_test *test, const uint8_t *labels, uint32_t n, uint64_t *bits);
    void (*pack_u16)(const struct label_test *test, const uint16_t *labels, uint32_t n, uint64_t *bits);
};
extern const struct mask_packer mask_packer_portable;
const struct mask_packer *mask_packer_best(void); /* The fastest on this processor; both give the same bits */

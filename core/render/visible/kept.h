#pragma once
/* A list of what is kept of plans from picture to picture, the most recently used first: what cap_cache and
 * isoline_cache share. Knows nothing of what is kept. One thread. */
#include "core/plan/plan.h"

struct kept { /* the first member of what is kept */
    const struct plan *plan;
    struct kept *next;
};

struct kept_type {
    void (*destroy)(struct kept *kept);
    bool (*is_used)(const struct kept *kept);   /* by a picture that is being drawn */
    size_t (*size_of)(const struct kept *kept); /* counts against max_size, in a unit of the type's own */
    size_t max_n, max_size;
};

void kept_put_first(struct kept **first, struct kept *kept);
/* Moves what *at points to, a link of the same list, to the front. */
void kept_use_again(struct kept **first, struct kept **at);
/* Destroys what is kept of the plan; NULL: of all. Nothing of it may be used. */
void kept_forget(struct kept **first, const struct kept_type *type, const struct plan *plan);
/* Destroys what exceeds the type's limits, least recently used first, but nothing that is used. */
void kept_trim(struct kept **first, const struct kept_type *type);

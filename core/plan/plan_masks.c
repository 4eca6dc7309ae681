#include "core/plan/plan_masks.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"

struct plan_masks {
    const struct plan *plan;
    size_t n;
    uint64_t most_bytes;
    struct mask_wish *wishes; /* [n] */
    pthread_mutex_t lock;     /* of all below; held while masks are made, as whoever waits wants one of them */
    struct mask **masks;      /* [n]; NULL: not made, or taken */
    bool *is_taken;           /* [n] */
};

struct plan_masks *plan_masks_create(const struct plan *plan, const struct mask_wish *wishes, size_t n,
                                     uint64_t most_bytes)
{
    struct plan_masks *masks = mem_new(sizeof *masks);
    masks->plan = plan;
    masks->n = n;
    masks->most_bytes = most_bytes;
    masks->wishes = mem_new((n + 1) * sizeof *wishes); /* a wish a region of the plan */
    masks->masks = mem_new((n + 1) * sizeof *masks->masks);
    masks->is_taken = mem_new((n + 1) * sizeof *masks->is_taken);
    memcpy(masks->wishes, wishes, n * sizeof *wishes);
    pthread_mutex_init(&masks->lock, NULL);
    return masks;
}

void plan_masks_destroy(struct plan_masks *masks)
{
    if (!masks)
        return;
    for (size_t w = 0; w < masks->n; w++)
        mask_destroy(masks->masks[w]);
    pthread_mutex_destroy(&masks->lock);
    free(masks->wishes);
    free(masks->masks);
    free(masks->is_taken);
    free(masks);
}

static uint64_t bytes_of(const struct plan_masks *masks, size_t wish)
{
    const struct region_set *set = &masks->plan->regions;
    const uint32_t *size = set->layers[set->regions[masks->wishes[wish].region].layer]->grid.size;
    return (uint64_t)((size[0] + 63) / 64) * sizeof(uint64_t) * size[1] * size[2];
}

/* From this one on, as many as may be made at once of those that nobody has taken yet. */
static bool make_from(struct plan_masks *masks, size_t wish, struct error *err)
{
    size_t n_left = masks->n - wish, n = 0;
    struct mask_wish *wishes = mem_new(n_left * sizeof *wishes);
    size_t *numbers = mem_new(n_left * sizeof *numbers);
    struct mask **made = mem_new(n_left * sizeof *made);
    uint64_t n_bytes = 0;
    for (size_t w = wish; w < masks->n; w++) {
        if (w > wish && (masks->is_taken[w] || masks->masks[w]))
            continue;
        n_bytes += bytes_of(masks, w);
        if (n > 0 && n_bytes > masks->most_bytes)
            break;
        numbers[n] = w;
        wishes[n++] = masks->wishes[w];
    }
    bool is_made = mask_sweep(&masks->plan->regions, wishes, n, 0, made, err);
    for (size_t i = 0; is_made && i < n; i++)
        masks->masks[numbers[i]] = made[i];
    free(wishes);
    free(numbers);
    free(made);
    return is_made;
}

struct mask *plan_masks_take(struct plan_masks *masks, size_t wish, struct error *err)
{
    struct mask *mask = NULL;
    pthread_mutex_lock(&masks->lock);
    if (masks->masks[wish] || make_from(masks, wish, err)) {
        mask = masks->masks[wish];
        masks->masks[wish] = NULL;
        masks->is_taken[wish] = true;
    }
    pthread_mutex_unlock(&masks->lock);
    return mask;
}

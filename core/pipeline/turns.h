#pragma once
/* Which request is drawn next: fair turns between sources, by the time that their pictures took and not by their
 * number. Knows no threads, no clock and no pictures: the caller hands in the costs.
 *
 * A source is a set of requests that are counted together: a member's own views, a room's shared views, all scripts.
 * The source that has used the least time is next. A source whose next picture is a moving one is preferred as if it
 * had used TURNS_MOVING_AHEAD_US less. A source without requests saves at most TURNS_CREDIT_US for later. When more
 * than TURNS_FEW_SOURCES have requests, both advantages shrink: all sources together keep a still waiting no longer
 * with them than those few could. Within a source, moving pictures go before stills, but at most TURNS_MAX_OVERTAKING
 * of them before the same still; among moving pictures those of the view in which a person acts go first, but after
 * TURNS_MAX_ACTED_OVERTAKING of them comes the oldest other one; otherwise the oldest request is next. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    TURNS_MAX_OVERTAKING = 8,
    TURNS_MAX_ACTED_OVERTAKING = 2,
    TURNS_CREDIT_US = 100000,
    TURNS_MOVING_AHEAD_US = 100000,
    TURNS_FEW_SOURCES = 8
};

/* A request that waits, or whose picture is paused. */
struct turns_item {
    uint64_t source;
    bool is_still;   /* or waits like one */
    bool is_acted;   /* of the view in which a person acts; counts for moving pictures alone */
    bool is_held;    /* must not be chosen now */
    bool is_begun;   /* was chosen before */
    int n_overtaken; /* later pictures of its source that were begun before it as they go first; of a moving one only
                        while it is the oldest */
};

struct turns;
struct turns *turns_create(void);
void turns_destroy(struct turns *turns);
/* Returns the index of the item to draw next, which counts as begun from then on; SIZE_MAX: all are held. items: all
 * requests that wait or are paused, oldest first; fewer sources than turns.c remembers (512) */
size_t turns_choose(struct turns *turns, struct turns_item *const *items, size_t n);
/* Adds the time that a picture of the source took, or a part of it. */
void turns_charge(struct turns *turns, uint64_t source, int64_t cost_us);
/* True if newcomer may be chosen while `drawn`, the picture that is being drawn, is not done. */
bool turns_may_interrupt(const struct turns_item *drawn, const struct turns_item *newcomer);

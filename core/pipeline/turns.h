#pragma once
/* Which picture is drawn next: fair turns between those who ask, by the time their pictures took and not by their
 * number. Knows no threads, no clock and no pictures: costs are handed in.
 *
 * A source is anybody whose pictures are counted together: a member's own views, a room's shared views, all scripts.
 * The source that has used the least time is next; one whose next picture is a moving one may be TURNS_MOVING_AHEAD_US
 * ahead of one whose next is a still. A source that asks for nothing saves at most TURNS_CREDIT_US for later. Of one
 * source, moving pictures go before stills, which let at most TURNS_MAX_OVERTAKING of them pass; else the oldest is
 * next. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { TURNS_MAX_OVERTAKING = 8, TURNS_CREDIT_US = 100000, TURNS_MOVING_AHEAD_US = 100000 };

struct turns_item {
    uint64_t source;
    bool is_still;
    bool is_held;    /* not to be chosen now */
    bool is_begun;   /* chosen before */
    int n_overtaken; /* still: moving pictures of the source that were begun before it although they came later */
};

struct turns;
struct turns *turns_create(void);
void turns_destroy(struct turns *turns);
/* items: all that wait or are paused, oldest first. The number of the one to draw on, which is then begun; SIZE_MAX:
 * all are held. */
size_t turns_choose(struct turns *turns, struct turns_item *const *items, size_t n);
/* What a picture of a source took, or a part of it. */
void turns_charge(struct turns *turns, uint64_t source, int64_t cost_us);
/* Whether newcomer may be chosen before drawn, which is being drawn. */
bool turns_may_interrupt(const struct turns_item *drawn, const struct turns_item *newcomer);

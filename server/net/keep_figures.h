#pragma once
/* Gathers what a decision is kept with beside the room's own record: four pictures of 1600 x 1200, the dose and its
 * histogram, limits with weights and states, what fits what, the beam, whose plan it is, all of the scene and views at
 * that moment. Asked of the plan's renderer while the decision waits. What cannot be had is named in the record
 * (kept.missing) with the reason, and the decision is kept all the same: a renderer that is gone takes no decision
 * along. Internal to server/net; net thread. */
#include "server/net/net_state.h"

enum {
    KEEP_FIGURE_WIDTH_PX = 1600,
    KEEP_FIGURE_HEIGHT_PX = 1200,
    KEEP_FIGURE_QUALITY = 90,        /* of the JPEG */
    KEEP_FIGURES_MS = 20000,         /* that a decision waits for them at most */
    KEEP_MAX_ANSWER_BYTES = 4 << 20, /* of one answer that is kept, as JSON */
    KEEP_DVH_BINS = 200              /* of a curve */
};

/* Begins to gather for the record in prompt->row, or does nothing if it is no decision. True: prompt->gathering is set,
 * and done(prompt) is called later, once. */
bool keep_figures_begin(struct net_room *entry, struct prompt_write *prompt,
                        void (*done)(struct net_room *entry, struct prompt_write *prompt));
/* Ends those that have waited for KEEP_FIGURES_MS. */
void keep_figures_due(struct net *net);
/* Nothing is gathered for it any more; done is not called. */
void keep_figures_forget(struct net_room *entry, struct prompt_write *prompt);

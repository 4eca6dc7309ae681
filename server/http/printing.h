#pragma once
/* Draws a record as PDF by beamroom-paper, a process and a thread for each. Internal to server/http; net thread. */
#include "server/http/api_state.h"
#include "server/net/net.h"

enum {
    PRINTING_AT_ONCE = 2,
    PRINTING_S = 30 /* of each, by the clock */
};

struct printing;

/* With copies of the record's pictures. NULL with problem. */
NODISCARD struct printing *printing_create(const struct net_record *record, bool is_letter, struct problem *problem);
void printing_destroy(struct printing *printing); /* of one that was not started */
/* Draws the paper, which is borrowed, and answers the call. Takes printing. */
void printing_start(struct api *api, struct call *call, struct printing *printing, const cJSON *paper);

#pragma once
/* One order to draw a paper, as it comes from beamroomd (input.h). Not trusted: each length is checked before memory is
 * taken for it. */
#include "server/printer/draw.h"

struct order {
    struct drawing_input input; /* borrows from below */
    cJSON *paper;
    unsigned char *pictures[PRINTER_PICTURES];
};
/* Fills `to` with the next n bytes. False: there are not so many. */
typedef bool order_source(void *context, void *to, size_t n);
/* True: whole. For order_finish in any case. */
bool order_read(struct order *order, order_source *source, void *context);
void order_finish(struct order *order);

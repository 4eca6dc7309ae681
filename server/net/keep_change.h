#pragma once
/* A change of a list that the server keeps beside its rooms, as statements and meetings: it counts once it is on disk,
 * in one write with its row of the audit. Internal to server/net; net thread. */
#include "server/net/net_state.h"

/* The person who makes the change, as its row of the audit says. */
struct keep_change_by {
    const struct identity *who;
    const char *name, *address; /* name: as people read it */
};

/* The row's text, the caller's. room, plan "": of none. detail: taken. NULL: no memory; without its words the row would
 * not say what was done. */
char *keep_change_row(const char *room, const char *plan, const char *action, cJSON *detail,
                      const struct keep_change_by *by);
/* Adds the row (taken; NULL: none) to the write (taken), which is then a prompt one. is_whole: all else of it is there.
 * NULL: it is not, or no memory. */
struct store_room *keep_change_with(struct store_room *write, bool is_whole, char *row);
/* Gives the write with its row to the store. write: taken; NULL: there was no memory for it. False with problem
 * storage: nothing changes. */
NODISCARD bool keep_change_write(struct net *net, struct store_room *write, uint64_t *ticket, struct problem *problem);

enum keep_change { KEEP_CHANGE_OTHER, KEEP_CHANGE_WRITTEN, KEEP_CHANGE_REFUSED };
/* Reads the store's answer to the change with this ticket, which becomes 0 unless the answer is another's. problem: of
 * KEEP_CHANGE_REFUSED. */
enum keep_change keep_change_answer(uint64_t *ticket, const struct store_answer *answer, struct problem *problem);

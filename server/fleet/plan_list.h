#pragma once
/* The list of plans: entries come and go with the folders that the lister finds. Internal to server/fleet; net
 * thread. */
#include "server/fleet/plan_entry.h"

struct folder_list;

/* Adds plans for new folders, has changed ones scanned again, and frees those whose folder is gone and that nothing
 * uses. */
void plan_list_update(struct fleet *fleet, const struct folder_list *found);
/* Frees deleted plans that nothing uses any more. Never call it while the list is walked. */
void plan_list_drop_removed(struct fleet *fleet);

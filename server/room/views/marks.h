#pragma once
/* Marks: the measures, pinned probes and limits on doses of the shared scene. The presenter changes all of them, any
 * other member with the right scene those whose id ends with "-" and the member's id: so two who write at once never
 * have the same one. The room writes down who made each. Marks that come from another room, as with a saved view that
 * begins this one, keep their ids: no member of this room gets a number that such an id ends with. Internal to
 * server/room. */
#include "server/room/state/room_state.h"

/* True if the patch changes nothing of the scene but marks of this member; else fills problem: not-presenter, or
 * forbidden with the code "author" where it would change marks of others. */
bool marks_are_own(const struct room *room, const struct member *member, const cJSON *patch, struct problem *problem);
/* The number of the next new member: no mark of the scene has an id that ends with it. */
uint32_t marks_next_number(const struct room *room);
/* The patch with the name of the member in each mark that is new, or whose author the member may not choose: the
 * presenter's patch keeps the author that it gives, as that of a mark that comes back. The caller's; NULL: no memory.
 */
NODISCARD cJSON *marks_authored(const struct room *room, const struct member *member, const cJSON *patch);

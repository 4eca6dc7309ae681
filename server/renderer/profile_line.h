#pragma once
/* The line that the question of a dose profile asks for. Any thread. */
#include "core/dose/profile.h"
#include "core/scene/snapshot.h"
#include "server/wire/packet.h"
#include "server/wire/problem.h"

/* A beam from its entry through its target, as far as the dose's grid and the regions reach and, where it meets
 * regions, up to 10 mm before the first and behind the last; or from one point to another. False with problem. */
NODISCARD bool profile_line_find(const struct snapshot *snapshot, const struct dose *dose,
                                 const struct packet_profile *asked, struct profile_line *line,
                                 struct problem *problem);

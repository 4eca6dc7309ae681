#pragma once
/* How rooms ask for the meeting that they are a case of. Internal to server/net; net thread. */
#include "server/net/net_state.h"

extern const struct room_meeting_callbacks meeting_doors; /* context is the net */

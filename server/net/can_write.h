#pragma once
/* Whether anything can be accepted now that must last. Internal to server/net; net thread. */
#include "server/net/net_state.h"

/* Fills problem: the disk is full, or fails. Returns false. */
bool keep_refuse(bool is_full, struct problem *problem);
/* struct room_callbacks; context is the net */
bool keep_can_write(void *context, struct problem *problem);

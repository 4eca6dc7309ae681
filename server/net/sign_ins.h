#pragma once
/* Sign-ins of those who are connected: following in a meeting counts as input. Internal to server/net. */
#include "server/net/net_state.h"

enum { SIGN_INS_EVERY_MS = 20000 };

/* Looks at all connections if that is due, and notes when it is due next. */
void sign_ins_check(struct net *net, int64_t now_us);

#pragma once
/* Sign-ins of those who are connected: they end the connection with theirs, and following in a meeting counts as input.
 * Internal to server/net; net.h has what others ask. */
#include "server/net/net_state.h"

enum { SIGN_INS_EVERY_MS = 20000 }; /* a connection ends within a minute of its sign-in */

/* Looks at all connections if that is due, and notes when it is due next. */
void sign_ins_check(struct net *net, int64_t now_us);

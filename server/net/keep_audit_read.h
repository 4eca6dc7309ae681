#pragma once
/* Reads rows of the audit from the store (net_read_audit). Internal to server/net; net thread. */
#include "server/net/net_state.h"

void keep_audit_was_read(struct net *net, const struct store_answer *answer); /* borrowed */
void keep_audit_readers_finish(struct net *net); /* answers all that wait: the server stops */

#pragma once
/* Reads records of decisions and signatures from the store (net_read_records). Internal to server/net; net thread. */
#include "server/net/net_state.h"

void keep_records_were_read(struct net *net, const struct store_answer *answer); /* borrowed */
void keep_record_readers_finish(struct net *net); /* answers all that wait: the server stops */

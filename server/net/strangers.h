#pragma once
/* Connections whose room is not there, or sleeps and is not listed to them, where people sign in: they are told the
 * same as by a room that is closed to them, and wake none without a word that could open it. Internal to server/net. */
#include "server/net/net_state.h"

/* Says bye to who has spoken to a room that is not there, as such a room says it to those it is closed to. text: the
 * first that it said. */
void stranger_refuse(struct visitor *visitor, const char *text, size_t n);
/* True of a hello with a link or a member's secret, whether they are good or not. */
bool stranger_has_key(const char *text, size_t n);

#pragma once
/* How often one caller may call, make rooms, upload and open streams, where people sign in: so that nobody fills the
 * server for the others. Each limit is at least four times what one person's page has ever asked for (docs/api.md).
 * Internal to server/http; net thread. */
#include "server/http/call.h"

enum api_rate { API_RATE_CALLS, API_RATE_ROOMS, API_RATE_UPLOADS, API_RATE_STREAMS, API_N_RATES };
enum { API_MAX_CALLERS = 1024 }; /* whose rates are known; of more, one that was quiet for long is forgotten */

struct api_rates;

struct api_rates *api_rates_create(void);
void api_rates_destroy(struct api_rates *rates);
/* Counts one more of this. The caller is the user who has signed in; of others the address. False with problem limit
 * and the time to wait: it is too often. */
NODISCARD bool api_rates_take(struct api_rates *rates, const struct call *call, enum api_rate rate, int64_t now_us,
                              struct problem *problem);

#pragma once
/* Gathers the credentials of a request for server/auth. Internal to server/front. */
#include "server/front/front_state.h"
#include "server/front/head.h"

/* Fills in the link's identity; client: behind trusted proxies. False with problem: the request is refused. */
NODISCARD bool front_identify(struct front_link *link, const struct head_request *request, const struct address *client,
                              struct problem *problem);

#pragma once
/* Tells who a patient is, in full. Internal to server/http; net thread. */
#include "server/http/api_state.h"

/* Whether the caller, who has the right on the plan, may be told here and now. False with problem. */
NODISCARD bool api_identity_may_read(const struct api *api, const struct call *call, struct problem *problem);

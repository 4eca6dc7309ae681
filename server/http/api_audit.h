#pragma once
/* Records for the audit what calls give away as files. Internal to server/http; net thread. */
#include "server/http/api_state.h"

/* False with problem storage: what would be recorded cannot be stored now. */
NODISCARD bool api_audit_has_place(const struct api *api, struct problem *problem);
/* From now on the call is recorded as an export once it is answered with success. Handlers call it before they answer,
 * and may call it again. False: what would be recorded cannot be stored now, and the call was answered with storage. */
NODISCARD bool api_audit_export(struct api *api, struct call *call, const char *what);

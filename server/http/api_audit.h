#pragma once
/* Records for the audit what calls give away as files. Internal to server/http; net thread. */
#include "server/http/api_state.h"

/* True if it was made on the server's own machine, and the server answers that one alone. */
bool api_is_of_this_machine(const struct api *api, const struct call *call);
/* False with problem storage: what would be recorded cannot be stored now. */
NODISCARD bool api_audit_has_place(const struct api *api, struct problem *problem);
/* Adds the header Audit-Head to what is given away: number and hash of the newest row on the disk, for
 * beamroomd --verify-audit --audit-head. */
void api_audit_add_head(const struct api *api, struct call *call);
/* Marks the call as an export, which is recorded once it is answered with success. Handlers call it before they answer,
 * and may call it again. False: what would be recorded cannot be stored now, and the call was answered with storage. */
NODISCARD bool api_audit_export(struct api *api, struct call *call, const char *what);

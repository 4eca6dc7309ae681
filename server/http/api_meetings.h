#pragma once
/* Shared by the handlers of meetings. Internal to server/http; net thread. */
#include "server/http/api_state.h"
#include "server/net/meetings.h"

/* The meeting that the call's address names; NULL: there is none, the call was answered. */
const struct meeting *api_find_meeting(struct api *api, struct call *call);
/* Whether the caller sees the meeting, and with which role in it; by name, or by the seat in one of its rooms. */
bool api_meeting_role(const struct api *api, const struct call *call, const struct meeting *meeting,
                      enum wire_member_role *role);
/* The meeting as GET gives it to this caller. */
NODISCARD cJSON *api_meeting_document(struct api *api, const struct call *call, const struct meeting *meeting);
/* A copy of the meeting of the call, to be changed; NULL: the call was answered. */
NODISCARD struct meeting *api_meeting_copy(struct api *api, struct call *call);
/* Writes the change (taken), then answers with the meeting. what: for the audit. */
void api_meeting_commit(struct api *api, struct call *call, struct meeting *changed, const char *what,
                        const char *case_id);
/* net_meeting_done with a call: answers with the meeting, or the problem. */
void api_meeting_changed(void *context, const struct meeting *meeting, const struct problem *problem);

#pragma once
/* Jobs: what takes longer than a call (opening a plan, an upload, a film), its progress and its end. Internal to
 * server/http; net thread. */
#include "server/http/api_state.h"

/* Brings the states of running jobs up to date with their plans and uploads. */
void api_jobs_update(struct api *api);
/* Makes a job of the caller's. When there are too many one is forgotten: first one that opened a plan and has ended,
 * then one that opens a plan, then one whose film or upload has ended; never one whose film or upload goes on. kind:
 * "open", "upload" or "film". */
struct api_job *api_job_create(struct api *api, const struct call *call, const char *kind);
/* NULL: there is none, or not any more. */
struct api_job *api_job_find(struct api *api, const char *id);
void api_job_answer_missing(struct call *call);
/* Answers the call with 202, the job, and its address. */
void api_job_answer(struct api *api, struct call *call, struct api_job *job);

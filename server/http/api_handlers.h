#pragma once
/* The handler of every route of the API; api.c's table names them. Each answers its call now or later, exactly once.
 * Internal to server/http; net thread. */
#include "server/http/api_state.h"

void api_healthz(struct api *api, struct call *call);
void api_readyz(struct api *api, struct call *call);
void api_metrics(struct api *api, struct call *call);
void api_version(struct api *api, struct call *call);
void api_openapi(struct api *api, struct call *call);

void api_session(struct api *api, struct call *call);
void api_session_begin(struct api *api, struct call *call);
void api_session_end(struct api *api, struct call *call);
void api_session_confirm(struct api *api, struct call *call);
void api_session_input(struct api *api, struct call *call);
void api_session_first(struct api *api, struct call *call);
void api_signin_proxy(struct api *api, struct call *call);
void api_users(struct api *api, struct call *call);
void api_user_add(struct api *api, struct call *call);
void api_user_disable(struct api *api, struct call *call);
void api_user_password(struct api *api, struct call *call);
void api_tokens(struct api *api, struct call *call);
void api_token_make(struct api *api, struct call *call);
void api_token_revoke(struct api *api, struct call *call);

void api_plans(struct api *api, struct call *call);
void api_plan_search(struct api *api, struct call *call);
void api_plan(struct api *api, struct call *call);
void api_plan_upload(struct api *api, struct call *call);
void api_plan_delete(struct api *api, struct call *call);
void api_plan_revision(struct api *api, struct call *call);
void api_plan_erase(struct api *api, struct call *call);
void api_plan_open(struct api *api, struct call *call);
void api_plan_close(struct api *api, struct call *call);
void api_job(struct api *api, struct call *call);
void api_job_cancel(struct api *api, struct call *call);
void api_plan_film(struct api *api, struct call *call);
void api_room_film(struct api *api, struct call *call);
void api_room_recording_film(struct api *api, struct call *call);
void api_job_film(struct api *api, struct call *call);
void api_plan_render(struct api *api, struct call *call);
void api_plan_surface(struct api *api, struct call *call);
void api_plan_identity(struct api *api, struct call *call);
void api_plan_statement(struct api *api, struct call *call);
void api_plan_statement_withdraw(struct api *api, struct call *call);
void api_room_identity(struct api *api, struct call *call);
void api_room_wall_identity(struct api *api, struct call *call);

void api_rooms(struct api *api, struct call *call);
void api_room_new(struct api *api, struct call *call);
void api_room(struct api *api, struct call *call);
void api_room_patch(struct api *api, struct call *call);
void api_room_delete(struct api *api, struct call *call);
void api_room_scene(struct api *api, struct call *call);
void api_room_scene_patch(struct api *api, struct call *call);
void api_room_members(struct api *api, struct call *call);
void api_room_notes(struct api *api, struct call *call);
void api_meetings(struct api *api, struct call *call);
void api_meeting_new(struct api *api, struct call *call);
void api_meeting(struct api *api, struct call *call);
void api_meeting_patch(struct api *api, struct call *call);
void api_meeting_delete(struct api *api, struct call *call);
void api_meeting_end(struct api *api, struct call *call);
void api_meeting_go(struct api *api, struct call *call);
void api_meeting_enter(struct api *api, struct call *call);
void api_meeting_case_new(struct api *api, struct call *call);
void api_meeting_case_patch(struct api *api, struct call *call);
void api_meeting_case_delete(struct api *api, struct call *call);
void api_meeting_prepare(struct api *api, struct call *call);
void api_meeting_links(struct api *api, struct call *call);
void api_meeting_link_new(struct api *api, struct call *call);
void api_meeting_link_end(struct api *api, struct call *call);
void api_meeting_minutes(struct api *api, struct call *call);
void api_audit(struct api *api, struct call *call);
void api_records(struct api *api, struct call *call);
void api_record_search(struct api *api, struct call *call);
void api_record(struct api *api, struct call *call);
/* Whether the record that was read may be seen by the caller, else the call is answered: as if there were none. */
bool api_record_may_be_seen(struct call *call, const struct net_record *records, size_t n,
                            const struct problem *problem);
void api_record_paper(struct api *api, struct call *call);
void api_record_figure(struct api *api, struct call *call);
/* Whether a room or plan (what) with these many decisions and signatures may be deleted: records=keep was said where
 * there are any. False: the call was answered. */
bool api_may_delete(struct call *call, size_t n_decided, const char *what);
/* True: the plan folders are listed before the call is handled by `again`, once for a call. */
bool api_lists_first(struct api *api, struct call *call, void (*again)(struct api *api, struct call *call));
void api_room_record(struct api *api, struct call *call);
void api_room_recordings(struct api *api, struct call *call);
void api_room_recording_delete(struct api *api, struct call *call);
void api_room_recording_state(struct api *api, struct call *call);
void api_room_bookmarks(struct api *api, struct call *call);
void api_room_bookmark(struct api *api, struct call *call);
void api_room_bookmark_picture(struct api *api, struct call *call);
void api_permalink(struct api *api, struct call *call);
void api_room_snapshot(struct api *api, struct call *call);
void api_room_stream(struct api *api, struct call *call);
void api_room_events(struct api *api, struct call *call);
/* The reader of this feed has gone: its listener leaves its room. False: it is no listener's. */
bool api_listener_left(struct api *api, const struct feed *feed);
/* Ends the streams of those whose sign-in has ended or who have no right to the room any more. */
void api_streams_look(void *api);
void api_listeners_look(struct api *api); /* of events; api_streams_look does both */
void api_room_export(struct api *api, struct call *call);
void api_room_link_new(struct api *api, struct call *call);
void api_room_links(struct api *api, struct call *call);
void api_room_link_revoke(struct api *api, struct call *call);
void api_room_people(struct api *api, struct call *call);
void api_room_people_patch(struct api *api, struct call *call);
void api_room_member_remove(struct api *api, struct call *call);
void api_room_acceptances(struct api *api, struct call *call);
void api_room_control(struct api *api, struct call *call);
void api_room_ws(struct api *api, struct call *call);

/* The plan as it stands in lists; the caller's. */
cJSON *api_plan_head(const struct fleet_plan *plan);
/* The revision of the plan's files. False with problem: not known, busy while it is being found out. */
NODISCARD bool api_plan_revision_known(struct api *api, const char *plan_id, struct fleet_revision *revision,
                                       struct problem *problem);
/* The body of the bookmark with this token, of any room; the caller's. NULL: there is none. */
NODISCARD cJSON *api_bookmark_of_token(struct api *api, const char *token);
/* True: the token may be of a room that sleeps; the call's handler runs once more when that has been looked for. */
NODISCARD bool api_bookmark_sleeps(struct api *api, struct call *call, const char *token,
                                   void (*handle)(struct api *api, struct call *call));

#pragma once
/* Pictures for a call: limits per plan, the request to the renderer, and the answer with bytes and headers. Internal to
 * server/http; net thread. */
#include "server/http/api_state.h"

struct api_marking {
    bool has_caption;   /* and letters and scale bar */
    bool is_named;      /* the caption has the patient in full, else masked */
    bool has_crosshair; /* on a slice; with a caption */
};

/* Requests a picture from the plan's renderer and answers the call with its bytes.
 *
 *   scene, view  complete documents, borrowed
 *   acceptances  [{thing, with, by, words}] for the renderer, borrowed; NULL: none
 *   revision     of the room whose scene it is, for the header Beamroom-Revision; NULL: no room's
 *   format       "png", "jpeg" or NULL for png; others are refused
 *   quality      of a JPEG, 1 to 100
 *   marking      what is painted onto the picture and below it
 *   shared_as    calls with the same text want the same picture of the plan, and are answered with one drawing as long
 *                as it is under way; at most API_SHARED_AS_SIZE bytes; NULL: this call alone */
void api_picture_request(struct api *api, struct call *call, const char *plan_id, const cJSON *scene,
                         const cJSON *acceptances, const uint32_t *revision, const cJSON *view, const char *format,
                         double quality, struct api_marking marking, const char *shared_as);
/* The call's parameter "view" as a complete document; the default view when it was not given. NULL: the call was
 * answered with a problem. */
NODISCARD cJSON *api_view_parameter(struct call *call);

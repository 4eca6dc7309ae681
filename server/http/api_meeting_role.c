/* The role of a caller in a meeting. */
#include "server/http/api_meetings.h"

bool api_meeting_role(const struct api *api, const struct call *call, const struct meeting *meeting,
                      enum wire_member_role *role)
{
    enum wire_member_role sits;
    bool presents;
    const bool is_known = net_meeting_role(api->net, meeting, &call->identity, role);
    if (!net_meeting_seat(api->net, meeting, &call->identity, call->member, &sits, &presents))
        return is_known;
    if (presents && sits < WIRE_MEMBER_ROLE_PRESENTER)
        sits = WIRE_MEMBER_ROLE_PRESENTER; /* has the meeting go on, as by the message meeting.next */
    if (!is_known || (sits > *role && sits != WIRE_MEMBER_ROLE_WALL))
        *role = sits;
    return true;
}

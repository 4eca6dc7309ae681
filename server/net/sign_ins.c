/* Asks about the identity of each visitor from time to time. */
#include "server/net/sign_ins.h"

#include <string.h>

#include "core/base/clock.h"
#include "server/auth/auth.h"
#include "server/net/schedule.h"

/* The sign-in behind the connection is over. */
static void sign_out(struct visitor *visitor)
{
    struct net_room *room = visitor->room;
    if (!room) {
        ws_bye_code(visitor->connection, WS_CLOSE_POLICY, "sign-in", "your sign-in has ended", -1);
        return;
    }
    room_sign_in_over(room->room, visitor->connection, clock_now_us());
    schedule_room(room);
}

void net_on_identities(struct net *net, void (*looked)(void *context), void *context)
{
    net->identities_looked = looked;
    net->identities_context = context;
}

static void tell_looked(struct net *net)
{
    if (net->identities_looked)
        net->identities_looked(net->identities_context);
}

void net_look_at(struct net *net, int64_t time_us)
{
    if (!net->looked_us || time_us < net->looked_us)
        net->looked_us = time_us;
    schedule_at(net, net->looked_us);
}

void net_session_over(struct net *net, const char *session)
{
    for (struct visitor *visitor = net->visitors; visitor; visitor = visitor->next)
        if (session[0] && strcmp(visitor->identity.session, session) == 0)
            sign_out(visitor);
    tell_looked(net);
}

void net_accounts_changed(struct net *net)
{
    net->sign_ins_us = 0;
    schedule_at(net, 0);
}

void net_grants_changed(struct net *net)
{
    for (size_t i = 0; i < net->n_rooms; i++) {
        room_grants_changed(net->rooms[i]->room, clock_now_us());
        schedule_room(net->rooms[i]);
    }
    tell_looked(net);
}

bool net_identity_holds(const struct net *net, const struct identity *who)
{
    struct identity now = *who;
    return !net->is_still || !who->user[0] || net->is_still(net->rights, &now);
}

static void look_at(struct net *net, struct visitor *visitor)
{
    if (net->is_still && visitor->identity.user[0] && !net->is_still(net->rights, &visitor->identity))
        sign_out(visitor);
    else if (visitor->identity.source == IDENTITY_PASSWORD && visitor->room &&
             room_is_followed(visitor->room->room, visitor->connection))
        auth_session_used(net->auth, visitor->identity.session);
}

void sign_ins_check(struct net *net, int64_t now_us)
{
    if (net->looked_us && now_us >= net->looked_us) {
        net->looked_us = 0;
        tell_looked(net);
    }
    if (!net->auth || (!auth_is_local(net->auth) && !auth_is_proxied(net->auth)))
        return;
    if (now_us >= net->sign_ins_us) {
        net->sign_ins_us = now_us + SIGN_INS_EVERY_MS * INT64_C(1000);
        auth_tick(net->auth);
        for (struct visitor *visitor = net->visitors; visitor; visitor = visitor->next)
            look_at(net, visitor);
        tell_looked(net);
    }
    schedule_at(net, net->sign_ins_us);
}

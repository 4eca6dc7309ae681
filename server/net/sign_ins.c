/* Tells server/auth of each visitor who follows. */
#include "server/net/sign_ins.h"

#include "server/auth/auth.h"
#include "server/net/schedule.h"

void sign_ins_check(struct net *net, int64_t now_us)
{
    if (!net->auth || (!auth_is_local(net->auth) && !auth_is_proxied(net->auth)))
        return;
    if (now_us >= net->sign_ins_us) {
        net->sign_ins_us = now_us + SIGN_INS_EVERY_MS * INT64_C(1000);
        auth_tick(net->auth);
        for (const struct visitor *visitor = net->visitors; visitor; visitor = visitor->next)
            if (visitor->identity.source == IDENTITY_PASSWORD && visitor->room &&
                room_is_followed(visitor->room->room, visitor->connection))
                auth_session_used(net->auth, visitor->identity.session);
    }
    schedule_at(net, net->sign_ins_us);
}

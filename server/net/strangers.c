/* Answers those who are not known to a room: strangers.h. */
#include "server/net/strangers.h"

#include "server/wire/message.h"

/* Brought by a first text, to be let in by. */
struct keys {
    bool has_link, has_seat;
};

static struct keys read_keys(const char *text, size_t n)
{
    struct keys keys = { 0 };
    struct message message;
    struct problem problem;
    if (!message_read(text, n, true, &message, &problem))
        return keys;
    if (message.type == MESSAGE_HELLO)
        keys = (struct keys){ message.hello.link[0] != 0, message.hello.member[0] && message.hello.secret[0] };
    message_finish(&message);
    return keys;
}

void stranger_refuse(struct visitor *visitor, const char *text, size_t n)
{
    visitor->is_refused = true;
    if (visitor->identity.source == IDENTITY_NOBODY && !read_keys(text, n).has_link)
        ws_bye_code(visitor->connection, WS_CLOSE_POLICY, "sign-in", ROOM_NEEDS_SIGN_IN, -1);
    else /* a link that the room does not know */
        ws_bye(visitor->connection, WS_CLOSE_NORMAL, ROOM_IS_CLOSED, -1);
}

bool stranger_has_key(const char *text, size_t n)
{
    const struct keys keys = read_keys(text, n);
    return keys.has_link || keys.has_seat;
}

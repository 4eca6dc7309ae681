/* A place for each WebSocket: few enough that the search for a free one also counts those of the same address. */
#include "server/front/websocket_count.h"

void websocket_count_init(struct websocket_count *count)
{
    for (size_t i = 0; i < FRONT_MAX_WEBSOCKETS; i++)
        atomic_init(&count->places[i].is_used, false);
}

struct websocket_place *websocket_count_add(struct websocket_count *count, const struct address *client,
                                            struct problem *problem)
{
    struct address counted = address_counted(client);
    struct websocket_place *unused = NULL;
    size_t n_same = 0;
    for (size_t i = 0; i < FRONT_MAX_WEBSOCKETS; i++) {
        struct websocket_place *place = &count->places[i];
        if (!atomic_load(&place->is_used))
            unused = place;
        else
            n_same += address_is_equal(&place->counted, &counted);
    }
    if (!unused || n_same >= FRONT_MAX_WEBSOCKETS_PER_ADDRESS) {
        (void)problem_set(problem, PROBLEM_LIMIT, "", "",
                          "too many WebSockets are open: at most %d in all, %d from one address", FRONT_MAX_WEBSOCKETS,
                          FRONT_MAX_WEBSOCKETS_PER_ADDRESS);
        problem->retry_after_ms = FRONT_RETRY_MS;
        return NULL;
    }
    unused->counted = counted;
    atomic_store(&unused->is_used, true);
    return unused;
}

void websocket_count_ended(void *place)
{
    struct websocket_place *ended = place;
    atomic_store(&ended->is_used, false);
}

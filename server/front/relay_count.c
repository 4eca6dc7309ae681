/* Counts connections per client and in all, and keeps the list of links to advance. */
#include "server/front/relay_count.h"

#include "core/base/clock.h"
#include "core/base/log.h"

static size_t count_address(const struct relay *relay, const struct address *counted)
{
    size_t n = 0;
    for (const struct relay_link *link = relay->links; link; link = link->next)
        n += link->is_counted && address_is_equal(&link->counted, counted);
    return n;
}

void relay_uncount(struct relay_link *link)
{
    link->relay->n_counted -= link->is_counted;
    link->is_counted = false;
}

/* A request that waits inside the library keeps memory and a descriptor after its client has gone, so it still counts:
 * a client could else send requests and go without end. */
void relay_uncount_ended(struct relay_link *link)
{
    if (link->server < 0)
        relay_uncount(link);
}

bool relay_count(struct relay_link *link, const struct address *client, struct problem *problem)
{
    struct relay *relay = link->relay;
    struct address counted = address_counted(client);
    if (link->is_counted && address_is_equal(&link->counted, &counted))
        return true;
    size_t n_before = count_address(relay, &counted), n_all = relay->n_counted - link->is_counted;
    if (n_all >= RELAY_MAX_CONNECTIONS || n_before >= RELAY_MAX_PER_ADDRESS) {
        problem_set(problem, PROBLEM_LIMIT, "", "", "too many connections: at most %d in all, %d from one address",
                    RELAY_MAX_CONNECTIONS, RELAY_MAX_PER_ADDRESS);
        problem->retry_after_ms = RELAY_RETRY_MS;
        return false;
    }
    relay->n_counted += !link->is_counted;
    link->is_counted = true;
    link->counted = counted;
    return true;
}

void relay_log_refusal(struct relay *relay)
{
    int64_t now_us = clock_now_us();
    relay->n_refused++;
    if (relay->logged_us && now_us - relay->logged_us < 10000000)
        return;
    log_warn("http: too many connections: %zu refused", relay->n_refused);
    relay->logged_us = now_us;
    relay->n_refused = 0;
}

void relay_touch(struct relay_link *link)
{
    if (link->is_touched)
        return;
    link->is_touched = true;
    link->next_touched = link->relay->touched;
    link->relay->touched = link;
}

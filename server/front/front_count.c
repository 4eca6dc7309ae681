/* Counts connections by state, per client and in all, and keeps the list of links to advance. */
#include "server/front/front_count.h"

#include "core/base/clock.h"
#include "core/base/log.h"

/* The number of links in the state of this one, where there is a limit; NULL: there is none. */
static size_t *counter_of(const struct front_link *link)
{
    struct front *front = link->front;
    if (link->state == LINK_HEAD && link->is_first)
        return &front->n_waiting;
    if (link->state == LINK_LINGER)
        return link->is_first ? &front->n_lingering_first : &front->n_lingering;
    return NULL;
}

void front_set_state(struct front_link *link, enum link_state state)
{
    size_t *counter = counter_of(link);
    if (counter)
        --*counter;
    link->state = state;
    counter = counter_of(link);
    if (counter)
        ++*counter;
}

void front_end_waiting(struct front_link *link)
{
    link->front->n_waiting -= link->is_first;
    link->is_first = false;
}

bool front_may_wait(const struct front *front, const struct address *peer, bool is_trusted)
{
    const struct address counted = address_counted(peer);
    size_t n_same = 0;
    if (front->n_waiting >= FRONT_MAX_WAITING)
        return false;
    if (is_trusted || address_is_in(peer, front->options.trusted, front->options.n_trusted))
        return true;
    for (const struct front_link *link = front->links; link; link = link->next) {
        if (link->state != LINK_HEAD || !link->is_first)
            continue;
        struct address other = address_counted(&link->peer);
        n_same += address_is_equal(&other, &counted);
    }
    return n_same < FRONT_MAX_WAITING_PER_ADDRESS;
}

static size_t count_address(const struct front *front, const struct address *counted)
{
    size_t n = 0;
    for (const struct front_link *link = front->links; link; link = link->next)
        n += link->is_counted && address_is_equal(&link->counted, counted);
    return n;
}

void front_uncount(struct front_link *link)
{
    link->front->n_counted -= link->is_counted;
    link->is_counted = false;
}

/* A request that waits inside the library keeps memory and a descriptor after its client has gone, so it still counts:
 * a client could else send requests and go without end. */
void front_uncount_ended(struct front_link *link)
{
    if (link->server < 0)
        front_uncount(link);
}

bool front_count(struct front_link *link, const struct address *client, struct problem *problem)
{
    struct front *front = link->front;
    struct address counted = address_counted(client);
    if (link->is_counted && address_is_equal(&link->counted, &counted))
        return true;
    size_t n_before = count_address(front, &counted), n_all = front->n_counted - link->is_counted;
    if (n_all >= FRONT_MAX_CONNECTIONS || n_before >= FRONT_MAX_PER_ADDRESS) {
        problem_set(problem, PROBLEM_LIMIT, "", "", "too many connections: at most %d in all, %d from one address",
                    FRONT_MAX_CONNECTIONS, FRONT_MAX_PER_ADDRESS);
        problem->retry_after_ms = FRONT_RETRY_MS;
        return false;
    }
    front->n_counted += !link->is_counted;
    link->is_counted = true;
    link->counted = counted;
    return true;
}

void front_log_refusal(struct front *front)
{
    int64_t now_us = clock_now_us();
    front->n_refused++;
    if (front->logged_us && now_us - front->logged_us < 10000000)
        return;
    log_warn("http: too many connections: %zu refused", front->n_refused);
    front->logged_us = now_us;
    front->n_refused = 0;
}

void front_touch(struct front_link *link)
{
    if (link->is_touched)
        return;
    link->is_touched = true;
    link->next_touched = link->front->touched;
    link->front->touched = link;
}

/* Says why nothing is accepted that must last: can_write.h. */
#include "server/net/can_write.h"

bool keep_refuse(bool is_full, struct problem *problem)
{
    (void)problem_set(problem, PROBLEM_STORAGE, "", is_full ? "full" : "write",
                      "%s: this was not kept and does not count; give it again when the disk can be written",
                      is_full ? "the server's disk is full" : "the server cannot write to its disk, its log says why");
    problem->retry_after_ms = 10000;
    return false;
}

bool keep_can_write(void *context, struct problem *problem)
{
    const struct net *net = context;
    return !net->store || !net->store_fails || keep_refuse(net->store_is_full, problem);
}

bool net_can_write(struct net *net, struct problem *problem)
{
    return keep_can_write(net, problem);
}

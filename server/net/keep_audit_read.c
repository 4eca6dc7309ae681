/* Passes rows of the audit from the store to who asked for them. */
#include "server/net/keep_audit_read.h"

#include <stdlib.h>

#include "core/base/mem.h"

bool net_read_audit(struct net *net, const struct store_audit_query *query, net_audit_read *done, void *context,
                    struct problem *problem)
{
    if (!net->store)
        return problem_set(problem, PROBLEM_NOT_FOUND, "", "", "this server keeps no records");
    if (store_read_audit(net->store, query, net->n_tickets + 1)) {
        struct audit_reader *reader = mem_new(sizeof *reader);
        *reader = (struct audit_reader){
            .next = net->audit_readers, .ticket = ++net->n_tickets, .done = done, .context = context
        };
        net->audit_readers = reader;
        return true;
    }
    problem_set(problem, PROBLEM_BUSY, "", "", "the disk has too much to do to read records now");
    problem->retry_after_ms = 1000;
    return false;
}

void keep_audit_was_read(struct net *net, const struct store_answer *answer)
{
    struct audit_reader **at = &net->audit_readers;
    struct problem problem;
    while (*at && (*at)->ticket != answer->ticket)
        at = &(*at)->next;
    struct audit_reader *reader = *at;
    if (!reader)
        return;
    *at = reader->next;
    if (!answer->audit)
        problem_set(&problem, PROBLEM_STORAGE, "", "", "%s", answer->error.text);
    reader->done(reader->context, answer->audit, answer->n_audit_rows, answer->next_n, answer->audit ? NULL : &problem);
    free(reader);
}

void keep_audit_readers_finish(struct net *net)
{
    struct problem problem;
    problem_set(&problem, PROBLEM_BUSY, "", "", "the server is stopping");
    while (net->audit_readers) {
        struct audit_reader *reader = net->audit_readers;
        net->audit_readers = reader->next;
        reader->done(reader->context, NULL, 0, 0, &problem);
        free(reader);
    }
}

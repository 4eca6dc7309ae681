/* Passes records from the store to who asked for them. */
#include "server/net/keep_records.h"

#include <stdlib.h>

#include "core/base/mem.h"

bool net_read_records(struct net *net, const char *id, const char *before, net_records_read *done, void *context,
                      struct problem *problem)
{
    if (!net->store)
        return problem_set(problem, PROBLEM_NOT_FOUND, "", "", "this server keeps no records");
    if (store_read_records(net->store, id, before, net->n_tickets + 1)) {
        struct record_reader *reader = mem_new(sizeof *reader);
        *reader = (struct record_reader){
            .next = net->record_readers, .ticket = ++net->n_tickets, .done = done, .context = context
        };
        net->record_readers = reader;
        return true;
    }
    problem_set(problem, PROBLEM_BUSY, "", "", "the disk has too much to do to read records now");
    problem->retry_after_ms = 1000;
    return false;
}

static void give(const struct record_reader *reader, const struct store_answer *answer)
{
    struct problem problem;
    struct net_record *list = mem_array(answer->n_records + 1, sizeof *list, 1 << 20, NULL);
    if (!answer->records || !list) {
        problem_set(&problem, answer->error.code == ERROR_NOT_FOUND ? PROBLEM_NOT_FOUND : PROBLEM_STORAGE, "", "", "%s",
                    list ? answer->error.text : "no memory for records");
        reader->done(reader->context, NULL, 0, &problem);
        free(list);
        return;
    }
    for (size_t i = 0; i < answer->n_records; i++) {
        const struct store_record *record = &answer->records[i];
        list[i] = (struct net_record){ .id = record->id,
                                       .room = record->room,
                                       .plan = record->plan,
                                       .kind = record->kind,
                                       .author = record->author,
                                       .author_name = record->author_name,
                                       .item = record->item,
                                       .body = record->body,
                                       .hash = record->hash,
                                       .facts = record->facts,
                                       .time_ms = record->time_ms,
                                       .figures = record->figures,
                                       .signatures = record->signatures,
                                       .decisions = record->decisions };
    }
    reader->done(reader->context, list, answer->n_records, NULL);
    free(list);
}

void keep_records_were_read(struct net *net, const struct store_answer *answer)
{
    struct record_reader **at = &net->record_readers;
    while (*at && (*at)->ticket != answer->ticket)
        at = &(*at)->next;
    struct record_reader *reader = *at;
    if (!reader)
        return;
    *at = reader->next;
    give(reader, answer);
    free(reader);
}

void keep_record_readers_finish(struct net *net)
{
    struct problem problem;
    problem_set(&problem, PROBLEM_BUSY, "", "", "the server is stopping");
    while (net->record_readers) {
        struct record_reader *reader = net->record_readers;
        net->record_readers = reader->next;
        reader->done(reader->context, NULL, 0, &problem);
        free(reader);
    }
}

/* Writes changes of lists with their rows of the audit, and reads the store's answers to them. */
#include "server/net/keep_change.h"

#include <stdlib.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "server/net/can_write.h"
#include "server/net/keep_audit.h"

char *keep_change_row(const char *room, const char *plan, const char *action, cJSON *detail,
                      const struct keep_change_by *by)
{
    char *words = json_print(detail);
    const struct room_audit row = { .time_ms = clock_wall_ms(),
                                    .action = action,
                                    .member = "",
                                    .name = by->name,
                                    .role = "",
                                    .address = by->address,
                                    .user = by->who->user,
                                    .source = identity_source_word(by->who->source),
                                    .session = by->who->session,
                                    .detail = words ? words : "{}",
                                    .result = "done",
                                    .before = -1,
                                    .after = -1 };
    cJSON *json = keep_audit_describe(room, plan, &row);
    char *text = words ? json_print(json) : NULL;
    cJSON_Delete(json);
    cJSON_Delete(detail);
    free(words);
    return text;
}

struct store_room *keep_change_with(struct store_room *write, bool is_whole, char *row)
{
    write->audit = row ? mem_array(1, sizeof write->audit[0], 1 << 20, NULL) : NULL;
    if (write->audit)
        write->audit[write->n_audit++] = row;
    else
        free(row);
    write->is_prompt = row != NULL;
    if (is_whole && (!row || write->audit))
        return write;
    store_room_free(write);
    return NULL;
}

bool keep_change_write(struct net *net, struct store_room *write, uint64_t *ticket, struct problem *problem)
{
    if (!write || !store_write(net->store, write, net->n_tickets + 1)) {
        store_room_free(write);
        return keep_refuse(false, problem);
    }
    *ticket = ++net->n_tickets;
    net->n_audit_waiting++;
    return true;
}

enum keep_change keep_change_answer(uint64_t *ticket, const struct store_answer *answer, struct problem *problem)
{
    if (!*ticket || *ticket != answer->ticket)
        return KEEP_CHANGE_OTHER;
    *ticket = 0;
    if (answer->error.code == ERROR_NONE)
        return KEEP_CHANGE_WRITTEN;
    (void)keep_refuse(answer->error.code == ERROR_LIMIT, problem);
    return KEEP_CHANGE_REFUSED;
}

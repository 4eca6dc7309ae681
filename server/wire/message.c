/* Finds the message by its "type" and gives its table to fields.h: message.h. */
#include "server/wire/message.h"

#include <string.h>

bool message_read(const char *bytes, size_t n, bool from_client, struct message *message, struct problem *problem)
{
    memset(message, 0, sizeof *message);
    if (n > WIRE_MAX_CLIENT_BYTES && from_client)
        return problem_set(problem, PROBLEM_TOO_LARGE, "", "", "a message of %zu bytes, at most %d are allowed", n,
                           WIRE_MAX_CLIENT_BYTES);
    cJSON *json = json_read(bytes, n, problem);
    if (!json)
        return false;
    bool ok = false;
    const char *name = json_text(json, "type");
    if (!name) {
        problem_set(problem, PROBLEM_VALIDATION, "/type", "required", "a message needs a \"type\"");
        goto done;
    }
    for (int type = 0; type < MESSAGE_N_TYPES; type++) {
        const struct message_description *description = &message_descriptions[type];
        if (description->is_from_client != from_client || strcmp(description->name, name) != 0)
            continue;
        message->type = (enum message_type)type;
        ok = fields_read(description->object, json, "type", (char *)message + description->offset, problem);
        goto done;
    }
    problem_set(problem, PROBLEM_VALIDATION, "/type", "enum", "\"%.40s\" is not a message from the %s", name,
                from_client ? "page" : "server");
done:
    cJSON_Delete(json);
    return ok;
}

char *message_write(const struct message *message)
{
    const struct message_description *description = &message_descriptions[message->type];
    cJSON *json = fields_write(description->object, (const char *)message + description->offset);
    cJSON_AddStringToObject(json, "type", description->name);
    char *text = json_print(json);
    cJSON_Delete(json);
    return text;
}

void message_finish(struct message *message)
{
    const struct message_description *description = &message_descriptions[message->type];
    fields_finish(description->object, (char *)message + description->offset);
}

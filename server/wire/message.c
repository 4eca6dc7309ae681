/* Finds the message by its "type" and gives its table to fields.h: message.h. */
#include "server/wire/message.h"

#include <string.h>

/* The number at *at, written as JSON.stringify writes a whole one, and the text behind it; false: something else. */
static bool take_number(const char **at, const char *end, const char *behind, const struct field *field, int64_t *value)
{
    const char *from = *at;
    size_t n_behind = strlen(behind);
    for (*value = 0; *at < end && **at >= '0' && **at <= '9' && *at - from < 10; ++*at)
        *value = *value * 10 + (**at - '0');
    if (*at == from || (*from == '0' && *at - from > 1) || (double)*value < field->min || (double)*value > field->max ||
        (size_t)(end - *at) < n_behind || memcmp(*at, behind, n_behind) != 0)
        return false;
    *at += n_behind;
    return true;
}

/* A frame.shown as pages write it, without the general reader: of what a member says it is nearly all, and with two
 * hundred members it would be most of a thread's time. What is written in another way, or is wrong, is left to that. */
static bool read_frame_shown(const char *bytes, size_t n, struct message *message)
{
    static const char begin[] = "{\"type\":\"frame.shown\",\"view\":";
    const char *at = bytes + sizeof begin - 1, *end = bytes + n;
    const struct field *fields = message_descriptions[MESSAGE_FRAME_SHOWN].object->fields; /* view, sequence */
    struct message_frame_shown shown;
    if (n <= sizeof begin || memcmp(bytes, begin, sizeof begin - 1) != 0 ||
        !take_number(&at, end, ",\"sequence\":", &fields[0], &shown.view) ||
        !take_number(&at, end, "}", &fields[1], &shown.sequence) || at != end)
        return false;
    message->type = MESSAGE_FRAME_SHOWN;
    message->frame_shown = shown;
    return true;
}

bool message_read(const char *bytes, size_t n, bool from_client, struct message *message, struct problem *problem)
{
    if (from_client && read_frame_shown(bytes, n, message))
        return true;
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

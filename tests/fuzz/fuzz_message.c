/* Text messages of the WebSocket, as the browser sends them: first byte odd reads it as the server's instead. */
#include "server/wire/message.h"
#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    if (n < 1)
        return 0;
    bool from_client = data[0] % 2 == 0;
    struct message message;
    struct problem problem = { 0 };
    if (!message_read((const char *)data + 1, n - 1, from_client, &message, &problem)) {
        REQUIRE(problem.type != PROBLEM_NONE);
        REQUIRE(problem.detail[0] != '\0');
        cJSON *json = problem_to_json(&problem);
        struct problem back = { 0 };
        REQUIRE(problem_from_json(json, &back));
        REQUIRE(back.type == problem.type);
        cJSON_Delete(json);
        return 0;
    }
    REQUIRE(message.type < MESSAGE_N_TYPES);
    REQUIRE(message_descriptions[message.type].is_from_client == from_client);

    char *once = message_write(&message);
    message_finish(&message);
    REQUIRE(message_read(once, strlen(once), from_client, &message, &problem));
    char *twice = message_write(&message);
    message_finish(&message);
    REQUIRE(strcmp(once, twice) == 0);
    free(once);
    free(twice);
    return 0;
}

/* Text messages of the WebSocket. An accepted message must survive writing and reading again. */
#include <stdlib.h>
#include <string.h>

#include "server/wire/message.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    struct message message, again;
    struct problem problem;
    for (int from_client = 0; from_client < 2; from_client++) {
        if (!message_read((const char *)data, n, from_client, &message, &problem))
            continue;
        char *text = message_write(&message);
        if (message_read(text, strlen(text), from_client, &again, &problem))
            message_finish(&again);
        else if (problem.type != PROBLEM_TOO_LARGE) /* written with every field, it may exceed the size limit */
            abort();
        free(text);
        message_finish(&message);
    }
    return 0;
}

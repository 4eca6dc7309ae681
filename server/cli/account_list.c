/* A call for a list, and its rows. */
#include "server/cli/account_list.h"

#include <stdio.h>

#include "server/cli/exit_code.h"

int account_refused(const char *command, const struct error *err)
{
    fprintf(stderr, "beamroom %s: %s\n", command, err->text);
    return EXIT_REFUSED;
}

int account_list(const struct account_words *words, const char *command, const char *path, const char *list,
                 void (*print)(const cJSON *row))
{
    struct error err = { 0 };
    cJSON *answer;
    if (!control_call(words->data, "GET", path, NULL, &answer, &err))
        return account_refused(command, &err);
    if (words->wants_json) {
        char *text = json_print(answer);
        puts(text ? text : "");
        cJSON_free(text);
    } else {
        const cJSON *row;
        cJSON_ArrayForEach(row, cJSON_GetObjectItemCaseSensitive(answer, list)) print(row);
    }
    cJSON_Delete(answer);
    return EXIT_DONE;
}

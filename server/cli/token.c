/* `beamroom token`: tokens of scripts at a running daemon. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "server/cli/account_list.h"
#include "server/cli/command.h"
#include "server/cli/exit_code.h"
#include "server/cli/text.h"
#include "server/wire/json.h"

static void print_help(void)
{
    fputs(
        "usage: beamroom token create --user USER --name NAME --scope SCOPE[,SCOPE] --days N [--folder DIR]... [--data DIR]\n"
        "       beamroom token revoke ID [--data DIR]\n"
        "       beamroom token list [--json] [--data DIR]\n"
        "Manages the tokens of scripts at the daemon that runs on the data folder DIR, by its socket there. A script\n"
        "sends its token as the header Authorization: Bearer TOKEN. create prints it, once; the daemon keeps its hash.\n\n"
        "  --user USER      as whom it acts\n"
        "  --name NAME      what it is for; others read it as the name of who does something with it\n"
        "  --scope SCOPE    read; plan, changes and uploads; pull, from an archive; admin\n"
        "  --days N         how long it lasts, 1 to 366\n"
        "  --folder DIR     a folder of grants that it is held to; all that USER may see by default\n"
        "  --data DIR       the daemon's data folder; its default by default\n"
        "  --json           the list as the daemon's API gives it\n"
        "  --help           this text\n",
        stdout);
}

static void print_text(const cJSON *object, const char *name)
{
    const char *text = json_text(object, name);
    text_print(stdout, text ? text : "", 0);
    printf("\t");
}

static void print_token(const cJSON *token)
{
    char day[16] = "";
    struct tm utc;
    const time_t expires = (time_t)(json_number(token, "expires_ms", 0) / 1000);
    const cJSON *scope;
    print_text(token, "id");
    print_text(token, "user");
    print_text(token, "name");
    cJSON_ArrayForEach(scope, cJSON_GetObjectItemCaseSensitive(token, "scope"))
        printf("%s%s", scope->valuestring ? scope->valuestring : "", scope->next ? "," : "\t");
    if (gmtime_r(&expires, &utc))
        (void)strftime(day, sizeof day, "%Y-%m-%d", &utc);
    printf("%s %s\n", json_number(token, "revoked_ms", 0) > 0 ? "revoked, would last until" : "until", day);
}

/* The words of a list that is parted by commas. */
static cJSON *list_of(const char *words)
{
    cJSON *list = cJSON_CreateArray();
    while (*words) {
        char word[80];
        const size_t n = strcspn(words, ",");
        (void)snprintf(word, sizeof word, "%.*s", (int)(n < sizeof word ? n : sizeof word - 1), words);
        if (n)
            cJSON_AddItemToArray(list, cJSON_CreateString(word));
        words += n + (words[n] != 0);
    }
    return list;
}

static int create(const struct account_words *words)
{
    struct error err = { 0 };
    cJSON *answer = NULL, *body = cJSON_CreateObject(), *folders = cJSON_CreateArray();
    for (size_t i = 0; i < words->n_folders; i++)
        cJSON_AddItemToArray(folders, cJSON_CreateString(words->folders[i]));
    cJSON_AddStringToObject(body, "user", words->user);
    cJSON_AddStringToObject(body, "name", words->name);
    cJSON_AddItemToObject(body, "scope", list_of(words->scope));
    cJSON_AddItemToObject(body, "folders", folders);
    cJSON_AddNumberToObject(body, "days", strtod(words->days, NULL));
    if (!control_call(words->data, "POST", "/api/v1/tokens", body, &answer, &err))
        return account_refused("token", &err);
    const char *token = json_text(answer, "token");
    puts(token ? token : "");
    cJSON_Delete(answer);
    return EXIT_DONE;
}

static int revoke(const struct account_words *words)
{
    char path[100];
    struct error err = { 0 };
    cJSON *answer = NULL;
    if (strspn(words->subject, "0123456789abcdef") != strlen(words->subject) || strlen(words->subject) > 32) {
        fprintf(stderr, "beamroom token: '%.60s' is no id of a token; see beamroom token list\n", words->subject);
        return EXIT_USAGE;
    }
    (void)snprintf(path, sizeof path, "/api/v1/tokens/%s", words->subject);
    if (!control_call(words->data, "DELETE", path, NULL, &answer, &err))
        return account_refused("token", &err);
    cJSON_Delete(answer);
    return EXIT_DONE;
}

int command_token(int argc, char **argv)
{
    struct account_words words;
    if (!account_words_read(argc, argv, "token", &words))
        return EXIT_USAGE;
    if (words.wants_help) {
        print_help();
        return EXIT_DONE;
    }
    if (words.act && strcmp(words.act, "list") == 0 && !words.subject)
        return account_list(&words, "token", "/api/v1/tokens", "tokens", print_token);
    if (words.act && strcmp(words.act, "revoke") == 0 && words.subject)
        return revoke(&words);
    if (words.act && strcmp(words.act, "create") == 0 && !words.subject) {
        if (words.user && words.name && words.scope && words.days)
            return create(&words);
        fputs("beamroom token: create needs --user, --name, --scope and --days; see --help\n", stderr);
        return EXIT_USAGE;
    }
    fputs("beamroom token: expected create, revoke ID or list; see --help\n", stderr);
    return EXIT_USAGE;
}

/* `beamroom user`: users of a running daemon. */
#include <stdio.h>
#include <string.h>

#include "server/cli/account_list.h"
#include "server/cli/command.h"
#include "server/cli/exit_code.h"
#include "server/cli/password.h"
#include "server/cli/text.h"
#include "server/wire/json.h"

static void print_help(void)
{
    fputs(
        "usage: beamroom user add USER [--name NAME] [--groups GROUP,GROUP] [--data DIR]\n"
        "       beamroom user passwd|disable|enable USER [--data DIR]\n"
        "       beamroom user list [--json] [--data DIR]\n"
        "Manages the people who sign in with a password at the daemon that runs on the data folder DIR, by its socket\n"
        "there. A password is read from the terminal, or as one line of standard input. Who is in the group admin is\n"
        "an administrator. Disabling ends sign-ins and refuses tokens; a new password ends sign-ins.\n\n"
        "  --name NAME      as others read it; USER by default\n"
        "  --groups A,B     groups, which the daemon's grants name as @A\n"
        "  --data DIR       the daemon's data folder; its default by default\n"
        "  --json           the list as the daemon's API gives it\n"
        "  --help           this text\n",
        stdout);
}

static void print_user(const cJSON *user)
{
    const cJSON *group;
    text_print(stdout, json_text(user, "user") ? json_text(user, "user") : "", 0);
    printf("\t");
    text_print(stdout, json_text(user, "name") ? json_text(user, "name") : "", 0);
    printf("\t%s\t", cJSON_IsTrue(cJSON_GetObjectItemCaseSensitive(user, "is_disabled")) ? "disabled" : "enabled");
    cJSON_ArrayForEach(group, cJSON_GetObjectItemCaseSensitive(user, "groups"))
    {
        text_print(stdout, group->valuestring ? group->valuestring : "", 0);
        if (group->next)
            printf(",");
    }
    printf("\n");
}

/* The body of a call about this user. */
static cJSON *about(const struct account_words *words)
{
    cJSON *body = cJSON_CreateObject();
    cJSON_AddStringToObject(body, "user", words->subject);
    return body;
}

static int send_body(const struct account_words *words, const char *path, cJSON *body)
{
    struct error err = { 0 };
    cJSON *answer = NULL;
    if (!control_call(words->data, "POST", path, body, &answer, &err))
        return account_refused("user", &err);
    cJSON_Delete(answer);
    return EXIT_DONE;
}

static int with_password(const struct account_words *words, bool is_new)
{
    char password[PASSWORD_SIZE];
    if (!password_read(password))
        return EXIT_REFUSED;
    cJSON *body = about(words);
    cJSON_AddStringToObject(body, "password", password);
    explicit_bzero(password, sizeof password);
    if (is_new) {
        cJSON_AddStringToObject(body, "name", words->name ? words->name : words->subject);
        cJSON_AddStringToObject(body, "groups", words->groups ? words->groups : "");
    }
    return send_body(words, is_new ? "/api/v1/users" : "/api/v1/users/password", body);
}

static int disable(const struct account_words *words, bool is_disabled)
{
    cJSON *body = about(words);
    cJSON_AddBoolToObject(body, "is_disabled", is_disabled);
    return send_body(words, "/api/v1/users/disable", body);
}

int command_user(int argc, char **argv)
{
    struct account_words words;
    if (!account_words_read(argc, argv, "user", &words))
        return EXIT_USAGE;
    if (words.wants_help) {
        print_help();
        return EXIT_DONE;
    }
    if (words.act && strcmp(words.act, "list") == 0 && !words.subject)
        return account_list(&words, "user", "/api/v1/users", "users", print_user);
    if (words.act && words.subject) {
        if (strcmp(words.act, "add") == 0 || strcmp(words.act, "passwd") == 0)
            return with_password(&words, words.act[0] == 'a');
        if (strcmp(words.act, "disable") == 0 || strcmp(words.act, "enable") == 0)
            return disable(&words, words.act[0] == 'd');
    }
    fputs("beamroom user: expected add USER, passwd USER, disable USER, enable USER or list; see --help\n", stderr);
    return EXIT_USAGE;
}

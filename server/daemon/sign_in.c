/* Creates accounts and grants from the settings, and reads grants again. */
#include "server/daemon/sign_in.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/wire/json.h"

/* The first line that is wrong by itself; 0: none in the file is. */
static int find_wrong(const struct access_line *lines, size_t n)
{
    struct access *trial = access_create();
    size_t i = 0;
    while (i < n && access_set(trial, &lines[i], 1, NULL))
        i++;
    access_destroy(trial);
    return i < n ? lines[i].line : 0;
}

/* Hands the grants to access. wrong_line: where that fails, the line of the file; 0: none of it. */
static bool use_grants(struct access *access, const char *file, const struct options_grants *grants, int *wrong_line,
                       struct error *err)
{
    struct access_line *lines = mem_new((grants->n + 1) * sizeof *lines);
    for (size_t i = 0; i < grants->n; i++)
        lines[i] = (struct access_line){ .value = grants->list[i].value,
                                         .file = grants->list[i].line ? file : "the command line",
                                         .line = grants->list[i].line };
    const bool ok = access_set(access, lines, grants->n, err);
    *wrong_line = ok ? 0 : find_wrong(lines, grants->n);
    free(lines);
    return ok;
}

bool sign_in_create(struct sign_in *sign_in, const struct options *options, struct error *err)
{
    const struct auth_options auth = { .is_local = options->is_local,
                                       .is_proxied = options->is_proxied,
                                       .idle_ms = options->session_idle_min * 60 * 1000,
                                       .total_ms = options->session_max_h * 60 * 60 * 1000 };
    *sign_in = (struct sign_in){ .options = options };
    sign_in->auth = auth_create(&auth, err);
    if (!sign_in->auth || !options_signs_in(options))
        return sign_in->auth != NULL;
    sign_in->access = access_create();
    int wrong_line;
    return options_read_grants(options, &sign_in->grants, err) &&
           use_grants(sign_in->access, options->config, &sign_in->grants, &wrong_line, err);
}

void sign_in_finish(struct sign_in *sign_in)
{
    if (sign_in->auth)
        auth_close(sign_in->auth);
    auth_destroy(sign_in->auth);
    access_destroy(sign_in->access);
    options_grants_finish(&sign_in->grants);
}

/* ---- reading grants again --------------------------------------------------------------------------------------- */

static bool has(const struct options_grants *grants, const char *value)
{
    for (size_t i = 0; i < grants->n; i++)
        if (strcmp(grants->list[i].value, value) == 0)
            return true;
    return false;
}

/* Grants that `grants` has and `others` has not. */
static cJSON *new_in(const struct options_grants *grants, const struct options_grants *others)
{
    cJSON *list = cJSON_CreateArray();
    for (size_t i = 0; i < grants->n; i++)
        if (!has(others, grants->list[i].value))
            cJSON_AddItemToArray(list, cJSON_CreateString(grants->list[i].value));
    return list;
}

/* On the net thread. */
static void record(struct net *net, void *detail)
{
    net_audit(net, "", "", "", "grants", detail);
    net_grants_changed(net);
}

/* A line may name a patient, as folders do: the log says which one is wrong, the audit has its text. */
static void say_unchanged(struct net *net, const char *file, int line, const struct error *err)
{
    cJSON *detail = cJSON_CreateObject();
    cJSON_AddStringToObject(detail, "refused", err->text);
    if (err->code != ERROR_FORMAT)
        log_error("grants: those in use stay: %s", err->text);
    else if (line)
        log_error("grants: those in use stay: %s, line %d is wrong; the audit says why", file, line);
    else
        log_error("grants: those in use stay: one of the command line is wrong; the audit says why");
    net_post(net, record, detail);
}

/* Folders may be called after patients, so the log has numbers alone and the audit has the lines. */
static void say_changed(struct net *net, const struct options_grants *before, const struct options_grants *now)
{
    cJSON *detail = cJSON_CreateObject(), *added = new_in(now, before), *removed = new_in(before, now);
    log_info("grants: read again: %d new, %d gone, %zu in use", cJSON_GetArraySize(added), cJSON_GetArraySize(removed),
             now->n);
    cJSON_AddItemToObject(detail, "added", added);
    cJSON_AddItemToObject(detail, "removed", removed);
    net_post(net, record, detail);
}

void sign_in_reload(struct sign_in *sign_in, struct net *net)
{
    struct options_grants grants;
    struct error err = { 0 };
    const char *file = sign_in->options->config;
    int wrong_line;
    if (!sign_in->access)
        return;
    if (!options_read_grants(sign_in->options, &grants, &err)) {
        say_unchanged(net, file, grants.last_line, &err);
    } else if (!use_grants(sign_in->access, file, &grants, &wrong_line, &err)) {
        say_unchanged(net, file, wrong_line, &err);
        options_grants_finish(&grants);
    } else {
        say_changed(net, &sign_in->grants, &grants);
        options_grants_finish(&sign_in->grants);
        sign_in->grants = grants;
    }
}

/* Checks a renderer's list of missing regions: missing.h. */
#include "server/wire/missing.h"

#include <stdio.h>

#include "server/wire/fields.h"

enum { MAX_REASON = 240 /* bytes */, MAX_COUNT = 1 << 20 /* regions */ };

static cJSON *read_region(const cJSON *given)
{
    const char *id = json_text(given, "region"), *reason = json_text(given, "reason");
    if (!id || !id_is_valid(id) || !reason)
        return NULL;
    char text[MAX_REASON + 1];
    (void)snprintf(text, sizeof text, "%s", reason);
    cJSON *region = cJSON_CreateObject();
    cJSON_AddStringToObject(region, "region", id);
    cJSON_AddStringToObject(region, "reason", text);
    return region;
}

cJSON *missing_read(const cJSON *frame)
{
    const cJSON *given = cJSON_GetObjectItemCaseSensitive(frame, "missing"),
                *list = cJSON_GetObjectItemCaseSensitive(given, "regions"), *item;
    double n = json_number(given, "n", 0);
    int n_listed = cJSON_GetArraySize(list);
    if (!cJSON_IsArray(list) || n_listed < 1 || n_listed > MISSING_MAX_REGIONS || !(n >= n_listed && n <= MAX_COUNT))
        return NULL;
    cJSON *missing = cJSON_CreateObject();
    cJSON_AddNumberToObject(missing, "n", (double)(int)n);
    cJSON *regions = cJSON_AddArrayToObject(missing, "regions");
    cJSON_ArrayForEach(item, list)
    {
        cJSON *region = read_region(item);
        if (!region) {
            cJSON_Delete(missing);
            return NULL;
        }
        json_append(regions, region);
    }
    return missing;
}

void missing_words(const cJSON *missing, char *text, size_t size)
{
    const cJSON *list = cJSON_GetObjectItemCaseSensitive(missing, "regions"), *region;
    int n = (int)json_number(missing, "n", 0) - cJSON_GetArraySize(list);
    size_t used = 0;
    text[0] = 0;
    cJSON_ArrayForEach(region, list)
    {
        int added = snprintf(text + used, size - used, "%s%s", used ? ", " : "", json_text(region, "region"));
        if (added < 0 || (size_t)added >= size - used)
            return;
        used += (size_t)added;
    }
    if (n > 0)
        (void)snprintf(text + used, size - used, ", and %d more", n);
}

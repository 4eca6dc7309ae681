/* Adding and reading members of documents: json_member.h. */
#include "server/wire/json_member.h"

#include <math.h>
#include <stdio.h>

void json_add(cJSON *object, const char *name, cJSON *value)
{
    if (value && !cJSON_AddItemToObject(object, name, value))
        cJSON_Delete(value);
}

void json_append(cJSON *array, cJSON *value)
{
    if (value && !cJSON_AddItemToArray(array, value))
        cJSON_Delete(value);
}

cJSON *json_finite(double value)
{
    return isfinite(value) ? cJSON_CreateNumber(value) : cJSON_CreateNull();
}

void json_add_finite(cJSON *object, const char *name, double value)
{
    json_add(object, name, json_finite(value));
}

void json_add_text(cJSON *object, const char *name, const char *text)
{
    json_add(object, name, text ? cJSON_CreateString(text) : cJSON_CreateNull());
}

void json_copy_text(cJSON *to, const cJSON *from, const char *name)
{
    const char *text = json_text(from, name);
    json_add(to, name, cJSON_CreateString(text ? text : ""));
}

void json_put_text(char *to, size_t size, const cJSON *from, const char *name)
{
    const char *text = json_text(from, name);
    (void)snprintf(to, size, "%s", text ? text : "");
}

const char *json_text(const cJSON *object, const char *name)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, name);
    return cJSON_IsString(item) ? item->valuestring : NULL;
}

double json_number(const cJSON *object, const char *name, double fallback)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, name);
    return cJSON_IsNumber(item) ? item->valuedouble : fallback;
}

bool json_flag(const cJSON *object, const char *name, bool fallback)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, name);
    return cJSON_IsBool(item) ? cJSON_IsTrue(item) : fallback;
}

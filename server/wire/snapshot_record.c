/* Writes the record of an annotated picture. */
#include "server/wire/snapshot_record.h"

#include <time.h>

#include "server/wire/document.h"

char *snapshot_record(const struct snapshot *snapshot, const cJSON *view, int64_t unix_s)
{
    struct tm utc;
    time_t seconds = (time_t)unix_s;
    char date[32] = "";
    if (gmtime_r(&seconds, &utc))
        (void)strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%SZ", &utc);
    cJSON *record = cJSON_CreateObject(), *plan = cJSON_CreateObject(), *view_kept = cJSON_Duplicate(view, true);
    cJSON_AddNumberToObject(record, "version", SNAPSHOT_RECORD_VERSION);
    cJSON_AddStringToObject(record, "program", "Beamroom " BEAMROOM_VERSION);
    cJSON_AddStringToObject(plan, "id", snapshot->plan->id);
    cJSON_AddStringToObject(plan, "name", snapshot->plan->name);
    json_add(record, "plan", plan);
    cJSON_AddStringToObject(record, "date", date);
    cJSON_AddNumberToObject(record, "revision", snapshot->scene_revision);
    json_add(record, "scene", scene_write(&snapshot->scene));
    cJSON_DeleteItemFromObjectCaseSensitive(view_kept, "override");
    json_add(record, "view", view_kept);
    char *text = json_print(record);
    cJSON_Delete(record);
    return text;
}

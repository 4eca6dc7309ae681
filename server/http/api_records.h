#pragma once
/* Rows of lists of kept records. Internal to server/http; net thread. */
#include "server/net/net.h"
#include "server/wire/json.h"

/* {id, kind, room, plan, author, author_name, time_ms, sha256, decision, plan_name, patient, label, approval}; the last
 * five "" where it is not known. patient: masked. */
cJSON *api_record_row(const struct net_record *record);

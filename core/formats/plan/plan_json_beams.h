#pragma once
/* Reads the "beams" of plan.json. Only plan_json.c includes it. */
#include "core/formats/plan/plan_json_place.h"
#include "core/formats/plan_file.h"

NODISCARD bool plan_json_beams(const struct json_place *top, const cJSON *root, struct plan_file *file);

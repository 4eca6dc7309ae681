#pragma once
/* A room whose plan has two regions and an image, and whose one page only checks that what it is sent is JSON. */
#include "server/room/room.h"

/* The plan has come. */
void kept_plan_ready(struct room *room, int64_t now_us);
/* Callbacks that request nothing of anybody. */
extern const struct room_callbacks kept_plan_callbacks;

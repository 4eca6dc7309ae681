#pragma once
/* Reads one listed file of a plan by the reader of its format (reader_table.h); what all volumes share stands here. */
#include "core/load/loading.h"

/* Fills the reading with what its file holds, its report, and err when it fails. Any thread; one call a reading. */
NODISCARD bool plan_read_part(struct loading *loading, struct part_reading *reading);

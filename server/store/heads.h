#pragma once
/* The newest row of the audit in a small file beside the database, so that rows removed at its end are seen without a
 * hash that was given away. It is overwritten in place after each commit and never ahead of the database. Internal to
 * server/store. */
#include "server/store/audit.h"

/* n 0: there is no such file, or it is not readable as one. */
void heads_read(const char *database, struct audit_head *head);
void heads_write(const char *database, const struct audit_head *head); /* failure is logged */

#pragma once
/* Reads NRRD files of a plan's folder, with the data file that a detached header names. */
#include "core/formats/nrrd.h"

/* errors of all: as folder_read and core/formats/nrrd.h; the text names the file. After plan_nrrd_peek the caller
 * finishes header, also after a failure. */
NODISCARD bool plan_nrrd_peek(const struct folder *folder, const char *name, struct nrrd_header *header,
                              struct error *err);
NODISCARD struct volume *plan_nrrd_read(const struct folder *folder, const char *name, enum raw_use use,
                                        struct report *report, struct error *err);
NODISCARD bool plan_nrrd_read_layers(const struct folder *folder, const char *name, struct nrrd_layers *layers,
                                     struct report *report, struct error *err);

#pragma once
/* DICOM-RT files for tests: real ones out of their archives, and the beginnings of made ones. */
#include "tests/unit/made_dicom.h"

/* A file in memory, parsed whole; fails the test when it cannot be. */
struct rt_file {
    struct bytes bytes;
    struct dicom_file *file;
};
struct rt_file rt_file_open(const char *path);
struct rt_file rt_file_of(const struct made_dicom *made); /* a copy of its bytes */
void rt_file_close(struct rt_file *file);

/* Unpacks an archive of the real data into a new folder; false (and no folder) when there is no such archive, no tar or
 * no xz. */
bool rt_unpack(const char *archive, char folder[256]);
/* The first file of a folder (with a slash at its end or not) whose name begins so, the given time (0: the first);
 * false without one. */
bool rt_find(const char *folder, const char *beginning, size_t which, char *path, size_t size);

/* Header, character set, class, instance and modality. */
void made_rt_begin(struct made_dicom *made, const char *sop_class, const char *modality, const char *charset);
void made_numbers(struct made_dicom *made, uint32_t tag, const double *values, size_t n); /* DS */
void made_integer(struct made_dicom *made, uint32_t tag, long value);                     /* IS */

#pragma once
/* DICOM-RT files for tests: real ones from archives, and the beginnings of made-up ones. */
#include "tests/unit/made_dicom.h"

/* A parsed file with its bytes; fails the test if it cannot be parsed. */
struct rt_file {
    struct bytes bytes;
    struct dicom_file *file;
};
struct rt_file rt_file_open(const char *path);
struct rt_file rt_file_of(const struct made_dicom *made); /* copies the bytes */
void rt_file_close(struct rt_file *file);

/* Unpacks an archive of the real data into a new folder. Returns false, and makes no folder, if there is no such
 * archive, no tar or no xz. */
bool rt_unpack(const char *archive, char folder[256]);
/* Finds a file of a folder (with or without a slash at its end) by the beginning of its name; `which` counts from 0.
 * Returns false if there is none. */
bool rt_find(const char *folder, const char *beginning, size_t which, char *path, size_t size);

/* Writes header, character set, class, instance and modality. */
void made_rt_begin(struct made_dicom *made, const char *sop_class, const char *modality, const char *charset);
void made_numbers(struct made_dicom *made, uint32_t tag, const double *values, size_t n); /* DS */
void made_integer(struct made_dicom *made, uint32_t tag, long value);                     /* IS */

#pragma once
/* Databases for tests of the store: made from SQL, read past the store, changed behind its back. */
#include <stdint.h>

/* Runs SQL on the file, which is made where there is none; fails the test where that fails. */
void store_file_run(const char *path, const char *sql);
void store_file_run_file(const char *path, const char *sql_file);
int64_t store_file_number(const char *path, const char *sql); /* the first column of the first row; -1: no row */

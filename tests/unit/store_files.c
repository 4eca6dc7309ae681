/* SQL on database files. */
#include "tests/unit/store_files.h"

#include <sqlite3.h>

#include "tests/check.h"
#include "tests/unit/data_folder.h"

static sqlite3 *open_file(const char *path)
{
    sqlite3 *db = NULL;
    assert_int_equal(sqlite3_open(path, &db), SQLITE_OK);
    (void)sqlite3_busy_timeout(db, 10000);
    return db;
}

void store_file_run(const char *path, const char *sql)
{
    sqlite3 *db = open_file(path);
    char *message = NULL;
    if (sqlite3_exec(db, sql, NULL, NULL, &message) != SQLITE_OK)
        fail_msg("%s", message);
    assert_int_equal(sqlite3_close(db), SQLITE_OK);
}

void store_file_run_file(const char *path, const char *sql_file)
{
    size_t n;
    uint8_t *sql = file_bytes(sql_file, &n);
    store_file_run(path, (const char *)sql);
    free(sql);
}

int64_t store_file_number(const char *path, const char *sql)
{
    sqlite3 *db = open_file(path);
    sqlite3_stmt *statement = NULL;
    assert_int_equal(sqlite3_prepare_v2(db, sql, -1, &statement, NULL), SQLITE_OK);
    int64_t number = sqlite3_step(statement) == SQLITE_ROW ? sqlite3_column_int64(statement, 0) : -1;
    (void)sqlite3_finalize(statement);
    assert_int_equal(sqlite3_close(db), SQLITE_OK);
    return number;
}

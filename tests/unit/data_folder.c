#define _GNU_SOURCE
/* Finds real data for tests, and makes and removes temporary folders. */
#include "tests/unit/data_folder.h"

#include <ftw.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/formats/nifti_write.h"
#include "tests/check.h"

bool data_path(const char *name, char *path, size_t size)
{
    const char *root = getenv("BEAMROOM_DATA");
    snprintf(path, size, "%s/%s", root ? root : "../shared/data", name);
    return access(path, R_OK) == 0;
}

void folder_make(char path[256])
{
    const char *root = getenv("TMPDIR");
    snprintf(path, 256, "%s/beamroom-test-XXXXXX", root ? root : "/tmp");
    if (!mkdtemp(path))
        abort();
}

void folder_put(const char *folder, const char *name, const void *data, size_t size)
{
    char path[1024];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    char *slash = strrchr(path, '/');
    *slash = 0;
    mkdir(path, 0700);
    *slash = '/';
    FILE *file = fopen(path, "wb");
    if (!file || fwrite(data, 1, size, file) != size || fclose(file) != 0)
        abort();
}

void folder_put_text(const char *folder, const char *name, const char *text)
{
    folder_put(folder, name, text, strlen(text));
}

void folder_put_data(const char *folder, const char *name, const char *from)
{
    char path[1024];
    size_t size;
    assert_true(data_path(from, path, sizeof path));
    uint8_t *bytes = file_bytes(path, &size);
    folder_put(folder, name, bytes, size);
    free(bytes);
}

void folder_put_volume(const char *folder, const char *name, struct volume *volume)
{
    char path[600];
    struct error err = { 0 };
    snprintf(path, sizeof path, "%s/%s", folder, name);
    assert_true(nifti_write_exact(path, volume, NULL, &err));
    volume_unref(volume);
}

uint8_t *file_bytes(const char *path, size_t *size)
{
    FILE *file = fopen(path, "rb");
    if (!file)
        fail_msg("%s cannot be read", path);
    assert_int_equal(fseek(file, 0, SEEK_END), 0);
    *size = (size_t)ftell(file);
    rewind(file);
    uint8_t *bytes = malloc(*size + 1);
    assert_non_null(bytes);
    assert_int_equal(fread(bytes, 1, *size, file), *size);
    bytes[*size] = 0;
    fclose(file);
    return bytes;
}

static int remove_one(const char *path, const struct stat *about, int kind, struct FTW *where)
{
    (void)about;
    (void)kind;
    (void)where;
    return remove(path);
}

void folder_remove(const char *folder)
{
    nftw(folder, remove_one, 16, FTW_DEPTH | FTW_PHYS);
}

/* A CT series of 200 x 512 x 512 from its folder to a volume (scan, heads, sorting, voxels), against dcm2niix's whole
 * run and pydicom with numpy stacking the same files; all voxels compared. And what 20,000 files that are no DICOM
 * cost. */
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "core/formats/dicom/dicom_series.h"
#include "core/formats/nifti.h"
#include "tests/bench/peer.h"

enum {
    ROUNDS = 3,
    OURS = 5,
    CONVERTER = 2,
    N_UNRELATED = 20000
}; /* each round runs all three, so that all meet the same machine */

static const char folder_path[] = "build/bench/dicom", out_path[] = "build/bench/dicom-out",
                  values_path[] = "build/bench/dicom-out/values";

static int compare(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

static double median(double *ms, int n)
{
    qsort(ms, (size_t)n, sizeof *ms, compare);
    return ms[n / 2];
}

static struct volume *load(const char *path, int n_threads)
{
    struct folder folder;
    struct error err = { 0 };
    struct dicom_progress progress = { .n_threads = n_threads };
    struct volume *volume = NULL;
    if (folder_open(&folder, path, &err)) {
        struct dicom_index *index = dicom_index_scan(&folder, NULL, 0, &progress, NULL, &err);
        if (index && index->n_stacks == 1)
            volume = dicom_series_read(&folder, index, 0, &progress, NULL, NULL, &err);
        dicom_index_destroy(index);
        folder_close(&folder);
    }
    if (!volume) {
        fprintf(stderr, "bench_dicom: %s\n", err.text);
        exit(1);
    }
    return volume;
}

/* Peak memory of a process that loads the series and nothing else, in bytes; what the process had before is in it. */
static double peak_bytes(void)
{
    pid_t pid = fork();
    if (pid == 0) {
        volume_unref(load(folder_path, 2));
        _exit(0);
    }
    struct rusage usage = { 0 };
    int status;
    if (pid < 0 || wait4(pid, &status, 0, &usage) != pid || status != 0)
        return 0;
    return (double)usage.ru_maxrss * 1024;
}

static bool same_as_values(const struct volume *volume)
{
    size_t n = grid_n_voxels(&volume->grid);
    int16_t *values = malloc(n * sizeof *values);
    FILE *file = fopen(values_path, "rb");
    bool is_same = file && values && fread(values, sizeof *values, n, file) == n;
    const int16_t *cells = volume->voxels;
    for (size_t i = 0; is_same && i < n; i++)
        is_same = cells[i] * volume->slope + volume->offset == values[i];
    if (file)
        fclose(file);
    free(values);
    return is_same && volume->type == VOXEL_I16;
}

/* Voxel by voxel, at the same places in the patient. */
static bool same_as_nifti(const struct volume *volume)
{
    struct folder folder;
    struct bytes bytes;
    if (!folder_open(&folder, out_path, NULL) ||
        !folder_read(&folder, "series.nii", UINT32_MAX, UINT64_MAX, &bytes, NULL))
        return false;
    folder_close(&folder);
    struct volume *theirs = nifti_read(&bytes, "series.nii", RAW_IMAGE, NULL, NULL);
    bytes_free(&bytes);
    bool is_same = theirs && grid_n_voxels(&theirs->grid) == grid_n_voxels(&volume->grid);
    for (uint32_t k = 0; is_same && k < volume->grid.size[2]; k++)
        for (uint32_t j = 0; is_same && j < volume->grid.size[1]; j++) {
            struct vec3 row = affine_point(&volume->grid.lps_mm_from_ijk, vec3(0, j, k));
            struct vec3 at = affine_point(&theirs->grid.ijk_from_lps_mm, row);
            uint32_t tj = (uint32_t)lround(at.y), tk = (uint32_t)lround(at.z);
            is_same = fabs(at.x) < 1e-3 && tj < theirs->grid.size[1] && tk < theirs->grid.size[2];
            for (uint32_t i = 0; is_same && i < volume->grid.size[0]; i++)
                is_same = volume_value(volume, i, j, k) == volume_value(theirs, i, tj, tk);
        }
    volume_unref(theirs);
    return is_same;
}

static void bench_unrelated(void)
{
    static const char path[] = "build/bench/unrelated";
    char name[128];
    (void)mkdir(path, 0755);
    for (int i = 0; i < N_UNRELATED; i++) {
        snprintf(name, sizeof name, "%s/note-%05d.txt", path, i);
        FILE *file = fopen(name, "w");
        if (!file)
            return;
        fprintf(file, "note %d: not a picture of anything, but long enough to have a preamble. %0200d\n", i, i);
        fclose(file);
    }
    double ms[5];
    for (int i = 0; i < 5; i++) {
        struct folder folder;
        struct dicom_progress progress = { .n_threads = 2 };
        if (!folder_open(&folder, path, NULL))
            return;
        int64_t began = clock_now_us();
        struct dicom_index *index = dicom_index_scan(&folder, NULL, 0, &progress, NULL, NULL);
        ms[i] = (double)(clock_now_us() - began) / 1e3;
        if (!index || index->n_foreign != N_UNRELATED)
            exit(1);
        dicom_index_destroy(index);
        folder_close(&folder);
    }
    printf(
        "{\"name\":\"a file that is no DICOM, in a folder of 20,000\",\"value\":%.4f,\"unit\":\"ms\",\"note\":\"median of 5; at most 1 ms\"}\n",
        median(ms, 5) / N_UNRELATED);
}

int main(void)
{
    const char *python = getenv("PYTHON") ? getenv("PYTHON") : "/usr/bin/python3";
    char line[256];
    (void)mkdir("build/bench", 0755);
    (void)mkdir(out_path, 0755);
    if (access("build/bench/dicom/IM0001", R_OK) != 0 &&
        peer_run_ms((const char *[]){ python, "tests/bench/dicom_make.py", folder_path, NULL }, line, sizeof line) <
            0) {
        fprintf(stderr, "bench_dicom: no pydicom to make the series with\n");
        return 77;
    }
    double peak = peak_bytes(); /* before anything large was here */
    dicom_prepare();
    double ours[ROUNDS * OURS], converter[ROUNDS * CONVERTER], stack[ROUNDS];
    for (int round = 0; round < ROUNDS; round++) {
        for (int i = 0; i < OURS; i++) {
            int64_t began = clock_now_us();
            struct volume *volume = load(folder_path, 2);
            ours[round * OURS + i] = (double)(clock_now_us() - began) / 1e3;
            volume_unref(volume);
        }
        for (int i = 0; i < CONVERTER; i++)
            converter[round * CONVERTER + i] =
                peer_run_ms((const char *[]){ "dcm2niix", "-z", "n", "-b", "n", "-w", "1", "-f", "series", "-o",
                                              out_path, folder_path, NULL },
                            line, sizeof line);
        stack[round] =
            peer_run_ms((const char *[]){ python, "tests/bench/pydicom_load.py", folder_path, values_path, NULL }, line,
                        sizeof line) < 0
                ? -1
                : strtod(line, NULL);
    }
    struct volume *volume = load(folder_path, 2);
    double bytes = (double)(grid_n_voxels(&volume->grid) * voxel_size(volume->type));
    double ms = median(ours, ROUNDS * OURS), theirs = median(converter, ROUNDS * CONVERTER),
           stacking = median(stack, ROUNDS);
    bool is_same = true;
    if (theirs > 0) {
        is_same = same_as_nifti(volume);
        printf(
            "{\"name\":\"CT series, 200 x 512 x 512\",\"value\":%.2f,\"unit\":\"ms\",\"peer\":\"dcm2niix -z n, whole run\",\"peer_value\":%.2f,"
            "\"ratio\":%.3f,\"note\":\"median of %d, warm, 2 threads; voxels %s\"}\n",
            ms, theirs, theirs / ms, ROUNDS * OURS, is_same ? "equal" : "DIFFER");
    }
    if (stacking > 0) {
        bool is_same_stack = same_as_values(volume);
        printf(
            "{\"name\":\"CT series, 200 x 512 x 512\",\"value\":%.2f,\"unit\":\"ms\",\"peer\":\"pydicom + numpy\",\"peer_value\":%.2f,"
            "\"ratio\":%.3f,\"note\":\"voxels %s\"}\n",
            ms, stacking, stacking / ms, is_same_stack ? "equal" : "DIFFER");
        is_same = is_same && is_same_stack;
    }
    printf(
        "{\"name\":\"memory for the CT series, peak over decoded\",\"value\":%.3f,\"unit\":\"ratio\",\"note\":\"%.1f MiB of %.1f; at most 1.3\"}\n",
        peak / bytes, peak / 1048576, bytes / 1048576);
    volume_unref(volume);
    bench_unrelated();
    return is_same ? 0 : 1;
}

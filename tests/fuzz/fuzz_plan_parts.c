/* A whole plan, read and assembled: a folder with a small file of every kind, and a plan.json that names any of them
 * anywhere, any number of times. Even first byte: the rest is the plan.json. Odd: pairs of bytes choose entries, first
 * the list and its options, then the file. */
#include "core/formats/plan/plan_json.h"
#include "core/load/load.h"
#include "core/load/summary.h"
#include "core/plan/plan.h"
#include "tests/fuzz/fuzz.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/made_chd.h"
#include "tests/unit/made_dose.h"

enum { N_DOSES = PLAN_MAX_DOSES, MOST_ENTRIES = 80, TEXT_SIZE = 1 << 16 };

/* Seeds of other targets, without the leading bytes that only control the target. */
static const struct {
    const char *name, *seed;
    size_t skip;
} seeds[] = { { "labels.nii", "nifti/labels-u8", 1 },
              { "mask.nii", "nifti/mask-u8-qform", 1 },
              { "image.nii.gz", "nifti/image-i32-packed", 1 },
              { "layers.seg.nrrd", "nrrd/labels-segments", 1 },
              { "image.nrrd", "nrrd/image-i16-gzip", 1 },
              { "head.uvh", "uvh/version-1", 0 },
              { "mr.qhd", "qhd/bytes", 2 },
              { "run.rst", "sera_rst/two-cells-12", 0 },
              { "line.dose", "sera_table/three", 0 },
              { "tracks.pp", "tracks/head", 0 },
              { "colors.cmap", "rsc/cmap", 1 },
              { "head.rsc", "rsc/sera3d", 1 },
              { "tree.info", "hierarchy/head", 0 },
              { "names.json", "plan_json/labels", 1 },
              { "rt/dose.dcm", "dicom_rt/dose", 1 },
              { "rt/plan.dcm", "dicom_rt/plan", 1 },
              { "rt/structures.dcm", "dicom_rt/structures", 1 } };
/* Paths that an entry may name: those files, missing ones, folders, and the empty path. */
static const char *const paths[] = {
    "labels.nii", "mask.nii",    "image.nii.gz", "layers.seg.nrrd",   "image.nrrd",   "head.uvh", "mr.qhd",
    "mr.qim",     "run.rst",     "line.dose",    "tracks.pp",         "colors.cmap",  "head.rsc", "tree.info",
    "names.json", "rt/dose.dcm", "rt/plan.dcm",  "rt/structures.dcm", "contours.chd", "doses",    "doses/03.dcm",
    "rt",         "absent.nii"
};
enum { N_SEEDS = sizeof seeds / sizeof seeds[0], N_PATHS = sizeof paths / sizeof paths[0] };

static char folder[256];

static void leave(void)
{
    folder_remove(folder);
}

static void make_folder(void)
{
    folder_make(folder);
    REQUIRE(atexit(leave) == 0);
    for (size_t i = 0; i < N_SEEDS; i++) {
        char path[256];
        size_t n;
        snprintf(path, sizeof path, "tests/fuzz/corpus/%s", seeds[i].seed);
        uint8_t *bytes = file_bytes(path, &n);
        folder_put(folder, seeds[i].name, bytes + seeds[i].skip, n - seeds[i].skip);
        free(bytes);
    }
    folder_put(folder, "head.uv", "\1\1\1\1\1\3\3\1\1\3\3\1\1\3\3\1\1\3\3\1\1\1\1\1", 24);
    folder_put(folder, "mr.qim", "abcdefghijklmnopqrstuvwx", 24);
    struct chd_text header = chd_make_header(&chd_plain), table = chd_make_table(&chd_plain);
    folder_put(folder, "contours.chd", header.at, header.n);
    folder_put(folder, "contours.cdf", table.at, table.n);
    free(header.at);
    free(table.at);
    for (int i = 0; i < N_DOSES; i++) {
        struct made_dicom made;
        char name[32];
        made_dose(&made, i);
        snprintf(name, sizeof name, "doses/%02d.dcm", i);
        folder_put(folder, name, made.data, made.size);
        made_finish(&made);
    }
}

struct text {
    char *at;
    size_t n;
};

static void put(struct text *text, const char *format, ...) PRINTF_LIKE(2, 3);
static void put(struct text *text, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    int n = vsnprintf(text->at + text->n, TEXT_SIZE - text->n, format, args);
    va_end(args);
    REQUIRE(n >= 0 && (size_t)n < TEXT_SIZE - text->n);
    text->n += (size_t)n;
}

enum list { IMAGES, REGIONS, DOSES, BEAMS, TRACKS, CURVES, PREFERENCES, N_LISTS };

static void put_entry(struct text *text, enum list list, unsigned options, const char *path)
{
    static const char *const quantities[] = { "total", "boron", "nitrogen",       "fast",
                                              "gamma", "other", "weighted-total", "thermal-fluence" };
    if (list == BEAMS && options & 1) {
        put(text, "{\"entry_mm\": [0, 0, %u], \"target_mm\": [0, 0, 0]}", options + 1);
    } else if (list == REGIONS && options % 3 > 0) {
        put(text, "{\"path\": \"%s\", \"%s\"}", path, options % 3 == 1 ? "name\": \"brain" : "names\": \"names.json");
    } else if (list == DOSES && options & 1) {
        put(text, "{\"components\": [");
        for (unsigned c = 0; c <= options / 2 % 8; c++)
            put(text, "%s{\"path\": \"%s\", \"quantity\": \"%s\"}", c ? ", " : "", c % 2 ? "mask.nii" : path,
                quantities[c]);
        put(text, "]}");
    } else if (list == DOSES && options & 2) {
        put(text, "{\"path\": \"%s\", \"id\": \"same\", \"mask\": \"mask.nii\", \"quantity\": \"%s\"}", path,
            quantities[options / 4 % 8]);
    } else {
        put(text, "{\"path\": \"%s\"}", path);
    }
}

/* Makes lists of entries from pairs of bytes; plan.json has each list once. */
static void put_plan(struct text *text, const uint8_t *pairs, size_t n)
{
    static const char *const names[N_LISTS] = {
        "images", "regions", "doses", "beams", "tracks", "curves", "preferences"
    };
    put(text, "{\"format\": \"beamroom-plan\", \"version\": 1");
    if (n > 0 && pairs[0] & 128)
        put(text, ", \"hierarchy\": \"tree.info\"");
    for (enum list list = IMAGES; list < N_LISTS; list++) {
        bool is_begun = false;
        for (size_t i = 0; i < n; i++) {
            if (pairs[2 * i] % 8 != (uint8_t)list)
                continue;
            put(text, is_begun ? ", " : ", \"%s\": [", names[list]);
            put_entry(text, list, pairs[2 * i] / 8, paths[pairs[2 * i + 1] % N_PATHS]);
            is_begun = true;
        }
        if (is_begun)
            put(text, "]");
    }
    put(text, "}");
}

static void check_plan(const struct plan *plan)
{
    REQUIRE(plan->n_images <= PLAN_MAX_IMAGES && plan->n_doses <= PLAN_MAX_DOSES && plan->n_beams <= PLAN_MAX_BEAMS);
    REQUIRE(plan->n_curves <= PLAN_MAX_CURVES && plan->regions.n_regions <= REGION_MAX &&
            plan->regions.n_layers <= REGION_MAX_LAYERS);
    for (size_t i = 0; i < plan->n_images; i++)
        REQUIRE(plan->images[i].volume && plan->images[i].id[0]);
    for (size_t d = 0; d < plan->n_doses; d++) {
        const struct dose *dose = &plan->doses[d];
        REQUIRE(dose->id[0] && dose->n_components > 0 && dose->n_components <= DOSE_N_QUANTITIES);
        for (size_t c = 0; c < dose->n_components; c++)
            REQUIRE(dose->components[c].values);
        for (size_t other = 0; other < d; other++)
            REQUIRE(strcmp(plan->doses[other].id, dose->id) != 0);
    }
    for (size_t r = 0; r < plan->regions.n_regions; r++)
        REQUIRE(plan->regions.regions[r].layer < plan->regions.n_layers &&
                plan->regions.regions[r].parent < (int)plan->regions.n_regions);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    static char written[TEXT_SIZE];
    struct text text = { written, 0 };
    struct error err = { 0 };
    if (n < 2)
        return 0;
    if (!folder[0])
        make_folder();
    if (data[0] % 2 == 0) {
        folder_put(folder, "plan.json", data + 1, n - 1);
    } else {
        size_t n_pairs = (n - 1) / 2;
        put_plan(&text, data + 1, n_pairs < MOST_ENTRIES ? n_pairs : MOST_ENTRIES);
        folder_put(folder, "plan.json", written, text.n);
    }
    struct plan *plan = plan_load(folder, "fuzz", NULL, &err);
    REQUIRE(plan || (err.code != ERROR_NONE && err.text[0] != '\0'));
    if (plan)
        check_plan(plan);
    plan_destroy(plan);
    struct plan_summary summary;
    plan_summarize(folder, &summary);
    REQUIRE(summary.n_parts <= sizeof summary.parts / sizeof summary.parts[0] &&
            (summary.is_readable || summary.reason[0]));
    return 0;
}

#pragma once
/* Inside core/load: one plan being loaded. load.c leads: what the folder holds (parts.h) becomes jobs (jobs.c), several
 * threads read them (read_part.c, which alone knows the readers of formats), and what they gave is put together
 * (assemble.c). */
#include "core/formats/dicom/dicom_rtdose.h"
#include "core/formats/dicom/dicom_rtplan.h"
#include "core/formats/dicom/dicom_rtstruct.h"
#include "core/formats/dicom/dicom_seg.h"
#include "core/formats/dicom/dicom_series.h"
#include "core/formats/nrrd.h"
#include "core/load/dicom_parts.h"
#include "core/load/load.h"
#include "core/load/region_builder.h"
#include "core/load/sera_parts.h"

enum { TEXT_FILE_MAX_BYTES = 16 << 20 };

/* One file to read, by any thread; what it gave waits here until all are read. */
enum job_kind { JOB_IMAGE, JOB_REGION, JOB_DOSE, JOB_DOSE_MASK, JOB_BEAMS };
#define JOB_OF_NO_ENTRY SIZE_MAX
struct job {
    enum job_kind kind;
    size_t index, component; /* into the plan file; JOB_OF_NO_ENTRY: found in the folder */
    const char *path;
    uint64_t bytes; /* of the file, for order and progress */
    enum part_format format;
    struct volume *volume;
    struct nrrd_layers *layers; /* of a NRRD label map or a DICOM segmentation, instead of volume */
    struct sera_doses doses;    /* of a SERA dose, instead of volume */
    struct uvh uvh;
    int stack; /* of a DICOM image */
    struct dicom_series_facts facts;
    struct rtstruct *structs; /* of a DICOM structure set */
    struct rtdose rtdose;     /* of a DICOM dose */
    struct rtplan *rtplan;    /* of a DICOM treatment plan */
    struct loading *loading;  /* for what a reader says of its progress */
    uint64_t bytes_told;
    struct label_names names;
    char modality[16];     /* as a .qhd says it */
    bool is_grid_doubtful; /* a .qhd that describes another image */
    struct report report;
    struct error err;
    bool is_failed; /* after plan_run_jobs: left out */
    size_t image;   /* in the plan, once it is there */
};

struct loading {
    struct plan *plan;
    struct plan_sources *sources; /* with a cache folder: the files it is made from */
    struct folder folder;
    struct plan_parts parts;
    struct plan_file *file;            /* of parts */
    int image_stacks[PLAN_MAX_IMAGES]; /* which stack of DICOM pictures an image of the plan is; -1: of other files */
    struct job *jobs;                  /* in the plan's order */
    size_t *order;                     /* largest first */
    size_t n_jobs;
    uint64_t n_bytes;
    atomic_size_t next, first_failed;
    struct plan_load_options options;
    struct error err;
    bool is_whole;
    struct queue *ended;                  /* one letter when the thread that loads is through */
    struct mailbox *phases;               /* for the caller to tell */
    atomic_uint_fast64_t work, work_done; /* of the phase */
    atomic_bool is_given_up;              /* nobody waits any more */
    atomic_int references;                /* the caller's and the thread's */
};

bool loading_is_cancelled(const struct loading *loading);
/* A phase begins: "reading", "ct.nii.gz", from 5 to 80 % */
void loading_phase(struct loading *loading, const char *what, const char *name, double low, double high);
/* What the phases from here on have to do together, and that a part of it is done; in bytes, or anything else. Any
 * thread. */
void loading_begin(struct loading *loading, uint64_t work);
void loading_work(struct loading *loading, uint64_t work);

/* The jobs of a plan file. errors ERROR_NOT_FOUND, ERROR_UNSUPPORTED */
NODISCARD bool plan_make_jobs(struct loading *loading, struct error *err);
/* Bytes that loading will take at its peak, from headers: within PLAN_ESTIMATE_FACTOR of what it takes, either way.
 * largest: the job that needs most. */
uint64_t plan_estimate(const struct loading *loading, const struct job **largest);
/* errors ERROR_LIMIT the estimate is above the options' limit; with both and the largest part */
NODISCARD bool plan_check_estimate(const struct loading *loading, struct error *err);
/* All jobs, in several threads. errors: those of the first job that failed, in the plan's order; ERROR_CANCELLED */
NODISCARD bool plan_run_jobs(struct loading *loading, struct error *err);
/* One job: reads its files and fills it, report and err included; any thread. */
NODISCARD bool plan_read_part(struct loading *loading, struct job *job);
/* An id that may stand in a URL: from what the plan gives, else from the file's name; unique among those before. */
void plan_make_id(char id[64], const char *given, const char *path, const char *const *others, size_t n_others);

/* False when the plan holds PLAN_MAX_DOSES doses; then the report says that this one, from the file where, was left
 * out. */
NODISCARD bool plan_has_room_for_dose(struct plan *plan, const char *id, const char *where);

/* The stack an image of the plan was read from; NULL when it was not DICOM. */
const struct dicom_stack *plan_dicom_stack_of(const struct loading *loading, size_t image);

/* What DICOM jobs gave, into the plan. regions: errors as contour_choose_grids and contour_fill, ERROR_CANCELLED.
 * doses: the jobs of one entry of the plan file, or of none; entry may be NULL. */
NODISCARD bool plan_dicom_add_regions(struct loading *loading, struct region_builder *builder, struct job *job,
                                      struct error *err);
void plan_dicom_check_segmentation(struct loading *loading,
                                   struct job *job); /* its frame of reference and series against the images' */
void plan_dicom_add_doses(struct loading *loading, size_t index, const struct plan_file_dose *entry);
void plan_dicom_add_component(struct loading *loading, struct dose *dose, struct job *job);
void plan_dicom_add_beams(struct loading *loading);

/* Fills the plan with what the jobs gave. errors ERROR_LIMIT; of the hierarchy's and the tracks' files */
NODISCARD bool plan_assemble(struct loading *loading, struct error *err);

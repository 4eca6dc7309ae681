#pragma once
/* Inside core/plan: one plan being loaded. plan_load.c leads: what the folder holds (plan_parts) becomes jobs (plan_jobs.c), several
 * threads read them (plan_read.c, which alone knows the readers of formats), and what they gave is put together (plan_assemble.c). */
#include "core/formats/nrrd.h"
#include "core/plan/plan_parts.h"
#include "core/plan/plan_sera.h"

enum { TEXT_FILE_MAX_BYTES = 16 << 20 };
#define DATA_FILE_MAX_BYTES (VOLUME_MAX_BYTES + (1 << 20))

/* One file to read, by any thread; what it gave waits here until all are read. */
enum job_kind { JOB_IMAGE, JOB_REGION, JOB_DOSE, JOB_DOSE_MASK };
struct job {
    enum job_kind kind;
    size_t index, component; /* into the plan file */
    const char *path;
    uint64_t bytes; /* of the file, for order and progress */
    enum part_format format;
    struct volume *volume;
    struct nrrd_layers *layers; /* of a NRRD label map, instead of volume */
    struct sera_doses doses;    /* of a SERA dose, instead of volume */
    struct uvh uvh;
    struct label_names names;
    char modality[16];     /* as a .qhd says it */
    bool is_grid_doubtful; /* a .qhd that describes another image */
    struct report report;
    struct error err;
    bool is_failed;
};

struct loading {
    struct plan *plan;
    struct folder folder;
    struct plan_file *file;
    struct job *jobs; /* in the plan's order */
    size_t *order;    /* largest first */
    size_t n_jobs;
    uint64_t n_bytes;
    atomic_size_t next, first_failed;
    struct plan_load_options options;
    struct error err;
    bool is_whole;
    struct queue *ended;     /* one letter when the thread that loads is through */
    struct mailbox *phases;  /* for the caller to tell */
    atomic_uint_fast64_t work, work_done; /* of the phase */
    atomic_bool is_given_up; /* nobody waits any more */
    atomic_int references;   /* the caller's and the thread's */
};

bool loading_is_cancelled(const struct loading *loading);
/* A phase begins: "reading", "ct.nii.gz", from 5 to 80 % */
void loading_phase(struct loading *loading, const char *what, const char *name, double low, double high);
/* What the phases from here on have to do together, and that a part of it is done; in bytes, or anything else. Any thread. */
void loading_begin(struct loading *loading, uint64_t work);
void loading_work(struct loading *loading, uint64_t work);

/* The jobs of a plan file. errors ERROR_NOT_FOUND, ERROR_UNSUPPORTED */
NODISCARD bool plan_make_jobs(struct loading *loading, struct error *err);
/* All jobs, in several threads. errors: those of the first job that failed, in the plan's order; ERROR_CANCELLED */
NODISCARD bool plan_run_jobs(struct loading *loading, struct error *err);
/* One job: reads its files and fills it, report and err included; any thread. */
NODISCARD bool plan_read_part(const struct loading *loading, struct job *job);
/* Fills the plan with what the jobs gave. errors ERROR_LIMIT; of the hierarchy's and the tracks' files */
NODISCARD bool plan_assemble(struct loading *loading, struct error *err);

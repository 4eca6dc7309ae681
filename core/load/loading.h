#pragma once
/* The state of a plan that is being loaded: the folder, its parts, the files being read, the plan they fill, the
 * progress. load.c leads: find_parts.h finds the parts, part_list.h lists the files, estimate.h checks the memory,
 * read_all.h reads them in several threads, assemble.h builds the plan. */
#include <stdatomic.h>

#include "core/base/mailbox.h"
#include "core/base/queue.h"
#include "core/load/part_reading.h"
#include "core/load/parts.h"
#include "core/plan/plan.h"

enum { TEXT_FILE_MAX_BYTES = 16 << 20 }; /* of a hierarchy file or a list of label names */

/* A step of the work and its share of the whole. */
struct loading_phase {
    char words[96];
    double low, high; /* percent */
};

/* Shared by the caller, who waits, and the thread that loads; the last of them frees it. */
struct loading {
    struct folder folder;
    uint64_t max_bytes; /* refuse a plan that needs more memory; 0: no limit */
    char *cache_folder; /* where an opened plan may be kept; a copy; NULL: nowhere */

    struct plan *plan;
    struct plan_sources *sources; /* with a cache folder: the files the plan is made from */
    struct plan_parts parts;
    struct plan_file *file;            /* of parts */
    int image_stacks[PLAN_MAX_IMAGES]; /* for each image of the plan: its stack in the DICOM index; -1: not DICOM */

    struct part_reading *readings; /* in the plan's order */
    size_t *order;                 /* indices of readings, largest file first */
    size_t n_readings;
    uint64_t n_bytes; /* of all files */
    atomic_size_t next, first_failed;

    struct error first_left_out; /* why the first part was left out */
    size_t n_left_out;
    struct error err; /* why loading failed, when is_whole is false */
    bool is_whole;
    struct queue *ended;                  /* gets one letter when the thread is through */
    struct mailbox *phases;               /* struct loading_phase; the newest is the current one */
    atomic_uint_fast64_t work, work_done; /* of the current phases, in units of loading_begin */
    atomic_bool is_given_up;              /* the caller was cancelled and waits no longer */
    atomic_int references;
};

/* Opens the folder and starts an empty plan; two references. errors as folder_open */
NODISCARD struct loading *loading_create(const char *folder, const char *id, struct error *err);
void loading_unref(struct loading *loading);

/* Progress; any thread. */
bool loading_is_cancelled(const struct loading *loading);
/* Starts a phase: "reading", "ct.nii.gz", from 5 to 80 %. name may be "". */
void loading_phase(struct loading *loading, const char *what, const char *name, double low, double high);
/* Sets the total work of the phases that follow, in bytes or any other unit. */
void loading_begin(struct loading *loading, uint64_t work);
/* Adds to the work that is done, in the same unit. */
void loading_work(struct loading *loading, uint64_t work);

/* True if the fault is of one part alone, so that the rest of the plan can be shown without it: anything but a lack of
 * memory, and a load that was cancelled. */
bool loading_may_leave_out(const struct error *why);
/* Reports a part that is left out, and keeps the first reason for the case that nothing is left to show. path: the
 * part's file. */
void loading_leave_out(struct loading *loading, const char *code, const char *path, const struct error *why);

/* The stack of the DICOM index that an image of the plan was read from; NULL when it was not DICOM. */
const struct dicom_stack *loading_stack_of(const struct loading *loading, size_t image);

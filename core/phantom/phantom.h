#pragma once
/* Writes the demo plan: a made-up head whose shape, beam and dose on the beam axis come from a paper, as a plan folder.
 * Nothing in it is a patient's. Uses files only through the writers of core/formats; never reads one.
 *
 *   source  J. T. Goorley, W. S. Kiger III, R. G. Zamenhof, Reference dosimetry calculations for neutron capture
 *           therapy with comparison of analytical and voxel models, Med. Phys. 29 (2002) 145: the modified Snyder head,
 *           its beam and the dose on the axis. Differs: target, tumour and marker are added, the dose off the axis is a
 *           stated formula (phantom_dose_at), and the tracks are a random walk that only looks like transport. */
#include "core/base/error.h"
#include "core/phantom/phantom_options.h"

/* Writes the plan folder: plan.json, README.txt, ct.nii.gz, labels.nii.gz, labels.json, dose/, tracks.pp. All of it
 * appears at once or not at all: it is built in a folder beside the target and renamed. Equal options give equal bytes.
 *
 *   folder   a new name in an existing folder, or an empty folder
 *   replace  an existing phantom may be replaced; a folder with any file that no phantom has is never touched
 *   errors   ERROR_RANGE a side outside PHANTOM_MIN_SIDE..PHANTOM_MAX_SIDE; ERROR_LIMIT more than PHANTOM_MAX_VOXELS;
 *            ERROR_STATE the folder exists and may not be replaced; ERROR_MEMORY; ERROR_IO
 *   thread   any; uses all cores */
NODISCARD bool phantom_write(const char *folder, const struct phantom_options *options, bool replace,
                             struct error *err);

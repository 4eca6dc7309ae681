#pragma once
/* Small DICOM plans for tests of what belongs together: images, doses, structure sets and treatment plans that say
 * whose they are. */
#include "tests/unit/made_series.h"

struct made_owner {
    const char *id, *issuer, *name, *birth_date; /* NULL: the element is absent */
    const char *study, *frame;
};

/* n CT slices of 8 x 8 pixels, 2 x 2 x 3 mm from the origin on; names begin with `prefix`. */
void made_part_images(const char *folder, const char *prefix, const struct made_owner *owner, const char *series,
                      int n);

struct made_part_dose {
    const char *uid, *plan_uid /* NULL: refers to none */, *summation, *description;
    int beam;            /* number of the only beam that it refers to; 0: none */
    const char *scaling; /* of the values 1 to 8, Gy; NULL: "0.5" */
    const char *date;    /* instance creation date; NULL: absent */
};
/* 2 x 2 x 2 voxels of 6 mm from the origin on. */
void made_part_dose(const char *folder, const char *file, const struct made_owner *owner,
                    const struct made_part_dose *dose);

struct made_part_plan {
    const char *uid, *structs_uid /* NULL: refers to none */, *label, *date, *approval /* NULL: absent */;
    const char *beams[4]; /* names; number 1 to 4 */
    bool has_frame;       /* states the owner's frame of reference */
};
void made_part_plan(const char *folder, const char *file, const struct made_owner *owner,
                    const struct made_part_plan *plan);

/* A structure set with one box, "Box", of 6 x 6 mm on the slices at 3 and 6 mm. */
void made_part_structs(const char *folder, const char *file, const struct made_owner *owner, const char *uid,
                       const char *series);

/* A registration of frame `from` to frame `to` by a matrix of 16 numbers, rows first, as text. */
void made_part_registration(const char *folder, const char *file, const struct made_owner *owner, const char *from,
                            const char *to, const char *type, const char *matrix);

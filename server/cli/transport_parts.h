#pragma once
/* Parts of `beamroom transport`: beams, materials in voxels, and the dose that a plan gets. */
#include "core/beam/beam_particles.h"
#include "core/formats/plan/beam_file.h"
#include "core/plan/fit.h"
#include "core/report/report.h"
#include "core/transport/transport.h"

/* The text of a beam of the library; NULL if there is none of that name. */
const char *transport_library_beam(const char *name);
const char *transport_library_names(void); /* for people, with commas */

/* Reads the beam file at a path, with the source or the particles that it names, a file of particles itself (which says
 * no strength), or a beam of the library. The caller finishes particles, which are none before. */
NODISCARD bool transport_read_beam(const char *path_or_name, struct beam_file *file, struct beam_particles *particles,
                                   struct error *err);

bool transport_is_particles(const char *name); /* by its ending */
NODISCARD bool transport_read_particles(const struct folder *folder, const char *name, struct beam_particles *particles,
                                        struct error *err);
/* The beam's particles at the aperture plane; says on standard output what was taken, in which axes and units, and what
 * was left out. */
NODISCARD bool transport_list_of_particles(struct phase_space *space, const struct beam_file *file,
                                           const struct beam_particles *particles, size_t n_neutrons, size_t n_photons,
                                           uint64_t seed, struct error *err);

/* Lines of a report on standard error, each with its file. */
void transport_print_report(const struct report *report);

/* The regions that a simulation uses are those of the patient that is shown. Index of the first; -1: none. */
int transport_first_region(const struct plan *plan);
/* Asks the gate (core/plan/fit.h) whether a part may be used with the first region. ERROR_STATE: the gate's sentence */
NODISCARD bool transport_fits(const struct plan *plan, struct fit_part part, struct error *err);
/* The centre of the aperture plane and the axis from a beam of the plan, whose entry is the source: the aperture lies
 * the distance of the beam file along the axis.
 *   errors  ERROR_UNSUPPORTED the beam of a treatment plan; ERROR_STATE the gate's sentence */
NODISCARD bool transport_pose_of_beam(const struct plan *plan, size_t beam, struct beam_file *file, struct error *err);

struct transport_scene {
    const struct grid *grid; /* of the layer of the first region that is used */
    uint8_t *voxels;         /* owned */
    struct material materials[MATERIAL_MAX];
    size_t n_materials;
};
/* Each region's voxels get its material; regions inside others win. Materials are the beam file's by region, else what
 * the region's name suggests, else soft tissue; a line for each region on standard output.
 * Regions of another patient are left out, with a line each.
 *   errors  ERROR_NOT_FOUND no regions; a region of the file that is not there; an unknown tissue or element;
 *           ERROR_STATE regions that do not belong together, by the gate; ERROR_LIMIT; ERROR_MEMORY */
NODISCARD bool transport_scene_init(struct transport_scene *scene, const struct plan *plan,
                                    const struct beam_file *file, struct error *err);
void transport_scene_finish(struct transport_scene *scene);

/* Adds the result to the plan as its last dose, in the unit of the plan's first if that is cGy, else in Gy; takes the
 * result's volumes. ERROR_LIMIT: the plan has PLAN_MAX_DOSES */
NODISCARD bool transport_add_dose(struct plan *plan, struct transport_result *result, const char *per,
                                  enum transport_mode mode, uint64_t seed, struct error *err);

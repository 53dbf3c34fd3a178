/* symmetry - fewer genes: boundary cables that are mirror images of each other change their tension by the same step.
 *
 * The plane x stands at the middle of the net's x extent (of all nodes), the plane y likewise; z is unchanged. The
 * mirror image of a cable joins the mirrored positions of its ends (to 1e-9 of the net's size), whose roles and loads
 * must be mirrored too, and is of the same group, law and target. A net is symmetric when every cable has one. */
#ifndef HIFDM_SYMMETRY_H
#define HIFDM_SYMMETRY_H

#include <hifdm/model.h>

#define HF_PLANE_X 1
#define HF_PLANE_Y 2

/* Set model->gene_leader, n_leader and the merged gene_group of a fresh model by what is wanted. *planes: the
 * HF_PLANE_ bits in force. HF_OK; HF_BAD_CASE naming cables without a mirror image when a plane that was asked for by
 * name does not hold; HF_NO_MEMORY. */
hf_status hf_symmetry_apply(const hf_scene *scene, hf_symmetry wanted, hf_model *model, int *planes,
                            hf_messages *messages);

/* "planes x and y", "plane x", "no plane" */
const char *hf_symmetry_planes_text(int planes);

/* Base tensions [n_gene] of a class that agree to 1e-6 become their mean; others stay, each cable keeps its own. */
void hf_symmetry_average(const hf_model *model, double *base_N);

/* Give every gene the step of its leader from the base: T'_k = T_k + (T'_leader - T_leader). leader: [n_gene]. */
void hf_symmetry_follow(int n_gene, const int *leader, const double *base_N, double *design_N);

#endif

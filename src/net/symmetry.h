/* symmetry - reduces the genes: boundary cables that are mirror images of each other change tension by the same step.
 *
 * The plane x stands at the middle of the net's x extent (of all nodes), the plane y likewise; z is unchanged. The
 * mirror image of a cable joins the mirrored positions of its ends (to 1e-9 of the net's size), whose roles and loads
 * must be mirrored too, and is of the same group, law and target. A net is symmetric when every cable has one. */
#ifndef HIFDM_SYMMETRY_H
#define HIFDM_SYMMETRY_H

#include <hifdm/model.h>

#define HF_PLANE_X 1
#define HF_PLANE_Y 2

/* Set model->gene_leader, n_leader and the merged gene_group of a newly built model as settings->symmetry says; genes
 * of optimize.variables follow if their row has link: symmetry. *planes: the HF_PLANE_ bits in force. Returns HF_OK;
 * HF_BAD_CASE with the cables that have no mirror image, when the net is not symmetric about a plane that was asked
 * for by name; HF_NO_MEMORY. */
hf_status hf_symmetry_apply(const hf_scene *scene, const hf_optimize_settings *settings, hf_model *model, int *planes,
                            hf_messages *messages);

/* "planes x and y", "plane x", "no plane" */
const char *hf_symmetry_planes_text(int planes);

/* Replace the base tensions [n_gene] of each class by their mean if they agree to 1e-6; other classes are unchanged. */
void hf_symmetry_average(const hf_model *model, double *base_N);

/* Give every gene the step of its leader from the base: T'_k = T_k + (T'_leader - T_leader). leader: [n_gene]. */
void hf_symmetry_follow(int n_gene, const int *leader, const double *base_N, double *design_N);

#endif

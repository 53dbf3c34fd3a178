/* symmetry - reduces the number of design variables: mirror images change by the same step.
 *
 * The plane x is at the middle of the x extent of all nodes, and the plane y at the middle of their y extent; z is
 * unchanged. The mirror image of a cable joins the mirrored positions of its ends (to 1e-9 of the size of the net). The
 * roles and loads of the ends must be mirrored, too. The image has the same group, law and target. A net is symmetric
 * if every cable has an image. */
#pragma once

#include <hifdm/model.h>

#define HF_PLANE_X 1
#define HF_PLANE_Y 2

/* Sets variable_leader, n_leader and the merged variable_group of a newly built model, as settings->symmetry asks for.
 * A design variable of optimize.variables is linked if its row has link: symmetry. *planes receives the HF_PLANE_ bits
 * of the planes used. Returns HF_OK or HF_NO_MEMORY. Returns HF_BAD_CASE if the user named a plane about which the net
 * is not symmetric; the message lists cables without an image. */
hf_status hf_symmetry_apply(const hf_scene *scene, const hf_optimize_settings *settings, hf_model *model, int *planes,
                            hf_messages *messages);

/* Returns "planes x and y", "plane x", "plane y" or "no plane". */
const char *hf_symmetry_planes_text(int planes);

/* Replaces the initial values [n_variable] of each class by their mean if they agree to 1e-6. Other
 * classes are unchanged. */
void hf_symmetry_average(const hf_model *model, double *initial);

/* Returns the step of design variable k per step of its leader: 1 or, with link: scale, the ratio of their initial
 * values. initial [n_variable] is NULL if no design variable scales. */
double hf_symmetry_weight(const hf_model *model, const double *initial, int k);

/* Changes every design variable by the step of its leader from the initial design: T'_k = T_k + w_k (T'_leader -
 * T_leader), with the weight w_k of hf_symmetry_weight. `initial` (T) and `design` (T') are [n_variable]. */
void hf_symmetry_follow(const hf_model *model, const double *initial, double *design);

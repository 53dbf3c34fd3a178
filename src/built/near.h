/* near - nets as built that are near the nominal one, by chord steps (search/chord.h): one matrix, factored at the
 * nominal shape and shared by all threads, serves eight nets at a time, one in each SIMD lane; or each by Newton's
 * method from the nominal shape (METHOD section 12).
 *
 * No operation mixes lanes, so the shape of a net depends neither on the others nor on the thread. */
#ifndef HIFDM_NEAR_H
#define HIFDM_NEAR_H

#include "built/pull_kernel.h"
#include "search/chord.h"
#include <hifdm/built.h>

/* What all threads share. */
typedef struct {
    const hf_built *built;
    hf_model model;         /* that of `built` but for its genes, of which there are none; it borrows all memory */
    hf_evaluator evaluator; /* for chord, which reads its model and its settings; so this struct may not move */
    hf_chord chord;
    double *band; /* the factored matrix of the nominal net, as in a workspace */
    /* On a truss: (I + F S)^-1, with F the flexibility and S the stiffness of the nominal net at the attachments,
     * packed for hf_pull_multiply. It stands in place of the modes of chord. */
    double *answer;
    hf_pull_find *find; /* kernels of this machine */
    hf_pull_multiply *multiply;
    void *block;
} hf_near;

/* Factor the matrix of the nominal net; w is scratch. Returns HF_OK; HF_NO_MEMORY; or another status when there is no
 * matrix: then nothing else here serves. Call hf_near_free in any case. */
hf_status hf_near_create(const hf_built *built, hf_workspace *w, hf_near *near);
void hf_near_free(hf_near *near);

/* The nets in the lanes of one thread. */
typedef struct {
    hf_chord_lanes lanes;
    double *cut_m, *stiffness_N_per_m, *tension_N; /* [n_cable][HF_LANES] */
    double *gap_lanes_m;                           /* [chord.n_pull][HF_LANES] */
    int steps[HF_LANES];
    double excess_N[HF_LANES], excess_before_N[HF_LANES]; /* residual, or gap of the truss in units of its tolerance */
    double residual_N[HF_LANES], gap_m[HF_LANES];
    hf_chord_measures now; /* of the shapes in the lanes */
    bool is_measured;
    void *block;
} hf_near_lanes;

hf_status hf_near_lanes_create(const hf_near *near, hf_near_lanes *lanes);
void hf_near_lanes_free(hf_near_lanes *lanes);

/* Begin with a net in a lane: cut_m and EA_N given, support_move_m given or NULL, at the nominal shape. */
void hf_near_load(const hf_near *near, hf_near_lanes *lanes, int lane, const hf_built_net *net);

/* Measure the forces in all lanes; take a step in all lanes. */
void hf_near_look(const hf_near *near, hf_near_lanes *lanes);
void hf_near_step(const hf_near *near, hf_near_lanes *lanes);

/* After hf_near_look. LOST: the net is too far from the nominal one. */
typedef enum { HF_NEAR_GOES_ON, HF_NEAR_FOUND, HF_NEAR_LOST } hf_near_verdict;

/* What to do with a lane. When the shape is found, it is in position_m and tension_N of the workspace. */
hf_near_verdict hf_near_settle(const hf_near *near, hf_near_lanes *lanes, int lane, const hf_built_net *net,
                               hf_workspace *w, hf_form_result *result);

/* Find one net by Newton's method from the nominal shape. Loose nodes are placed and counted as by hf_built_solve.
 * Returns false when it has not converged; else the status is HF_OK and the workspace holds the shape. */
bool hf_near_find(const hf_near *near, const hf_built_net *net, hf_workspace *w, hf_form_result *result);

/* ---- the parts of hf_near_find ---- */

/* The workspace gets the net at the nominal shape and tensions, with supports moved and attachments as unknowns. */
void hf_near_prepare(const hf_near *near, const hf_built_net *net, hf_workspace *w);

/* Newton's method from the workspace's position_m and tension_N. Adds its steps to *n_step. Returns false when it has
 * not come near an equilibrium; else tension_N and q_N_per_m belong to the shape, and the caller measures it. */
bool hf_near_newton(const hf_near *near, hf_workspace *w, int *n_step);

#endif

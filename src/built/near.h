/* near - solves as-built nets whose shape is near the nominal one (METHOD section 12).
 *
 * Chord steps (search/chord.h) use one matrix, factored at the nominal shape and shared by all threads. They solve
 * eight nets at a time, one in each SIMD lane. Newton's method solves one net, also from the nominal shape. No
 * operation mixes lanes, so the shape of a net depends neither on the other nets nor on the thread. */
#pragma once

#include "search/chord.h"
#include <hifdm/built.h>

/* Holds what all threads share. */
typedef struct {
    const hf_built *built;
    /* The model of `built` without design variables. It borrows all its memory. */
    hf_model model;
    /* For chord, which reads its model and settings. It points into this struct, so the struct must not be moved. */
    hf_evaluator evaluator;
    hf_chord chord;
    double *band; /* factored matrix of the nominal net, in the layout of a workspace */
    /* On a truss: (I + F S)^-1, packed for the kernel `multiply`. F is the flexibility, S the stiffness of the nominal
     * net at the attachments. It replaces the modes of chord. */
    double *answer;
    void *block;
} hf_near;

/* Factors the matrix of the nominal net; w is scratch. Returns HF_OK; HF_NO_MEMORY; or another status when there is no
 * such matrix, in which case no other function may be called. Call hf_near_free in any case. */
hf_status hf_near_create(const hf_built *built, hf_workspace *w, hf_near *near);
void hf_near_free(hf_near *near);

/* Holds the nets in the lanes of one thread. */
typedef struct {
    hf_chord_lanes lanes;
    double *cut_m, *stiffness_N_per_m, *tension_N; /* [n_cable][HF_LANES] of the nets in the lanes */
    double *gap_lanes_m;                           /* [chord.n_pull][HF_LANES] gaps of the truss */
    hf_chord_progress progress;
    void *block;
} hf_near_lanes;

hf_status hf_near_lanes_create(const hf_near *near, hf_near_lanes *lanes);
void hf_near_lanes_free(hf_near_lanes *lanes);

/* Puts a net into a lane, at the nominal shape. net->cut_m and net->EA_N must be given, net->support_displacement_m may
 * be NULL. If lanes->lanes.load_N is not NULL, net->load_N must be given, else it must be NULL. */
void hf_near_load(const hf_near *near, hf_near_lanes *lanes, int lane, const hf_built_net *net);

/* hf_near_look measures the forces in all lanes. hf_near_step takes a chord step in all lanes. */
void hf_near_look(const hf_near *near, hf_near_lanes *lanes);
void hf_near_step(const hf_near *near, hf_near_lanes *lanes);

/* State of a lane after hf_near_look. HF_NEAR_LOST: the net is too far from the nominal one. */
typedef enum { HF_NEAR_GOES_ON, HF_NEAR_FOUND, HF_NEAR_LOST } hf_near_verdict;

/* Decides whether a lane continues. When its shape is found, position_m and tension_N of the workspace and *result
 * receive it. */
hf_near_verdict hf_near_settle(const hf_near *near, hf_near_lanes *lanes, int lane, const hf_built_net *net,
                               hf_workspace *w, hf_form_result *result);

/* Solves one net by Newton's method from the nominal shape. Loose nodes get positions and are counted as in
 * hf_built_solve. Returns false when it does not converge. Otherwise the status is HF_OK and the workspace holds the
 * shape. */
bool hf_near_find(const hf_near *near, const hf_built_net *net, hf_workspace *w, hf_form_result *result);

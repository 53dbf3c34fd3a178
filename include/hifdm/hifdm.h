/* hifdm - everything the library offers. Reading order: scene, settings, truss, config, model, result, frame, carrier,
 * workspace, formfind, evaluate, ga, batch, metrics, surface, store. For all of it:
 *
 * Units. SI; the unit is the last part of a name (psi_m, tension_N, q_N_per_m, wall_s). No unit: no dimension.
 * Shapes. [n_cable][2]: n_cable rows of 2 numbers, one row after the other. Indices count from 0, and -1 is none.
 * Source. "Eq. n" and "Fig. n" are those of Chen et al., Aerospace 2022, 9, 239.
 * Errors. What can fail returns hf_status, HF_OK being 0, and, where it takes hf_messages, says what is wrong in words.
 *     Nothing prints, but to a stream it is given, or ends the program; a call that is wrong in itself is an assert.
 *     A design or shape that cannot be has its status in the result, and measures without a value are NaN.
 * Memory. hf_THING_free frees what the thing holds and leaves it all zero; one that is all zero already is fine. What
 *     is "borrowed" must stay as long as the thing that borrows it.
 * Threads. Nothing is kept outside the things. A scene, model, truss, frame, carrier
 *     or evaluator does not change once it is made, so threads share it; a workspace, batch, ga or store belongs to one
 *     thread at a time.
 * GSL. Its error handler, one for the whole program, ends that by default where GSL only means "no progress": call
 *     gsl_set_error_handler_off() (gsl/gsl_errno.h) before hf_surface_measure or hf_surface_fit_nodes. */
#ifndef HIFDM_HIFDM_H
#define HIFDM_HIFDM_H

#include <hifdm/batch.h>
#include <hifdm/cable_law.h>
#include <hifdm/carrier.h>
#include <hifdm/config.h>
#include <hifdm/evaluate.h>
#include <hifdm/formfind.h>
#include <hifdm/frame.h>
#include <hifdm/ga.h>
#include <hifdm/generate.h>
#include <hifdm/metrics.h>
#include <hifdm/model.h>
#include <hifdm/problem.h>
#include <hifdm/result.h>
#include <hifdm/run.h>
#include <hifdm/scene.h>
#include <hifdm/settings.h>
#include <hifdm/status.h>
#include <hifdm/store.h>
#include <hifdm/summary.h>
#include <hifdm/surface.h>
#include <hifdm/truss.h>
#include <hifdm/workspace.h>

#endif

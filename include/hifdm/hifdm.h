/* hifdm - all headers of the library.
 * Stability: stable.
 *
 * Start with problem (a case opened by one call), batch (designs -> results) and run (a whole run). Reading order of
 * the rest: scene, settings, truss, config, model, result, frame, carrier, workspace, formfind, evaluate, population,
 * optimiser, metrics, surface, store. These rules hold in all headers:
 *
 * Stability. The head of each header says one of two words. Stable: a program that uses it compiles with later
 *     versions and means the same, unless CHANGELOG.md names the change; structs may get members, so initialise them to
 *     zero, set members by name, and compile again. Internal: it is installed because a stable header needs its types;
 *     names and meaning may change in any version.
 * Units. SI; the unit is the last part of a name (psi_m, tension_N, q_N_per_m, wall_s). No unit: no dimension.
 * Shapes. [n_cable][2]: n_cable rows of 2 numbers, one row after the other. Indices count from 0, and -1 is none.
 * Source. "Eq. n" and "Fig. n" are those of Chen et al., Aerospace 2022, 9, 239.
 * Errors. A function that can fail returns hf_status (HF_OK is 0) and, where it takes hf_messages, describes the fault
 *     in words. No function ends the program, and none prints except to a stream that it is given; a wrong call fails
 *     an assert.
 *     A design without a shape has its status in its result, and measures without a value are NaN.
 * Memory. hf_THING_free frees what the struct hf_THING holds and leaves it all zero; it may be called on a struct that
 *     is all zero. What is "borrowed" must outlive the struct that borrows it.
 * Threads. No state is kept outside these structs. A scene, model, truss, frame, carrier or evaluator does not change
 *     once it is made, so threads share it; a workspace, batch, problem, optimiser or store belongs to one thread at a
 *     time.
 * Waiting. Threads that wait for others spin for long unless the environment says otherwise: hf_batch_wait_quietly.
 * GSL. GSL has one error handler for the whole program, which by default ends it even where GSL only reports "no
 *     progress": call gsl_set_error_handler_off() (gsl/gsl_errno.h) before hf_surface_measure, hf_surface_fit_points,
 *     or hf_run_case for a case with a surface section. */
#ifndef HIFDM_HIFDM_H
#define HIFDM_HIFDM_H

#include <hifdm/batch.h>
#include <hifdm/cable_law.h>
#include <hifdm/cable_set.h>
#include <hifdm/carrier.h>
#include <hifdm/config.h>
#include <hifdm/evaluate.h>
#include <hifdm/flat.h>
#include <hifdm/formfind.h>
#include <hifdm/frame.h>
#include <hifdm/generate.h>
#include <hifdm/material.h>
#include <hifdm/metrics.h>
#include <hifdm/model.h>
#include <hifdm/optimiser.h>
#include <hifdm/population.h>
#include <hifdm/problem.h>
#include <hifdm/result.h>
#include <hifdm/run.h>
#include <hifdm/scene.h>
#include <hifdm/scene_arrays.h>
#include <hifdm/settings.h>
#include <hifdm/states.h>
#include <hifdm/status.h>
#include <hifdm/store.h>
#include <hifdm/summary.h>
#include <hifdm/surface.h>
#include <hifdm/truss.h>
#include <hifdm/workspace.h>

#endif

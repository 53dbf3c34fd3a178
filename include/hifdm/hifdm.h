/* hifdm - all headers of the library.
 * Stability: stable.
 *
 * Start with problem (a case opened by one call), batch (designs -> results) and run (a whole run). Reading order of
 * the rest: scene, settings, truss, config, model, result, frame, carrier, workspace, formfind, evaluate, population,
 * optimiser, metrics, surface, store. The following rules hold in all headers.
 *
 * Stability: the head of each header says whether it is stable or internal. A program that uses a stable header
 * compiles with later versions and has the same meaning, unless CHANGELOG.md names the change. Structs may get members,
 * so initialise them to zero, set members by name, and compile again. An internal header is installed because a stable
 * header needs its types; names and meaning may change in any version.
 *
 * Units: SI. The unit is the last part of a name (psi_m, tension_N, q_N_per_m, wall_s). A name without a unit has no
 * dimension.
 *
 * Shapes: [n_cable][2] are n_cable rows of 2 numbers, one row after the other. Indices count from 0, and -1 is none.
 *
 * Source: "Eq. n" and "Fig. n" are those of Chen et al., Aerospace 2022, 9, 239. "METHOD section n" and (Mn) are those
 * of src/METHOD.md.
 *
 * Errors: a function that can fail returns hf_status (HF_OK is 0) and, if it takes hf_messages, adds a message about
 * the fault. No function ends the program, and none prints except to a stream that it is given. A wrong call fails an
 * assert. The result of a design without a shape contains the status, and measures without a value are NaN.
 *
 * Memory: hf_THING_free frees what the struct hf_THING holds and, unless its comment says otherwise, sets it to all
 * zero. It may be called for a struct that is all zero. A "borrowed" argument must outlive the struct that borrows it.
 *
 * Threads: no state is kept outside these structs. A scene, model, truss, frame, carrier or evaluator does not change
 * once it is made, so threads share it. A workspace, batch, problem, optimiser or store belongs to one thread at a
 * time.
 *
 * Waiting: threads that wait for others spin for long unless the environment says otherwise (hf_batch_wait_quietly).
 *
 * GSL: the library GSL has one error handler for the whole program. By default it ends the program even if GSL only
 * reports "no progress". Call gsl_set_error_handler_off() (gsl/gsl_errno.h) before hf_surface_measure,
 * hf_surface_fit_points, or hf_run_case for a case with a section surface. */
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
#include <hifdm/load_cases.h>
#include <hifdm/status.h>
#include <hifdm/store.h>
#include <hifdm/summary.h>
#include <hifdm/surface.h>
#include <hifdm/truss.h>
#include <hifdm/workspace.h>

#endif

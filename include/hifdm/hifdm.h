/* hifdm - includes all headers of the library.
 * Stability: stable.
 *
 * Start with the headers problem (opens a case in one call), batch (evaluates designs) and run (executes a complete
 * run). Read the other headers in this order: scene, settings, truss, config, model, result, frame, carrier, workspace,
 * formfind, evaluate, population, optimiser, metrics, surface, store. The following rules apply to all headers.
 *
 * Stability: the comment at the head of each header states whether the header is stable or internal. A program that
 * uses only stable headers compiles and behaves in the same way with later versions. The file CHANGELOG.md lists all
 * exceptions to this compatibility. A later version may add members to structs. Initialise structs to zero, set members
 * by name, and recompile for each version. An internal header is installed only because a stable header needs its
 * types. The names in an internal header and their meaning may change in any version.
 *
 * Units: all quantities are in SI units. The last part of a name is the unit (psi_m, tension_N, q_N_per_m, wall_s). A
 * quantity without a unit in its name is dimensionless.
 *
 * Shapes: [n_cable][2] means n_cable consecutive rows of 2 numbers. Indices start at 0. An index of -1 means that the
 * element does not exist.
 *
 * Source: "Eq. n" and "Fig. n" refer to Chen et al., Aerospace 2022, 9, 239. "METHOD section n" and (Mn) refer to
 * src/METHOD.md.
 *
 * Errors: a function that can fail returns an hf_status (HF_OK is 0). If the function has an argument of type
 * hf_messages, the function also adds a message about the fault. No function ends the program. A function prints only
 * to a stream that the caller passes. If a call is invalid, an assertion fails. If a design has no shape, the status in
 * its result gives the reason. Quantities without a value are NaN.
 *
 * Memory: hf_THING_free frees the memory that the struct hf_THING owns. Unless its comment states otherwise,
 * hf_THING_free also sets all members of the struct to zero. The argument of hf_THING_free may be a struct whose
 * members are all zero. A "borrowed" argument must outlive the struct that borrows it.
 *
 * Threads: the library has no state outside its structs. Threads can share a scene, model, truss, frame, carrier or
 * evaluator because these objects do not change after creation. Only one thread at a time may use a workspace, batch,
 * problem, optimiser or store.
 *
 * Waiting: by default, threads that wait for other threads spin for a long time. The function hf_batch_wait_quietly
 * shortens the time for which waiting threads spin.
 *
 * GSL: the GSL library has one error handler for the whole program. By default, the error handler of GSL ends the
 * program even if GSL only reports "no progress". Call gsl_set_error_handler_off() (gsl/gsl_errno.h) before
 * hf_surface_measure and hf_surface_fit_points. If the case has a `surface` section, also call
 * gsl_set_error_handler_off() before hf_run_case. */
#pragma once

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

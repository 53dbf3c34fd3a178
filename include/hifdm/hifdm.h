/* hifdm - everything the library offers. Reading order: scene, config, model, workspace, formfind, evaluate, ga, batch,
 * store. */
#ifndef HIFDM_HIFDM_H
#define HIFDM_HIFDM_H

#include <hifdm/batch.h>
#include <hifdm/carrier.h>
#include <hifdm/config.h>
#include <hifdm/evaluate.h>
#include <hifdm/formfind.h>
#include <hifdm/frame.h>
#include <hifdm/ga.h>
#include <hifdm/metrics.h>
#include <hifdm/model.h>
#include <hifdm/scene.h>
#include <hifdm/status.h>
#include <hifdm/store.h>
#include <hifdm/summary.h>
#include <hifdm/surface.h>
#include <hifdm/truss.h>
#include <hifdm/workspace.h>

#endif

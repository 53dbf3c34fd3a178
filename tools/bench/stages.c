/* A whole run, stage by stage, of a case that only needs the force density method, one that is form-found, and one that
 * is optimised as well: what takes how long, and what memory each stage has allocated and keeps. The run is the
 * program's own: the linker puts the functions below between it and the library (BENCH_WRAP in the Makefile). What a
 * case does not need has no sample. Evaluations include the breeding of what is evaluated. On one thread, where the
 * stages of a generation come one after the other. */
#include "bench.h"

#include "search/refine.h"
#include <hifdm/run.h>
#include "net/symmetry.h"
#include <hifdm/store.h>

#include <malloc.h>
#include <math.h>
#include <stdio.h>

enum { READ, SCENE, MODEL, FORM, SETUP, EVALUATE, RANK, REFINE, STORE, N_STAGE };
static const char *const stage_word[N_STAGE] = {"read case", "scene",          "model",      "form-finding",
                                                "GA set-up", "GA evaluations", "GA ranking", "Levenberg-Marquardt",
                                                "storing"};

/* Globals, because the functions of the library have no context to pass them in. */
static int watching, depth, n_call[N_STAGE];
static double time_s[N_STAGE], kept_bytes[N_STAGE], bytes_at_most;
static struct {
    double since_s, bytes; /* when it began, less what those inside have taken */
} call[8];

/* Bytes in use on the heap, including untouched pages that calloc has reserved; 0 where the C library has no count. */
static double heap_bytes(void)
{
#if defined __GLIBC__ && (__GLIBC__ > 2 || __GLIBC_MINOR__ >= 33)
    struct mallinfo2 now = mallinfo2();
    return (double)now.uordblks + (double)now.hblkhd;
#else
    return 0;
#endif
}

static void enter(void)
{
    if (!watching) return;
    call[depth].bytes = heap_bytes();
    call[depth++].since_s = bench_clock_s();
}

static void leave(int stage)
{
    if (!watching) return;
    double took_s = bench_clock_s() - call[--depth].since_s, bytes = heap_bytes(), kept = bytes - call[depth].bytes;
    time_s[stage] += took_s;
    kept_bytes[stage] += kept;
    bytes_at_most = fmax(bytes_at_most, bytes);
    n_call[stage]++;
    if (depth == 0) return;
    call[depth - 1].since_s += took_s;
    call[depth - 1].bytes += kept;
}

#define WATCH(stage, type, name, parameters, arguments)                                                                \
    __typeof__(name) __real_##name, __wrap_##name;                                                                     \
    type __wrap_##name parameters                                                                                      \
    {                                                                                                                  \
        enter();                                                                                                       \
        type returned = __real_##name arguments;                                                                       \
        leave(stage);                                                                                                  \
        return returned;                                                                                               \
    }
#define WATCH_VOID(stage, name, parameters, arguments)                                                                 \
    __typeof__(name) __real_##name, __wrap_##name;                                                                     \
    void __wrap_##name parameters                                                                                      \
    {                                                                                                                  \
        enter();                                                                                                       \
        __real_##name arguments;                                                                                       \
        leave(stage);                                                                                                  \
    }

WATCH(READ, hf_status, hf_config_load,
      (const char *path, const char *const *set, int n_set, hf_case *settings, hf_messages *messages),
      (path, set, n_set, settings, messages))
WATCH(SCENE, hf_status, hf_config_scene, (const hf_case *settings, hf_scene *scene, hf_messages *messages),
      (settings, scene, messages))
WATCH(MODEL, hf_status, hf_model_build,
      (const hf_scene *scene, const hf_form_settings *form, hf_model *model, hf_messages *messages),
      (scene, form, model, messages))
WATCH(MODEL, hf_status, hf_symmetry_apply,
      (const hf_scene *scene, const hf_optimize_settings *settings, hf_model *model, int *planes,
       hf_messages *messages),
      (scene, settings, model, planes, messages))
WATCH(FORM, hf_status, hf_workspace_create, (const hf_model *model, hf_workspace *workspace), (model, workspace))
WATCH(FORM, hf_status, hf_evaluate_form,
      (const hf_model *model, const hf_form_settings *form, hf_workspace *w, hf_history *history, hf_form_result *r),
      (model, form, w, history, r))
WATCH(SETUP, hf_status, hf_batch_create, (const hf_evaluator *evaluator, int n_thread, hf_batch *batch),
      (evaluator, n_thread, batch))
WATCH(SETUP, hf_solver, hf_batch_share, (hf_batch * batch, const double *initial), (batch, initial))
WATCH(SETUP, hf_status, hf_optimiser_create,
      (const hf_optimiser_kind *kind, const hf_optimize_settings *settings, const hf_model *model,
       const double *initial, hf_optimiser *optimiser),
      (kind, settings, model, initial, optimiser))
WATCH_VOID(EVALUATE, hf_batch_run,
           (hf_batch * batch, int n, const double *design, const unsigned char *pending, hf_form_result *result),
           (batch, n, design, pending, result))
WATCH(EVALUATE, bool, hf_batch_next, (hf_batch * batch, hf_optimiser *ga, void (*beside)(void *), void *context),
      (batch, ga, beside, context))
WATCH(EVALUATE, hf_workspace *, hf_batch_run_one, (hf_batch * batch, const double *design, hf_form_result *result),
      (batch, design, result))
WATCH_VOID(RANK, hf_optimiser_tell, (hf_optimiser * ga), (ga))
WATCH(REFINE, hf_status, hf_refine_run,
      (const hf_evaluator *evaluator, const double *lower, const double *upper, int max_iterations,
       const hf_watch_front *front, const hf_refine_watcher *watcher, double *design, hf_workspace *workspace,
       hf_refine_result *result),
      (evaluator, lower, upper, max_iterations, front, watcher, design, workspace, result))
WATCH(STORE, hf_status, hf_store_create,
      (const char *path, bool force, const hf_case *settings, const hf_scene *scene, const hf_truss *truss, int argc,
       char *const *argv, hf_store **store, hf_messages *messages),
      (path, force, settings, scene, truss, argc, argv, store, messages))
WATCH(STORE, hf_status, hf_store_form,
      (hf_store * store, const hf_model *model, const hf_workspace *workspace, const hf_history *history,
       hf_messages *messages),
      (store, model, workspace, history, messages))
WATCH(STORE, hf_status, hf_store_generation,
      (hf_store * store, const hf_model *model, const hf_population *population, hf_messages *messages),
      (store, model, population, messages))
WATCH(STORE, hf_status, hf_store_publish,
      (hf_store * store, const hf_summary *summary, bool at_once, hf_messages *messages),
      (store, summary, at_once, messages))
WATCH(STORE, hf_status, hf_store_shape,
      (hf_store * store, hf_stage stage, const hf_model *model, const hf_workspace *workspace, const double *design,
       hf_messages *messages),
      (store, stage, model, workspace, design, messages))
WATCH(STORE, hf_status, hf_store_complete, (hf_store * store, const hf_summary *summary, hf_messages *messages),
      (store, summary, messages))
WATCH(STORE, hf_status, hf_store_settle, (hf_store * store, hf_messages *messages), (store, messages))

void bench_stages(const char *name, const char *folder, const char *path, const char *const *overrides, int n_override)
{
    char wanted[HF_PATH_SIZE], output[HF_OUTPUT_SIZE];
    static hf_summary summary;
    hf_messages messages = {0};
    snprintf(wanted, sizeof wanted, "%s/stages.h5", folder);
    hf_run_request request = {.input = {path, .set = overrides, .n_set = n_override},
                              .output = {.path = wanted, .restart = true},
                              .control.threads = 1};
    hf_store_quiet();
    double bytes_at_first = heap_bytes(), start_s = bench_clock_s();
    watching = 1;
    hf_status status = hf_run_case(&request, &summary, output, &messages);
    double total_s = bench_clock_s() - start_s;
    watching = 0;
    if (status != HF_OK) bench_fail(path, messages.text);
    double rest_s = total_s;
    for (int i = 0; i < N_STAGE; i++) {
        rest_s -= time_s[i];
        if (n_call[i] == 0) continue;
        bench_emit("stages", name, stage_word[i], i, "time_s", time_s[i]);
        bench_emit("stages", name, stage_word[i], i, "kept_bytes", kept_bytes[i]);
    }
    bench_emit("stages", name, "everything else", N_STAGE, "time_s", rest_s);
    bench_emit("stages", name, "whole run", N_STAGE + 1, "time_s", total_s);
    bench_emit("stages", name, "whole run", N_STAGE + 1, "kept_bytes", bytes_at_most - bytes_at_first);
    hf_messages_free(&messages);
}

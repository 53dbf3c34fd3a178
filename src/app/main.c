/* main - from the command line to an exit status; with print, progress and plan the only printing part of the
 * program. */
#include "app/cmd_check.h"
#include "linalg/band.h"
#include "store/compare.h"
#include "out/cutlist.h"
#include "app/cmd_evaluate.h"
#include "out/export.h"
#include "app/help.h"
#include "app/options.h"
#include "out/print.h"
#include "app/progress.h"
#include "out/report.h"
#include <hifdm/run.h>
#include "out/vtk.h"
#include "base/signals.h"
#include "app/cmd_sweep.h"
#include <hifdm/batch.h>
#include <hifdm/store.h>

#include <gsl/gsl_errno.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static hf_status command_run(const hf_options *o, int argc, char **argv, hf_messages *messages)
{
    hf_summary summary;
    char output[HF_OUTPUT_SIZE];
    hf_progress progress = hf_progress_on(stderr, o->quiet ? HF_PROGRESS_NONE : o->progress);
    hf_run_request request = {.case_path = o->file,
                              .set = o->set,
                              .n_set = o->n_set,
                              .output = o->output,
                              .restart = o->force,
                              .threads = o->threads,
                              .has_seed = o->has_seed,
                              .seed = o->seed,
                              .argc = argc,
                              .argv = argv,
                              .stop_requested = hf_signals_watch(),
                              .observer = hf_progress_show,
                              .observer_context = &progress};
    hf_status status = hf_run_point(&request, &summary, output, messages);
    hf_progress_end(&progress);
    const char *path = *output ? output : NULL;
    if (o->json)
        hf_summary_write_json(&summary, status, messages->text, path, stdout);
    else if (path && !o->quiet)
        hf_print_summary(&summary, path, stdout);
    return status;
}

static hf_status command_show(const hf_options *o, hf_messages *messages)
{
    hf_summary summary;
    HF_TRY(hf_store_read_summary(o->file, &summary, messages));
    if (o->json) {
        hf_summary_write_json(&summary, summary.finished ? summary.status : summary.form.status, summary.warnings,
                              o->file, stdout);
    } else {
        hf_print_summary(&summary, o->file, stdout);
        fputs(summary.warnings, stdout);
    }
    return HF_OK;
}

static hf_status command_export(const hf_options *o, hf_messages *messages)
{
    static hf_status (*const writer[])(const hf_export_request *, char *, size_t, hf_messages *) = {hf_export, hf_vtk,
                                                                                                    hf_cutlist};
    const char *const asked[] = {o->csv, o->vtk, o->cutlist};
    for (int i = 0; i < 3; i++) {
        char said[4096];
        if (!asked[i]) continue;
        const hf_export_request request = {o->file, asked[i], o->stage, o->force};
        HF_TRY(writer[i](&request, said, sizeof said, messages));
        printf("%s\n", said);
    }
    return HF_OK;
}

static hf_status command_report(const hf_options *o, hf_messages *messages)
{
    const hf_export_request request = {.file = o->file, .output = o->output, .force = o->force};
    char said[4096];
    HF_TRY(hf_report(&request, said, sizeof said, messages));
    printf("%s\n", said);
    return HF_OK;
}

static hf_status command_recover(const hf_options *o, hf_messages *messages)
{
    hf_summary summary;
    HF_TRY(hf_store_recover(o->file, &summary, messages));
    return command_show(o, messages);
}

static void tell_difference(void *context, const char *path, const char *how)
{
    fprintf(context, "%s%s\n", path, how);
}

static hf_status command_diff(const hf_options *o, hf_messages *messages)
{
    hf_comparison c = {.rtol = o->rtol, .atol = o->atol};
    hf_status status = hf_compare_files(o->file, o->second, &c, tell_difference, stdout, messages);
    if (status != HF_OK && status != HF_DIFFERENT) return status;
    printf("%d data sets, %d differ; attributes (times, machine, provenance, summary) are not compared\n", c.n_data_set,
           c.n_different);
    return status;
}

static hf_status dispatch(const hf_options *o, int argc, char **argv, hf_messages *messages)
{
    switch (o->command) {
    case HF_COMMAND_RUN:
        return command_run(o, argc, argv, messages);
    case HF_COMMAND_CHECK:
        return hf_cmd_check(o, stdout, messages);
    case HF_COMMAND_EVALUATE:
        return hf_cmd_evaluate(o, stdout, messages);
    case HF_COMMAND_SWEEP:
        return hf_cmd_sweep(o, argc, argv, hf_signals_watch(), stdout, messages);
    case HF_COMMAND_STATUS:
        return hf_cmd_status(o, stdout, messages);
    case HF_COMMAND_MERGE:
        return hf_cmd_merge(o, stdout, messages);
    case HF_COMMAND_SHOW:
        return command_show(o, messages);
    case HF_COMMAND_RECOVER:
        return command_recover(o, messages);
    case HF_COMMAND_DIFF:
        return command_diff(o, messages);
    case HF_COMMAND_REPORT:
        return command_report(o, messages);
    case HF_COMMAND_EXPORT:
        return command_export(o, messages);
    case HF_COMMAND_SCHEMA:
        hf_print_schema(stdout);
        return HF_OK;
    case HF_COMMAND_HELP:
        hf_help(o, stdout);
        return HF_OK;
    case HF_COMMAND_VERSION:
        printf("hifdm %s\n", hf_store_version());
        return HF_OK;
    }
    return HF_BAD_USAGE;
}

/* A generation takes less than a millisecond. Threads that spin for long while they wait for one that does not run, as
 * OpenMP's do by default, made runs beside others 30 times slower on two cores; threads that sleep at once lose 10 to
 * 20 % of a run on an idle machine: they spin for some microseconds. OpenBLAS's own threads, which nobody uses here,
 * spin while the program begins. Both libraries read their wishes before main does, so the program starts itself once
 * more with them. What the user has set stays; where it cannot be, the program goes on as it is. */
static void wait_quietly(char **argv)
{
    char path[HF_PATH_SIZE];
    int says_how = getenv("OMP_WAIT_POLICY") || getenv("GOMP_SPINCOUNT");
    if (says_how && getenv("OPENBLAS_NUM_THREADS")) return;
    ssize_t n = readlink("/proc/self/exe", path, sizeof path - 1);
    if (n <= 0) return;
    path[n] = '\0';
    if (strstr(path, "/ld-") || strstr(path, "/ld.so")) return; /* the dynamic linker, told to run this program */
    int failed = setenv("OPENBLAS_NUM_THREADS", "1", 0);
    if (!says_how) failed |= setenv("GOMP_SPINCOUNT", "2000", 1);
    if (!says_how) failed |= setenv("OMP_WAIT_POLICY", "passive", 1); /* of other OpenMP libraries */
    if (!failed) execv(path, argv);
}

int main(int argc, char **argv)
{
    hf_options options;
    hf_messages messages = {0};
    hf_status status = hf_options_parse(argc, argv, &options, &messages);
    int uses_threads = status == HF_OK && options.command <= HF_COMMAND_SWEEP;
    if (uses_threads) wait_quietly(argv); /* may begin anew, so before the libraries are set up */
    signal(SIGXFSZ, SIG_IGN);             /* a file that may not grow is an error of writing, with words */
    gsl_set_error_handler_off();
    hf_store_quiet();
    hf_band_single_threaded(); /* its own threads would change bits, and only get in the way of ours */
    if (uses_threads) {
        int n_thread = options.threads > 0 ? options.threads : hf_batch_default_threads();
        if (!hf_band_has_room(n_thread))
            status = hf_error(&messages, HF_NO_MEMORY,
                              "LAPACK takes %d MB of address space for each of %d threads, more than there is (ulimit "
                              "-v); raise it, or use fewer --threads",
                              HF_BAND_ROOM_MB, n_thread);
    }
    if (status == HF_OK) status = dispatch(&options, argc, argv, &messages);
    hf_options_free(&options);
    if (messages.text) fputs(messages.text, stderr);
    hf_messages_free(&messages);
    if ((fflush(stdout) != 0 || ferror(stdout)) && status == HF_OK) {
        fputs("error: cannot write to standard output\n", stderr);
        status = HF_IO;
    }
    return hf_status_exit_code(status);
}

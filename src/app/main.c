/* main - reads the command line, runs the command, and returns the exit status. The file cmd_NAME.c holds the command
 * NAME. */
#include "app/options.h"
#include "app/reader.h"

#include "linalg/band.h"
#include <hifdm/batch.h>
#include <hifdm/store.h>

#include <gsl/gsl_errno.h>
#include <limits.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Sets the environment for OpenMP and OpenBLAS and starts the program a second time, because both libraries read the
 * environment before main begins. Variables that the user has set are kept; when a variable cannot be set, the program
 * continues as it is.
 *
 * OpenMP: a generation takes less than a millisecond. By default waiting threads spin for long; when the machine also
 * runs other programs, the thread they wait for may not be running, and runs were 30 times slower on two cores. Threads
 * that sleep at once lose 10 to 20 % of a run on an idle machine. Spinning for some microseconds avoids both.
 * OpenBLAS: its own threads are not used here, but would spin while the program starts. */
static void wait_quietly(char **argv)
{
    char path[PATH_MAX];
    bool says_how = getenv("OMP_WAIT_POLICY") || getenv("GOMP_SPINCOUNT");
    if (says_how && getenv("OPENBLAS_NUM_THREADS")) return;
    ssize_t n = readlink("/proc/self/exe", path, sizeof path - 1);
    if (n <= 0 || n == sizeof path - 1) return; /* no path, or one that may be cut */
    path[n] = '\0';
    if (strstr(path, "/ld-") || strstr(path, "/ld.so")) return; /* the dynamic linker, told to run this program */
    bool failed = setenv("OPENBLAS_NUM_THREADS", "1", 0) != 0;
    if (!says_how) failed |= setenv("GOMP_SPINCOUNT", "2000", 1);
    if (!says_how) failed |= setenv("OMP_WAIT_POLICY", "passive", 1); /* of other OpenMP libraries */
    if (!failed) execv(path, argv);
}

static hf_status check_room(const hf_options *o, hf_messages *messages)
{
    int n_thread = o->threads > 0 ? o->threads : hf_batch_default_threads();
    if (hf_band_has_room(n_thread)) return HF_OK;
    return hf_error(messages, HF_NO_MEMORY,
                    "LAPACK takes %d MB of address space for each of %d threads, more than there is (ulimit -v); "
                    "raise it, or use fewer --threads",
                    HF_BAND_ROOM_MB, n_thread);
}

static void print_messages(hf_messages *messages)
{
    if (messages->text) fputs(messages->text, stderr);
    hf_messages_free(messages);
}

int main(int argc, char **argv)
{
    hf_options options;
    hf_messages messages = {0};
    hf_status status = hf_options_parse(argc, argv, &options, &messages);
    bool uses_threads = status == HF_OK && options.command->uses_threads;
    int exit_status;
    if (status == HF_OK && options.command->reads_results && hf_reader_watch(&options, &exit_status, &messages)) {
        print_messages(&messages);
        hf_options_free(&options);
        return exit_status;
    }
    if (uses_threads) wait_quietly(argv); /* may start the program anew, so before the libraries are set up */
    signal(SIGXFSZ, SIG_IGN);             /* writing beyond the limit on file size then fails with an error */
    gsl_set_error_handler_off();
    hf_store_quiet();
    hf_band_single_threaded(); /* threads of LAPACK's own would change bits and take cores from ours */
    if (uses_threads) status = check_room(&options, &messages);
    if (status == HF_OK) status = options.command->run(&options, stdout, &messages);
    hf_options_free(&options);
    print_messages(&messages);
    if ((fflush(stdout) != 0 || ferror(stdout)) && status == HF_OK) {
        fputs("error: cannot write to standard output\n", stderr);
        status = HF_IO;
    }
    return hf_status_exit_code(status);
}

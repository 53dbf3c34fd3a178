/* Runs a command that reads results in a copy of the program. reader.h describes the interface.
 *
 *     fork -> copy: runs the command, notes the file that it reads -> ends
 *          -> first process: waits -> same exit status, same signal, or a message about the damaged file */
#define _DEFAULT_SOURCE /* for MAP_ANONYMOUS */
#include "app/reader.h"

#include "base/child.h"
#include "store/hdf5.h"

#include <signal.h>
#include <string.h>
#include <sys/mman.h>

/* Returns true for an exit status of the manual, not of a sanitizer or an abort handler. */
static bool is_ours(int exit_status)
{
#define IS(name, ...) exit_status == hf_status_exit_code(HF_##name) ||
    return HF_STATUS_LIST(IS) false;
#undef IS
}

/* Returns true for a signal that is meant to end this process as well as its copy. */
static bool is_for_us(int number)
{
    return number == SIGINT || number == SIGTERM || number == SIGHUP || number == SIGPIPE || number == SIGQUIT;
}

bool hf_reader_watch(const hf_options *options, int *exit_status, hf_messages *messages)
{
    char words[128];
    char *reading = mmap(NULL, HF_HDF5_READING_SIZE, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (reading == MAP_FAILED) return false;
    hf_hdf5_reading = reading;
    pid_t child = hf_child_fork();
    if (child <= 0) return false;
    hf_messages_free(messages); /* the copy prints them */
    hf_child_end end = hf_child_wait(child);
    if (is_for_us(end.signal)) { /* this process ends by the same signal */
        signal(end.signal, SIG_DFL);
        raise(end.signal);
    }
    *exit_status = end.exit_status;
    if (end.is_known && !end.signal && is_ours(end.exit_status)) return true;
    hf_child_describe(end, words, sizeof words);
    const char *file = *reading ? reading : options->file, *other = options->second;
    if (other && !strcmp(file, other)) other = options->file;
    hf_status status = HF_IO;
    if (end.is_sent)
        hf_error(messages, status, "%s: the process that read this file was ended by %s", file, words);
    else
        hf_error(messages, status, "%s: this file is damaged. The process that read the file was ended by %s%s%s", file,
                 words, other ? ", beside " : "", other ? other : "");
    *exit_status = hf_status_exit_code(status);
    return true;
}

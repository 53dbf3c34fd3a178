/* child - work that may crash or never end, done by a copy of this process: HDF5 answers some damaged files so.
 *
 * A copy (fork) has one thread, and finds every lock as another thread of this process held it: of a process with
 * several threads it may hang in malloc for ever. Such a process starts a server before its threads begin. The server
 * is a copy with one thread that makes the others. A child ends when its parent ends. */
#ifndef HIFDM_CHILD_H
#define HIFDM_CHILD_H

#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

typedef struct {
    bool is_known;   /* false: somebody else has waited for it, or it could not be made */
    int exit_status; /* -1 after a signal */
    int signal;      /* 0: it ended by itself */
    bool is_sent;    /* the signal is none that a fault raises: it was killed, or had no more memory or CPU time of the
                        user's; nothing follows for the work */
} hf_child_end;

/* As fork(2), for a process of one thread. The child leaves with _exit(2), or what is in buffers of stdio is written
 * twice. Signals of the terminal reach both. */
pid_t hf_child_fork(void);

hf_child_end hf_child_wait(pid_t child);

/* "signal 11 (Segmentation fault)", "exit status 99", or after a signal that was sent the signal and what to do */
void hf_child_describe(hf_child_end end, char *text, size_t size);

/* From now on this process ends by SIGXCPU when it has used so many more seconds of CPU time, at least 1; 0: it does
 * not. The next call replaces this one. A limit of the user's that is lower stays. */
void hf_child_limit_cpu(int seconds);

/* ---- The server ---- */

/* Between the two calls hf_child_ask works. Calls may be nested: the server of the first serves until the last has
 * ended. Without memory or processes there is no server, which is no error. What a thread holds when the server begins
 * (descriptors, and locks by them) the server holds until it ends. */
void hf_child_server_begin(void);
void hf_child_server_end(void);

/* Do the work in a child of the server and wait for its end; exit status 0 when `work` returns. From any thread: one
 * child at a time. False when there is no server, or the text is too long for it. The child ignores SIGINT, SIGTERM,
 * SIGHUP and SIGUSR1: whoever waits decides. */
typedef void hf_child_work(const char *text);
#define HF_CHILD_TEXT_SIZE 8192
bool hf_child_ask(hf_child_work *work, const char *text, hf_child_end *end);

#endif

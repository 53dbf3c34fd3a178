/* child - runs work that may crash or never end in another process. HDF5 crashes or loops on some damaged files.
 *
 * A copy made by fork(2) has one thread and inherits every lock in its current state. If another thread holds a lock at
 * that moment, the copy can block in malloc for ever. A process with several threads therefore starts a server before
 * it starts its threads. The server is a copy with one thread, and it forks the other children. If the process is not
 * ours, such as that of Python, another program takes the place of the copy (hf_child_spawn). On Linux, a copy ends
 * when its parent ends. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

typedef struct {
    bool is_known;   /* false: the process could not be created, or another caller waited for it */
    int exit_status; /* -1 after a signal */
    int signal;      /* 0: the process ended by itself */
    bool is_sent;    /* true if the signal came from outside, or if memory or the user's CPU time ran out; the work is
                        not at fault */
} hf_child_end;

/* Forks like fork(2), for a process with one thread. The child must leave with _exit(2), because exit(3) would write
 * the buffers of stdio a second time. Signals from the terminal reach both processes. */
pid_t hf_child_fork(void);

/* Starts the program command[0] with the words of `command`, which NULL ends, and the last word `text`. The program
 * inherits no memory, so no lock of this process can block it. It blocks the signals that a child of the server
 * ignores. Returns -1 if it cannot be started. */
#define HF_CHILD_WORDS 8 /* maximum number of words of a command; the rest is left out */
pid_t hf_child_spawn(const char *const *command, const char *text);

hf_child_end hf_child_wait(pid_t child);

/* Writes how a child ended into text[size]: "signal 11 (Segmentation fault)" or "exit status 99". After a signal from
 * outside, the text also says what the user can do. */
void hf_child_describe(hf_child_end end, char *text, size_t size);

/* Limits the CPU time of this process. SIGXCPU ends the process when it has used `seconds` more seconds, at
 * least 1. `seconds` = 0 removes the limit. A later call replaces the limit, and a lower limit set by the user
 * stays in force. */
void hf_child_limit_cpu(int seconds);

/* ---- The server ---- */

/* Start and end the server. hf_child_ask works between the two calls. Calls may be nested: the server then runs from
 * the first hf_child_server_begin to the last hf_child_server_end. If memory or processes run out, there is no server,
 * and this is not an error. The server keeps open every descriptor that is open when it starts, with the locks on it,
 * until the server ends. */
void hf_child_server_begin(void);
void hf_child_server_end(void);

/* Runs work(text) in a child of the server and waits for its end. The exit status is 0 when `work` returns. Any
 * thread may call this function; the server runs one child at a time. Returns false if there is no server or
 * `text` is too long for it. The child ignores SIGINT, SIGTERM, SIGHUP, SIGUSR1 and SIGQUIT, so that only the
 * waiting process reacts. */
typedef void hf_child_work(const char *text);
#define HF_CHILD_TEXT_SIZE 8192
bool hf_child_ask(hf_child_work *work, const char *text, hf_child_end *end);

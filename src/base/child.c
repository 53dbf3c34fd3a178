#define _GNU_SOURCE /* wait4, environ */
/* Contents: children - the server */
#include "base/child.h"

#include "base/file_io.h"

#include <pthread.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif

/* ---- children ---- */

pid_t hf_child_fork(void)
{
    pid_t parent = getpid();
    pid_t child = fork();
    if (child != 0) return child;
#ifdef __linux__
    prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
    if (getppid() != parent) _exit(1); /* the parent ended before prctl */
    return 0;
}

static const int of_parent[] = {SIGINT, SIGTERM, SIGHUP, SIGUSR1, SIGQUIT}; /* to which only the parent reacts */
enum { N_OF_PARENT = sizeof of_parent / sizeof *of_parent };

pid_t hf_child_spawn(const char *const *command, const char *text)
{
    const char *word[HF_CHILD_WORDS + 2] = {NULL};
    posix_spawnattr_t attributes;
    sigset_t blocked;
    pid_t child;
    int n = 0;
    for (; n < HF_CHILD_WORDS && command[n]; n++)
        word[n] = command[n];
    word[n] = text;
    sigemptyset(&blocked);
    for (int i = 0; i < N_OF_PARENT; i++)
        sigaddset(&blocked, of_parent[i]);
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setsigmask(&attributes, &blocked);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
    int failed = posix_spawn(&child, *word, NULL, &attributes, (char *const *)word, environ);
    posix_spawnattr_destroy(&attributes);
    return failed ? -1 : child;
}

/* Returns true for a signal that no fault of the program raises. SIGXCPU is a fault if the limit of hf_child_limit_cpu
 * raised it, and no fault if a lower limit of the user raised it. This process has the same limit of the user. */
static bool is_from_outside(int number, const struct rusage *used)
{
    static const int of_faults[] = {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGTRAP, SIGSYS};
    struct rlimit limit;
    for (size_t i = 0; i < sizeof of_faults / sizeof *of_faults; i++)
        if (number == of_faults[i]) return false;
    if (number != SIGXCPU) return true;
    double used_s = (double)(used->ru_utime.tv_sec + used->ru_stime.tv_sec) +
                    1e-6 * (double)(used->ru_utime.tv_usec + used->ru_stime.tv_usec);
    return getrlimit(RLIMIT_CPU, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY &&
           used_s > (double)limit.rlim_cur - 0.5; /* the kernel counts CPU time in clock ticks */
}

hf_child_end hf_child_wait(pid_t child)
{
    int status;
    struct rusage used;
    if (HF_UNINTERRUPTED(wait4(child, &status, 0, &used)) != child) return (hf_child_end){.is_known = false};
    if (!WIFSIGNALED(status)) return (hf_child_end){.is_known = true, .exit_status = WEXITSTATUS(status)};
    int number = WTERMSIG(status);
    return (hf_child_end){true, -1, number, is_from_outside(number, &used)};
}

void hf_child_describe(hf_child_end end, char *text, size_t size)
{
    const char *advice = !end.is_sent            ? ""
                         : end.signal == SIGKILL ? "; is there enough memory, and time (ulimit -t)?"
                         : end.signal == SIGXCPU ? "; raise the limit (ulimit -t)"
                                                 : "; try again";
    if (end.signal)
        snprintf(text, size, "signal %d (%s)%s", end.signal, strsignal(end.signal), advice);
    else
        snprintf(text, size, "exit status %d", end.exit_status);
}

void hf_child_limit_cpu(int seconds)
{
    struct rusage used;
    struct rlimit limit;
    if (getrusage(RUSAGE_SELF, &used) != 0 || getrlimit(RLIMIT_CPU, &limit) != 0) return;
    static rlim_t before; /* the limit set by the user */
    static bool is_known;
    if (!is_known) before = limit.rlim_cur;
    is_known = true;
    rlim_t until = (rlim_t)(used.ru_utime.tv_sec + used.ru_stime.tv_sec + 1 + seconds); /* 1: truncated fractions */
    limit.rlim_cur = seconds == 0 || until > before ? before : until;
    setrlimit(RLIMIT_CPU, &limit);
}

/* ---- the server ---- */

typedef struct {
    hf_child_work *work;
    char text[HF_CHILD_TEXT_SIZE]; /* a message carries only the used bytes */
} order;

static pthread_mutex_t server_lock = PTHREAD_MUTEX_INITIALIZER;
static int n_begun; /* server_lock protects this and the two variables below */
static pid_t server;
static int server_socket = -1;

/* Runs one order in a child and returns how the child ended. */
static hf_child_end obey(const order *o)
{
    pid_t child = hf_child_fork();
    if (child == 0) {
        o->work(o->text);
        _exit(0);
    }
    if (child > 0) return hf_child_wait(child);
    return (hf_child_end){.is_known = false};
}

/* Serves orders until the other end of the socket closes. The server process is a copy of a process that may have
 * threads. Outside `work` it therefore makes only calls that POSIX allows in such a copy. */
static void serve_orders(int by)
{
    static order o;
    for (int i = 0; i < N_OF_PARENT; i++)
        signal(of_parent[i], SIG_IGN);
    signal(SIGCHLD, SIG_DFL); /* where it is ignored, nobody learns how a child ended */
    for (;;) {
        ssize_t n = HF_UNINTERRUPTED(recv(by, &o, sizeof o, 0));
        if (n <= (ssize_t)offsetof(order, text)) _exit(0);
        hf_child_end end = obey(&o);
        if (send(by, &end, sizeof end, MSG_NOSIGNAL) != (ssize_t)sizeof end) _exit(0);
    }
}

static void end_server(void)
{
    if (server_socket < 0) return;
    close(server_socket);
    server_socket = -1;
    hf_child_wait(server);
}

void hf_child_server_begin(void)
{
    int both[2];
    pthread_mutex_lock(&server_lock);
    if (n_begun++ == 0 && socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, both) == 0) {
        server = hf_child_fork();
        if (server == 0) {
            close(both[0]);
            serve_orders(both[1]);
        }
        close(both[1]);
        if (server > 0)
            server_socket = both[0];
        else
            close(both[0]);
    }
    pthread_mutex_unlock(&server_lock);
}

void hf_child_server_end(void)
{
    pthread_mutex_lock(&server_lock);
    if (--n_begun == 0) end_server();
    pthread_mutex_unlock(&server_lock);
}

/* Sends an order and receives its answer. Repeats a call that a signal interrupted. Returns false if the
 * server has ended. */
static bool exchange(const order *o, size_t size, hf_child_end *end)
{
    return HF_UNINTERRUPTED(send(server_socket, o, size, MSG_NOSIGNAL)) == (ssize_t)size &&
           HF_UNINTERRUPTED(recv(server_socket, end, sizeof *end, 0)) == (ssize_t)sizeof *end;
}

bool hf_child_ask(hf_child_work *work, const char *text, hf_child_end *end)
{
    order o = {.work = work};
    size_t length = strlen(text);
    if (length >= sizeof o.text) return false;
    memcpy(o.text, text, length + 1);
    pthread_mutex_lock(&server_lock);
    bool is_done = server_socket >= 0 && exchange(&o, offsetof(order, text) + length + 1, end);
    if (!is_done) end_server();
    pthread_mutex_unlock(&server_lock);
    return is_done;
}

#include "base/child.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif

pid_t hf_child_fork(void)
{
    pid_t parent = getpid();
    pid_t child = fork();
    if (child != 0) return child;
#ifdef __linux__
    prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
    if (getppid() != parent) _exit(1); /* it ended meanwhile */
    return 0;
}

hf_child_end hf_child_wait(pid_t child)
{
    int status;
    pid_t ended;
    do
        ended = waitpid(child, &status, 0);
    while (ended < 0 && errno == EINTR);
    if (ended != child) return (hf_child_end){.is_known = false};
    if (WIFSIGNALED(status)) return (hf_child_end){true, -1, WTERMSIG(status)};
    return (hf_child_end){true, WEXITSTATUS(status), 0};
}

void hf_child_describe(hf_child_end end, char *text, size_t size)
{
    if (end.signal)
        snprintf(text, size, "signal %d (%s)", end.signal, strsignal(end.signal));
    else
        snprintf(text, size, "exit status %d", end.exit_status);
}

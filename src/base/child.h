/* child - work that may crash, done by a copy of this process: HDF5 answers some damaged files with a signal alone.
 *
 * Any thread may make the copy (fork) as long as the work needs no other thread, and no lock that another thread may
 * hold. A child ends when its parent ends; signals of the terminal reach both. */
#ifndef HIFDM_CHILD_H
#define HIFDM_CHILD_H

#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

typedef struct {
    bool is_known;   /* false: somebody else has waited for it */
    int exit_status; /* -1 after a signal */
    int signal;      /* 0: it ended by itself */
} hf_child_end;

/* As fork(2). The child leaves with _exit(2), or what is in buffers of stdio is written twice. */
pid_t hf_child_fork(void);

hf_child_end hf_child_wait(pid_t child);

/* "signal 11 (Segmentation fault)" or "exit status 99" */
void hf_child_describe(hf_child_end end, char *text, size_t size);

#endif

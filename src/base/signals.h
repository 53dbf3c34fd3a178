/* signals - being told to stop: the program's, because handlers are of the whole process. */
#ifndef HIFDM_SIGNALS_H
#define HIFDM_SIGNALS_H

#include <signal.h>

/* From now on the first SIGINT, SIGTERM, SIGHUP or SIGUSR1 sets the returned flag to its number, for work that looks at
 * it between steps; a second one does what it would have done without. A signal that was ignored stays ignored. */
const volatile sig_atomic_t *hf_signals_watch(void);

#endif

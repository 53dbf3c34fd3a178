/* signals - requests to stop. Only the program watches them, because handlers belong to the whole process. */
#ifndef HIFDM_SIGNALS_H
#define HIFDM_SIGNALS_H

#include <signal.h>

/* From now on the first SIGINT, SIGTERM, SIGHUP or SIGUSR1 sets the returned flag to its number; work reads the flag
 * between steps. A second signal has its default effect. A signal that was ignored stays ignored. */
const volatile sig_atomic_t *hf_signals_watch(void);

/* The same flag; it stays 0 in a program that does not watch. */
const volatile sig_atomic_t *hf_signals_request(void);

#endif

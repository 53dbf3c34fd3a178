/* signals - requests to stop. Only the program installs handlers, because they belong to the whole process. */
#pragma once

#include <signal.h>

/* Installs handlers and returns a flag. The first SIGINT, SIGTERM, SIGHUP or SIGUSR1 sets the flag to the number
 * of the signal; long work reads it between steps. A second signal has its default effect. A signal that was
 * ignored stays ignored. */
const volatile sig_atomic_t *hf_signals_watch(void);

/* Returns the same flag. It stays 0 in a program that never calls hf_signals_watch. */
const volatile sig_atomic_t *hf_signals_request(void);

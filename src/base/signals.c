#include "base/signals.h"

#include <stdatomic.h>
#include <stddef.h>

static volatile sig_atomic_t requested;
static atomic_flag is_second = ATOMIC_FLAG_INIT; /* atomic: two threads may each receive a signal at the same time */

static void request(int number)
{
    if (atomic_flag_test_and_set(&is_second)) {
        signal(number, SIG_DFL);
        raise(number);
    }
    requested = number;
}

const volatile sig_atomic_t *hf_signals_request(void)
{
    return &requested;
}

const volatile sig_atomic_t *hf_signals_watch(void)
{
    static const int watched[] = {SIGINT, SIGTERM, SIGHUP, SIGUSR1};
    for (size_t i = 0; i < sizeof watched / sizeof *watched; i++) {
        struct sigaction old, new = {.sa_handler = request, .sa_flags = SA_RESTART};
        sigemptyset(&new.sa_mask);
        if (sigaction(watched[i], NULL, &old) == 0 && old.sa_handler != SIG_IGN) sigaction(watched[i], &new, NULL);
    }
    return &requested;
}

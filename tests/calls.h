/* calls - makes system calls and HDF5 calls fail. The linker redirects the calls of the library and of the tests to
 * calls.c (TEST_WRAP in the Makefile). It cannot redirect calls inside shared libraries. Any thread may make the
 * calls. */
#pragma once

#include <stdbool.h>

/* Makes the n-th call of this name from now on fail with the error number `why` (1: the next call); with `for_ever` all
 * later calls fail, too. Calls of two names may fail at the same time. */
void fail_call_at(const char *name, long n, int why, bool for_ever);
bool end_call_failure(void); /* ends the failures; true: the n-th call of each name was reached */

/* Ends this process with status 9 before the n-th call from now that makes, changes, names or removes a file. */
void die_before_change(long n);

/* Calls act() once, before the next call of this name. */
void before_call(const char *name, void (*act)(void));

/* Disturbs the calls that may be interrupted or end early: open, read, write, ..., flock, fsync. One in three is
 * interrupted by a signal, and one in three transfers a single byte. */
void disturb_calls(bool on);

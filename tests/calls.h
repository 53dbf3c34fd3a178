/* calls - system calls and HDF5 calls that fail. The linker leads those of the library AND of the tests through calls.c
 * (TEST_WRAP in the Makefile); those inside shared libraries are out of reach. From any thread. */
#ifndef HIFDM_TESTS_CALLS_H
#define HIFDM_TESTS_CALLS_H

#include <stdbool.h>

/* The n-th call of this name from now on (1: the next) fails with the error number `why`; with `for_ever` all that
 * follow it do, too. Two kinds of calls may be made to fail at the same time. */
void fail_call_at(const char *name, long n, int why, bool for_ever);
bool end_call_failure(void); /* back to normal; true when the n-th of each kind was reached */

/* This process ends at once, with status 9, before the n-th call from now by which a file is made, changed, named or
 * removed. */
void die_before_change(long n);

/* Once, before the next call of this name, act() is called. */
void before_call(const char *name, void (*act)(void));

/* From now on, of the calls that may be interrupted or end early (open, read, write, ..., flock, fsync) one in three is
 * interrupted by a signal, and one in three transfers a single byte. */
void disturb_calls(bool on);

#endif

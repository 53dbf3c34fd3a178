/* clock - elapsed time for measuring and for pacing: never the time of day. */
#ifndef HIFDM_CLOCK_H
#define HIFDM_CLOCK_H

double hf_clock_s(void);            /* since an unspecified moment; never runs backwards */
double hf_clock_thread_cpu_s(void); /* processor time of the calling thread */

#endif

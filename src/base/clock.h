/* clock - elapsed time for measuring and for pacing. It is not the time of day. */
#pragma once

double hf_clock_s(void);            /* seconds since an unspecified moment; never decreases */
double hf_clock_thread_cpu_s(void); /* seconds of processor time of the calling thread */

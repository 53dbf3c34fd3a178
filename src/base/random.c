#include "base/random.h"

/* Definitions for calls that the compiler does not inline. */
extern inline uint64_t hf_random_mix(uint64_t z);
extern inline hf_random hf_random_stream(uint64_t seed, int generation, int individual);
extern inline uint64_t hf_random_next(hf_random *random);
extern inline double hf_random_uniform(hf_random *random);

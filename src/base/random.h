/* random - the generator of all pseudo-random numbers: SplitMix64 (Steele, Lea & Flood 2014). Results store the seed
 * instead of the random numbers, so the generated numbers must never change. */
#pragma once

#include <stdint.h>

#define HF_RANDOM_STEP 0x9e3779b97f4a7c15u /* 2^64 divided by the golden ratio, odd */

/* A stream of random numbers. Every state is a valid start. */
typedef struct {
    uint64_t state;
} hf_random;

/* Returns a mixed value in which every bit depends on every bit of z. It is the output function of the generator. It
 * also separates the starting states of streams. */
inline uint64_t hf_random_mix(uint64_t z)
{
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

inline uint64_t hf_random_next(hf_random *random)
{
    return hf_random_mix(random->state += HF_RANDOM_STEP);
}

/* Returns the stream of one individual of one generation. It depends neither on earlier draws nor on the thread. */
inline hf_random hf_random_stream(uint64_t seed, int generation, int individual)
{
    uint64_t index = (uint64_t)(uint32_t)generation << 32 | (uint32_t)individual;
    return (hf_random){hf_random_mix(hf_random_mix(seed + HF_RANDOM_STEP) ^ hf_random_mix(index + 2 * HF_RANDOM_STEP))};
}

/* Returns a uniformly distributed multiple of 2^-53 in [0, 1). */
inline double hf_random_uniform(hf_random *random)
{
    return (double)(hf_random_next(random) >> 11) * 0x1p-53;
}

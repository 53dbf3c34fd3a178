#include "base/lane.h"

#if defined __x86_64__
#define CPU_HAS(feature) (__builtin_cpu_supports(feature) != 0)
#else
#define CPU_HAS(feature) false
#endif

bool hf_lane_has_isa(hf_lane_isa isa)
{
    return isa == HF_LANE_PORTABLE || (isa == HF_LANE_AVX2 && CPU_HAS("avx2") && CPU_HAS("fma")) ||
           (isa == HF_LANE_AVX512 && CPU_HAS("avx512f"));
}

hf_lane_isa hf_lane_best_isa(void)
{
    if (hf_lane_has_isa(HF_LANE_AVX512)) return HF_LANE_AVX512;
    return hf_lane_has_isa(HF_LANE_AVX2) ? HF_LANE_AVX2 : HF_LANE_PORTABLE;
}

const char *hf_lane_isa_name(hf_lane_isa isa)
{
    static const char *const name[HF_LANE_N_ISA] = {"portable", "avx2", "avx512"};
    return name[isa];
}

#include "base/lane.h"

#if defined __x86_64__
#define CPU_HAS(feature) (__builtin_cpu_supports(feature) != 0)
#else
#define CPU_HAS(feature) false
#endif

bool hf_lane_has_isa(hf_lane_isa isa)
{
    switch (isa) {
    case HF_LANE_PORTABLE:
        return true;
    case HF_LANE_AVX2:
        return CPU_HAS("avx2") && CPU_HAS("fma");
    case HF_LANE_AVX512:
        return CPU_HAS("avx512f");
    }
    return false;
}

hf_lane_isa hf_lane_best_isa(void)
{
    if (hf_lane_has_isa(HF_LANE_AVX512)) return HF_LANE_AVX512;
    return hf_lane_has_isa(HF_LANE_AVX2) ? HF_LANE_AVX2 : HF_LANE_PORTABLE;
}

const char *hf_lane_isa_name(hf_lane_isa isa)
{
    switch (isa) {
    case HF_LANE_PORTABLE:
        return "portable";
    case HF_LANE_AVX2:
        return "avx2";
    case HF_LANE_AVX512:
        return "avx512";
    }
    return "unknown";
}

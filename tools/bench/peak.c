/* How near the lane factorisation comes to what one core can do: its operations per second over the measured peak of
 * independent fused multiply-adds in the same instruction set, one measured right after the other.
 *
 * Contents: peaks - operations of the factorisation - nets - the section */
#include "bench.h"

#include "search/swarm.h"

#include <stdio.h>
#include <string.h>

#define ENOUGH_S 0.004 /* of each peak */
#define ENOUGH_FACTOR_S 0.01
#define ROUNDS 9
#define PASSES 1000

/* ---- peaks: chains enough to hide the latency, in registers; a x + b with |a| < 1 stays an ordinary number ---- */

typedef double peak_kernel(double a, double b); /* returns something that depends on all of it */

#define EACH _Pragma("GCC unroll 16") for (int i = 0; i < CHAINS; i++)

/* PASSES operations in each of CHAINS vectors of `width`; `step` maps x[i] to its next value. Every loop over the
 * chains is unrolled, so that they live in registers; the empty asm keeps each operation as it stands. */
#define PEAK_KERNEL(name, attribute, vector, width, step)                                                              \
    attribute static double name(double a_of_all, double b_of_all)                                                     \
    {                                                                                                                  \
        vector x[CHAINS], a = a_of_all - (vector){0}, b = b_of_all - (vector){0}, sum = {0};                           \
        EACH x[i] = b + (double)i;                                                                                     \
        for (int k = 0; k < PASSES; k++)                                                                               \
            EACH                                                                                                       \
            {                                                                                                          \
                step;                                                                                                  \
                __asm__("" : "+x"(x[i]));                                                                              \
            }                                                                                                          \
        EACH sum += x[i];                                                                                              \
        return sum[0] + sum[(width)-1];                                                                                \
    }

enum { CHAINS = 12 }; /* of 16 registers, or 32; 2 units x latency 4 or 5 need 8 to 10 */

#if defined __x86_64__
#include <immintrin.h>
typedef double vec4 __attribute__((vector_size(32)));
typedef double vec8 __attribute__((vector_size(64)));
#define AVX2 __attribute__((target("avx2,fma")))
#define AVX512 __attribute__((target("avx512f")))
PEAK_KERNEL(fused_avx512, AVX512, vec8, 8, x[i] = _mm512_fmadd_pd(x[i], a, b))
PEAK_KERNEL(fused_avx2, AVX2, vec4, 4, x[i] = _mm256_fmadd_pd(x[i], a, b))
#endif

typedef struct {
    peak_kernel *fused; /* NULL: the instruction set has none */
    int width;
} peak;

static const peak peak_of_isa[HF_LANE_N_ISA] = {
    [HF_LANE_PORTABLE] = {NULL, 2},
#if defined __x86_64__
    [HF_LANE_AVX2] = {fused_avx2, 4},
    [HF_LANE_AVX512] = {fused_avx512, 8},
#endif
};

static volatile double sink;

static void run_peak(void *context)
{
    static volatile double a = 0.75, b = 0.5; /* unknown to the compiler */
    sink = ((peak_kernel *)context)(a, b);
}

static double flops_per_s(peak_kernel *kernel, int width)
{
    return 2.0 * PASSES * CHAINS * width / bench_time_s(run_peak, (void *)kernel, ENOUGH_S);
}

/* ---- operations of the factorisation ---- */

/* Operations in one lane, as swarm_kernel.c does them: tiles from the skyline of the block row on, in the part that
 * both block rows of a product have. A fused multiply-add counts two, a product, a root and a reciprocal one each. */
static double flops_done(const hf_swarm_plan *p)
{
    double n = 0;
    for (int i = 0; i < p->n_block; i++) {
        int first = p->first_column[i];
        for (int j = first / HF_SWARM_BLOCK; j < i; j++) {
            int column = j * HF_SWARM_BLOCK, from = p->first_column[j];
            if (from < first) from = first < column ? first : column;
            for (int c = 0; c < HF_SWARM_BLOCK; c++) /* each entry of a column: products with those before, scaled */
                n += HF_SWARM_BLOCK * (2.0 * (column + c - from) + 1);
        }
        for (int c = 0; c < HF_SWARM_BLOCK; c++) /* the lower half of the tile on the diagonal */
            n += (HF_SWARM_BLOCK - c) * (2.0 * (i * HF_SWARM_BLOCK + c - first) + 1) + 1;
    }
    return n;
}

/* Operations of a factorisation of the whole band with all its entries, by rows: those counted for dpbtrf. */
static double flops_of_band(const hf_model *m)
{
    double n = 0;
    for (int i = 0; i < m->n_free; i++) {
        int before = i < m->half_bandwidth ? i : m->half_bandwidth;
        for (int k = 0; k < before; k++)
            n += 2.0 * k + 1;
        n += 2.0 * before + 1;
    }
    return n;
}

/* ---- nets ---- */

static const char *const net_table[] = {"21x25 perimeter", "22x24 perimeter", "66x68 perimeter"};

typedef struct {
    bench_scene scene;
    hf_swarm_plan plan;
    hf_swarm_lanes lanes;
} net;

static void open_net(const char *name, hf_lane_isa isa, net *n)
{
    bench_scene_model(name, &n->scene);
    hf_workspace *w = &n->scene.workspace;
    const hf_model *m = &n->scene.model;
    if (hf_swarm_plan_create(m, isa, &n->plan) != HF_OK || hf_swarm_lanes_create(&n->plan, &n->lanes) != HF_OK)
        bench_fail(name, "out of memory");
    hf_form_prepare(m, w);
    memcpy(w->position_m, m->position_m, 3 * (size_t)m->n_node * sizeof(double));
    for (int lane = 0; lane < HF_LANES; lane++)
        hf_swarm_put(&n->plan, w, lane, &n->lanes);
    memcpy(n->lanes.law, w->law, (size_t)m->n_cable);
}

static void close_net(net *n)
{
    hf_arena_free(&n->lanes.arena);
    hf_arena_free_block(n->plan.block);
    bench_scene_free(&n->scene);
}

/* Seconds of the factorisation of eight matrices, each assembled anew, outside the clock. */
static double factor_s(net *n)
{
    double spent_s = 0;
    int count = 0;
    for (; spent_s < ENOUGH_FACTOR_S; count++) {
        n->plan.kernels->assemble(&n->plan, &n->lanes);
        double start_s = bench_clock_s();
        n->plan.kernels->factor(&n->plan, &n->lanes);
        spent_s += bench_clock_s() - start_s;
    }
    return spent_s / count;
}

/* ---- the section ---- */

static void one_round(net *n, hf_lane_isa isa)
{
    const char *name = n->scene.name, *set = hf_lane_isa_name(isa);
    const peak *p = &peak_of_isa[isa];
    int half_bandwidth = n->scene.model.half_bandwidth;
    double fused = p->fused ? flops_per_s(p->fused, p->width) : 0;
    double seconds = factor_s(n), done = HF_LANES * flops_done(&n->plan) / seconds;
    if (p->fused) fused = (fused + flops_per_s(p->fused, p->width)) / 2; /* before and after: the clock rate wanders */
    bench_emit("peak", name, set, half_bandwidth, "factor_us", 1e6 * seconds / HF_LANES);
    bench_emit("peak", name, set, half_bandwidth, "flops", flops_done(&n->plan));
    bench_emit("peak", name, set, half_bandwidth, "flops_of_band", flops_of_band(&n->scene.model));
    bench_emit("peak", name, set, half_bandwidth, "factor_GFs", 1e-9 * done);
    if (p->fused) bench_emit("peak", name, set, half_bandwidth, "fma_peak_GFs", 1e-9 * fused);
    if (p->fused) bench_emit("peak", name, set, half_bandwidth, "share_of_fma_peak", done / fused);
}

void bench_peak(const char *what, const char *folder)
{
    (void)what, (void)folder;
    for (size_t i = 0; i < sizeof net_table / sizeof *net_table; i++)
        for (int isa = 0; isa < HF_LANE_N_ISA; isa++) {
            net n;
            if (!hf_lane_has_isa((hf_lane_isa)isa)) continue;
            open_net(net_table[i], (hf_lane_isa)isa, &n);
            for (int round = 0; round < ROUNDS; round++)
                one_round(&n, (hf_lane_isa)isa);
            close_net(&n);
        }
}

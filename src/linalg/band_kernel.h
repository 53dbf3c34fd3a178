/* band_kernel - band Cholesky and what goes with it, compiled once for each instruction set; band.c chooses one at run
 * time. All give the same bits: products are fused with the sums that they go into (fma), rows are worked on in strips
 * of eight whatever the width of a vector is, and each entry has one accumulator that runs over the columns in rising
 * order. Where a processor has no fused multiply-add: the same bits, slowly (lane.h). */
#ifndef HIFDM_BAND_KERNEL_H
#define HIFDM_BAND_KERNEL_H

/* The Makefile compiles band_kernel.c with -DHF_ISA=avx512 and so on; the names end in it. */
#define HF_BAND_KERNELS(isa)                                                                                           \
    int hf_band_factor_##isa(int n, int half_bandwidth, double *band, int first, int end);                             \
    void hf_band_back_solve_##isa(int n, int half_bandwidth, int n_rhs, const double *factor, double *b, int ldb);     \
    void hf_band_gram_##isa(int first, int end, int n_column, const double *a, int lda, double *gram, int ldg);

/* What they do stands in band.h; hf_band_factor does columns `first`, a multiple of 4, to end - 1, after all before. */
HF_BAND_KERNELS(portable)
HF_BAND_KERNELS(avx2)
HF_BAND_KERNELS(avx512)

#endif

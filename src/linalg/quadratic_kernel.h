/* quadratic_kernel - the inner loops of quadratic programmes, compiled once for each instruction set. quadratic.c
 * chooses one at run time. All give the same bits as scalar loops: products are not fused with sums, and each entry is
 * accumulated in the same order. */
#ifndef HIFDM_QUADRATIC_KERNEL_H
#define HIFDM_QUADRATIC_KERNEL_H

/* The Makefile compiles quadratic_kernel.c with -DHF_ISA=avx512 and so on. The names end in the instruction set.
 *
 * invert: strip [n][HF_LANES] contains columns `first` and on of the unit matrix; the same columns of L^-1 replace
 * them. triangle [n][n] is L as a band whose columns begin with the diagonal. Rows before `first` are neither read nor
 * written.
 *
 * turn: works on columns of J [][ld], where ld is a multiple of HF_LANES. For i from last down to first, columns i and
 * i + 1 (u and v) become cosine[i] u + sine[i] v and cosine[i] v - sine[i] u.
 *
 * combine: computes sum [ld] = weight[first] column `first` + ... + weight[end - 1] column end - 1 of J, added
 * in this order. */
#define HF_QUADRATIC_KERNELS(isa)                                                                                      \
    void hf_quadratic_invert_##isa(int n, int first, const double *triangle, double *strip);                           \
    void hf_quadratic_turn_##isa(int ld, int first, int last, const double *cosine, const double *sine, double *J);    \
    void hf_quadratic_combine_##isa(int ld, int first, int end, const double *weight, const double *J, double *sum);

HF_QUADRATIC_KERNELS(portable)
HF_QUADRATIC_KERNELS(avx2)
HF_QUADRATIC_KERNELS(avx512)

#endif

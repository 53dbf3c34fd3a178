/* packed_band_kernel - triangular solves with eight right-hand sides, one in each SIMD lane, compiled once for each
 * instruction set. packed_band.c chooses one at run time. All give the same bits (base/lane.h). */
#ifndef HIFDM_PACKED_BAND_KERNEL_H
#define HIFDM_PACKED_BAND_KERNEL_H

struct hf_packed_band;

/* Solves in place. lanes [hf_packed_band_rows][HF_LANES]; the rows before and after the right-hand sides
 * must be zero. */
typedef void hf_packed_band_solve(const struct hf_packed_band *band, double *lanes);

hf_packed_band_solve hf_packed_band_solve_portable, hf_packed_band_solve_avx2, hf_packed_band_solve_avx512;

#endif

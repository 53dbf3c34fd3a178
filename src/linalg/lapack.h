/* lapack - LAPACK and its BLAS, loaded at run time when they are first needed.
 *
 * Programs that use this library do not link LAPACK. A command that factors nothing loads neither LAPACK nor its BLAS.
 * Any shared library with the routines below can be used. */
#pragma once

#include <hifdm/status.h>

/* The Fortran interface. The hidden lengths of one-character arguments are omitted, because the routines
 * never read them. */
#define HF_LAPACK_ROUTINES(X)                                                                                          \
    X(double, dlansb, const char *norm, const char *uplo, const int *n, const int *k, const double *ab,                \
      const int *ldab, double *work)                                                                                   \
    X(void, dlacn2, const int *n, double *v, double *x, int *isgn, double *est, int *kase, int *isave)                 \
    X(void, dgbtrf, const int *m, const int *n, const int *kl, const int *ku, double *ab, const int *ldab, int *ipiv,  \
      int *info)                                                                                                       \
    X(void, dgbtrs, const char *trans, const int *n, const int *kl, const int *ku, const int *nrhs, const double *ab,  \
      const int *ldab, const int *ipiv, double *b, const int *ldb, int *info)                                          \
    X(void, dgbcon, const char *norm, const int *n, const int *kl, const int *ku, const double *ab, const int *ldab,   \
      const int *ipiv, const double *anorm, double *rcond, double *work, int *iwork, int *info)                        \
    X(void, dpbtrf, const char *uplo, const int *n, const int *k, double *ab, const int *ldab, int *info)              \
    X(void, dpbtrs, const char *uplo, const int *n, const int *k, const int *nrhs, const double *ab, const int *ldab,  \
      double *b, const int *ldb, int *info)

typedef struct {
#define HF_LAPACK_MEMBER(type, name, ...) type (*name)(__VA_ARGS__);
    HF_LAPACK_ROUTINES(HF_LAPACK_MEMBER)
#undef HF_LAPACK_MEMBER
} hf_lapack_routines;

/* Loads LAPACK unless it is loaded. Any thread may call it. While LAPACK is loaded, OPENBLAS_NUM_THREADS and
 * OMP_NUM_THREADS are 1 in the environment, so no other thread may call getenv during that time. Returns HF_OK. Returns
 * HF_NO_LAPACK if no library is found, and HF_NO_MEMORY if a limit of the address space is too low. `messages` may be
 * NULL; otherwise it gets an error that says what to do. */
hf_status hf_lapack_load(hf_messages *messages);

/* hf_lapack returns the routines; hf_lapack_load must have returned HF_OK. Enclose each call of a routine in
 * hf_lapack_begin and hf_lapack_end. hf_lapack_end gets the value that hf_lapack_begin returned. In between, LAPACK
 * uses one thread. One caller at a time passes hf_lapack_begin if the address space is limited, or if OpenBLAS is a
 * sequential build, which may not be thread-safe. */
const hf_lapack_routines *hf_lapack(void);
int hf_lapack_begin(void);
void hf_lapack_end(int n_thread);

/* Returns another routine of the library by its name, such as "dgetrf_", or NULL. It is used by
 * tests and benchmarks. */
void (*hf_lapack_find(const char *name))(void);

/* Returns the path of the loaded library, or "not loaded". For OpenBLAS the text also contains its configuration and
 * the kernel that it chose. Results store this text as provenance. */
const char *hf_lapack_library(void);

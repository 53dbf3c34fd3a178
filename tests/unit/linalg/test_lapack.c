/* LAPACK as it is loaded: once, by any thread, with the environment and the threads of OpenMP as before, and never
 * without end where the address space is limited. */
#include "support.h"

#include "linalg/band.h"
#include "linalg/lapack.h"

#include <malloc.h>
#include <omp.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

/* The sanitizers map terabytes. */
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define HAS_LIMIT 0
#else
#define HAS_LIMIT 1
#endif

enum { N_THREAD = 8, N = 400, K = 100, LDAB = 3 * K + 1 };

/* Factors a matrix that is large enough for a BLAS to use threads and buffers of its own. */
static void *factor(void *unused)
{
    (void)unused;
    int *pivot = malloc(N * sizeof *pivot);
    double *general = calloc((size_t)N * LDAB, sizeof *general), *b = calloc(N, sizeof *b);
    bool is_right = pivot && general && b;
    for (int j = 0; j < N && is_right; j++)
        for (int i = j > K ? j - K : 0; i <= j + K && i < N; i++)
            general[2 * K + i - j + j * LDAB] = i == j ? 4 * K : 1;
    for (int i = 0; i < N && is_right; i++)
        b[i] = 1;
    is_right = is_right && hf_band_factor_general(N, K, general, pivot) == 0;
    if (is_right) hf_band_back_solve_general(N, K, 1, general, pivot, b, N);
    is_right = is_right && b[0] > 0 && b[0] < 1;
    free(pivot);
    free(general);
    free(b);
    static char yes;
    return is_right ? &yes : NULL;
}

static void *factor_often(void *unused)
{
    void *is_right = factor(unused);
    for (int i = 1; i < 30 && is_right; i++)
        is_right = factor(unused);
    return is_right;
}

static void in_threads(void *(*work)(void *))
{
    pthread_t thread[N_THREAD];
    for (int i = 0; i < N_THREAD; i++)
        ck_assert_int_eq(pthread_create(&thread[i], NULL, work, NULL), 0);
    for (int i = 0; i < N_THREAD; i++) {
        void *answer;
        ck_assert_int_eq(pthread_join(thread[i], &answer), 0);
        ck_assert_ptr_nonnull(answer);
    }
}

static void *load(void *unused)
{
    (void)unused;
    static char yes;
    return hf_lapack_load(NULL) == HF_OK && hf_lapack()->dpbtrs ? &yes : NULL;
}

START_TEST(name_is_that_of_the_loaded_file)
{
    ck_assert_str_eq(hf_lapack_library(), "not loaded");
    ck_assert(!hf_lapack_find("dgbtrf_"));
    ck_assert_int_eq(hf_lapack_load(NULL), HF_OK);
    char path[4096];
    snprintf(path, sizeof path, "%.*s", (int)strcspn(hf_lapack_library(), ";"), hf_lapack_library());
    ck_assert_msg(path[0] == '/' && access(path, R_OK) == 0, "no file %s", path);
    bool is_openblas = hf_lapack_find("openblas_get_config") != NULL;
    ck_assert_int_eq(strstr(hf_lapack_library(), "; OpenBLAS ") != NULL, is_openblas);
    ck_assert(!hf_lapack_find("no_such_routine_"));
}
END_TEST

START_TEST(environment_and_threads_stay)
{
    setenv("OPENBLAS_NUM_THREADS", "3", 1);
    unsetenv("OMP_NUM_THREADS");
    omp_set_num_threads(5);
    ck_assert_int_eq(hf_lapack_load(NULL), HF_OK);
    ck_assert_str_eq(getenv("OPENBLAS_NUM_THREADS"), "3");
    ck_assert_ptr_null(getenv("OMP_NUM_THREADS"));
    ck_assert_ptr_nonnull(factor(NULL));
    ck_assert_int_eq(omp_get_max_threads(), 5);
    int n_thread = 0;
#pragma omp parallel num_threads(2)
#pragma omp atomic
    n_thread += factor(NULL) != NULL;
    ck_assert_int_eq(n_thread, 2);
    ck_assert_int_eq(omp_get_max_threads(), 5);
}
END_TEST

/* Threads that a BLAS begins stay; those of the OpenMP library are of the test. */
START_TEST(lapack_has_no_threads_of_its_own)
{
    char text[16384] = "";
    ck_assert_int_eq(hf_lapack_load(NULL), HF_OK);
    ck_assert_ptr_nonnull(factor(NULL));
    FILE *file = fopen("/proc/self/status", "r");
    ck_assert_ptr_nonnull(file);
    size_t n = fread(text, 1, sizeof text - 1, file);
    fclose(file);
    text[n] = '\0';
    ck_assert_ptr_nonnull(strstr(text, "Threads:\t1\n"));
}
END_TEST

START_TEST(threads_load_it_at_once)
{
    in_threads(load);
    in_threads(factor);
}
END_TEST

/* Of what is mapped now, and so many MB more. */
static void limit_address_space(size_t more_MB)
{
    long pages = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    ck_assert(file && fscanf(file, "%ld", &pages) == 1);
    fclose(file);
    rlim_t bytes = (rlim_t)pages * (rlim_t)sysconf(_SC_PAGESIZE) + ((rlim_t)more_MB << 20);
    ck_assert_int_eq(setrlimit(RLIMIT_AS, &(struct rlimit){bytes, RLIM_INFINITY}), 0);
}

/* Refused, with words, and loaded when there is room. */
START_TEST(too_little_address_space)
{
    hf_messages messages = {0};
    if (!HAS_LIMIT) return;
    limit_address_space((size_t)_i);
    ck_assert_int_eq(hf_lapack_load(&messages), HF_NO_MEMORY);
    ck_assert_msg(strstr(messages.text, "LAPACK needs 320 MB of address space") && strstr(messages.text, "ulimit -v"),
                  "%s", messages.text);
    ck_assert_str_eq(hf_lapack_library(), "not loaded");
    hf_messages_free(&messages);
    limit_address_space(2000);
    ck_assert_int_eq(hf_lapack_load(&messages), HF_OK);
}
END_TEST

/* Room for one buffer of OpenBLAS, which eight threads ask for. A second one would be asked for without end. */
START_TEST(one_buffer_for_all_threads)
{
    if (!HAS_LIMIT) return;
    limit_address_space(330);
    ck_assert_int_eq(hf_lapack_load(NULL), HF_OK);
    mallopt(M_ARENA_MAX, 1);  /* or each thread may take 128 MB for a heap of its own */
    limit_address_space(110); /* for stacks of 8 MB */
    in_threads(factor_often);
}
END_TEST

Suite *suite_unit_lapack(void)
{
    Suite *suite = suite_create("unit/lapack");
    TCase *tests = tcase_create("lapack");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, name_is_that_of_the_loaded_file);
    tcase_add_test(tests, environment_and_threads_stay);
    tcase_add_test(tests, lapack_has_no_threads_of_its_own);
    tcase_add_test(tests, threads_load_it_at_once);
    for (int mb = 10; mb < 320; mb += 60)
        tcase_add_loop_test(tests, too_little_address_space, mb, mb + 1);
    tcase_add_test(tests, one_buffer_for_all_threads);
    return suite;
}

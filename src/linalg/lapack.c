#define _GNU_SOURCE /* dladdr, MAP_ANONYMOUS, RTLD_DEFAULT */
/* Contents: the library - address space - loading - calls - name of the library */
#include "linalg/lapack.h"

#include <assert.h>
#include <dlfcn.h>
#include <limits.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>

/* OpenBLAS maps a buffer of 128 MB for each thread that calls it at the same time. It does so as late as in a call, and
 * repeats a refused request without end. Measured with Debian's OpenBLAS 0.3.21: 47 MB for the library, one buffer when
 * its OpenMP build is loaded, and one buffer in the first call of each build. */
#define ROOM_MB 320

/* ---- the library ---- */

static const char *const candidate[] = {HF_LAPACK};
enum { N_CANDIDATE = sizeof candidate / sizeof *candidate };

static pthread_mutex_t loading = PTHREAD_MUTEX_INITIALIZER, turn = PTHREAD_MUTEX_INITIALIZER;
static atomic_bool is_loaded;
/* These variables are written before is_loaded is set, and never again. */
static hf_lapack_routines routines;
static void *library;
static bool takes_turns;
static char name_of_library[PATH_MAX + 256];

/* Functions of OpenBLAS; NULL for another library. openblas_get_parallel returns BY_OPENMP for a build that uses the
 * threads of the OpenMP library. It returns SEQUENTIAL for a build without threads. Only some of those builds protect
 * their buffers when several threads call them. */
enum { SEQUENTIAL = 0, BY_OPENMP = 2 };
static struct {
    void (*set_num_threads)(int n);
    int (*get_parallel)(void);
    char *(*get_config)(void);
    char *(*get_corename)(void);
} openblas;
static struct {
    int (*get_max_threads)(void);
    void (*set_num_threads)(int n);
} openmp;

/* Looks up a symbol and returns whether it exists. memcpy converts the object pointer to a function pointer,
 * as POSIX requires. */
static bool find_in(void *where, const char *name, void *function)
{
    void *symbol = dlsym(where, name);
    memcpy(function, &symbol, sizeof symbol);
    return symbol != NULL;
}

static bool find_routines(void *where, hf_lapack_routines *found)
{
#define FIND(type, name, ...) find_in(where, #name "_", &found->name) &&
    return HF_LAPACK_ROUTINES(FIND) true;
#undef FIND
}

/* ---- address space ---- */

/* Returns true if the address space is limited. With vm.overcommit_memory=2 the system promises no more memory
 * than it has. */
static bool is_limited(void)
{
    FILE *file = fopen("/proc/sys/vm/overcommit_memory", "r");
    int policy = file ? fgetc(file) : '0';
    struct rlimit space = {.rlim_cur = RLIM_INFINITY}, data = space;
    if (file) fclose(file);
    getrlimit(RLIMIT_AS, &space);
    getrlimit(RLIMIT_DATA, &data);
    return policy == '2' || space.rlim_cur != RLIM_INFINITY || data.rlim_cur != RLIM_INFINITY;
}

static bool has_room(void)
{
    size_t bytes = (size_t)ROOM_MB << 20;
    void *room = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (room == MAP_FAILED) return false;
    munmap(room, bytes);
    return true;
}

/* Solves a small system once. OpenBLAS then maps the buffer that all later calls use in turn. */
static void warm_up(void)
{
    enum { N = 4, K = 1, LDAB = 3 * K + 1 };
    int n = N, k = K, ldab = LDAB, one = 1, pivot[N], info;
    double band[N * LDAB] = {0}, b[N] = {0};
    for (int i = 0; i < N; i++)
        band[2 * K + i * LDAB] = 1;
    int kept = hf_lapack_begin();
    routines.dgbtrf(&n, &n, &k, &k, band, &ldab, pivot, &info);
    routines.dgbtrs("N", &n, &k, &k, &one, band, &ldab, pivot, b, &n, &info);
    hf_lapack_end(kept);
}

/* ---- loading ---- */

/* Variables that OpenBLAS reads while it is loaded. They belong to the user and get their values back afterwards. */
static const char *const setting[] = {"OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"};
enum { N_SETTING = sizeof setting / sizeof *setting };

static void open_library(char *reasons, size_t size)
{
    char *old[N_SETTING];
    bool is_set[N_SETTING];
    size_t n = 0;
    for (int i = 0; i < N_SETTING; i++) {
        const char *value = getenv(setting[i]);
        old[i] = value ? strdup(value) : NULL;
        if (!value || old[i]) setenv(setting[i], "1", 1); /* if strdup fails, the user's value stays */
        is_set[i] = !value || old[i];
    }
    for (int i = 0; i < N_CANDIDATE && !library; i++) {
        library = dlopen(candidate[i], RTLD_NOW | RTLD_LOCAL);
        const char *reason = library ? NULL : dlerror();
        if (library && !find_routines(library, &routines)) {
            dlclose(library);
            library = NULL;
            reason = NULL;
        }
        if (!library && n < size)
            n += (size_t)snprintf(reasons + n, size - n, "%s%s%s", n ? "; " : "", reason ? reason : candidate[i],
                                  reason ? "" : " has not all routines that are needed");
    }
    for (int i = 0; i < N_SETTING; i++) {
        if (old[i])
            setenv(setting[i], old[i], 1);
        else if (is_set[i])
            unsetenv(setting[i]);
        free(old[i]);
    }
}

static void describe(void)
{
    Dl_info info;
    void *symbol;
    char path[PATH_MAX];
    memcpy(&symbol, &routines.dgbtrf, sizeof symbol);
    const char *file = dladdr(symbol, &info) && info.dli_fname ? info.dli_fname : "unknown file";
    if (realpath(file, path)) file = path;
    if (openblas.get_config)
        snprintf(name_of_library, sizeof name_of_library, "%s; %s; core %s", file, openblas.get_config(),
                 openblas.get_corename ? openblas.get_corename() : "unknown");
    else
        snprintf(name_of_library, sizeof name_of_library, "%s", file);
}

static hf_status load(hf_messages *messages)
{
    char reasons[1024];
    takes_turns = is_limited();
    if (takes_turns && !has_room())
        return hf_error(messages, HF_NO_MEMORY,
                        "LAPACK needs %d MB of address space, but the limit of this process allows less. Raise the "
                        "limit (ulimit -v, ulimit -d)",
                        ROOM_MB);
    /* an OpenMP library of this process that reads the environment late must read it before it is changed */
    if (find_in(RTLD_DEFAULT, "omp_get_max_threads", &openmp.get_max_threads)) openmp.get_max_threads();
    open_library(reasons, sizeof reasons);
    if (!library)
        return hf_error(messages, HF_NO_LAPACK, "hifdm cannot load LAPACK: %s. Install it (Debian: liblapack3)",
                        reasons);
    find_in(library, "openblas_set_num_threads", &openblas.set_num_threads);
    find_in(library, "openblas_get_config", &openblas.get_config);
    find_in(library, "openblas_get_corename", &openblas.get_corename);
    int kind = find_in(library, "openblas_get_parallel", &openblas.get_parallel) ? openblas.get_parallel() : -1;
    takes_turns |= kind == SEQUENTIAL;
    bool by_openmp = kind == BY_OPENMP && find_in(library, "omp_get_max_threads", &openmp.get_max_threads) &&
                     find_in(library, "omp_set_num_threads", &openmp.set_num_threads);
    if (!by_openmp) openmp.set_num_threads = NULL;
    if (!by_openmp && openblas.set_num_threads) openblas.set_num_threads(1);
    if (takes_turns) warm_up();
    describe();
    return HF_OK;
}

hf_status hf_lapack_load(hf_messages *messages)
{
    hf_messages unread = {0};
    if (is_loaded) return HF_OK;
    pthread_mutex_lock(&loading);
    hf_status status = is_loaded ? HF_OK : load(messages ? messages : &unread);
    if (status == HF_OK) is_loaded = true;
    pthread_mutex_unlock(&loading);
    hf_messages_free(&unread);
    return status;
}

/* ---- calls ---- */

const hf_lapack_routines *hf_lapack(void)
{
    assert(routines.dlansb);
    return &routines;
}

int hf_lapack_begin(void)
{
    int n_thread = 0;
    if (takes_turns) pthread_mutex_lock(&turn);
    if (openmp.set_num_threads) {
        n_thread = openmp.get_max_threads();
        openmp.set_num_threads(1);
    }
    return n_thread;
}

void hf_lapack_end(int n_thread)
{
    if (n_thread) openmp.set_num_threads(n_thread);
    if (takes_turns) pthread_mutex_unlock(&turn);
}

void (*hf_lapack_find(const char *name))(void)
{
    void (*routine)(void) = NULL;
    if (library) find_in(library, name, &routine);
    return routine;
}

/* ---- name of the library ---- */

const char *hf_lapack_library(void)
{
    return is_loaded ? name_of_library : "not loaded";
}

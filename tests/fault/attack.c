/* Makes one call of the program under test fail, once: attack.py compiles this file and loads it by LD_PRELOAD.
 * ATTACK="CALL N ERRNO" names the call: in all processes and threads together, the N-th call after main has begun fails
 * with this error number. ATTACK_COUNTS names a file for what `shared` holds.
 *
 * A filter of the kernel (seccomp) stops the calls of the system and hands them to a handler here. So those that the
 * C library makes for itself fail, too: in fopen, in fclose, in dlopen. Memory, threads and processes are functions of
 * the C library. The handler is for x86-64. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <execinfo.h>
#include <fcntl.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <pthread.h>
#include <signal.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <ucontext.h>
#include <unistd.h>

enum { N_NUMBER = 4, N_FRAME = 12 };

/* attack.py reads the names of this table. Numbers of 0 are none: the real number 0 is that of read, in the first place
 * of its row. */
static const struct {
    const char *name;
    int number[N_NUMBER];
} calls[] = {
    {"open", {SYS_openat, SYS_open}},
    {"read", {SYS_read}},
    {"pread", {SYS_pread64}},
    {"write", {SYS_write, SYS_writev}},
    {"pwrite", {SYS_pwrite64}},
    {"fsync", {SYS_fsync}},
    {"fdatasync", {SYS_fdatasync}},
    {"rename", {SYS_rename, SYS_renameat, SYS_renameat2}},
    {"link", {SYS_link, SYS_linkat}},
    {"unlink", {SYS_unlink, SYS_unlinkat, SYS_rmdir}},
    {"ftruncate", {SYS_ftruncate}},
    {"stat", {SYS_newfstatat, SYS_stat, SYS_lstat, SYS_fstat}},
    {"access", {SYS_access, SYS_faccessat}},
    {"close", {SYS_close}},
    {"fcntl", {SYS_fcntl}},
    {"flock", {SYS_flock}},
    {"mmap", {SYS_mmap}},
    {"readlink", {SYS_readlink, SYS_readlinkat}},
    {"getdents", {SYS_getdents64}},
    {"mkdir", {SYS_mkdir, SYS_mkdirat}},
    {"getrandom", {SYS_getrandom}},
    {"socketpair", {SYS_socketpair}},
    {"sendto", {SYS_sendto}},
    {"recvfrom", {SYS_recvfrom}},
    {"wait4", {SYS_wait4}},
    {"malloc", {-1}},
    {"calloc", {-1}},
    {"realloc", {-1}},
    {"aligned_alloc", {-1}},
    {"pthread_create", {-1}},
    {"fork", {-1}},
};
enum { N_CALL = sizeof calls / sizeof *calls, MALLOC = N_CALL - 6, CALLOC, REALLOC, ALIGNED, THREAD, FORK };

/* In the file, so that all processes of the program share it. */
static struct shared {
    long count[N_CALL]; /* how often each call was made */
    long has_failed;
    char by[64]; /* the library that asked for memory and got none */
} none, *shared = &none;
static int wanted = -1, is_begun, error_number;
static long wanted_at;

static int strikes(int call)
{
    if (!is_begun) return 0;
    long n = __atomic_add_fetch(&shared->count[call], 1, __ATOMIC_SEQ_CST);
    if (call != wanted || n != wanted_at) return 0;
    shared->has_failed = 1;
    return 1;
}

/* ---- calls of the system ---- */

long attack_call(long number, long a, long b, long c, long d, long e, long f);
extern const char attack_after[];
__asm__(".text\n.globl attack_call\nattack_call:\n"
        "mov %rdi, %rax\nmov %rsi, %rdi\nmov %rdx, %rsi\nmov %rcx, %rdx\nmov %r8, %r10\nmov %r9, %r8\n"
        "mov 8(%rsp), %r9\nsyscall\n.globl attack_after\nattack_after:\nret\n");

static int call_of(long number)
{
    for (int i = 0; i < N_CALL; i++)
        for (int k = 0; k < N_NUMBER && (k == 0 || calls[i].number[k]); k++)
            if (calls[i].number[k] == number) return i;
    return -1;
}

static void handle(int signal_number, siginfo_t *info, void *context)
{
    greg_t *r = ((ucontext_t *)context)->uc_mcontext.gregs;
    long number = info->si_syscall, result = 0;
    (void)signal_number;
    /* words on standard error are what the test reads */
    int is_word = (number == SYS_write || number == SYS_writev) && r[REG_RDI] == STDERR_FILENO;
    int fails = !is_word && strikes(call_of(number));
    if (!fails || number == SYS_close) /* a close that fails has closed the file, as on Linux */
        result = attack_call(number, r[REG_RDI], r[REG_RSI], r[REG_RDX], r[REG_R10], r[REG_R8], r[REG_R9]);
    r[REG_RAX] = fails ? -error_number : result;
}

static void filter_calls(void)
{
    enum { N_HEAD = 5 };
    struct sock_filter code[N_HEAD + N_CALL * N_NUMBER + 2];
    int n = N_HEAD, first = n;
    uint64_t own = (uint64_t)(uintptr_t)attack_after;
    for (int i = 0; i < N_CALL; i++)
        for (int k = 0; k < N_NUMBER && calls[i].number[k] >= 0 && (k == 0 || calls[i].number[k]); k++)
            code[n++] = (struct sock_filter)BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, (uint32_t)calls[i].number[k], 0, 0);
    for (int i = first; i < n; i++)
        code[i].jt = (uint8_t)(n - i); /* to the trap, the last line */
    code[n++] = (struct sock_filter)BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
    code[n++] = (struct sock_filter)BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRAP);
    /* the handler's own calls pass */
    code[0] =
        (struct sock_filter)BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, instruction_pointer));
    code[1] = (struct sock_filter)BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, (uint32_t)own, 0, 2);
    code[2] =
        (struct sock_filter)BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, instruction_pointer) + 4);
    code[3] = (struct sock_filter)BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, (uint32_t)(own >> 32), (uint8_t)(n - 2 - 4), 0);
    code[4] = (struct sock_filter)BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, nr));
    struct sock_fprog program = {.len = (unsigned short)n, .filter = code};
    struct sigaction action = {.sa_sigaction = handle, .sa_flags = SA_SIGINFO | SA_NODEFER | SA_RESTART};
    if (sigaction(SIGSYS, &action, NULL) != 0 || prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 ||
        prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) != 0)
        _exit(99);
}

/* ---- memory, threads, processes ---- */

extern void *__libc_malloc(size_t n), *__libc_calloc(size_t n, size_t size), *__libc_realloc(void *p, size_t n),
    *__libc_memalign(size_t to, size_t n);

/* The library is that of the first caller outside of this file and of the C library, which asks for others. */
static void *no_memory(void)
{
    void *frame[N_FRAME];
    Dl_info info;
    int n = backtrace(frame, N_FRAME);
    for (int i = 2; i < n && !*shared->by; i++) {
        const char *name = dladdr(frame[i], &info) && info.dli_fname ? info.dli_fname : "", *slash = strrchr(name, '/');
        if (!strstr(name, "/libc.so")) snprintf(shared->by, sizeof shared->by, "%s", slash ? slash + 1 : name);
    }
    errno = ENOMEM;
    return NULL;
}

#define MEMORY(call, name, parameters, real)                                                                           \
    void *name parameters                                                                                              \
    {                                                                                                                  \
        return strikes(call) ? no_memory() : real;                                                                     \
    }
MEMORY(MALLOC, malloc, (size_t n), __libc_malloc(n))
MEMORY(CALLOC, calloc, (size_t n, size_t size), __libc_calloc(n, size))
MEMORY(REALLOC, realloc, (void *p, size_t n), __libc_realloc(p, n))
MEMORY(ALIGNED, aligned_alloc, (size_t to, size_t n), __libc_memalign(to, n))

int pthread_create(pthread_t *thread, const pthread_attr_t *how, void *(*begin)(void *), void *context)
{
    int (*real)(pthread_t *, const pthread_attr_t *, void *(*)(void *), void *) = NULL;
    *(void **)&real = dlsym(RTLD_NEXT, "pthread_create");
    return strikes(THREAD) ? error_number : real(thread, how, begin, context);
}

pid_t fork(void)
{
    pid_t (*real)(void) = NULL;
    *(void **)&real = dlsym(RTLD_NEXT, "fork");
    if (!strikes(FORK)) return real();
    errno = error_number;
    return -1;
}

/* ---- the begin ---- */

static int (*program_main)(int, char **, char **);

static int begin(int argc, char **argv, char **environment)
{
    char name[32] = "";
    const char *how = getenv("ATTACK"), *path = getenv("ATTACK_COUNTS");
    int file = path ? open(path, O_RDWR) : -1;
    if (!how || sscanf(how, "%31s %ld %d", name, &wanted_at, &error_number) < 3 || file < 0) _exit(98);
    shared = mmap(NULL, sizeof none, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    if (shared == MAP_FAILED) _exit(97);
    close(file);
    for (int i = 0; i < N_CALL; i++)
        if (!strcmp(calls[i].name, name)) wanted = i;
    backtrace(&(void *){NULL}, 1); /* the first time it asks for memory itself */
    filter_calls();
    is_begun = 1;
    return program_main(argc, argv, environment);
}

int __libc_start_main(int (*main)(int, char **, char **), int argc, char **argv, void (*first)(void),
                      void (*last)(void), void (*of_loader)(void), void *stack_end)
{
    int (*real)(int (*)(int, char **, char **), int, char **, void (*)(void), void (*)(void), void (*)(void), void *) =
        NULL;
    *(void **)&real = dlsym(RTLD_NEXT, "__libc_start_main");
    program_main = main;
    return real(begin, argc, argv, first, last, of_loader, stack_end);
}

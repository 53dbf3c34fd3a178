/* Makes OpenMP threads sleep while they wait: sets two environment variables and starts the program again.
 * <hifdm/batch.h> gives the reasons. */
#include <hifdm/batch.h>

#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

void hf_batch_wait_quietly(char *const *argv)
{
    char path[PATH_MAX];
    if (getenv("OMP_WAIT_POLICY") || getenv("GOMP_SPINCOUNT")) return;
    ssize_t n = readlink("/proc/self/exe", path, sizeof path - 1);
    if (n <= 0 || n == sizeof path - 1) return; /* the path is unknown, or may be truncated */
    path[n] = '\0';
    /* The dynamic linker was started with this program as its argument, so the path is not that of the program. */
    if (strstr(path, "/ld-") || strstr(path, "/ld.so")) return;
    if (setenv("GOMP_SPINCOUNT", "2000", 1) != 0) return;
    /* GOMP_SPINCOUNT is read by libgomp, OMP_WAIT_POLICY by other OpenMP libraries. */
    if (setenv("OMP_WAIT_POLICY", "passive", 1) == 0) execv(path, argv);
}

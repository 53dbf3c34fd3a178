#include "store/provenance.h"

#include "linalg/lapack.h"
#include "store/layout.h"
#include <hifdm/store.h>

#include <gsl/gsl_version.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

#ifndef HF_VERSION /* the Makefile defines the four macros below */
#define HF_VERSION "unknown"
#endif
#ifndef HF_GIT_DESCRIBE
#define HF_GIT_DESCRIBE "unknown"
#endif
#ifndef HF_COMPILER
#define HF_COMPILER "unknown"
#endif
#ifndef HF_BUILD_FLAGS
#define HF_BUILD_FLAGS "unknown"
#endif

#define ARGUMENTS_MAX 4000 /* maximum number of stored arguments; an attribute holds 64 KiB */

const char *hf_store_version(void)
{
    return HF_VERSION " (" HF_GIT_DESCRIBE ")";
}

void hf_provenance_put_time(hf_hdf5 *io, const char *attribute)
{
    char text[32] = "";
    time_t now = time(NULL);
    struct tm utc;
    if (gmtime_r(&now, &utc)) strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
    hf_hdf5_put_chars(io, io->file, "/", attribute, text);
}

void hf_provenance_put_job(hf_hdf5 *io)
{
    static const char *const table[][2] = {{"slurm_job_id", "SLURM_JOB_ID"},
                                           {"slurm_array_job_id", "SLURM_ARRAY_JOB_ID"},
                                           {"slurm_array_task_id", "SLURM_ARRAY_TASK_ID"},
                                           {"slurm_restart_count", "SLURM_RESTART_COUNT"}};
    for (int i = 0; i < HF_HDF5_COUNT(table); i++) {
        const char *value = getenv(table[i][1]);
        if (value) hf_hdf5_put_chars(io, io->file, "/", table[i][0], value);
    }
}

void hf_provenance_put(hf_hdf5 *io, int argc, char *const *argv)
{
    char host[256] = "", hdf5[32];
    unsigned major = 0, minor = 0, release = 0;
    if (gethostname(host, sizeof host - 1) != 0) host[0] = '\0';
    H5get_libversion(&major, &minor, &release);
    snprintf(hdf5, sizeof hdf5, "%u.%u.%u", major, minor, release);
    const char *const table[][2] = {{"version", HF_VERSION},
                                    {"git_describe", HF_GIT_DESCRIBE},
                                    {"compiler", HF_COMPILER},
                                    {"build_flags", HF_BUILD_FLAGS},
                                    {"hdf5_version", hdf5},
                                    {"gsl_version", gsl_version},
                                    {"lapack", hf_lapack_library()},
                                    {"rng", "splitmix64 keyed by (seed, generation, individual)"},
                                    {"host", host}};
    for (int i = 0; i < HF_HDF5_COUNT(table); i++)
        hf_hdf5_put_chars(io, io->file, "/", table[i][0], table[i][1]);
    hf_hdf5_put_chars(io, io->file, "/", "program", HF_PROGRAM);
    hf_hdf5_put(io, io->file, "/", "format_version", HF_KIND_INT, 0, &(int){HF_FORMAT_VERSION});
    if (argc > ARGUMENTS_MAX) argc = ARGUMENTS_MAX;
    if (argc > 0) hf_hdf5_put(io, io->file, "/", "argv", HF_KIND_TEXT, (hsize_t)argc, argv);
    hf_provenance_put_job(io);
    hf_provenance_put_time(io, "started_utc");
}

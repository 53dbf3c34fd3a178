/* The lock that lets one thread at a time use HDF5. */
#include "store/hdf5.h"

#include <pthread.h>

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

static bool is_quiet; /* read and set under the lock */

static void silence(void)
{
    if (is_quiet) H5Eset_auto2(H5E_DEFAULT, NULL, NULL); /* HDF5 has one error stack per thread */
}

void hf_hdf5_lock(void)
{
    pthread_mutex_lock(&lock);
    silence();
}

bool hf_hdf5_try_lock(void)
{
    if (pthread_mutex_trylock(&lock) != 0) return false;
    silence();
    return true;
}

void hf_hdf5_quiet(void)
{
    is_quiet = true;
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
}

hf_status hf_hdf5_unlock(hf_status status)
{
    pthread_mutex_unlock(&lock);
    return status;
}

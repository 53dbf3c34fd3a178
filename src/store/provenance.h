/* provenance - the attributes of a result file that say how it was made. */
#pragma once

#include "store/hdf5.h"

/* Writes program, versions, compiler, libraries, host, arguments, Slurm job and start of the run to the root. */
void hf_provenance_put(hf_hdf5 *io, int argc, char *const *argv);

/* Writes the present time in UTC as an attribute of the root. */
void hf_provenance_put_time(hf_hdf5 *io, const char *attribute);

/* Writes the ids of the Slurm job, by which its logs can be found. */
void hf_provenance_put_job(hf_hdf5 *io);

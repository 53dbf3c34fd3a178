#include "store/store_open.h"

#include "store/layout.h"
#include <hifdm/store.h>

#include <stdio.h>
#include <string.h>

/* Returns true if an open file is a file of hifdm. There is no message if the attribute `program` is missing or of
 * another type. *could_read: false if the machine, not the file, is the reason why this is unknown. */
static bool is_ours(const hf_hdf5 *io, bool *could_read)
{
    char program[16] = "";
    hf_hdf5 probe = {.path = io->path, .status = HF_OK, .file = io->file};
    hf_hdf5_get(&probe, probe.file, "/", "program", HF_KIND_CHARS, program, sizeof program);
    *could_read = probe.status == HF_OK || probe.is_damaged;
    return !strcmp(program, HF_PROGRAM);
}

/* Notes in io->made_by which version made the file, if not this one. */
static void note_version(hf_hdf5 *io)
{
    char version[64] = "", git[64] = "", both[132];
    if (!hf_hdf5_has_chars(io, io->file, "/", "version") || !hf_hdf5_has_chars(io, io->file, "/", "git_describe"))
        return;
    hf_hdf5_get(io, io->file, "/", "version", HF_KIND_CHARS, version, sizeof version);
    hf_hdf5_get(io, io->file, "/", "git_describe", HF_KIND_CHARS, git, sizeof git);
    snprintf(both, sizeof both, "%s (%s)", version, git);
    if (io->status == HF_OK && strcmp(both, hf_store_version()) != 0) memcpy(io->made_by, both, sizeof both);
}

hf_hdf5 hf_store_open_result(const char *path, hf_messages *messages)
{
    hf_hdf5 io = {.path = path, .messages = messages, .status = HF_OK, .file = -1};
    int version = 0;
    hf_hdf5_lock();
    hf_hdf5_open_file(&io, path);
    if (io.status != HF_OK) return io;
    if (!is_ours(&io, &io.is_damaged))
        io.status = hf_error(messages, HF_IO, "%s: this HDF5 file is damaged or is not a result of hifdm", path);
    hf_hdf5_get(&io, io.file, "/", "format_version", HF_KIND_INT, &version, sizeof version);
    if (version == HF_FORMAT_0_2) io.alias = hf_renamed;
    if (io.status == HF_OK && version != HF_FORMAT_VERSION && version != HF_FORMAT_0_2) {
        io.is_damaged = true;
        io.status =
            hf_error(messages, HF_IO, "%s: this file has format version %d, but this program reads format version %d",
                     path, version, HF_FORMAT_VERSION);
    }
    note_version(&io);
    return io;
}

hf_status hf_store_close_result(hf_hdf5 *io)
{
    hf_hdf5_close_file(io);
    return hf_hdf5_unlock(io->status);
}

hf_status hf_store_fail_damaged(const char *path, hf_messages *messages)
{
    return hf_error(messages, HF_EXISTS,
                    "%s: this file is damaged or belongs to another version of hifdm. Use --restart (in a sweep: "
                    "--retry failed) to replace the file, or use -o to choose another name",
                    path);
}

/* Contents: names and checks - the temporary file - publishing - the end */
#include "store/store_file.h"

#include "base/file_out.h"
#include "base/path.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define COPY_BYTES (1 << 20)
#define FLOW_BYTES (1 << 20)

/* ---- names and checks ---- */

/* Can the file be made under this name? Checked before the run rather than after hours of work. */
static hf_status check_target(const char *path, hf_messages *messages)
{
    char folder[4096];
    struct stat info;
    if (lstat(path, &info) == 0 && stat(path, &info) == 0 && !S_ISREG(info.st_mode))
        return hf_error(messages, HF_IO, "%s: is %s; use -o to choose a file name", path,
                        S_ISDIR(info.st_mode) ? "a folder" : "not an ordinary file");
    hf_path_folder(path, folder, sizeof folder);
    if (!*path || stat(folder, &info) != 0 || !S_ISDIR(info.st_mode))
        return hf_error(messages, HF_IO, "%s: there is no folder %s; make it or use -o to choose another name", path,
                        folder);
    if (access(folder, W_OK | X_OK) != 0)
        return hf_error(messages, HF_IO, "%s: cannot write into the folder %s: %s; use -o to choose another name", path,
                        folder, strerror(errno));
    return HF_OK;
}

hf_status hf_store_file_begin(const char *path, bool replaces, hf_store_file *f, hf_messages *messages)
{
    size_t size = strlen(path) + 48;
    *f = (hf_store_file){.journal.file = -1, .io.file = -1, .visible = -1, .flow = -1, .replaces = replaces};
    HF_TRY(check_target(path, messages));
    f->path = malloc(size);
    f->temporary = malloc(size);
    if (!f->path || !f->temporary) return hf_error(messages, HF_NO_MEMORY, "%s: out of memory", path);
    snprintf(f->path, size, "%s", path);
    snprintf(f->temporary, size, "%s.journal.tmp", path);
    f->io = (hf_hdf5){.path = f->path, .messages = messages, .status = HF_OK, .file = -1};
    return hf_journal_open(f->path, replaces, &f->journal, messages);
}

/* ---- the temporary file ---- */

/* Remove the temporary file of a killed run. It may be a second name of the visible file (hf_file_out_add), so it is
 * never written into. True when the name is free. */
static bool free_temporary(hf_store_file *f)
{
    if (hf_file_out_clear(f->temporary) == 0) return true;
    f->io.status = hf_error(f->io.messages, HF_IO, "%s: cannot remove %s: %s", f->path, f->temporary, strerror(errno));
    return false;
}

void hf_store_file_create(hf_store_file *f)
{
    if (f->io.status != HF_OK || !free_temporary(f)) return;
    f->has_temporary = true;
    hf_hdf5_create_file(&f->io, f->temporary);
}

/* 0, or -1 and errno. */
static int copy_bytes(int from, int to, char *buffer)
{
    ssize_t n;
    while ((n = read(from, buffer, COPY_BYTES)) > 0) {
        ssize_t done = write(to, buffer, (size_t)n);
        if (done == n) continue;
        if (done >= 0) errno = ENOSPC;
        return -1;
    }
    return n == 0 ? 0 : -1;
}

static void copy_visible(hf_store_file *f)
{
    if (!free_temporary(f)) return;
    char *buffer = malloc(COPY_BYTES);
    if (!buffer) {
        f->io.status = hf_error(f->io.messages, HF_NO_MEMORY, "%s: out of memory", f->path);
        return;
    }
    int to = hf_file_out_create(f->temporary);
    f->has_temporary |= to >= 0;
    bool ok = to >= 0 && lseek(f->visible, 0, SEEK_SET) == 0 && copy_bytes(f->visible, to, buffer) == 0;
    int why = errno;
    if (to >= 0) close(to);
    free(buffer);
    if (!ok)
        f->io.status =
            hf_error(f->io.messages, HF_IO, "%s: cannot copy it to %s: %s", f->path, f->temporary, strerror(why));
}

void hf_store_file_open(hf_store_file *f)
{
    if (f->io.file >= 0 || f->io.status != HF_OK) return;
    copy_visible(f);
    if (f->io.status == HF_OK) hf_hdf5_open_file(&f->io, f->temporary, 1);
}

static void stop_flow(hf_store_file *f)
{
    if (f->flow >= 0) close(f->flow);
    f->flow = -1;
    f->flowing = 0;
}

/* Only advice to the system: its failure does not matter. */
void hf_store_file_flow(hf_store_file *f)
{
    struct stat info;
    if (f->io.file < 0 || f->io.status != HF_OK) return;
    if (f->flow < 0) f->flow = open(f->temporary, O_RDONLY | O_CLOEXEC);
    if (f->flow < 0 || fstat(f->flow, &info) != 0 || info.st_size - f->flowing < FLOW_BYTES) return;
    (void)posix_fadvise(f->flow, f->flowing, info.st_size - f->flowing, POSIX_FADV_DONTNEED);
    f->flowing = info.st_size;
}

void hf_store_file_adopt(hf_store_file *f)
{
    if (f->io.status != HF_OK) return;
    if (f->visible >= 0) close(f->visible);
    f->visible = open(f->path, O_RDONLY | O_CLOEXEC);
    if (f->visible >= 0 && fstat(f->visible, &f->ours) == 0)
        f->is_published = true;
    else
        f->io.status = hf_error(f->io.messages, HF_IO, "%s: cannot open: %s", f->path, strerror(errno));
}

/* ---- publishing ---- */

/* HDF5 1.10 does not survive a close that cannot write what is left: the ids stay open and the program crashes at its
 * end. So all is written before; and when the disk is full, the file stays open, for which hf_store_quiet has prepared,
 * but empty. */
void hf_store_file_close(hf_store_file *f)
{
    stop_flow(f);
    if (f->io.file < 0) return;
    if (H5Fflush(f->io.file, H5F_SCOPE_GLOBAL) < 0) {
        hf_hdf5_fail(&f->io, "write", -1, NULL);
        int ignored = truncate(f->temporary, 0);
        (void)ignored;
        f->io.file = -1;
        return;
    }
    hf_hdf5_close_file(&f->io);
}

/* Sync before the rename: after a power cut there is the old file or the new one, whole. */
static void sync_to_disk(hf_store_file *f, const char *name)
{
    if (hf_file_out_sync(name) != 0)
        f->io.status = hf_error(f->io.messages, HF_IO, "%s: cannot write to the disk: %s", f->path, strerror(errno));
}

/* Is the visible file still the one of this run? */
static bool is_ours(const hf_store_file *f)
{
    struct stat now;
    return stat(f->path, &now) == 0 && hf_path_is_same_inode(&now, &f->ours) && now.st_size == f->ours.st_size &&
           now.st_mtim.tv_sec == f->ours.st_mtim.tv_sec && now.st_mtim.tv_nsec == f->ours.st_mtim.tv_nsec;
}

/* Keep a whole file that cannot get its name, under a name that no later run uses. */
static void keep_work(hf_store_file *f, bool is_worth_keeping)
{
    char kept[4096] = "";
    const char *words = "", *why = strerror(errno);
    bool is_taken = errno == EEXIST;
    if (is_worth_keeping) {
        snprintf(kept, sizeof kept, "%s.%ld.h5", f->path, (long)getpid());
        if (hf_file_out_add(f->temporary, kept) != 0) snprintf(kept, sizeof kept, "%s", f->temporary);
        f->has_temporary = false;
        words = "; this run's result is ";
    }
    if (is_taken)
        f->io.status =
            hf_error(f->io.messages, HF_EXISTS, "%s: was made, replaced or removed by someone else during the run%s%s",
                     f->path, words, kept);
    else
        f->io.status =
            hf_error(f->io.messages, HF_IO, "%s: cannot be given this name: %s%s%s", f->path, why, words, kept);
}

void hf_store_file_publish(hf_store_file *f, bool durable)
{
    char folder[4096];
    if (f->io.status == HF_OK && durable) sync_to_disk(f, f->temporary);
    if (f->io.status != HF_OK) return;
    int taken = -1;
    errno = EEXIST;
    if (f->is_published ? is_ours(f) : f->replaces)
        taken = hf_file_out_replace(f->temporary, f->path);
    else if (!f->is_published)
        taken = hf_file_out_add(f->temporary, f->path);
    if (taken != 0) {
        keep_work(f, durable);
        return;
    }
    f->has_temporary = false;
    hf_store_file_adopt(f);
    hf_path_folder(f->path, folder, sizeof folder);
    if (f->io.status == HF_OK && durable) sync_to_disk(f, folder);
}

/* ---- the end ---- */

void hf_store_file_end(hf_store_file *f)
{
    hf_messages unwanted = {0};
    f->io.messages = &unwanted;
    hf_store_file_close(f);
    if (f->has_temporary) unlink(f->temporary); /* before the lock is given back */
    hf_journal_close(&f->journal, f->is_published ? hf_journal_is_empty(&f->journal) : f->journal.is_new);
    hf_messages_free(&unwanted);
    if (f->visible >= 0) close(f->visible);
    free(f->path);
    free(f->temporary);
    *f = (hf_store_file){.io.file = -1};
}

/* Implements store_file.h. Sections: names and checks, the temporary file, publishing, the end. */
#include "store/store_file.h"

#include "base/file_io.h"
#include "base/file_out.h"
#include "base/path.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define COPY_BYTES (1 << 20) /* bytes copied at a time; the copy does not depend on it */
/* Bytes written after which the system is asked again to write the file to the disk. This is only advice, and the file
 * does not depend on it. The tests of the store, of results and of interrupting pass with 0 and with 100 MiB. */
#define FLOW_BYTES (8 << 20)
#define NAMES_MAX 100 /* names that are tried for a result that cannot get its own */

#define EARLIER ".before-restart"

/* ---- names and checks ---- */

hf_status hf_store_file_check(const char *path, hf_messages *messages)
{
    char folder[4096];
    struct stat info;
    if (lstat(path, &info) == 0 && stat(path, &info) == 0 && !S_ISREG(info.st_mode))
        return hf_error(messages, HF_EXISTS, "%s: this is %s. Use -o to choose a file name", path,
                        S_ISDIR(info.st_mode) ? "a folder" : "not a regular file");
    if (!*path) return hf_error(messages, HF_IO, "the name of the result file is empty. Use -o to choose a file name");
    hf_path_folder(path, folder, sizeof folder);
    if (stat(folder, &info) != 0 || !S_ISDIR(info.st_mode))
        return hf_error(messages, HF_IO,
                        "%s: the folder %s does not exist. Create this folder, or use -o to choose another name", path,
                        folder);
    if (access(folder, W_OK | X_OK) != 0)
        return hf_error(messages, HF_IO,
                        "%s: cannot write into the folder %s: %s. Use the -o option to choose another name", path,
                        folder, strerror(errno));
    return HF_OK;
}

hf_status hf_store_file_begin(const char *path, bool replaces, hf_store_file *f, hf_messages *messages)
{
    *f = (hf_store_file){.journal.file = -1, .io.file = -1, .visible = -1, .out.file = -1, .replaces = replaces};
    HF_TRY(hf_file_out_target(path, f->out.path, messages));
    snprintf(f->earlier_name, sizeof f->earlier_name, "%s" EARLIER, f->out.path);
    f->io = (hf_hdf5){.path = f->out.path, .messages = messages, .status = HF_OK, .file = -1};
    HF_TRY(hf_store_file_check(f->out.path, messages));
    HF_TRY(hf_journal_open(f->out.path, replaces, &f->journal, messages));
    if (f->journal.was_there) hf_file_out_clean(f->out.path);
    return HF_OK;
}

/* ---- the temporary file ---- */

static bool make_temporary(hf_store_file *f)
{
    hf_file_out_drop(&f->out, f->io.messages);
    f->flowing = 0;
    if (hf_file_out_make(f->out.path, &f->out) == 0) return true;
    f->io.status =
        hf_error(f->io.messages, HF_IO, "%s: cannot create %s: %s", f->out.path, f->out.temporary, strerror(errno));
    return false;
}

void hf_store_file_create(hf_store_file *f)
{
    if (f->io.status == HF_OK && make_temporary(f)) hf_hdf5_create_file(&f->io, &f->out);
}

/* Copies the rest of one file to another, through buffer[COPY_BYTES]. Returns 0, or -1 and errno. */
static int copy_bytes(int from, int to, char *buffer)
{
    ssize_t n;
    while ((n = hf_file_io_read(from, buffer, COPY_BYTES)) > 0)
        if (hf_file_io_write(to, buffer, (size_t)n) != 0) return -1;
    return (int)n;
}

static void copy_visible(hf_store_file *f)
{
    if (!make_temporary(f)) return;
    char *buffer = malloc(COPY_BYTES);
    if (!buffer) {
        f->io.status = hf_error(f->io.messages, HF_NO_MEMORY, "%s: out of memory", f->out.path);
        return;
    }
    bool ok = lseek(f->visible, 0, SEEK_SET) == 0 && copy_bytes(f->visible, f->out.file, buffer) == 0;
    f->beside += hf_store_file_size(f);
    int why = errno;
    free(buffer);
    if (!ok)
        f->io.status = hf_error(f->io.messages, HF_IO, "%s: cannot copy this file to %s: %s", f->out.path,
                                f->out.temporary, strerror(why));
}

void hf_store_file_open(hf_store_file *f)
{
    if (f->io.file >= 0 || f->io.status != HF_OK) return;
    copy_visible(f);
    if (f->io.status == HF_OK) hf_hdf5_open_to_write(&f->io, &f->out);
}

int64_t hf_store_file_size(const hf_store_file *f)
{
    struct stat info;
    return f->out.file >= 0 && fstat(f->out.file, &info) == 0 ? info.st_size : f->ours.st_size;
}

/* The call is only advice to the system, so its failure does not matter. */
void hf_store_file_flow(hf_store_file *f)
{
    if (f->io.file < 0 || f->io.status != HF_OK) return;
    int64_t size = hf_store_file_size(f);
    if (size - f->flowing < FLOW_BYTES) return;
    (void)posix_fadvise(f->out.file, f->flowing, size - f->flowing, POSIX_FADV_DONTNEED);
    f->flowing = size;
}

void hf_store_file_adopt(hf_store_file *f)
{
    if (f->io.status != HF_OK) return;
    if (f->visible >= 0) close(f->visible);
    f->visible = hf_file_io_open(f->out.path, O_RDONLY | O_CLOEXEC);
    if (f->visible >= 0 && fstat(f->visible, &f->ours) == 0)
        f->is_published = true;
    else
        f->io.status = hf_error(f->io.messages, HF_IO, "%s: cannot open: %s", f->out.path, strerror(errno));
}

/* ---- publishing ---- */

/* HDF5 1.10 does not survive a close that cannot write the remaining data. The ids stay open, and the program crashes
 * at its end. All data are therefore flushed before the close. If the disk is full, the file stays open but empty;
 * hf_store_quiet has prepared the program for this. */
void hf_store_file_close(hf_store_file *f)
{
    if (f->io.file < 0) return;
    if (H5Fflush(f->io.file, H5F_SCOPE_GLOBAL) < 0) {
        hf_hdf5_fail(&f->io, "write", -1, NULL);
        int ignored = hf_file_io_cut(f->out.file, 0);
        (void)ignored;
        f->io.file = -1;
        return;
    }
    hf_hdf5_close_file(&f->io);
}

static void sync_failed(hf_store_file *f)
{
    f->io.status = hf_error(f->io.messages, HF_IO, "%s: cannot write to the disk: %s", f->out.path, strerror(errno));
}

/* Returns true if the visible file is still that of this run. */
static bool is_ours(const hf_store_file *f)
{
    struct stat now;
    return stat(f->out.path, &now) == 0 && hf_path_is_same_inode(&now, &f->ours) && now.st_size == f->ours.st_size &&
           now.st_mtim.tv_sec == f->ours.st_mtim.tv_sec && now.st_mtim.tv_nsec == f->ours.st_mtim.tv_nsec;
}

/* Sets the status after a file could not get its name. If the file is worth keeping, it gets a name that no later run
 * uses. */
static void keep_work(hf_store_file *f, bool is_worth_keeping)
{
    char kept[HF_FILE_OUT_SIZE + 64] = "";
    const char *words = "", *why = strerror(errno);
    bool is_taken = errno == EEXIST;
    if (is_worth_keeping) {
        int added = -1;
        for (int k = 1; added != 0 && k <= NAMES_MAX && (k == 1 || errno == EEXIST); k++) {
            snprintf(kept, sizeof kept, k == 1 ? "%s.%ld.h5" : "%s.%ld-%d.h5", f->out.path, (long)getpid(), k);
            added = hf_file_out_add(&f->out, kept, f->io.messages);
        }
        if (added != 0) {
            snprintf(kept, sizeof kept, "%s", f->out.temporary);
            close(f->out.file);
            f->out.file = -1;
        }
        words = "; this run's result is ";
    }
    if (is_taken)
        f->io.status = hf_error(f->io.messages, HF_EXISTS,
                                "%s: another process created, replaced or removed this file during the run%s%s",
                                f->out.path, words, kept);
    else
        f->io.status = hf_error(f->io.messages, HF_IO, "%s: cannot give this name to the result: %s%s%s", f->out.path,
                                why, words, kept);
}

/* Returns true if `name` is a second name of the earlier result itself. A restart leaves both names if it ended between
 * its two changes of names. */
static bool is_earlier(const char *name, const char *result)
{
    struct stat of_name, of_result;
    return lstat(name, &of_name) == 0 && lstat(result, &of_result) == 0 && hf_path_is_same_inode(&of_name, &of_result);
}

hf_status hf_store_file_demand_room(hf_store_file *f, hf_messages *messages)
{
    struct stat info;
    if (f->earlier != HF_EARLIER_THERE && f->earlier != HF_EARLIER_UNREAD) return HF_OK;
    int seen = hf_path_look_at_link(f->earlier_name, &info);
    if (f->earlier == HF_EARLIER_UNREAD && seen >= 0) {
        f->earlier = seen ? HF_EARLIER_NONE : HF_EARLIER_THERE;
        return HF_OK;
    }
    if (seen < 0)
        return hf_error(messages, HF_IO, "%s: cannot get the status of this file: %s", f->earlier_name,
                        strerror(errno));
    if (seen == 0 || is_earlier(f->earlier_name, f->out.path)) return HF_OK;
    return hf_error(
        messages, HF_EXISTS,
        "%s: hifdm needs this name for the earlier result until the new result is finished. Remove or rename the file",
        f->earlier_name);
}

static void keep_earlier(hf_store_file *f)
{
    int failed = is_earlier(f->earlier_name, f->out.path) ? 0 : hf_file_out_second_name(f->out.path, f->earlier_name);
    if (failed && errno != ENOENT) /* another process has removed it */
        f->io.status = hf_error(f->io.messages, HF_IO, "%s: cannot keep the earlier result as %s: %s", f->out.path,
                                f->earlier_name, strerror(errno));
    f->earlier = failed ? HF_EARLIER_NONE : HF_EARLIER_KEPT;
}

void hf_store_file_forget_earlier(const char *result)
{
    char name[HF_FILE_OUT_SIZE + 16];
    snprintf(name, sizeof name, "%s" EARLIER, result);
    (void)unlink(name); /* if it stays, the next restart reports it */
}

/* Syncs the file before the rename. After a power cut there is either the old file or the new one, whole. */
void hf_store_file_publish(hf_store_file *f, bool durable, bool is_finished)
{
    if (f->io.status == HF_OK && durable && hf_file_io_sync(f->out.file, false) != 0) sync_failed(f);
    if (f->io.status == HF_OK && !is_finished && f->earlier == HF_EARLIER_THERE) keep_earlier(f);
    if (f->io.status != HF_OK) return;
    int taken = -1;
    errno = EEXIST;
    if (f->is_published ? is_ours(f) : f->replaces)
        taken = hf_file_out_replace(&f->out, f->out.path);
    else if (!f->is_published)
        taken = hf_file_out_add(&f->out, f->out.path, f->io.messages);
    if (taken != 0) {
        if (f->out.file < 0)
            sync_failed(f); /* it has its name, but its close failed */
        else
            keep_work(f, durable);
        return;
    }
    hf_store_file_adopt(f);
    if (f->io.status == HF_OK && durable && hf_file_out_sync_folder(f->out.path) != 0) sync_failed(f);
    if (f->io.status != HF_OK || !is_finished) return;
    if (f->earlier == HF_EARLIER_KEPT && unlink(f->earlier_name) != 0 && errno != ENOENT)
        hf_warning(f->io.messages, "%s: cannot remove the earlier result %s: %s", f->out.path, f->earlier_name,
                   strerror(errno));
    f->earlier = HF_EARLIER_NONE;
}

/* ---- the end ---- */

/* The journal stays beside a temporary file that could not be removed. The next command that finds a journal looks for
 * such files. */
void hf_store_file_end(hf_store_file *f, hf_messages *messages)
{
    f->io.messages = NULL;
    hf_store_file_close(f);
    if (f->earlier == HF_EARLIER_KEPT && messages)
        hf_warning(messages, "%s: the earlier result is named %s until the new result is finished", f->out.path,
                   f->earlier_name);
    hf_file_out_drop(&f->out, messages); /* before the lock is released */
    bool is_needless = f->is_published ? hf_journal_is_empty(&f->journal) : f->journal.is_new;
    hf_journal_close(&f->journal, is_needless && !f->out.is_left);
    if (f->visible >= 0) close(f->visible);
    *f = (hf_store_file){.journal.file = -1, .io.file = -1, .visible = -1, .out.file = -1};
}

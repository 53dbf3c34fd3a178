/* Contents: names - locks and leftovers - temporary files - files with fixed names - a file from begin to end - sets of
 * files - files without a name */
#define _GNU_SOURCE /* F_OFD_SETLK, renameat2 */
#include "base/file_out.h"

#include "base/file_io.h"
#include "base/path.h"
#include "base/text.h"

#include <assert.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#define MARK ".hifdm-"
#define ENDING ".tmp"
#define RANDOM_BYTES 16
#define STEM_MAX 200 /* bytes of a name that its temporary names repeat; file systems allow 255 bytes */
#define LINKS_MAX 40 /* as in Linux */
#define ATTEMPTS 100

/* ---- names ---- */

static hf_status tell_too_long(const char *path, hf_messages *messages)
{
    return hf_error(messages, HF_IO, "%s: the path is too long", path);
}

static bool is_trusted(const struct stat *link)
{
    return link->st_uid == geteuid() || link->st_uid == 0;
}

static hf_status refuse_link(const char *path, const char *what, hf_messages *messages)
{
    return hf_error(messages, HF_IO,
                    "%s: this symbolic link belongs to another user. Give the name of the %s to which the link points, "
                    "or choose another name",
                    path, what);
}

/* Reports that a path cannot be examined. errno must be that of the failed call. */
static hf_status cannot_look(const char *path, hf_messages *messages)
{
    return hf_error(messages, HF_IO, "%s: cannot get the status of this file: %s", path, strerror(errno));
}

/* Returns HF_IO if a folder on the way to `path` is a link made by somebody else in a folder to which everybody may
 * write. Other links to folders are followed: the owner of their folder allowed them. */
static hf_status check_folders(const char *path, hf_messages *messages)
{
    char part[HF_FILE_OUT_SIZE], folder[HF_FILE_OUT_SIZE];
    struct stat info;
    for (int i = 1; *path && path[i]; i++) {
        if (path[i] != '/' || path[i - 1] == '/') continue;
        snprintf(part, sizeof part, "%.*s", i, path);
        int seen = hf_path_look_at_link(part, &info);
        if (seen < 0) return cannot_look(part, messages);
        if (seen == 0 || !S_ISLNK(info.st_mode) || is_trusted(&info)) continue;
        if (!hf_path_folder(part, folder, sizeof folder) || stat(folder, &info) != 0 || info.st_mode & S_IWOTH)
            return refuse_link(part, "folder", messages);
    }
    return HF_OK;
}

/* Replaces `target` by the file that it leads to, as long as it is a link. `what` is "file" or
 * "folder", for messages. */
static hf_status follow(char target[HF_FILE_OUT_SIZE], const char *what, hf_messages *messages)
{
    char to[HF_FILE_OUT_SIZE], next[HF_FILE_OUT_SIZE];
    struct stat info;
    int seen;
    HF_TRY(check_folders(target, messages));
    for (int i = 0; (seen = hf_path_look_at_link(target, &info)) > 0 && S_ISLNK(info.st_mode); i++) {
        if (!is_trusted(&info)) return refuse_link(target, what, messages);
        ssize_t n = readlink(target, to, sizeof to - 1);
        if (i == LINKS_MAX) errno = ELOOP;
        if (n < 0 || i == LINKS_MAX)
            return hf_error(messages, HF_IO, "%s: cannot follow this symbolic link: %s", target, strerror(errno));
        to[n] = '\0';
        if (!hf_path_beside(target, to, next, sizeof next)) return tell_too_long(target, messages);
        strcpy(target, next);
        HF_TRY(check_folders(target, messages));
    }
    return seen < 0 ? cannot_look(target, messages) : HF_OK;
}

hf_status hf_file_out_target(const char *path, char target[HF_FILE_OUT_SIZE], hf_messages *messages)
{
    struct stat info;
    if (snprintf(target, HF_FILE_OUT_SIZE, "%s", path) >= HF_FILE_OUT_SIZE) return tell_too_long(path, messages);
    HF_TRY(follow(target, "file", messages));
    int seen = hf_path_look(path, &info);
    if (seen < 0) return cannot_look(path, messages);
    if (seen > 0 && !S_ISREG(info.st_mode)) strcpy(target, path);
    return HF_OK;
}

hf_status hf_file_out_folder(const char *path, hf_messages *messages)
{
    char name[HF_FILE_OUT_SIZE], target[HF_FILE_OUT_SIZE];
    int n = snprintf(name, sizeof name, "%s", path);
    if (n >= HF_FILE_OUT_SIZE) return tell_too_long(path, messages);
    /* lstat(2) of a link with a slash at its end does not show the link */
    while (n > 1 && (name[n - 1] == '/' || (name[n - 1] == '.' && name[n - 2] == '/')))
        name[--n] = '\0';
    strcpy(target, name);
    HF_TRY(follow(target, "folder", messages));
    if (mkdir(name, 0777) == 0 || errno == EEXIST) return HF_OK;
    return hf_error(messages, HF_IO, "%s: cannot create this folder: %s", path, strerror(errno));
}

hf_status hf_file_out_spare(const char *input, const char *what, const char *output, hf_messages *messages)
{
    int is_same = input && *input ? hf_path_compare(input, output) : 0;
    if (is_same == 0) return HF_OK;
    if (is_same > 0) return hf_error(messages, HF_EXISTS, "%s: this file is %s. Choose another name", output, what);
    return hf_error(messages, HF_IO, "%s: cannot determine whether this file is %s: %s", output, what, strerror(errno));
}

hf_status hf_file_out_look(const char *path, bool *is_there, hf_messages *messages)
{
    struct stat info;
    int seen = hf_path_look(path, &info);
    *is_there = seen != 0;
    return seen < 0 ? cannot_look(path, messages) : HF_OK;
}

/* Writes the common beginning of all temporary names of `path`, without the folder. */
static void begin_of_names(const char *path, char begin[STEM_MAX + 16])
{
    char stem[STEM_MAX + 1];
    snprintf(stem, sizeof stem, "%s", hf_path_name(path));
    hf_text_trim_utf8(stem);
    snprintf(begin, STEM_MAX + 16, ".%s%s", stem, MARK);
}

/* Writes a temporary name of `path`. Returns 0, or -1 and errno. */
static int choose_name(const char *path, char name[HF_FILE_OUT_SIZE])
{
    unsigned char bytes[RANDOM_BYTES];
    char hex[2 * RANDOM_BYTES + 1], begin[STEM_MAX + 16];
    if (getrandom(bytes, sizeof bytes, 0) != (ssize_t)sizeof bytes) return -1;
    for (int i = 0; i < RANDOM_BYTES; i++)
        snprintf(hex + 2 * i, 3, "%02x", (unsigned)bytes[i]);
    begin_of_names(path, begin);
    int n = snprintf(name, HF_FILE_OUT_SIZE, "%.*s%s%s%s", hf_path_prefix_length(path), path, begin, hex, ENDING);
    if (n < HF_FILE_OUT_SIZE) return 0;
    errno = ENAMETOOLONG;
    return -1;
}

static bool is_temporary_name(const char *name, const char *begin)
{
    size_t n = strlen(begin);
    return !strncmp(name, begin, n) && strspn(name + n, "0123456789abcdef") == (size_t)2 * RANDOM_BYTES &&
           !strcmp(name + n + (size_t)2 * RANDOM_BYTES, ENDING);
}

/* ---- locks and leftovers ---- */

typedef enum { LOCKED, HELD_BY_ANOTHER, WITHOUT_LOCKS } lock_answer;

/* Locks a file. The lock belongs to the open file description and ends with it, also if the process is killed. flock(2)
 * is not used, because HDF5 may lock the same file that way through another descriptor. */
static lock_answer lock_file(int file)
{
    struct flock lock = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
    if (fcntl(file, F_OFD_SETLK, &lock) == 0) return LOCKED;
    return errno == EAGAIN || errno == EACCES ? HELD_BY_ANOTHER : WITHOUT_LOCKS;
}

static void remove_leftover(const char *name)
{
    struct stat info;
    int file = hf_file_io_open(name, O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (file < 0) return;
    if (fstat(file, &info) == 0 && S_ISREG(info.st_mode) && lock_file(file) == LOCKED && hf_path_leads_to(name, file))
        unlink(name); /* only unlinked, never written: it may be a second name of the visible file (hf_file_out_add) */
    close(file);
}

void hf_file_out_clean(const char *path)
{
    char folder[HF_FILE_OUT_SIZE], begin[STEM_MAX + 16], name[HF_FILE_OUT_SIZE];
    if (!hf_path_folder(path, folder, sizeof folder)) return;
    DIR *list = opendir(folder);
    if (!list) return;
    begin_of_names(path, begin);
    for (const struct dirent *entry; (entry = readdir(list)) != NULL;)
        if (is_temporary_name(entry->d_name, begin) && hf_path_beside(path, entry->d_name, name, sizeof name))
            remove_leftover(name);
    closedir(list);
}

/* ---- temporary files ---- */

static void remove_temporary(hf_file_out *f, hf_messages *messages)
{
    if (unlink(f->temporary) == 0 || errno == ENOENT) return;
    f->is_left = true;
    if (messages)
        hf_warning(messages,
                   "%s: cannot remove the temporary file %s: %s. Remove this file, or wait for the next command that "
                   "writes %s to remove it",
                   f->path, f->temporary, strerror(errno), hf_path_name(f->path));
}

static int close_with(int file, int why)
{
    close(file);
    errno = why;
    return -1;
}

int hf_file_out_make(const char *path, hf_file_out *f)
{
    struct stat info;
    f->file = -1;
    *f->temporary = '\0';
    if (path != f->path) snprintf(f->path, sizeof f->path, "%s", path);
    for (int i = 0; i < ATTEMPTS; i++) {
        if (choose_name(f->path, f->temporary) != 0) return -1;
        f->file = hf_file_out_create(f->temporary);
        if (f->file < 0 && errno != EEXIST) return -1;
        if (f->file < 0) continue;
        /* another process may have taken the unlocked file for a leftover and removed it */
        bool is_ours = lock_file(f->file) != HELD_BY_ANOTHER;
        if (fstat(f->file, &info) != 0) break;
        if (is_ours && info.st_nlink > 0) return 0;
        hf_file_out_drop(f, NULL);
        errno = EAGAIN;
    }
    int why = errno;
    hf_file_out_drop(f, NULL);
    errno = why;
    return -1;
}

void hf_file_out_drop(hf_file_out *f, hf_messages *messages)
{
    if (f->file < 0) return;
    remove_temporary(f, messages);
    close(f->file);
    f->file = -1;
}

int hf_file_out_sync_folder(const char *path)
{
    char folder[HF_FILE_OUT_SIZE];
    hf_path_folder(path, folder, sizeof folder);
    int file = hf_file_io_open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (file < 0 || hf_file_io_sync(file, false) != 0) return file < 0 ? -1 : close_with(file, errno);
    close(file);
    return 0;
}

/* Closes the file after it has got its name. Returns 0, or -1 and errno: some content may then not be on the disk. */
static int end(hf_file_out *f)
{
    int file = f->file;
    f->file = -1;
    return hf_file_io_close(file);
}

int hf_file_out_replace(hf_file_out *f, const char *path)
{
    return rename(f->temporary, path) == 0 ? end(f) : -1;
}

int hf_file_out_add(hf_file_out *f, const char *path, hf_messages *messages)
{
    if (link(f->temporary, path) == 0) {
        remove_temporary(f, messages);
        return end(f);
    }
    if (errno == EEXIST) return -1;
    if (renameat2(AT_FDCWD, f->temporary, AT_FDCWD, path, RENAME_NOREPLACE) == 0) return end(f);
    if (errno == EEXIST) return -1;
    /* a file system without both calls: reserve the name with an empty file, then replace that file */
    int file = hf_file_out_create(path);
    if (file < 0) return -1;
    close(file);
    if (rename(f->temporary, path) == 0) return end(f);
    int why = errno;
    unlink(path);
    errno = why;
    return -1;
}

int hf_file_out_second_name(const char *path, const char *name)
{
    if (link(path, name) == 0) return 0;
    return errno == EEXIST || errno == ENOENT ? -1 : rename(path, name);
}

void hf_file_out_name(const hf_file_out *f, char name[HF_FILE_OUT_NAME_SIZE])
{
    snprintf(name, HF_FILE_OUT_NAME_SIZE, "/proc/self/fd/%d", f->file);
    if (!hf_path_leads_to(name, f->file)) snprintf(name, HF_FILE_OUT_NAME_SIZE, "%s", f->temporary);
}

/* ---- files with fixed names ---- */

int hf_file_out_create(const char *name)
{
    return hf_file_io_open(name, O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC);
}

int hf_file_out_keep(const char *name, bool *was_there)
{
    struct stat info;
    int file = -1;
    for (int i = 0; i < ATTEMPTS && file < 0; i++) {
        file = hf_file_io_open(name, O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
        *was_there = file >= 0;
        if (file < 0 && errno == ENOENT) file = hf_file_out_create(name);
        if (file < 0 && errno != EEXIST && errno != ENOENT) break; /* made or removed between the two calls */
    }
    if (file < 0) {
        if (errno == ELOOP || errno == EISDIR || errno == ENXIO) errno = EEXIST; /* a link, a folder, a socket */
        return -1;
    }
    if (fstat(file, &info) != 0) return close_with(file, errno);
    if (!S_ISREG(info.st_mode) || info.st_nlink > 1) return close_with(file, EEXIST);
    return file;
}

/* ---- a file from begin to end ---- */

static hf_status fail(const char *path, hf_messages *messages)
{
    return hf_error(messages, HF_IO, "%s: cannot write: %s", path, strerror(errno));
}

hf_status hf_file_out_begin(const char *path, hf_file_out *f, hf_messages *messages)
{
    struct stat info;
    f->file = -1;
    f->is_left = false;
    HF_TRY(hf_file_out_target(path, f->path, messages));
    if (lstat(f->path, &info) != 0 && errno == ENAMETOOLONG) return fail(path, messages);
    int seen = hf_path_look(f->path, &info);
    if (seen < 0) return cannot_look(f->path, messages);
    if (seen > 0 && !S_ISREG(info.st_mode) && !S_ISDIR(info.st_mode)) /* rename(2) never replaces a folder */
        return hf_error(messages, HF_IO, "%s: this is not a regular file. Choose another name", path);
    hf_file_out_clean(f->path);
    return hf_file_out_make(f->path, f) == 0 ? HF_OK : fail(path, messages);
}

hf_status hf_file_out_try(const char *path, hf_messages *messages)
{
    hf_file_out f;
    HF_TRY(hf_file_out_begin(path, &f, messages));
    hf_file_out_drop(&f, messages);
    return HF_OK;
}

hf_status hf_file_out_publish(hf_file_out *f, hf_messages *messages)
{
    if (hf_file_io_sync(f->file, false) == 0 && hf_file_out_replace(f, f->path) == 0) return HF_OK;
    hf_status status = fail(f->path, messages);
    hf_file_out_drop(f, messages);
    return status;
}

/* Fills the temporary file with the text that `write` writes. Drops the file after a failure. */
static hf_status fill_file(hf_file_out *f, void (*write)(const void *context, FILE *file), const void *context,
                           hf_messages *messages)
{
    int copy = fcntl(f->file, F_DUPFD_CLOEXEC, 0); /* for the stream; the original descriptor keeps the lock */
    FILE *stream = copy >= 0 ? fdopen(copy, "w") : NULL;
    int failed = !stream;
    if (stream) {
        write(context, stream);
        failed = ferror(stream) != 0;
        failed |= fclose(stream) != 0;
    } else if (copy >= 0) {
        close(copy);
    }
    if (!failed) return HF_OK;
    hf_status status = fail(f->path, messages);
    hf_file_out_drop(f, messages);
    return status;
}

hf_status hf_file_out_write(const char *path, void (*write)(const void *context, FILE *file), const void *context,
                            hf_messages *messages)
{
    hf_file_out f;
    HF_TRY(hf_file_out_begin(path, &f, messages));
    HF_TRY(fill_file(&f, write, context, messages));
    return hf_file_out_publish(&f, messages);
}

/* ---- sets of files ---- */

hf_status hf_file_out_set_begin(hf_file_out_set *set, const char *path, hf_file_out **file, hf_messages *messages)
{
    assert(set->n < HF_FILE_OUT_SET_MAX);
    hf_file_out *f = &set->file[set->n];
    HF_TRY(hf_file_out_begin(path, f, messages));
    set->n++;
    *file = f;
    for (int i = 0; i + 1 < set->n; i++)
        if (!strcmp(set->file[i].path, f->path))
            return hf_error(messages, HF_EXISTS, "%s: two output files would have this name", path);
    return HF_OK;
}

hf_status hf_file_out_set_write(hf_file_out_set *set, const char *path, void (*write)(const void *context, FILE *file),
                                const void *context, hf_messages *messages)
{
    hf_file_out *f;
    HF_TRY(hf_file_out_set_begin(set, path, &f, messages));
    return fill_file(f, write, context, messages);
}

hf_status hf_file_out_set_end(hf_file_out_set *set, hf_status status, hf_messages *messages)
{
    for (int i = 0; i < set->n && status == HF_OK; i++)
        if (hf_file_io_sync(set->file[i].file, false) != 0) status = fail(set->file[i].path, messages);
    for (int i = 0; i < set->n && status == HF_OK; i++)
        if (hf_file_out_replace(&set->file[i], set->file[i].path) != 0) status = fail(set->file[i].path, messages);
    for (int i = 0; i < set->n; i++)
        hf_file_out_drop(&set->file[i], messages);
    set->n = 0;
    return status;
}

/* ---- files without a name ---- */

/* Makes a file and removes its name at once, for file systems that have no files without a name. */
static int scratch_with_name(const char *beside)
{
    hf_file_out f = {0};
    if (hf_file_out_make(beside, &f) != 0) return -1;
    int file = fcntl(f.file, F_DUPFD_CLOEXEC, 0), why = errno;
    hf_file_out_drop(&f, NULL);
    errno = why;
    return file;
}

int hf_file_out_scratch(const char *beside)
{
    char folder[HF_FILE_OUT_SIZE];
    if (!beside) beside = P_tmpdir "/hifdm";
    if (!hf_path_folder(beside, folder, sizeof folder)) {
        errno = ENAMETOOLONG;
        return -1;
    }
#ifdef O_TMPFILE
    int file = open(folder, O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    if (file >= 0) return file;
#endif
    return scratch_with_name(beside);
}

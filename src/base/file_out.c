#include "base/file_out.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <unistd.h>

hf_status hf_file_out_begin(const char *path, hf_file_out *f, hf_messages *messages)
{
    f->path = path;
    if (snprintf(f->temporary, sizeof f->temporary, "%s.%ld.tmp", path, (long)getpid()) < (int)sizeof f->temporary)
        return HF_OK;
    return hf_error(messages, HF_IO, "%s: the path is too long", path);
}

hf_status hf_file_out_try(const char *path, hf_messages *messages)
{
    hf_file_out f;
    HF_TRY(hf_file_out_begin(path, &f, messages));
    int file = hf_file_out_create(f.temporary);
    if (file < 0) return hf_error(messages, HF_IO, "%s: cannot write: %s", f.temporary, strerror(errno));
    close(file);
    hf_file_out_drop(&f);
    return HF_OK;
}

void hf_file_out_drop(const hf_file_out *f)
{
    unlink(f->temporary);
}

hf_status hf_file_out_publish(const hf_file_out *f, hf_messages *messages)
{
    if (hf_file_out_sync(f->temporary) == 0 && hf_file_out_replace(f->temporary, f->path) == 0) return HF_OK;
    hf_status status = hf_error(messages, HF_IO, "%s: cannot write: %s", f->path, strerror(errno));
    hf_file_out_drop(f);
    return status;
}

hf_status hf_file_out_write(const char *path, void (*write)(const void *context, FILE *file), const void *context,
                            hf_messages *messages)
{
    hf_file_out f;
    HF_TRY(hf_file_out_begin(path, &f, messages));
    int file = hf_file_out_create(f.temporary);
    FILE *stream = file >= 0 ? fdopen(file, "w") : NULL;
    if (!stream) {
        hf_status status = hf_error(messages, HF_IO, "%s: cannot write: %s", f.temporary, strerror(errno));
        if (file >= 0) {
            close(file);
            hf_file_out_drop(&f);
        }
        return status;
    }
    write(context, stream);
    int failed = ferror(stream) != 0;
    failed |= fclose(stream) != 0;
    if (!failed) return hf_file_out_publish(&f, messages);
    hf_status status = hf_error(messages, HF_IO, "%s: cannot write: %s", path, strerror(errno));
    hf_file_out_drop(&f);
    return status;
}

/* ---- on names ---- */

int hf_file_out_create(const char *name)
{
    return open(name, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
}

int hf_file_out_clear(const char *name)
{
    return unlink(name) == 0 || errno == ENOENT ? 0 : -1;
}

int hf_file_out_sync(const char *name)
{
    int file = open(name, O_RDONLY | O_CLOEXEC);
    if (file < 0) return -1;
    int failed = fsync(file) != 0 && errno != EINVAL; /* EINVAL: this file system has no such thing */
    int why = errno;
    close(file);
    errno = why;
    return failed ? -1 : 0;
}

int hf_file_out_replace(const char *temporary, const char *path)
{
    return rename(temporary, path);
}

int hf_file_out_add(const char *temporary, const char *path)
{
    if (link(temporary, path) == 0) {
        unlink(temporary); /* where that fails, hf_file_out_clear tries again */
        return 0;
    }
    if (errno == EEXIST) return -1;
    /* a file system without links: take the name with an empty file, then replace that */
    int file = open(path, O_WRONLY | O_CREAT | O_EXCL, 0600);
    if (file < 0) return -1;
    close(file);
    if (rename(temporary, path) == 0) return 0;
    int why = errno;
    unlink(path);
    errno = why;
    return -1;
}

/* file_out - makes all files that this program writes.
 *
 * A file first has a temporary name. When its content is complete and on the disk, the file is renamed. So nobody sees
 * a half-written file, and after a power failure either the old or the new file exists, complete. The temporary file of
 * FOLDER/NAME is FOLDER/.NAME.hifdm-<32 random hexadecimal digits>.tmp. Nobody can guess this name and put a link or a
 * file there. No other program uses such names, so a file that a killed process left behind can be recognised. A
 * temporary file is locked (fcntl, F_OFD_SETLK) while its process runs, so that no other process removes it. On a file
 * system without these locks, temporary files that a killed process left behind remain.
 *
 * If the user or root made a symbolic link, the file that it points to is written. A link made by anybody else is
 * refused, because in a shared folder it could point to any file of the user. The same holds for an output folder. A
 * link to a folder further up the path may belong to somebody else, unless everybody may write to the folder that
 * contains it (such as /tmp). */
#pragma once

#include <hifdm/status.h>
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>

#define HF_FILE_OUT_SIZE PATH_MAX /* the system refuses longer paths */

typedef struct {
    char path[HF_FILE_OUT_SIZE];      /* the visible name, after following links */
    char temporary[HF_FILE_OUT_SIZE]; /* its temporary name, in the same folder */
    int file;                         /* descriptor of the temporary file, open to read and write, locked; -1: none */
    bool is_left;                     /* the temporary file could not be removed */
} hf_file_out;

/* Makes a temporary file for `path`. First removes temporary files of `path` that killed processes left behind. Returns
 * HF_OK, or HF_IO with a message. A `path` that is a device, a pipe or a socket is an error. A folder causes the error
 * later, in hf_file_out_publish. */
hf_status hf_file_out_begin(const char *path, hf_file_out *file, hf_messages *messages);

/* Checks whether the file can be made, before long work begins: makes the temporary file and removes it. Returns
 * HF_OK or HF_IO. */
hf_status hf_file_out_try(const char *path, hf_messages *messages);

/* Gives the finished temporary file its visible name and closes it. A file with this name is replaced. If that fails,
 * removes the temporary file and returns HF_IO with a message. */
hf_status hf_file_out_publish(hf_file_out *file, hf_messages *messages);
/* Closes and removes the temporary file, if there is one. Warns if the removal fails, unless `messages` is NULL. */
void hf_file_out_drop(hf_file_out *file, hf_messages *messages);

/* Makes a text file with the functions above. `write` writes the text to the stream. Returns HF_OK or HF_IO. */
hf_status hf_file_out_write(const char *path, void (*write)(const void *context, FILE *file), const void *context,
                            hf_messages *messages);

/* ---- sets of files: all get their visible names or none does, unless a rename fails ---- */

#define HF_FILE_OUT_SET_MAX 80

typedef struct {
    hf_file_out file[HF_FILE_OUT_SET_MAX];
    int n;
} hf_file_out_set;

/* Makes one more temporary file, empty. *file points to it; the set owns it. Returns HF_OK or HF_IO, and HF_EXISTS if
 * the set already contains this path. */
hf_status hf_file_out_set_begin(hf_file_out_set *set, const char *path, hf_file_out **file, hf_messages *messages);

/* Makes one more temporary file and fills it as hf_file_out_write does. */
hf_status hf_file_out_set_write(hf_file_out_set *set, const char *path, void (*write)(const void *context, FILE *file),
                                const void *context, hf_messages *messages);

/* Writes all files of the set to the disk, then renames all of them. If `status` is not HF_OK, drops all files instead
 * and returns `status`. Returns HF_IO if a file cannot be written. */
hf_status hf_file_out_set_end(hf_file_out_set *set, hf_status status, hf_messages *messages);

/* ---- single steps, for files that keep their temporary name for longer ----
 * The functions that return an int return 0, or -1 and errno; the caller writes the message. */

/* Writes the file that `path` stands for into `target`: follows links, also to a file that does not exist yet. A path
 * that leads to anything else than an ordinary file is copied unchanged. Returns HF_IO if the path is too long, if it
 * cannot be examined, or if a link on it was made by somebody else. */
hf_status hf_file_out_target(const char *path, char target[HF_FILE_OUT_SIZE], hf_messages *messages);

/* Makes a folder unless it exists. Returns HF_IO if that fails, and also if the folder is a link made by somebody else.
 * Slashes and dots at the end of the path do not hide such a link. */
hf_status hf_file_out_folder(const char *path, hf_messages *messages);

/* Reports in *is_there whether a file exists at `path`, following links. Returns HF_IO if the system cannot answer.
 * *is_there is then true, so that the file is not replaced. */
hf_status hf_file_out_look(const char *path, bool *is_there, hf_messages *messages);

/* Returns HF_EXISTS if `output` leads to the file `input`. No option allows an output to replace its input. `what`
 * describes the input to the user, such as "the result itself". `input` may be NULL or "". Returns HF_IO if the
 * system cannot answer. */
hf_status hf_file_out_spare(const char *input, const char *what, const char *output, hf_messages *messages);

/* Removes the temporary files of `path` whose processes have ended. */
void hf_file_out_clean(const char *path);

int hf_file_out_make(const char *path, hf_file_out *file); /* temporary file of `path`, links already followed */
int hf_file_out_sync_folder(const char *path);             /* waits until the name `path` is on the disk */

/* Gives the file `path` a second name. On a file system without links, the file is renamed to it. */
int hf_file_out_second_name(const char *path, const char *name);

/* Give the temporary file the name `path` and close it. hf_file_out_replace replaces an existing file. hf_file_out_add
 * does not; errno is then EEXIST. If only the close failed, the file has its name and file->file is -1. hf_file_out_add
 * warns if it cannot remove the temporary name. */
int hf_file_out_replace(hf_file_out *file, const char *path);
int hf_file_out_add(hf_file_out *file, const char *path, hf_messages *messages);

/* Writes a name under which a library can open this temporary file, even if another file has its name meanwhile. */
#define HF_FILE_OUT_NAME_SIZE (HF_FILE_OUT_SIZE + 32)
void hf_file_out_name(const hf_file_out *file, char name[HF_FILE_OUT_NAME_SIZE]);

/* ---- files with fixed names ----
 * Both functions return a descriptor, or -1 and errno. */

int hf_file_out_create(const char *name); /* makes a new file to write; EEXIST if the name exists, also as a link */

/* Opens a file that stays, such as a lock, to read and write; makes it if it does not exist. errno is EEXIST if the
 * name is not that of an ordinary file with a single name. Otherwise links could direct the writing into any file. */
int hf_file_out_keep(const char *name, bool *was_there);

/* Makes a new file without a name and returns its descriptor, or -1 and errno. It is in the folder of the file
 * `beside`, or in the folder for temporary files if `beside` is NULL. It disappears when it is closed. */
int hf_file_out_scratch(const char *beside);

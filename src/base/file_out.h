/* file_out - the one door by which this program makes files.
 *
 * A file is written under a temporary name, brought to the disk, and renamed: nobody ever sees a half-written file, and
 * after a power cut there is the old file or the new one, whole. The temporary file of FOLDER/NAME is
 * FOLDER/.NAME.hifdm-<32 random hexadecimal digits>.tmp: nobody can put a link or a file there beforehand, nobody else
 * uses such names, and so what a killed process leaves can be told from what belongs to the user. While its process
 * lives, the temporary file is locked (fcntl, F_OFD_SETLK), so that no other process takes it for such a leftover. On a
 * file system without these locks leftovers stay.
 *
 * A symbolic link stands for the file that it leads to, if the user or root made it; links of others are refused, since
 * in a shared folder they could lead to any file of the user. The same holds for an output folder. A link of others
 * further up the path is refused where everybody may write (as in /tmp), and else followed. */
#ifndef HIFDM_FILE_OUT_H
#define HIFDM_FILE_OUT_H

#include <hifdm/status.h>
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>

#define HF_FILE_OUT_SIZE PATH_MAX /* the system refuses longer ones */

typedef struct {
    char path[HF_FILE_OUT_SIZE];      /* the visible name, links followed */
    char temporary[HF_FILE_OUT_SIZE]; /* beside it */
    int file;                         /* the temporary file, open to read and write, locked; -1: there is none */
    bool is_left;                     /* a temporary file of this path could not be removed */
} hf_file_out;

/* Make a temporary file for `path`, after removing what killed processes left there. HF_OK, or HF_IO with a message,
 * also when `path` is a device or another thing that is no ordinary file. */
hf_status hf_file_out_begin(const char *path, hf_file_out *file, hf_messages *messages);

/* Can the file be made? For a look before long work: makes the temporary file and removes it. HF_OK or HF_IO. */
hf_status hf_file_out_try(const char *path, hf_messages *messages);

/* The temporary file is written: give it the visible name, replacing what has it. HF_IO with a message and the
 * temporary file removed when that fails. Closes it in any case. */
hf_status hf_file_out_publish(hf_file_out *file, hf_messages *messages);
/* Closes and removes the temporary file, if there is one. Warns if that fails; messages: NULL for no warning. */
void hf_file_out_drop(hf_file_out *file, hf_messages *messages);

/* All of the above for a text: `write` puts it on the stream. HF_OK or HF_IO. */
hf_status hf_file_out_write(const char *path, void (*write)(const void *context, FILE *file), const void *context,
                            hf_messages *messages);

/* ---- files that belong together: all of them get their names, or none unless a rename fails ---- */

#define HF_FILE_OUT_SET_MAX 80

typedef struct {
    hf_file_out file[HF_FILE_OUT_SET_MAX];
    int n;
} hf_file_out_set;

/* A temporary file more, empty, in *file, which the set owns. HF_IO; HF_EXISTS when the set has this path already. */
hf_status hf_file_out_set_begin(hf_file_out_set *set, const char *path, hf_file_out **file, hf_messages *messages);

/* The same with a text in it, as hf_file_out_write. */
hf_status hf_file_out_set_write(hf_file_out_set *set, const char *path, void (*write)(const void *context, FILE *file),
                                const void *context, hf_messages *messages);

/* Publish all, once all are on the disk; or drop them when `status` is another than HF_OK, which is returned. */
hf_status hf_file_out_set_end(hf_file_out_set *set, hf_status status, hf_messages *messages);

/* ---- the parts, for files that live longer under their temporary name ----
 * Those that return an int return 0, or -1 and errno, so that the caller says what it was doing. */

/* The file that is meant by `path`: links are followed, also to where no file is yet. A path that leads to something
 * else than an ordinary file stays as it is. HF_IO when it is too long, or a link that somebody else made, whatever
 * that leads to. */
hf_status hf_file_out_target(const char *path, char target[HF_FILE_OUT_SIZE], hf_messages *messages);

/* Make a folder, unless it is there. HF_IO also when it is a link that somebody else made, with or without slashes and
 * dots behind it. */
hf_status hf_file_out_folder(const char *path, hf_messages *messages);

/* Is anything at `path`, or where it leads to? HF_IO when the system cannot tell: it is not to be replaced then. */
hf_status hf_file_out_look(const char *path, bool *is_there, hf_messages *messages);

/* HF_EXISTS when `output` leads to the file `input`, which no option lets an output replace; HF_IO when the system
 * cannot tell. what: what `input` is to the user, such as "the result itself". input may be NULL or "". */
hf_status hf_file_out_spare(const char *input, const char *what, const char *output, hf_messages *messages);

/* Remove the temporary files of `path` whose processes live no more. */
void hf_file_out_clean(const char *path);

int hf_file_out_make(const char *path, hf_file_out *file); /* a temporary file of `path`, whose links are followed */
int hf_file_out_sync(int file);                            /* its content is on the disk */
int hf_file_out_sync_folder(const char *path);             /* the name `path` is on the disk */

/* Gives the file `path` a second name, or its only one where the file system has no links. */
int hf_file_out_second_name(const char *path, const char *name);

/* Give the temporary file a name and close it; the second never replaces: EEXIST when the name is taken. When it has
 * its name but the close failed, file->file is -1. The second warns if the temporary name cannot be removed. */
int hf_file_out_replace(hf_file_out *file, const char *path);
int hf_file_out_add(hf_file_out *file, const char *path, hf_messages *messages);

/* A name under which a library opens the temporary file, and no other that has got its name meanwhile. */
#define HF_FILE_OUT_NAME_SIZE (HF_FILE_OUT_SIZE + 32)
void hf_file_out_name(const hf_file_out *file, char name[HF_FILE_OUT_NAME_SIZE]);

/* ---- files whose name is fixed ----
 * Both return a descriptor, or -1 and errno. */

int hf_file_out_create(const char *name); /* a new file to write; EEXIST when anything has the name, a link included */

/* A file that stays, such as a lock: opened to read and write, or made. EEXIST when the name is that of anything but an
 * ordinary file with one name: through links one could be led to write into any file. */
int hf_file_out_keep(const char *name, bool *was_there);

/* A new file without a name in the folder of the file `beside`, or of temporary files where that is NULL: its
 * descriptor, or -1 and errno. It is gone when it is closed. */
int hf_file_out_scratch(const char *beside);

#endif

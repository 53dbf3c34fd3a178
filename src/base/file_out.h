/* file_out - the one way to make a file: write it under a temporary name, bring it to the disk, rename it. Nobody ever
 * sees a half-written file, and after a power cut there is the old file or the new one, whole.
 *
 * The functions on names return 0, or -1 and errno, so that the caller says what it was doing. */
#ifndef HIFDM_FILE_OUT_H
#define HIFDM_FILE_OUT_H

#include <hifdm/status.h>

#include <limits.h>
#include <stdio.h>

#define HF_FILE_OUT_SIZE (PATH_MAX + 32) /* of a temporary name; the system refuses a path of PATH_MAX bytes */

typedef struct {
    const char *path;                 /* the visible name; borrowed */
    char temporary[HF_FILE_OUT_SIZE]; /* beside it, this process's own: <path>.<process id>.tmp */
} hf_file_out;

/* Choose the temporary name. Nothing is made yet. HF_OK, or HF_IO when the path is too long. */
hf_status hf_file_out_begin(const char *path, hf_file_out *file, hf_messages *messages);

/* Can the file be made? For a look before long work: makes the temporary file and removes it. HF_OK or HF_IO. */
hf_status hf_file_out_try(const char *path, hf_messages *messages);

/* The temporary file is written and closed: give it the visible name, replacing what has it. HF_IO with a message and
 * the temporary file removed when that fails. */
hf_status hf_file_out_publish(const hf_file_out *file, hf_messages *messages);
void hf_file_out_drop(const hf_file_out *file); /* remove the temporary file */

/* All of the above for a text: `write` puts it on the stream. HF_OK or HF_IO. */
hf_status hf_file_out_write(const char *path, void (*write)(const void *context, FILE *file), const void *context,
                            hf_messages *messages);

/* ---- on names, for files that live longer under their temporary name ---- */

int hf_file_out_create(const char *name); /* a new file to write; nothing may have the name. Returns its descriptor */
int hf_file_out_clear(const char *name);  /* remove what has the name, if anything has: it is never written into */
int hf_file_out_sync(const char *name);   /* a file's content, or a folder's list of names, is on the disk */
int hf_file_out_replace(const char *temporary, const char *path); /* rename(2) */
int hf_file_out_add(const char *temporary, const char *path);     /* never replaces: EEXIST when the name is taken */

#endif

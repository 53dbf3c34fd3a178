/* hdf5 - wrapper of HDF5 for the store: files, data sets, rows of data sets, attributes, the lock. Nothing here depends
 * on nets or results; what our files contain is in layout.h.
 *
 * Every call takes an hf_hdf5, records the first failure with the place where it happened, and does nothing once the
 * status is not HF_OK. A sequence of calls needs no check in between: check io->status at the end. After a failure ids
 * are negative, and closing them has no effect. */
#ifndef HIFDM_STORE_HDF5_H
#define HIFDM_STORE_HDF5_H

#include "base/child.h"
#include "base/file_out.h"
#include <hifdm/status.h>
#include <stdbool.h>
#include <stddef.h>

/* HDF5 1.12 and newer keep the calls of 1.10 under this. */
#define H5_USE_110_API
#include <hdf5.h>

typedef struct {
    const char *path; /* the file as messages call it; borrowed */
    hf_messages *messages;
    hf_status status; /* HF_OK, or of the first failure, which is in the messages */
    bool is_damaged;  /* the failure is one of the file's content, and will be there again; else one of the machine */
    hid_t file;
    char made_by[132]; /* the version of hifdm that made the file; "" = this one, or unknown */
} hf_hdf5;

/* Kinds of stored values, with the C type of each in arrays and attributes. */
typedef enum {
    HF_HDF5_REAL,   /* double */
    HF_HDF5_INT,    /* int */
    HF_HDF5_LONG,   /* long */
    HF_HDF5_UINT64, /* uint64_t */
    HF_HDF5_TEXT,   /* const char *: variable-length UTF-8, which h5py gives as str. Never read back here: HDF5 1.10
                       crashes on the damaged ones */
    HF_HDF5_CHARS,  /* char[length], padded with NULs: fixed-length UTF-8 */
    HF_HDF5_ENUM    /* signed char: one byte in the file, which also holds the words; h5dump and h5py show them */
} hf_hdf5_class;

/* Type of stored values. A new enumeration is a constant of this type. */
typedef struct {
    hf_hdf5_class class;
    int n_word; /* of an enumeration */
    const char *const *word;
    const signed char *value; /* [n_word] of each word; NULL: 0, 1, 2, ... */
} hf_hdf5_kind;

extern const hf_hdf5_kind hf_hdf5_number[4], hf_hdf5_text, hf_hdf5_chars, hf_hdf5_flag;
#define HF_KIND_REAL (&hf_hdf5_number[HF_HDF5_REAL])
#define HF_KIND_INT (&hf_hdf5_number[HF_HDF5_INT])
#define HF_KIND_LONG (&hf_hdf5_number[HF_HDF5_LONG])
#define HF_KIND_UINT64 (&hf_hdf5_number[HF_HDF5_UINT64])
#define HF_KIND_TEXT (&hf_hdf5_text)
#define HF_KIND_CHARS (&hf_hdf5_chars)
#define HF_KIND_FLAG (&hf_hdf5_flag) /* enumeration of 0 and 1, a bool in h5py */

/* Debian builds HDF5 without thread safety. Every public call of store and store_read holds this one lock, so that
 * several threads of a process may each have a store. It is a pthread mutex, not an OpenMP lock, because a caller may
 * make its threads in any way. hf_hdf5_unlock returns its argument. After hf_hdf5_quiet, called under the lock, HDF5
 * prints no errors in any thread that takes the lock. */
void hf_hdf5_lock(void);
bool hf_hdf5_try_lock(void); /* false: another thread has it */
void hf_hdf5_quiet(void);
hf_status hf_hdf5_unlock(hf_status status);

bool hf_hdf5_are_known(const hf_hdf5_kind *kind, const void *values, hsize_t n); /* has each a word? of HF_HDF5_ENUM */

size_t hf_hdf5_kind_bytes(const hf_hdf5_kind *kind); /* of one value in memory; not for HF_KIND_CHARS */

/* Where the path of the file that is being read is noted, for whoever has to tell after a crash: HF_HDF5_READING_SIZE
 * bytes, or NULL. Unless it is NULL, hf_hdf5_note, which is called before each object is read, also gives this process
 * HF_HDF5_CPU_S seconds of CPU time for it, because HDF5 may never come to an end with a damaged file; in a second it
 * unpacks more than 100 MB, and what is read at a time has less than a GB. With NULL for io, called when a file is
 * closed, the limit ends. */
#define HF_HDF5_READING_SIZE 4096
#define HF_HDF5_CPU_S 60
extern char *hf_hdf5_reading;
void hf_hdf5_note(const hf_hdf5 *io);

/* Does a child end as it should that does this work with the file at `path`? HF_OK, also when no child could be made;
 * HF_EXISTS: the file is damaged, `how` the child ended is in words; HF_IO with a message: the child was ended by what
 * says nothing about the file. Not under the lock. The work begins with hf_hdf5_limit, from which on the time is
 * limited, and changes nothing. */
void hf_hdf5_limit(void);
hf_status hf_hdf5_try(hf_child_work *work, const char *path, char *how, size_t size, hf_messages *messages);

/* Description of a data set: name, size, kind of its values. */
typedef struct {
    const char *name; /* below the group it is given with, perhaps with '/' */
    const hf_hdf5_kind *kind;
    int rank;                        /* 0 = a scalar */
    hsize_t dims[3];                 /* of HF_KIND_CHARS dims[rank] is the length of each string */
    const char *units, *description; /* kept as attributes; not needed for reading */
} hf_hdf5_array;

/* ---- Failures ----
 * Record the failure of the HDF5 call just made on `name` (may be NULL) below `place` (an id, or negative): HF_IO and
 * the message "path: cannot <verb> /place/name: <HDF5's or the system's reason>". Close nothing before. */
void hf_hdf5_fail(hf_hdf5 *io, const char *verb, hid_t place, const char *name);

/* Record that what is stored is not what this program writes: HF_IO, "path: is damaged: /place/name <what>". */
void hf_hdf5_damaged(hf_hdf5 *io, hid_t place, const char *name, const char *what);

/* Record that an object, or an attribute of it (may be NULL), is not there: the file is of another version
 * (io->made_by), or damaged. */
void hf_hdf5_missing(hf_hdf5 *io, hid_t place, const char *name, const char *attribute);

void hf_hdf5_no_memory(hf_hdf5 *io); /* record HF_NO_MEMORY */

/* ---- Files and groups ---- */

/* Both set io->file. Creating truncates an existing file. HDF5 locks the file if the file system supports it; if not,
 * that is no failure. */
void hf_hdf5_create_file(hf_hdf5 *io, const hf_file_out *file);   /* in the temporary file */
void hf_hdf5_open_to_write(hf_hdf5 *io, const hf_file_out *file); /* the temporary file holds one already */
void hf_hdf5_open_file(hf_hdf5 *io, const char *name);            /* to read; looks at it first */
void hf_hdf5_close_file(hf_hdf5 *io); /* no other id of the file may be open; also after a failure */

/* Is it an ordinary file with HDF5 in it? HDF5 itself would wait for who writes into a pipe. */
bool hf_hdf5_look_at_file(hf_hdf5 *io, const char *name);

void hf_hdf5_close(hf_hdf5 *io, hid_t id); /* of any kind, or negative; also after a failure */

hid_t hf_hdf5_make_group(hf_hdf5 *io, const char *path); /* or open it when it is there */
hid_t hf_hdf5_open_group(hf_hdf5 *io, const char *path);

/* Is there an object of this name, below `place` or from the root? A link of the path that is no hard one makes the
 * file a damaged one: HDF5 is never asked to follow it. */
bool hf_hdf5_has(hf_hdf5 *io, hid_t place, const char *name);

/* The one door to stored objects: opens a group (H5I_GROUP) or a data set (H5I_DATASET). What is not there, is another
 * thing, or is a data set whose values are not all in this file makes the file a damaged one. */
hid_t hf_hdf5_open(hf_hdf5 *io, hid_t place, const char *name, H5I_type_t wanted);

/* Visits every object below the root in the order of names, group by group: its path from the root, the open object and
 * its type; -1 and H5I_BADID for a link that is no hard one, which is not followed. The walk ends when io->status is
 * not HF_OK any more. */
typedef void hf_hdf5_visit(void *context, const char *path, hid_t object, H5I_type_t type);
void hf_hdf5_walk(hf_hdf5 *io, hf_hdf5_visit *visit, void *context);

/* ---- Data sets ---- */

/* New data set with its attributes. chunk: NULL, or [rank] for one that grows along its first dimension. */
hid_t hf_hdf5_make_array(hf_hdf5 *io, hid_t group, const hf_hdf5_array *array, const hsize_t *chunk);
void hf_hdf5_write_array(hf_hdf5 *io, hid_t group, const hf_hdf5_array *array, const void *values);

/* Rows [row, row + array->dims[0]) of a data set that grows, below `group`. Writing extends it as needed. */
void hf_hdf5_write_rows(hf_hdf5 *io, hid_t group, const hf_hdf5_array *array, hsize_t row, const void *values);
void hf_hdf5_read_rows(hf_hdf5 *io, hid_t group, const hf_hdf5_array *array, hsize_t row, void *values);

/* Read one string of fixed length into a new *text, which the caller frees. */
void hf_hdf5_read_text(hf_hdf5 *io, hid_t group, const char *name, char **text);

/* Write n >= 1 names as strings of one length. */
void hf_hdf5_write_ids(hf_hdf5 *io, hid_t group, const char *name, const char *const *id, int n,
                       const char *description);

/* Read the n and m ids of two data sets. id_a and id_b point into the block *text, which the caller frees. */
void hf_hdf5_read_ids(hf_hdf5 *io, hid_t group, const char *name_a, int n, const char **id_a, const char *name_b, int m,
                      const char **id_b, void **text);

hid_t hf_hdf5_array_type(const hf_hdf5_array *array); /* the caller closes it; negative after a failure of HDF5 */

/* Read exactly array->dims values. Other dimensions, other types and unknown values of enumerations are failures. */
void hf_hdf5_read_array(hf_hdf5 *io, hid_t group, const hf_hdf5_array *array, void *values);

/* The two checks of that. The first is made before values are read: with `all` the dimensions must be array->dims, else
 * rows [row, row + array->dims[0]) of them must be there. The second is about enumerations. */
void hf_hdf5_check_array(hf_hdf5 *io, hid_t group, const hf_hdf5_array *array, hid_t data_set, hsize_t row, bool all);
void hf_hdf5_check_values(hf_hdf5 *io, hid_t group, const hf_hdf5_array *array, const void *values);

/* First dimension of a data set, from 1 to `max`. 0 after a failure. */
int hf_hdf5_length(hf_hdf5 *io, hid_t group, const char *name, int max);

/* Length of each string of a data set of HF_KIND_CHARS, at least 1. 0 after a failure. */
size_t hf_hdf5_chars_length(hf_hdf5 *io, hid_t group, const char *name);

/* ---- Attributes of the object `name` below `place` ("." is `place` itself) ---- */

/* n values, 0 = a scalar; not for HF_KIND_CHARS. Putting replaces what is there. */
void hf_hdf5_put(hf_hdf5 *io, hid_t place, const char *name, const char *attribute, const hf_hdf5_kind *kind, hsize_t n,
                 const void *values);
void hf_hdf5_put_text(hf_hdf5 *io, hid_t place, const char *name, const char *attribute, const char *text);
void hf_hdf5_put_chars(hf_hdf5 *io, hid_t place, const char *name, const char *attribute, const char *text);

/* One value. HF_KIND_CHARS: a string into the `size` bytes at `value`, refused when it does not fit. */
void hf_hdf5_get(hf_hdf5 *io, hid_t place, const char *name, const char *attribute, const hf_hdf5_kind *kind,
                 void *value, size_t size);

/* Is there such an attribute, and is it a text of fixed length? */
bool hf_hdf5_has_chars(hf_hdf5 *io, hid_t place, const char *name, const char *attribute);

/* ---- Tables: one list of members serves writing and reading ---- */

/* A member of a struct <-> an attribute. Enumerations and HF_HDF5_INT are int, enum or bool in the struct, strings
 * char[size]. */
typedef struct {
    const char *object, *name;
    const hf_hdf5_kind *kind;
    size_t offset, size;
} hf_hdf5_member;

int hf_hdf5_int_value(const hf_hdf5_member *member, const void *owner); /* of HF_HDF5_ENUM and HF_HDF5_INT */

/* Of a file of another version (io->made_by), a figure that it has not is NaN, 0 or "". */
void hf_hdf5_put_members(hf_hdf5 *io, const hf_hdf5_member *table, int n, const void *owner);
void hf_hdf5_get_members(hf_hdf5 *io, const hf_hdf5_member *table, int n, void *owner);

#define HF_HDF5_MEMBER(type, object, name, member, kind)                                                               \
    {object, name, HF_KIND_##kind, offsetof(type, member), sizeof(((type *)0)->member)},

#define HF_HDF5_COUNT(table) ((int)(sizeof(table) / sizeof((table)[0])))

#endif

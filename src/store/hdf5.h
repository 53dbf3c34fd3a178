/* hdf5 - HDF5 as the store uses it: opening files, data sets, rows of them, attributes, the lock. It knows nothing of
 * nets and results; what our files contain is in layout.h.
 *
 * Every call takes an hf_hdf5, records the first failure with the place where it happened, and does nothing once the
 * status is not HF_OK. A sequence of calls needs no check in between: look at io->status at the end. Ids are negative
 * then, and closing them is harmless. */
#ifndef HIFDM_STORE_HDF5_H
#define HIFDM_STORE_HDF5_H

#include <hifdm/status.h>
#include <stddef.h>

/* HDF5 1.12 and newer keep the calls of 1.10 under this. */
#define H5_USE_110_API
#include <hdf5.h>

typedef struct {
    const char *path; /* the file as messages call it; borrowed */
    hf_messages *messages;
    hf_status status; /* HF_OK, or of the first failure, which is in the messages */
    hid_t file;
} hf_hdf5;

/* How a stored value looks, with the C type it has in arrays and attributes here. */
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

/* HDF5 as Debian builds it is not made for threads: every public call of store and store_read holds this one lock, so
 * that runs in threads of one process may each have a store. A pthread mutex and no OpenMP lock, because the threads
 * may be anybody's. hf_hdf5_unlock returns its argument. hf_hdf5_quiet, under the lock: every thread that takes it from
 * then on prints none of HDF5's errors. */
void hf_hdf5_lock(void);
int hf_hdf5_try_lock(void); /* 0: another thread has it */
void hf_hdf5_quiet(void);
hf_status hf_hdf5_unlock(hf_status status);

size_t hf_hdf5_kind_bytes(const hf_hdf5_kind *kind); /* of one value in memory; not for HF_KIND_CHARS */

/* A data set: what it is called, how large it is, what is in it. */
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

void hf_hdf5_no_memory(hf_hdf5 *io); /* HF_NO_MEMORY, unless something has failed before */

/* ---- Files and groups ---- */

/* Set io->file. What is in the file `name` is lost. Locks are taken where the file system has them, and their absence
 * is no failure. */
void hf_hdf5_create_file(hf_hdf5 *io, const char *name);
void hf_hdf5_open_file(hf_hdf5 *io, const char *name, int to_write);
void hf_hdf5_close_file(hf_hdf5 *io); /* nothing but the file may be open; closes after a failure, too */

void hf_hdf5_close(hf_hdf5 *io, hid_t id); /* of any kind, or negative; closes after a failure, too */

hid_t hf_hdf5_make_group(hf_hdf5 *io, const char *path); /* or open it when it is there */
hid_t hf_hdf5_open_group(hf_hdf5 *io, const char *path);
int hf_hdf5_has(hf_hdf5 *io, hid_t place, const char *name); /* is there a link of this name? */

/* The same from the root, over several groups: HDF5 has to be asked for every group on the way. */
int hf_hdf5_has_path(hf_hdf5 *io, const char *path);

/* ---- Data sets ---- */

/* New data set with its attributes. chunk: NULL, or [rank] for one that grows along its first dimension. */
hid_t hf_hdf5_make_array(hf_hdf5 *io, hid_t group, const hf_hdf5_array *array, const hsize_t *chunk);
void hf_hdf5_write_array(hf_hdf5 *io, hid_t group, const hf_hdf5_array *array, const void *values);

/* Rows [row, row + array->dims[0]) of a data set that grows, below `group`. Writing makes it larger when it must be. */
void hf_hdf5_write_rows(hf_hdf5 *io, hid_t group, const hf_hdf5_array *array, hsize_t row, const void *values);
void hf_hdf5_read_rows(hf_hdf5 *io, hid_t group, const hf_hdf5_array *array, hsize_t row, void *values);

/* One string that the file keeps with a fixed length, as a new text, *text, which the caller frees. */
void hf_hdf5_read_text(hf_hdf5 *io, hid_t group, const char *name, char **text);

/* n >= 1 names as strings of one length. */
void hf_hdf5_write_ids(hf_hdf5 *io, hid_t group, const char *name, const char *const *id, int n,
                       const char *description);

/* The n and m ids of two data sets, set in id_a and id_b, and the block that they point into (caller frees). */
void hf_hdf5_read_ids(hf_hdf5 *io, hid_t group, const char *name_a, int n, const char **id_a, const char *name_b, int m,
                      const char **id_b, void **text);

hid_t hf_hdf5_array_type(const hf_hdf5_array *array); /* the caller closes it; negative after a failure of HDF5 */

/* Read exactly array->dims values, refusing other dimensions, other types and foreign values of enumerations. */
void hf_hdf5_read_array(hf_hdf5 *io, hid_t group, const hf_hdf5_array *array, void *values);

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
int hf_hdf5_has_chars(hf_hdf5 *io, hid_t place, const char *name, const char *attribute);

/* ---- Tables: the same rows write and read, so that the two cannot diverge ---- */

/* A member of a struct <-> an attribute. Enumerations are int or enum in the struct, strings char[size]. */
typedef struct {
    const char *object, *name;
    const hf_hdf5_kind *kind;
    size_t offset, size;
} hf_hdf5_member;

void hf_hdf5_put_members(hf_hdf5 *io, const hf_hdf5_member *table, int n, const void *owner);
void hf_hdf5_get_members(hf_hdf5 *io, const hf_hdf5_member *table, int n, void *owner);

#define HF_HDF5_MEMBER(type, object, name, member, kind)                                                               \
    {object, name, HF_KIND_##kind, offsetof(type, member), sizeof(((type *)0)->member)},

#define HF_HDF5_COUNT(table) ((int)(sizeof(table) / sizeof((table)[0])))

#endif

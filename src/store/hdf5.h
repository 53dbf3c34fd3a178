/* hdf5 - wraps HDF5 for the store: files, data sets, rows of data sets, attributes and the lock. Nothing here depends
 * on nets or results; layout.h describes the content of our files.
 *
 * Every call takes an hf_hdf5 and records the first failure there. Once the status is not HF_OK, calls do nothing. A
 * sequence of calls therefore needs only one check of io->status, at its end. After a failure ids are negative, and
 * closing a negative id has no effect. */
#pragma once

#include "base/child.h"
#include "base/file_out.h"
#include <hifdm/status.h>
#include <stdbool.h>
#include <stddef.h>

/* HDF5 1.12 and newer have the calls of version 1.10 under this macro. */
#define H5_USE_110_API
#include <hdf5.h>

#define HF_HDF5_NAME_SIZE 1024 /* bytes of the path of an object */

/* Writes the k-th name that an object of today may have in a file of another version into object[]; k = 0, 1, ...
 * path: from the root. With `attribute` also the name of this attribute into name[]. Returns false if there is no k-th
 * name. A path of the other version stays as it is. */
typedef bool hf_hdf5_alias(const char *path, const char *attribute, int k, char object[HF_HDF5_NAME_SIZE],
                           char name[HF_HDF5_NAME_SIZE]);

typedef struct {
    const char *path; /* name of the file in messages; borrowed */
    hf_messages *messages;
    hf_status status; /* HF_OK, or the status of the first failure, whose message is in `messages` */
    bool is_damaged;  /* the failure lies in the content of the file and will recur; else in the machine */
    hid_t file;
    char made_by[132]; /* the version of hifdm that made the file; "" = this one, or unknown */
    hf_hdf5_alias
        *alias; /* the names in a file of another version, by which all calls read it; NULL: they are the same */
} hf_hdf5;

/* Kinds of stored values. Each comment gives the C type in arrays and attributes. */
typedef enum {
    HF_HDF5_REAL,   /* double */
    HF_HDF5_INT,    /* int */
    HF_HDF5_LONG,   /* long */
    HF_HDF5_UINT64, /* uint64_t */
    HF_HDF5_BYTE,   /* unsigned char */
    /* const char *: UTF-8 of variable length, which h5py returns as str. Never read back here, because HDF5 1.10
     * crashes on damaged texts of this kind. */
    HF_HDF5_TEXT,
    HF_HDF5_CHARS, /* char[length], padded with NULs: fixed-length UTF-8 */
    HF_HDF5_ENUM   /* signed char: one byte in the file, which also stores the words for h5dump and h5py */
} hf_hdf5_class;

/* Type of stored values. Each enumeration is a constant of this type. */
typedef struct {
    hf_hdf5_class class;
    int n_word; /* words of an enumeration; else 0 */
    const char *const *word;
    const signed char *value; /* [n_word] value of each word; NULL: 0, 1, 2, ... */
} hf_hdf5_kind;

extern const hf_hdf5_kind hf_hdf5_number[5], hf_hdf5_text, hf_hdf5_chars, hf_hdf5_flag;
#define HF_KIND_REAL (&hf_hdf5_number[HF_HDF5_REAL])
#define HF_KIND_INT (&hf_hdf5_number[HF_HDF5_INT])
#define HF_KIND_LONG (&hf_hdf5_number[HF_HDF5_LONG])
#define HF_KIND_UINT64 (&hf_hdf5_number[HF_HDF5_UINT64])
#define HF_KIND_BYTE (&hf_hdf5_number[HF_HDF5_BYTE])
#define HF_KIND_TEXT (&hf_hdf5_text)
#define HF_KIND_CHARS (&hf_hdf5_chars)
#define HF_KIND_FLAG (&hf_hdf5_flag) /* enumeration of 0 and 1, which h5py returns as bool */

/* The lock of HDF5. Debian builds HDF5 without thread safety. Every public call of store and store_read therefore holds
 * this one lock, so that several threads of a process may each have a store. It is a pthread mutex and not an OpenMP
 * lock, because the caller may create threads in any way.
 *
 * hf_hdf5_lock waits for the lock. hf_hdf5_unlock releases it and returns its argument. hf_hdf5_quiet, called under the
 * lock, switches off the error printing of HDF5 in every thread that takes the lock. */
void hf_hdf5_lock(void);
bool hf_hdf5_try_lock(void); /* does not wait; false: another thread has it */
void hf_hdf5_quiet(void);
hf_status hf_hdf5_unlock(hf_status status);

/* Returns true if each of the n values of an enumeration (HF_HDF5_ENUM) has a word. */
bool hf_hdf5_are_known(const hf_hdf5_kind *kind, const void *values, hsize_t n);

/* Returns the word of a value of an enumeration, "unknown" for a value without a word. */
const char *hf_hdf5_word(const hf_hdf5_kind *kind, int value);

/* Returns the bytes of one value in memory; not for HF_KIND_CHARS. */
size_t hf_hdf5_kind_bytes(const hf_hdf5_kind *kind);

/* hf_hdf5_reading points to HF_HDF5_READING_SIZE bytes for the path of the file that is being read, or is NULL. After a
 * crash the path shows which file is damaged.
 *
 * hf_hdf5_note does nothing if hf_hdf5_reading is NULL. Otherwise it writes the path there and allows this process
 * HF_HDF5_CPU_S more seconds of CPU time, because HDF5 may never finish with a damaged file. It is called before each
 * object is read. In one second HDF5 unpacks more than 100 MB, and less than 1 GB is read at a time. hf_hdf5_note(NULL)
 * ends the limit when a file is closed. */
#define HF_HDF5_READING_SIZE 4096
#define HF_HDF5_CPU_S 60
extern char *hf_hdf5_reading;
void hf_hdf5_note(const hf_hdf5 *io);

/* Tests in a child process whether work(path) ends normally. The caller must not hold the lock. The work must change
 * nothing, and begins with hf_hdf5_limit, after which hf_hdf5_note limits the CPU time. `command` is a command of
 * hf_child_spawn that does the same work, or NULL: then the child is a copy of this process. Returns HF_OK if the work
 * ended normally or if no child could be made. HF_EXISTS: the file is damaged, and how[size] describes the end of the
 * child. HF_IO with a message: the child was killed or reached a limit of the user. This proves nothing about the
 * file. */
void hf_hdf5_limit(void);
hf_status hf_hdf5_try(hf_child_work *work, const char *const *command, const char *path, char *how, size_t size,
                      hf_messages *messages);

/* Description of a data set: name, dimensions, kind of its values, and two attributes. */
typedef struct {
    const char *name; /* relative to the group of the call; may contain '/' */
    const hf_hdf5_kind *kind;
    int rank;                        /* 0 = a scalar */
    hsize_t dims[3];                 /* for HF_KIND_CHARS, dims[rank] is the length of each string */
    const char *units, *description; /* stored as attributes; not needed for reading */
} hf_hdf5_array;

/* ---- Failures ----
 * Records the failure of the last HDF5 call on `name` (may be NULL) below `place` (an id, or negative): HF_IO and the
 * message "path: cannot <verb> /place/name: <HDF5's or the system's reason>". Nothing may be closed before, because the
 * next call of HDF5 clears the reason. */
void hf_hdf5_fail(hf_hdf5 *io, const char *verb, hid_t place, const char *name);

/* Records that the stored data are not what this program writes: HF_IO, "path: is damaged: /place/name <what>". */
void hf_hdf5_damaged(hf_hdf5 *io, hid_t place, const char *name, const char *what);

/* Records that an object, or one of its attributes (`attribute`, else NULL), is missing: HF_IO. The file is from
 * another version (io->made_by) or damaged. */
void hf_hdf5_missing(hf_hdf5 *io, hid_t place, const char *name, const char *attribute);

void hf_hdf5_no_memory(hf_hdf5 *io); /* records HF_NO_MEMORY with a message */

/* Returns n items of zeros, which the caller frees. Returns NULL after a failure, also of this call. */
void *hf_hdf5_take(hf_hdf5 *io, size_t n, size_t bytes);

/* ---- Files and groups ---- */

/* The next three calls set io->file, which is -1 before. HDF5 locks a file that is opened to read, if the file system
 * supports locks; a file system without locks is no failure. Temporary files have a lock of their own (file_out). */
void hf_hdf5_create_file(hf_hdf5 *io, const hf_file_out *file);   /* makes a new HDF5 file in the temporary file */
void hf_hdf5_open_to_write(hf_hdf5 *io, const hf_file_out *file); /* opens the HDF5 file in the temporary file */
void hf_hdf5_open_file(hf_hdf5 *io, const char *name);            /* checks the file and opens it to read */
/* Closes the file; also after a failure. No other id of the file may be open. */
void hf_hdf5_close_file(hf_hdf5 *io);

/* Returns true if `name` is an ordinary file with HDF5 content. Otherwise records the failure. Without this check HDF5
 * would wait for a process that writes into a pipe. */
bool hf_hdf5_look_at_file(hf_hdf5 *io, const char *name);

/* Returns the name of an object below `place` in this file: `name`, or what the alias says, written into found[]. */
const char *hf_hdf5_name(hf_hdf5 *io, hid_t place, const char *name, char found[HF_HDF5_NAME_SIZE]);

/* Closes ids of any type; also after a failure. Negative ids are ignored. */
void hf_hdf5_close(hf_hdf5 *io, hid_t id);
void hf_hdf5_close_ids(hf_hdf5 *io, int n, const hid_t *id);
#define HF_HDF5_CLOSE(io, ...)                                                                                         \
    hf_hdf5_close_ids(io, (int)(sizeof((const hid_t[]){__VA_ARGS__}) / sizeof(hid_t)), (const hid_t[]){__VA_ARGS__})

hid_t hf_hdf5_make_group(hf_hdf5 *io, const char *path); /* makes the group, or opens it if it exists */
hid_t hf_hdf5_open_group(hf_hdf5 *io, const char *path);

/* Returns true if there is an object of this name below `place`; a path that begins with '/' starts at the root. HDF5
 * must never follow a soft or external link, so a path with such a link counts as damage. */
bool hf_hdf5_has(hf_hdf5 *io, hid_t place, const char *name);

/* Returns true if the existing object `name` is of this type. Does not look for names of another version. */
bool hf_hdf5_is(hf_hdf5 *io, hid_t place, const char *name, H5I_type_t type);

/* Opens a group (H5I_GROUP) or a data set (H5I_DATASET). All stored objects are opened here. Records damage if the
 * object is missing or of another type, or if the values of a data set are not all in this file. Returns a negative id
 * then. */
hid_t hf_hdf5_open(hf_hdf5 *io, hid_t place, const char *name, H5I_type_t wanted);

/* Visits every object below the root, group by group, in the order of names. The visitor gets the path from the root,
 * the open object and its type. A link that is not a hard link is reported with -1 and H5I_BADID and is not followed.
 * The walk ends as soon as io->status is not HF_OK. */
typedef void hf_hdf5_visit(void *context, const char *path, hid_t object, H5I_type_t type);
void hf_hdf5_walk(hf_hdf5 *io, hf_hdf5_visit *visit, void *context);

/* ---- Data sets ---- */

/* hf_hdf5_make_array makes a data set with its attributes and returns its id, which the caller closes. chunk: NULL, or
 * [rank] for a data set that grows along its first dimension; it has no rows at first. packs: as in
 * hf_hdf5_write_packed. hf_hdf5_write_array makes a data set of fixed size and writes all its values. */
hid_t hf_hdf5_make_array(hf_hdf5 *io, hid_t group, const hf_hdf5_array *array, const hsize_t *chunk, bool packs);
void hf_hdf5_write_array(hf_hdf5 *io, hid_t group, const hf_hdf5_array *array, const void *values);

/* Writes or reads rows row to row + array->dims[0] - 1 of a data set below `group` that grows. Writing sets its number
 * of rows to row + array->dims[0]. */
void hf_hdf5_write_rows(hf_hdf5 *io, hid_t group, const hf_hdf5_array *array, hsize_t row, const void *values);
void hf_hdf5_read_rows(hf_hdf5 *io, hid_t group, const hf_hdf5_array *array, hsize_t row, void *values);

/* hf_hdf5_write_list writes n values, or with columns > 0 n rows of so many. hf_hdf5_read_list reads them as
 * hf_hdf5_pass_array does. */
void hf_hdf5_write_list(hf_hdf5 *io, hid_t group, const char *name, const hf_hdf5_kind *kind, int n, int columns,
                        const char *units, const char *description, const void *values);
void hf_hdf5_read_list(hf_hdf5 *io, hid_t group, const char *name, const hf_hdf5_kind *kind, int n, int columns,
                       void *values);

/* Writes n values that only repeat or count. A large data set of them is compressed. */
void hf_hdf5_write_packed(hf_hdf5 *io, hid_t group, const char *name, const hf_hdf5_kind *kind, int n,
                          const char *description, const void *values);

/* Writes n >= 1 names, padded to the length of the longest. */
void hf_hdf5_write_ids(hf_hdf5 *io, hid_t group, const char *name, const char *const *id, int n,
                       const char *description);

/* Reads n strings of fixed length, or with n < 0 a scalar one, each with a NUL, into new memory [n][*size], which the
 * caller frees. Returns NULL after a failure to open the data set or to allocate. */
char *hf_hdf5_read_strings(hf_hdf5 *io, hid_t group, const char *name, int n, size_t *size);

/* Reads the n and m ids of two data sets. id_a [n] and id_b [m] then point into the new block *text, which the caller
 * frees. */
void hf_hdf5_read_ids(hf_hdf5 *io, hid_t group, const char *name_a, int n, const char **id_a, const char *name_b, int m,
                      const char **id_b, void **text);

/* Writes the values, or reads exactly array->dims values. Other dimensions, other types and unknown values of
 * enumerations are failures then. */
void hf_hdf5_pass_array(hf_hdf5 *io, bool writes, hid_t group, const hf_hdf5_array *array, void *values);

/* Returns the first dimension of a data set, 1 to `max`, or 0 after a failure. Other lengths are damage. */
int hf_hdf5_length(hf_hdf5 *io, hid_t group, const char *name, int max);

/* An open data set with its type and dimensions in the file. */
typedef struct {
    hid_t id, space, type;
    int rank; /* -1 after a failure */
    hsize_t dims[H5S_MAX_RANK];
} hf_hdf5_data_set;

/* hf_hdf5_close_data_set follows hf_hdf5_open_data_set in any case. hf_hdf5_take_strings reads all strings of fixed
 * length of an open data set into text [][size]; size: that of the stored strings and a NUL. */
void hf_hdf5_open_data_set(hf_hdf5 *io, hid_t place, const char *name, hf_hdf5_data_set *data_set);
void hf_hdf5_close_data_set(hf_hdf5 *io, hf_hdf5_data_set *data_set);
void hf_hdf5_take_strings(hf_hdf5 *io, hid_t group, const char *name, const hf_hdf5_data_set *data_set, size_t size,
                          char *text);

/* ---- Attributes of the object `name` below `place` ("." is `place` itself) ---- */

/* hf_hdf5_put writes n values (n = 0: a scalar) as an attribute and replaces an attribute of the same name. It does not
 * take HF_KIND_CHARS. hf_hdf5_put_text writes a text of variable length, hf_hdf5_put_chars one of fixed length, and
 * hf_hdf5_put_ascii one of fixed length that is declared as ASCII and not empty. */
void hf_hdf5_put(hf_hdf5 *io, hid_t place, const char *name, const char *attribute, const hf_hdf5_kind *kind, hsize_t n,
                 const void *values);
void hf_hdf5_put_text(hf_hdf5 *io, hid_t place, const char *name, const char *attribute, const char *text);
void hf_hdf5_put_chars(hf_hdf5 *io, hid_t place, const char *name, const char *attribute, const char *text);
void hf_hdf5_put_ascii(hf_hdf5 *io, hid_t place, const char *name, const char *attribute, const char *text);

/* Reads one value. HF_KIND_CHARS: reads a string with its NUL into the `size` bytes at `value`; a longer string is
 * damage. A missing attribute is a failure (hf_hdf5_missing). */
void hf_hdf5_get(hf_hdf5 *io, hid_t place, const char *name, const char *attribute, const hf_hdf5_kind *kind,
                 void *value, size_t size);

/* Copies an attribute to another object or name; replaces one of the same name. */
void hf_hdf5_copy_attribute(hf_hdf5 *io, const char *from, const char *from_name, const char *to, const char *to_name);

/* Returns true if the attribute exists. */
bool hf_hdf5_has_attribute(hf_hdf5 *io, hid_t place, const char *name, const char *attribute);

/* Returns true if the attribute exists and is a text of fixed length. */
bool hf_hdf5_has_chars(hf_hdf5 *io, hid_t place, const char *name, const char *attribute);

#define HF_HDF5_COUNT(table) ((int)(sizeof(table) / sizeof((table)[0])))

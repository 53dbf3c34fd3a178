/* Implements the calls of hdf5.h that make, write and read files, groups, data sets and attributes. Sections: failures,
 * types, files and groups, writing data sets, reading data sets, strings, data sets that grow, attributes. */
#include "store/hdf5.h"

#include <assert.h>
#include <limits.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define OPEN_BYTES (8 << 20) /* HDF5 1.10.8 needs less than 3 MB to open a file */

/* ---- failures ---- */

#define WHERE_SIZE (HF_HDF5_NAME_SIZE + 256)

typedef struct {
    char words[256]; /* "": HDF5 gives no reason */
    bool is_of_system, is_no_memory;
} hdf5_reason;

/* Keeps the first, innermost entry of HDF5's error stack. If the entry is about a system call, keeps only the words of
 * the system. */
static herr_t keep_reason(unsigned n, const H5E_error2_t *entry, void *context)
{
    static const char key[] = "error message = '";
    hdf5_reason *reason = context;
    (void)n;
    const char *desc = entry->desc ? entry->desc : "", *from = strstr(desc, key);
    if (from)
        snprintf(reason->words, sizeof reason->words, "%.*s", (int)strcspn(from + sizeof key - 1, "'"),
                 from + sizeof key - 1);
    else
        snprintf(reason->words, sizeof reason->words, "%s", desc);
    reason->is_of_system = from != NULL;
    reason->is_no_memory = entry->min_num == H5E_NOSPACE;
    return 1;
}

/* Writes the path of an object from the root into path[]. The name "." means the place itself. */
static void absolute_path(hid_t place, const char *name, char path[HF_HDF5_NAME_SIZE])
{
    char group[HF_HDF5_NAME_SIZE] = "";
    if (*name != '/' && H5Iget_name(place, group, sizeof group) < 0) group[0] = '\0';
    if (!strcmp(group, "/")) group[0] = '\0';
    bool is_place = !strcmp(name, ".");
    snprintf(path, HF_HDF5_NAME_SIZE, "%.500s%s%.500s", group, is_place || *name == '/' ? "" : "/",
             is_place && *group ? ""
             : is_place         ? "/"
                                : name);
}

/* Writes "/group/name", or "attribute a of /group/name", into text[]. */
static void full_name(hid_t place, const char *name, const char *attribute, char text[WHERE_SIZE])
{
    char path[HF_HDF5_NAME_SIZE] = "";
    if (place >= 0 || name) absolute_path(place, name ? name : ".", path);
    snprintf(text, WHERE_SIZE, "%s%.200s%s%s", attribute ? "attribute " : "", attribute ? attribute : "",
             attribute ? " of " : "", path);
}

static void fail_at(hf_hdf5 *io, const char *verb, hid_t place, const char *name, const char *attribute)
{
    char where[WHERE_SIZE];
    hdf5_reason reason = {.words = ""};
    if (io->status != HF_OK) return;
    H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_reason, &reason); /* before the next HDF5 call clears the error stack */
    full_name(place, name, attribute, where);
    io->is_damaged = *reason.words && !reason.is_of_system && !reason.is_no_memory;
    io->status = hf_error(io->messages, reason.is_no_memory ? HF_NO_MEMORY : HF_IO, "%s: cannot %s%s%s: %s", io->path,
                          verb, *where ? " " : "", where, *reason.words ? reason.words : "HDF5 gives no reason");
}

static void damaged_at(hf_hdf5 *io, hid_t place, const char *name, const char *attribute, const char *what)
{
    char where[WHERE_SIZE];
    if (io->status != HF_OK) return;
    full_name(place, name, attribute, where);
    io->is_damaged = true;
    io->status = hf_error(io->messages, HF_IO, "%s: this file is damaged: %s %s", io->path, where, what);
}

void hf_hdf5_missing(hf_hdf5 *io, hid_t place, const char *name, const char *attribute)
{
    char where[WHERE_SIZE];
    if (*io->made_by == '\0') damaged_at(io, place, name, attribute, "is not there");
    if (io->status != HF_OK) return;
    full_name(place, name, attribute, where);
    io->is_damaged = true;
    io->status = hf_error(io->messages, HF_IO,
                          "%s: this file of hifdm %s does not contain %s, which this version needs. Run the case "
                          "again, or read the file with the version that wrote the file",
                          io->path, io->made_by, where);
}

void hf_hdf5_no_memory(hf_hdf5 *io)
{
    if (io->status == HF_OK) io->status = hf_error(io->messages, HF_NO_MEMORY, "%s: out of memory", io->path);
}

void *hf_hdf5_take(hf_hdf5 *io, size_t n, size_t bytes)
{
    void *items = io->status == HF_OK ? calloc(n, bytes) : NULL;
    if (!items) hf_hdf5_no_memory(io);
    return items;
}

void hf_hdf5_fail(hf_hdf5 *io, const char *verb, hid_t place, const char *name)
{
    fail_at(io, verb, place, name, NULL);
}

void hf_hdf5_damaged(hf_hdf5 *io, hid_t place, const char *name, const char *what)
{
    damaged_at(io, place, name, NULL, what);
}

/* ---- types ---- */

/* Returns the id, or -1 after closing it if what was set in it has failed. */
static hid_t checked(hid_t id, bool ok)
{
    if (id >= 0 && !ok) H5Idec_ref(id);
    return ok ? id : -1;
}

const hf_hdf5_kind hf_hdf5_number[5] = {{.class = HF_HDF5_REAL},
                                        {.class = HF_HDF5_INT},
                                        {.class = HF_HDF5_LONG},
                                        {.class = HF_HDF5_UINT64},
                                        {.class = HF_HDF5_BYTE}};
const hf_hdf5_kind hf_hdf5_text = {.class = HF_HDF5_TEXT}, hf_hdf5_chars = {.class = HF_HDF5_CHARS};
static const char *const flag_word[2] = {"FALSE", "TRUE"}; /* names that h5py reads as bool */
const hf_hdf5_kind hf_hdf5_flag = {HF_HDF5_ENUM, 2, flag_word, NULL};

/* Returns the value of word i of an enumeration. */
static signed char value_at(const hf_hdf5_kind *kind, int i)
{
    return kind->value ? kind->value[i] : (signed char)i;
}

size_t hf_hdf5_kind_bytes(const hf_hdf5_kind *kind)
{
    static const size_t bytes[] = {
        sizeof(double), sizeof(int), sizeof(long), sizeof(uint64_t), 1, sizeof(char *), 1, 1};
    return bytes[kind->class];
}

static hid_t make_enum(const hf_hdf5_kind *kind)
{
    hid_t type = H5Tenum_create(H5T_NATIVE_SCHAR);
    bool ok = type >= 0;
    for (int i = 0; ok && i < kind->n_word; i++) {
        signed char value = value_at(kind, i);
        ok = H5Tenum_insert(type, kind->word[i], &value) >= 0;
    }
    return checked(type, ok);
}

/* Makes a type of strings. length: bytes of each string, or H5T_VARIABLE. */
static hid_t make_string(size_t length, H5T_cset_t characters)
{
    hid_t type = H5Tcopy(H5T_C_S1);
    return checked(type, type >= 0 && H5Tset_size(type, length) >= 0 && H5Tset_cset(type, characters) >= 0 &&
                             (length == H5T_VARIABLE || H5Tset_strpad(type, H5T_STR_NULLPAD) >= 0));
}

/* Makes the HDF5 type of a kind, which the caller closes; negative after a failure of HDF5. length: bytes of each
 * string of HF_KIND_CHARS. */
static hid_t make_type(const hf_hdf5_kind *kind, hsize_t length)
{
    const hid_t number[] = {H5T_NATIVE_DOUBLE, H5T_NATIVE_INT, H5T_NATIVE_LONG, H5T_NATIVE_UINT64, H5T_NATIVE_UCHAR};
    if (kind->class == HF_HDF5_ENUM) return make_enum(kind);
    if (kind->class <= HF_HDF5_BYTE) return H5Tcopy(number[kind->class]);
    return make_string(kind->class == HF_HDF5_TEXT ? H5T_VARIABLE : (size_t)length, H5T_CSET_UTF8);
}

static hid_t array_type(const hf_hdf5_array *a)
{
    return make_type(a->kind, a->kind == HF_KIND_CHARS ? a->dims[a->rank] : 0);
}

/* Makes the type by which values of this kind are read. Enumerations are read by their numbers, which never change;
 * their words may be those of another version. */
static hid_t make_read_type(const hf_hdf5_kind *kind, hsize_t length)
{
    return kind->class == HF_HDF5_ENUM ? H5Tcopy(H5T_NATIVE_SCHAR) : make_type(kind, length);
}

/* Returns true if values of this stored type can be read as `kind`. */
static bool is_of_kind(hid_t stored, const hf_hdf5_kind *kind)
{
    H5T_class_t class = H5Tget_class(stored);
    if (kind->class == HF_HDF5_ENUM) return class == H5T_ENUM && H5Tget_size(stored) == 1;
    if (kind == HF_KIND_CHARS) return class == H5T_STRING && H5Tis_variable_str(stored) == 0;
    assert(kind != HF_KIND_TEXT);
    return class == (kind == HF_KIND_REAL ? H5T_FLOAT : H5T_INTEGER);
}

bool hf_hdf5_are_known(const hf_hdf5_kind *kind, const void *values, hsize_t n)
{
    bool known[UCHAR_MAX + 1] = {false};
    const unsigned char *bytes = values;
    for (int i = 0; i < kind->n_word; i++)
        known[(unsigned char)value_at(kind, i)] = true;
    for (hsize_t i = 0; i < n; i++)
        if (!known[bytes[i]]) return false;
    return true;
}

const char *hf_hdf5_word(const hf_hdf5_kind *kind, int value)
{
    for (int i = 0; i < kind->n_word; i++)
        if (value_at(kind, i) == value) return kind->word[i];
    return "unknown";
}

/* ---- names in files of another version ---- */

/* Returns true if there is an object at this path. A link in it is not followed, but counts. */
static bool is_there(hf_hdf5 *io, const char *path)
{
    hf_hdf5_alias *alias = io->alias;
    io->alias = NULL;
    bool is = hf_hdf5_has(io, io->file, path);
    io->alias = alias;
    return is;
}

const char *hf_hdf5_name(hf_hdf5 *io, hid_t place, const char *name, char found[HF_HDF5_NAME_SIZE])
{
    char path[HF_HDF5_NAME_SIZE];
    if (!io->alias || io->status != HF_OK) return name;
    absolute_path(place, name, path);
    for (int k = 0; io->alias(path, NULL, k, found, NULL); k++)
        if (is_there(io, found)) return found;
    return name;
}

/* ---- files and groups ---- */

void hf_hdf5_close_ids(hf_hdf5 *io, int n, const hid_t *id)
{
    for (int i = 0; i < n; i++)
        if (id[i] >= 0 && (H5Iget_type(id[i]) == H5I_FILE ? H5Fclose(id[i]) : H5Idec_ref(id[i])) < 0)
            hf_hdf5_fail(io, "close", -1, NULL);
}

void hf_hdf5_close(hf_hdf5 *io, hid_t id)
{
    hf_hdf5_close_ids(io, 1, &id);
}

/* Makes properties of a new object. They leave out the creation time, so that equal results have equal bytes. */
static hid_t make_properties(hid_t class)
{
    hid_t properties = H5Pcreate(class);
    return checked(properties, properties >= 0 && H5Pset_obj_track_times(properties, 0) >= 0);
}

/* Makes the access properties of a file: the format of HDF5 1.8, whose object headers have checksums and which all
 * current programs read. Temporary files have a lock already (file_out). The lock of HDF5 would conflict with it on
 * file systems that do not distinguish the two kinds of locks. */
static hid_t make_access(bool locks)
{
    hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    bool ok = access >= 0 && H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_V18) >= 0;
#if H5_VERSION_GE(1, 10, 7)
    ok = ok && H5Pset_file_locking(access, locks, 1) >= 0;
#endif
    return checked(access, ok);
}

/* Returns true if there is memory to open a file. HDF5 1.10 crashes if it gets no memory for the caches of the file.
 * OPEN_BYTES is more than HDF5 needs, because other threads may take memory between this test and the call. */
static bool has_memory(hf_hdf5 *io)
{
    void *room = malloc(OPEN_BYTES);
    free(room);
    if (!room) hf_hdf5_no_memory(io);
    return room != NULL;
}

void hf_hdf5_create_file(hf_hdf5 *io, const hf_file_out *file)
{
    hid_t properties = -1, access = -1;
    char name[HF_FILE_OUT_NAME_SIZE];
    hf_file_out_name(file, name);
    if (!has_memory(io)) return;
    if ((properties = make_properties(H5P_FILE_CREATE)) < 0 || (access = make_access(false)) < 0 ||
        (io->file = H5Fcreate(name, H5F_ACC_TRUNC, properties, access)) < 0)
        hf_hdf5_fail(io, "create", -1, NULL);
    HF_HDF5_CLOSE(io, access, properties);
}

static void open_file(hf_hdf5 *io, const char *name, unsigned how, bool locks)
{
    hf_hdf5_note(io);
    if (!has_memory(io)) return;
    hid_t access = make_access(locks);
    io->file = access < 0 ? -1 : H5Fopen(name, how, access);
    if (io->file < 0) hf_hdf5_fail(io, "open", -1, NULL);
    hf_hdf5_close(io, access);
}

void hf_hdf5_open_file(hf_hdf5 *io, const char *name)
{
    if (hf_hdf5_look_at_file(io, name)) open_file(io, name, H5F_ACC_RDONLY, true);
}

void hf_hdf5_open_to_write(hf_hdf5 *io, const hf_file_out *file)
{
    char name[HF_FILE_OUT_NAME_SIZE];
    hf_file_out_name(file, name);
    open_file(io, name, H5F_ACC_RDWR, false);
}

void hf_hdf5_close_file(hf_hdf5 *io)
{
    if (io->file >= 0) {
        /* Either an object is still open, or HDF5 takes the file for an earlier file of this inode that it could not
         * close. */
        if (io->status == HF_OK && H5Fget_obj_count(io->file, H5F_OBJ_ALL | H5F_OBJ_LOCAL) != 1)
            hf_hdf5_fail(io, "close", -1, NULL);
        hf_hdf5_close(io, io->file);
    }
    io->file = -1;
    hf_hdf5_note(NULL);
}

hid_t hf_hdf5_make_group(hf_hdf5 *io, const char *path)
{
    hid_t properties = -1, group = -1;
    if (io->status == HF_OK && hf_hdf5_has(io, io->file, path)) return hf_hdf5_open_group(io, path);
    if (io->status != HF_OK) return -1;
    if ((properties = make_properties(H5P_GROUP_CREATE)) < 0 ||
        (group = H5Gcreate2(io->file, path, H5P_DEFAULT, properties, H5P_DEFAULT)) < 0)
        hf_hdf5_fail(io, "write", -1, path);
    hf_hdf5_close(io, properties);
    return group;
}

hid_t hf_hdf5_open_group(hf_hdf5 *io, const char *path)
{
    return io->status == HF_OK ? hf_hdf5_open(io, io->file, path, H5I_GROUP) : -1;
}

/* ---- making and writing data sets ---- */

/* Makes the data space of a new data set. HDF5 requires that each chunk fits within the maximum dimensions and that no
 * chunk is empty. A fixed dimension of 0 therefore gets the maximum 1. */
static hid_t make_space(const hf_hdf5_array *a, bool grows)
{
    hsize_t dims[3], max[3];
    for (int i = 0; i < a->rank; i++) {
        dims[i] = grows && i == 0 ? 0 : a->dims[i];
        max[i] = grows && i == 0 ? H5S_UNLIMITED : a->dims[i] ? a->dims[i] : 1;
    }
    return H5Screate_simple(a->rank, dims, grows ? max : NULL);
}

#define PACKED_MIN 4096 /* bytes from which data sets are compressed; the tables of a chunk take 2 KiB */

/* Makes the properties of a data set that grows by chunks, or whose values are packed in one chunk. */
static hid_t make_layout(const hf_hdf5_array *a, const hsize_t *chunk, bool packs)
{
    hid_t properties = make_properties(H5P_DATASET_CREATE);
    bool ok = properties >= 0;
    if (ok && chunk) /* chunks are written before they are read */
        ok = H5Pset_chunk(properties, a->rank, chunk) >= 0 && H5Pset_fill_time(properties, H5D_FILL_TIME_NEVER) >= 0;
    if (ok && packs && a->dims[0] * hf_hdf5_kind_bytes(a->kind) >= PACKED_MIN &&
        H5Zfilter_avail(H5Z_FILTER_DEFLATE) > 0)
        ok = H5Pset_chunk(properties, 1, a->dims) >= 0 && H5Pset_shuffle(properties) >= 0 &&
             H5Pset_deflate(properties, 1) >= 0;
    return checked(properties, ok);
}

hid_t hf_hdf5_make_array(hf_hdf5 *io, hid_t group, const hf_hdf5_array *a, const hsize_t *chunk, bool packs)
{
    hid_t type = -1, space = -1, properties = -1, data_set = -1;
    if (io->status != HF_OK) return -1;
    if ((type = array_type(a)) < 0 || (space = make_space(a, chunk != NULL)) < 0 ||
        (properties = make_layout(a, chunk, packs)) < 0 ||
        (data_set = H5Dcreate2(group, a->name, type, space, H5P_DEFAULT, properties, H5P_DEFAULT)) < 0)
        hf_hdf5_fail(io, "write", group, a->name);
    HF_HDF5_CLOSE(io, properties, space, type);
    hf_hdf5_put_text(io, data_set, ".", "units", a->units);
    hf_hdf5_put_text(io, data_set, ".", "description", a->description);
    return data_set;
}

static void write_values(hf_hdf5 *io, hid_t group, const hf_hdf5_array *a, bool packs, const void *values)
{
    hid_t data_set = hf_hdf5_make_array(io, group, a, NULL, packs), type = -1;
    if (io->status == HF_OK) {
        type = array_type(a);
        if (type < 0 || H5Dwrite(data_set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0)
            hf_hdf5_fail(io, "write", group, a->name);
    }
    HF_HDF5_CLOSE(io, type, data_set);
}

void hf_hdf5_write_array(hf_hdf5 *io, hid_t group, const hf_hdf5_array *a, const void *values)
{
    write_values(io, group, a, false, values);
}

void hf_hdf5_write_packed(hf_hdf5 *io, hid_t group, const char *name, const hf_hdf5_kind *kind, int n,
                          const char *description, const void *values)
{
    write_values(io, group, &(hf_hdf5_array){name, kind, 1, {(hsize_t)n}, "", description}, true, values);
}

void hf_hdf5_write_list(hf_hdf5 *io, hid_t group, const char *name, const hf_hdf5_kind *kind, int n, int columns,
                        const char *units, const char *description, const void *values)
{
    const hf_hdf5_array array = {name, kind, columns ? 2 : 1, {(hsize_t)n, (hsize_t)columns}, units, description};
    hf_hdf5_write_array(io, group, &array, values);
}

void hf_hdf5_write_ids(hf_hdf5 *io, hid_t group, const char *name, const char *const *id, int n,
                       const char *description)
{
    size_t length = 1;
    for (int i = 0; i < n; i++)
        length = strlen(id[i]) > length ? strlen(id[i]) : length;
    hf_hdf5_array array = {name, HF_KIND_CHARS, 1, {(hsize_t)n, length}, "", description};
    char *chars = hf_hdf5_take(io, (size_t)n, length);
    for (int i = 0; chars && i < n; i++)
        memcpy(chars + (size_t)i * length, id[i], strlen(id[i]));
    if (chars) hf_hdf5_write_array(io, group, &array, chars);
    free(chars);
}

/* ---- reading data sets ---- */

void hf_hdf5_open_data_set(hf_hdf5 *io, hid_t place, const char *name, hf_hdf5_data_set *d)
{
    *d = (hf_hdf5_data_set){.id = -1, .space = -1, .type = -1, .rank = -1};
    if (io->status == HF_OK) d->id = hf_hdf5_open(io, place, name, H5I_DATASET);
    if (io->status == HF_OK &&
        ((d->space = H5Dget_space(d->id)) < 0 || (d->rank = H5Sget_simple_extent_dims(d->space, d->dims, NULL)) < 0 ||
         (d->type = H5Dget_type(d->id)) < 0))
        hf_hdf5_fail(io, "read", place, name);
}

void hf_hdf5_close_data_set(hf_hdf5 *io, hf_hdf5_data_set *d)
{
    HF_HDF5_CLOSE(io, d->type, d->space, d->id);
}

/* Selects rows row to row + dims[0] - 1 in the data space of a file. Returns the data space of the values, which the
 * caller closes, or -1 after a failure. */
static hid_t select_rows(const hf_hdf5_array *a, hsize_t row, hid_t space)
{
    hsize_t start[3] = {row, 0, 0};
    if (H5Sget_simple_extent_ndims(space) != a->rank ||
        H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, a->dims, NULL) < 0)
        return -1;
    return H5Screate_simple(a->rank, a->dims, NULL);
}

/* Reads a data set, or only the rows from `row` on. Before, it compares type and dimensions; after, it checks that
 * values of an enumeration have words. */
static void read_values(hf_hdf5 *io, hid_t group, const hf_hdf5_array *a, bool all, hsize_t row, void *values)
{
    hf_hdf5_data_set d;
    hid_t type = -1, memory = H5S_ALL;
    hsize_t n = 1;
    hf_hdf5_open_data_set(io, group, a->name, &d);
    bool fits = d.rank == a->rank;
    for (int i = 0; i < a->rank; i++) {
        fits = fits && (i > 0 || all ? d.dims[i] == a->dims[i] : row <= d.dims[0] && a->dims[0] <= d.dims[0] - row);
        n *= a->dims[i];
    }
    if (io->status == HF_OK && !fits)
        hf_hdf5_damaged(io, group, a->name, "has other dimensions than the rest of the file asks for");
    if (io->status == HF_OK && !is_of_kind(d.type, a->kind)) hf_hdf5_damaged(io, group, a->name, "is of another type");
    if (io->status == HF_OK && ((type = make_read_type(a->kind, a->kind == HF_KIND_CHARS ? a->dims[a->rank] : 0)) < 0 ||
                                (!all && (memory = select_rows(a, row, d.space)) < 0) ||
                                H5Dread(d.id, type, memory, all ? H5S_ALL : d.space, H5P_DEFAULT, values) < 0))
        hf_hdf5_fail(io, "read", group, a->name);
    if (io->status == HF_OK && a->kind->class == HF_HDF5_ENUM && !hf_hdf5_are_known(a->kind, values, n))
        hf_hdf5_damaged(io, group, a->name, "holds a value that has no word");
    if (memory != H5S_ALL) hf_hdf5_close(io, memory);
    hf_hdf5_close(io, type);
    hf_hdf5_close_data_set(io, &d);
}

void hf_hdf5_read_list(hf_hdf5 *io, hid_t group, const char *name, const hf_hdf5_kind *kind, int n, int columns,
                       void *values)
{
    const hf_hdf5_array array = {name, kind, columns ? 2 : 1, {(hsize_t)n, (hsize_t)columns}, "", ""};
    read_values(io, group, &array, true, 0, values);
}

void hf_hdf5_pass_array(hf_hdf5 *io, bool writes, hid_t group, const hf_hdf5_array *a, void *values)
{
    if (writes)
        hf_hdf5_write_array(io, group, a, values);
    else
        read_values(io, group, a, true, 0, values);
}

int hf_hdf5_length(hf_hdf5 *io, hid_t group, const char *name, int max)
{
    hf_hdf5_data_set d;
    hf_hdf5_open_data_set(io, group, name, &d);
    if (io->status == HF_OK && (d.rank < 1 || d.dims[0] < 1 || d.dims[0] > (hsize_t)max))
        hf_hdf5_damaged(io, group, name, "is empty or too large");
    hf_hdf5_close_data_set(io, &d);
    return io->status == HF_OK ? (int)d.dims[0] : 0;
}

/* ---- strings ---- */

/* Opens a data set of n strings of fixed length; n < 0: a scalar. Returns the bytes of each with a NUL. */
static size_t open_strings(hf_hdf5 *io, hid_t group, const char *name, int n, hf_hdf5_data_set *d)
{
    hf_hdf5_open_data_set(io, group, name, d);
    if (io->status == HF_OK && !is_of_kind(d->type, HF_KIND_CHARS))
        hf_hdf5_damaged(io, group, name, "is of another type");
    if (io->status == HF_OK && (d->rank != (n >= 0) || (n >= 0 && d->dims[0] != (hsize_t)n)))
        hf_hdf5_damaged(io, group, name, "has other dimensions than the rest of the file asks for");
    return io->status == HF_OK ? H5Tget_size(d->type) + 1 : 0;
}

void hf_hdf5_take_strings(hf_hdf5 *io, hid_t group, const char *name, const hf_hdf5_data_set *d, size_t size,
                          char *text)
{
    hid_t type = H5Tcopy(H5T_C_S1);
    if (type < 0 || H5Tset_size(type, size) < 0 || H5Tset_cset(type, H5Tget_cset(d->type)) < 0 ||
        H5Dread(d->id, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text) < 0)
        hf_hdf5_fail(io, "read", group, name);
    hf_hdf5_close(io, type);
}

char *hf_hdf5_read_strings(hf_hdf5 *io, hid_t group, const char *name, int n, size_t *size)
{
    hf_hdf5_data_set d;
    *size = open_strings(io, group, name, n, &d);
    char *text = hf_hdf5_take(io, n < 0 ? 1 : (size_t)n, *size);
    if (text) hf_hdf5_take_strings(io, group, name, &d, *size, text);
    hf_hdf5_close_data_set(io, &d);
    return text;
}

void hf_hdf5_read_ids(hf_hdf5 *io, hid_t group, const char *name_a, int n, const char **id_a, const char *name_b, int m,
                      const char **id_b, void **text)
{
    hf_hdf5_data_set a, b;
    size_t size_a = open_strings(io, group, name_a, n, &a), size_b = open_strings(io, group, name_b, m, &b);
    char *of_a = hf_hdf5_take(io, 1, (size_t)n * size_a + (size_t)m * size_b);
    if (of_a) {
        char *of_b = of_a + (size_t)n * size_a;
        *text = of_a;
        hf_hdf5_take_strings(io, group, name_a, &a, size_a, of_a);
        if (io->status == HF_OK) hf_hdf5_take_strings(io, group, name_b, &b, size_b, of_b);
        for (int i = 0; i < n; i++)
            id_a[i] = of_a + (size_t)i * size_a;
        for (int i = 0; i < m; i++)
            id_b[i] = of_b + (size_t)i * size_b;
    }
    hf_hdf5_close_data_set(io, &b);
    hf_hdf5_close_data_set(io, &a);
}

/* ---- data sets that grow ---- */

/* Opens a data set without HDF5's cache of chunks. Many rows come at a time, so the cache would only copy them once
 * more. */
static hid_t open_uncached(hid_t group, const char *name)
{
    hid_t access = H5Pcreate(H5P_DATASET_ACCESS), data_set = -1;
    if (access >= 0 && H5Pset_chunk_cache(access, 1, 0, 1) >= 0) data_set = H5Dopen2(group, name, access);
    if (access >= 0) H5Pclose(access);
    return data_set;
}

void hf_hdf5_write_rows(hf_hdf5 *io, hid_t group, const hf_hdf5_array *a, hsize_t row, const void *values)
{
    hid_t data_set = -1, type = -1, space = -1, memory = -1;
    hsize_t extent[3] = {row + a->dims[0], a->dims[1], a->dims[2]};
    if (io->status != HF_OK) return;
    if ((data_set = open_uncached(group, a->name)) < 0 || H5Dset_extent(data_set, extent) < 0 ||
        (type = array_type(a)) < 0 || (space = H5Dget_space(data_set)) < 0 ||
        (memory = select_rows(a, row, space)) < 0 || H5Dwrite(data_set, type, memory, space, H5P_DEFAULT, values) < 0)
        hf_hdf5_fail(io, "write", group, a->name);
    HF_HDF5_CLOSE(io, memory, space, type, data_set);
}

void hf_hdf5_read_rows(hf_hdf5 *io, hid_t group, const hf_hdf5_array *a, hsize_t row, void *values)
{
    read_values(io, group, a, false, row, values);
}

/* ---- attributes ---- */

/* Writes an attribute. Takes ownership of the type, which is negative if it could not be made. */
static void put_typed(hf_hdf5 *io, hid_t place, const char *name, const char *attribute, hid_t type, hsize_t n,
                      const void *values)
{
    hid_t space = -1, id = -1;
    htri_t is_there = H5Aexists_by_name(place, name, attribute, H5P_DEFAULT);
    if (type < 0 || is_there < 0 || (is_there && H5Adelete_by_name(place, name, attribute, H5P_DEFAULT) < 0) ||
        (space = H5Screate_simple(n ? 1 : 0, n ? &n : NULL, NULL)) < 0 ||
        (id = H5Acreate_by_name(place, name, attribute, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT)) < 0 ||
        H5Awrite(id, type, values) < 0)
        fail_at(io, "write", place, name, attribute);
    HF_HDF5_CLOSE(io, id, space, type);
}

void hf_hdf5_copy_attribute(hf_hdf5 *io, const char *from, const char *from_name, const char *to, const char *to_name)
{
    hid_t id = -1, type = -1, space = -1;
    hssize_t n = 0;
    void *values = NULL;
    if (io->status != HF_OK) return;
    if ((id = H5Aopen_by_name(io->file, from, from_name, H5P_DEFAULT, H5P_DEFAULT)) < 0 ||
        (type = H5Aget_type(id)) < 0 || (space = H5Aget_space(id)) < 0 || (n = H5Sget_simple_extent_npoints(space)) < 1)
        fail_at(io, "read", io->file, from, from_name);
    else if (!(values = malloc((size_t)n * H5Tget_size(type))))
        hf_hdf5_no_memory(io);
    else if (H5Aread(id, type, values) < 0)
        fail_at(io, "read", io->file, from, from_name);
    HF_HDF5_CLOSE(io, space, id);
    if (io->status == HF_OK)
        put_typed(io, io->file, to, to_name, type, n > 1 ? (hsize_t)n : 0, values);
    else
        hf_hdf5_close(io, type);
    free(values);
}

void hf_hdf5_put(hf_hdf5 *io, hid_t place, const char *name, const char *attribute, const hf_hdf5_kind *kind, hsize_t n,
                 const void *values)
{
    if (io->status == HF_OK) put_typed(io, place, name, attribute, make_type(kind, 0), n, values);
}

void hf_hdf5_put_text(hf_hdf5 *io, hid_t place, const char *name, const char *attribute, const char *text)
{
    hf_hdf5_put(io, place, name, attribute, HF_KIND_TEXT, 0, &text);
}

void hf_hdf5_put_chars(hf_hdf5 *io, hid_t place, const char *name, const char *attribute, const char *text)
{
    size_t length = strlen(text) ? strlen(text) : 1; /* HDF5 has no type of 0 bytes; the NUL serves as padding */
    if (io->status == HF_OK) put_typed(io, place, name, attribute, make_string(length, H5T_CSET_UTF8), 0, text);
}

void hf_hdf5_put_ascii(hf_hdf5 *io, hid_t place, const char *name, const char *attribute, const char *text)
{
    if (io->status == HF_OK) put_typed(io, place, name, attribute, make_string(strlen(text), H5T_CSET_ASCII), 0, text);
}

/* Replaces place, name and attribute by those that the file has, written into object[] and known[]. Returns false if
 * the alias knows none. */
static bool find_attribute(hf_hdf5 *io, hid_t *place, const char **name, const char **attribute,
                           char object[HF_HDF5_NAME_SIZE], char known[HF_HDF5_NAME_SIZE])
{
    char path[HF_HDF5_NAME_SIZE];
    if (!io->alias || io->status != HF_OK) return true;
    absolute_path(*place, *name, path);
    if (!io->alias(path, *attribute, 0, object, known)) return false;
    *place = io->file;
    *name = object;
    *attribute = known;
    return true;
}

/* Returns false also if the object itself is missing, and after a failure. */
bool hf_hdf5_has_attribute(hf_hdf5 *io, hid_t place, const char *name, const char *attribute)
{
    char object[HF_HDF5_NAME_SIZE], known[HF_HDF5_NAME_SIZE];
    if (!find_attribute(io, &place, &name, &attribute, object, known)) return false;
    if (!hf_hdf5_has(io, place, name)) return false;
    htri_t has = H5Aexists_by_name(place, name, attribute, H5P_DEFAULT);
    if (has < 0) fail_at(io, "read", place, name, attribute);
    return has > 0;
}

void hf_hdf5_get(hf_hdf5 *io, hid_t place, const char *name, const char *attribute, const hf_hdf5_kind *kind,
                 void *value, size_t size)
{
    hid_t id = -1, stored = -1, space = -1, type = -1;
    size_t length = 0;
    char object[HF_HDF5_NAME_SIZE], known[HF_HDF5_NAME_SIZE];
    if (!hf_hdf5_has_attribute(io, place, name, attribute)) {
        hf_hdf5_missing(io, place, name, attribute);
        return;
    }
    find_attribute(io, &place, &name, &attribute, object, known);
    if ((id = H5Aopen_by_name(place, name, attribute, H5P_DEFAULT, H5P_DEFAULT)) < 0 ||
        (stored = H5Aget_type(id)) < 0 || (space = H5Aget_space(id)) < 0 || (length = H5Tget_size(stored)) == 0 ||
        (type = make_read_type(kind, length)) < 0)
        fail_at(io, "read", place, name, attribute);
    else if (H5Sget_simple_extent_npoints(space) != 1 || !is_of_kind(stored, kind))
        damaged_at(io, place, name, attribute, "is of another type");
    else if (kind == HF_KIND_CHARS && length >= size)
        damaged_at(io, place, name, attribute, "is too long");
    else if (H5Aread(id, type, value) < 0)
        fail_at(io, "read", place, name, attribute);
    else if (kind == HF_KIND_CHARS)
        ((char *)value)[length] = '\0';
    else if (kind->class == HF_HDF5_ENUM && !hf_hdf5_are_known(kind, value, 1))
        damaged_at(io, place, name, attribute, "holds a value that has no word");
    HF_HDF5_CLOSE(io, type, space, stored, id);
}

bool hf_hdf5_has_chars(hf_hdf5 *io, hid_t place, const char *name, const char *attribute)
{
    hid_t id = -1, stored = -1;
    bool has = false;
    char object[HF_HDF5_NAME_SIZE], known[HF_HDF5_NAME_SIZE];
    if (!hf_hdf5_has_attribute(io, place, name, attribute)) return false;
    find_attribute(io, &place, &name, &attribute, object, known);
    if ((id = H5Aopen_by_name(place, name, attribute, H5P_DEFAULT, H5P_DEFAULT)) < 0 || (stored = H5Aget_type(id)) < 0)
        fail_at(io, "read", place, name, attribute);
    else
        has = is_of_kind(stored, HF_KIND_CHARS);
    HF_HDF5_CLOSE(io, stored, id);
    return has;
}

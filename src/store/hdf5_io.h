/* hdf5_io - what writing and reading of result files share: calls of HDF5 that stop at the first failure and say where
 * it was, the types of stored values, and the tables of what is stored.
 *
 * Every call takes an hf_hdf5 and does nothing once its status is not HF_OK, so that a sequence of calls needs no check
 * in between: look at io->status at the end. Ids are negative then, and closing them is harmless. */
#ifndef HIFDM_HDF5_IO_H
#define HIFDM_HDF5_IO_H

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

/* Types of stored values, with the C type they have in arrays and attributes here. Enumerations are one byte in the
 * file and there carry their words, which h5dump and h5py show. */
typedef enum {
    HF_KIND_REAL,   /* double */
    HF_KIND_INT,    /* int */
    HF_KIND_LONG,   /* long */
    HF_KIND_UINT64, /* uint64_t */
    HF_KIND_TEXT,   /* const char *: variable-length UTF-8, which h5py gives as str. Never read back here: HDF5 1.10
                       crashes on the damaged ones */
    HF_KIND_CHARS,  /* char[length], padded with NULs: fixed-length UTF-8 */
    HF_KIND_FLAG,   /* this and all further ones: signed char; 0 or 1, a bool in h5py */
    HF_KIND_ROLE,
    HF_KIND_GROUP,
    HF_KIND_LAW,
    HF_KIND_STATUS,
    HF_KIND_STOP_REASON,
    HF_KIND_GA_STOP,
    HF_KIND_JOINT,
    HF_KIND_UNIT,
    HF_KIND_COUPLING_STOP
} hf_hdf5_kind;

/* HDF5 as Debian builds it is not made for threads: every public call of store and store_read holds this one lock, so
 * that runs in threads of one process may each have a store. A pthread mutex and no OpenMP lock, because the threads
 * may be anybody's. hf_hdf5_unlock returns its argument. hf_hdf5_quiet, under the lock: every thread that takes it from
 * then on prints none of HDF5's errors. */
void hf_hdf5_lock(void);
int hf_hdf5_try_lock(void); /* 0: another thread has it */
void hf_hdf5_quiet(void);
hf_status hf_hdf5_unlock(hf_status status);

size_t hf_hdf5_kind_bytes(hf_hdf5_kind kind); /* of one value in memory; not for HF_KIND_CHARS */

/* A data set: what it is called, how large it is, what is in it. */
typedef struct {
    const char *name; /* below the group it is given with, perhaps with '/' */
    hf_hdf5_kind kind;
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

/* ---- Data sets ---- */

/* New data set with its attributes. chunk: NULL, or [rank] for one that grows along its first dimension. */
hid_t hf_hdf5_make_array(hf_hdf5 *io, hid_t group, const hf_hdf5_array *array, const hsize_t *chunk);
void hf_hdf5_write_array(hf_hdf5 *io, hid_t group, const hf_hdf5_array *array, const void *values);

/* Rows [row, row + array->dims[0]) of a data set that grows, below `group`. Writing makes it larger when it must be. */
void hf_hdf5_write_rows(hf_hdf5 *io, hid_t group, const hf_hdf5_array *array, hsize_t row, const void *values);
void hf_hdf5_read_rows(hf_hdf5 *io, hid_t group, const hf_hdf5_array *array, hsize_t row, void *values);

/* One string that the file keeps with a fixed length, as a new text, *text, which the caller frees. */
void hf_hdf5_read_text(hf_hdf5 *io, hid_t group, const char *name, char **text);

hid_t hf_hdf5_array_type(const hf_hdf5_array *array); /* the caller closes it; negative after a failure of HDF5 */

/* Read exactly array->dims values, refusing other dimensions, other types and foreign values of enumerations. */
void hf_hdf5_read_array(hf_hdf5 *io, hid_t group, const hf_hdf5_array *array, void *values);

/* First dimension of a data set, from 1 to `max`. 0 after a failure. */
int hf_hdf5_length(hf_hdf5 *io, hid_t group, const char *name, int max);

/* Length of each string of a data set of HF_KIND_CHARS, at least 1. 0 after a failure. */
size_t hf_hdf5_chars_length(hf_hdf5 *io, hid_t group, const char *name);

/* ---- Attributes of the object `name` below `place` ("." is `place` itself) ---- */

/* n values, 0 = a scalar; not for HF_KIND_CHARS. Putting replaces what is there. */
void hf_hdf5_put(hf_hdf5 *io, hid_t place, const char *name, const char *attribute, hf_hdf5_kind kind, hsize_t n,
                 const void *values);
void hf_hdf5_put_text(hf_hdf5 *io, hid_t place, const char *name, const char *attribute, const char *text);
void hf_hdf5_put_chars(hf_hdf5 *io, hid_t place, const char *name, const char *attribute, const char *text);

/* One value. HF_KIND_CHARS: a string into the `size` bytes at `value`, refused when it does not fit. */
void hf_hdf5_get(hf_hdf5 *io, hid_t place, const char *name, const char *attribute, hf_hdf5_kind kind, void *value,
                 size_t size);

/* Is there such an attribute, and is it a text of fixed length? */
int hf_hdf5_has_chars(hf_hdf5 *io, hid_t place, const char *name, const char *attribute);

/* ---- Tables: the same rows write and read, so that the two cannot diverge ---- */

/* A member of a struct <-> an attribute. Enumerations are int or enum in the struct, strings char[size]. */
typedef struct {
    const char *object, *name;
    hf_hdf5_kind kind;
    size_t offset, size;
} hf_hdf5_member;

void hf_hdf5_put_members(hf_hdf5 *io, const hf_hdf5_member *table, int n, const void *owner);
void hf_hdf5_get_members(hf_hdf5 *io, const hf_hdf5_member *table, int n, void *owner);

/* A pointer in a struct <-> a data set [n_node or n_cable], or [...][columns] when columns > 1. Rows whose pointer is
 * NULL are left out. */
typedef struct {
    const char *name;
    hf_hdf5_kind kind;
    int per_cable, columns;
    const char *units, *description;
    size_t offset;
} hf_hdf5_column;

void hf_hdf5_write_columns(hf_hdf5 *io, hid_t group, const hf_hdf5_column *table, int n, int n_node, int n_cable,
                           const void *owner);
void hf_hdf5_read_columns(hf_hdf5 *io, hid_t group, const hf_hdf5_column *table, int n, int n_node, int n_cable,
                          void *owner);

/* n >= 1 names as strings of one length. */
void hf_hdf5_write_ids(hf_hdf5 *io, hid_t group, const char *name, const char *const *id, int n,
                       const char *description);

#define HF_HDF5_COUNT(table) ((int)(sizeof(table) / sizeof((table)[0])))

/* ---- What is stored of an hf_scene (below /scene), an hf_shape (/form, /ga/best) and an hf_summary ---- */

#define HF_PROGRAM "hifdm"  /* what says that a file is one of ours */
#define HF_FORMAT_VERSION 1 /* of the files; a change that old programs would misread raises it */

/* X(struct, name, member, kind, per_cable, columns, units, description) */
#define HF_SCENE_COLUMNS(X)                                                                                            \
    X(hf_scene, "node/position_m", position_m, REAL, 0, 3, "m", "theoretical position; of supports also the real one") \
    X(hf_scene, "node/load_N", load_N, REAL, 0, 3, "N", "load")                                                        \
    X(hf_scene, "node/role", role, ROLE, 0, 1, "", "support, inner (counted by psi) or edge")                          \
    X(hf_scene, "cable/end", end, INT, 1, 2, "", "the two nodes, as indices from 0 into /scene/node")                  \
    X(hf_scene, "cable/group", group, GROUP, 1, 1, "", "inner or boundary")                                            \
    X(hf_scene, "cable/law", law, LAW, 1, 1, "", "what the scene asks of the cable")                                   \
    X(hf_scene, "cable/target", target, REAL, 1, 1, "N, m or N/m",                                                     \
      "tension, length, force density or unstressed length, by law; "                                                  \
      "NaN = the pretension of the case")                                                                              \
    X(hf_scene, "cable/EA_N", EA_N, REAL, 1, 1, "N", "axial stiffness, NaN where not given")

#define HF_SHAPE_COLUMNS(X)                                                                                            \
    X(hf_shape, "position_m", position_m, REAL, 0, 3, "m", "position of each node of /scene/node")                     \
    X(hf_shape, "length_m", length_m, REAL, 1, 1, "m", "length of each cable of /scene/cable")                         \
    X(hf_shape, "tension_N", tension_N, REAL, 1, 1, "N", "tension, force density times length")                        \
    X(hf_shape, "q_N_per_m", q_N_per_m, REAL, 1, 1, "N/m", "force density")                                            \
    X(hf_shape, "law", law, LAW, 1, 1, "", "law in force, under the case's method or rule")

#define HF_HDF5_COLUMN(type, name, member, kind, per_cable, columns, units, description)                               \
    {name, HF_KIND_##kind, per_cable, columns, units, description, offsetof(type, member)},

/* X(struct, object, attribute, member, kind) */
#define HF_RESULT_MEMBERS(X, object, prefix, result)                                                                   \
    X(hf_summary, object, prefix "status", result.status, STATUS)                                                      \
    X(hf_summary, object, prefix "stop_reason", result.stop_reason, STOP_REASON)                                       \
    X(hf_summary, object, prefix "iterations", result.iterations, INT)                                                 \
    X(hf_summary, object, prefix "culprit", result.culprit, INT)                                                       \
    X(hf_summary, object, prefix "psi_m", result.psi_m, REAL)                                                          \
    X(hf_summary, object, prefix "residual_N", result.residual_N, REAL)                                                \
    X(hf_summary, object, prefix "tension_error", result.tension_error, REAL)                                          \
    X(hf_summary, object, prefix "length_error", result.length_error, REAL)                                            \
    X(hf_summary, object, prefix "inner_tension_ratio", result.inner_tension_ratio, REAL)                              \
    X(hf_summary, object, prefix "boundary_tension_ratio", result.boundary_tension_ratio, REAL)                        \
    X(hf_summary, object, prefix "shortest_length_ratio", result.shortest_length_ratio, REAL)                          \
    X(hf_summary, object, prefix "position_error_m", result.position_error_m, REAL)                                    \
    X(hf_summary, object, prefix "condition", result.condition, REAL)                                                  \
    X(hf_summary, object, prefix "backward_error", result.backward_error, REAL)                                        \
    X(hf_summary, object, prefix "n_slack", result.n_slack, INT)                                                       \
    X(hf_summary, object, prefix "n_loaded_chain", result.n_loaded_chain, INT)

#define HF_COUPLING_MEMBERS(X, object, prefix, result)                                                                 \
    X(hf_summary, object, prefix "stop_reason", result.coupling.stop_reason, COUPLING_STOP)                            \
    X(hf_summary, object, prefix "iterations", result.coupling.iterations, INT)                                        \
    X(hf_summary, object, prefix "step_m", result.coupling.step_m, REAL)                                               \
    X(hf_summary, object, prefix "ratio", result.coupling.ratio, REAL)                                                 \
    X(hf_summary, object, prefix "max_displacement_m", result.coupling.max_displacement_m, REAL)

/* only when has_coupling; those of the optimised shapes stand beside their results */
#define HF_SUMMARY_COUPLING_MEMBERS(X) HF_COUPLING_MEMBERS(X, "/coupling", "", form)
#define HF_SUMMARY_COUPLING_GA_MEMBERS(X) HF_COUPLING_MEMBERS(X, "/ga", "best_coupling_", best)
#define HF_SUMMARY_COUPLING_POLISH_MEMBERS(X) HF_COUPLING_MEMBERS(X, "/polish", "coupling_", polish)

#define HF_SUMMARY_FORM_MEMBERS(X)                                                                                     \
    X(hf_summary, "/", "title", title, CHARS)                                                                          \
    X(hf_summary, "/", "threads", threads, INT)                                                                        \
    X(hf_summary, "/", "seed", seed, UINT64)                                                                           \
    X(hf_summary, "/", "warnings", warnings, CHARS)                                                                    \
    X(hf_summary, "/", "finished", finished, FLAG)                                                                     \
    X(hf_summary, "/", "has_polish", has_polish, FLAG)                                                                 \
    X(hf_summary, "/", "has_optimize", has_optimize, FLAG)                                                             \
    X(hf_summary, "/case", "case_path", case_path, CHARS)                                                              \
    X(hf_summary, "/form", "version", version, CHARS)                                                                  \
    X(hf_summary, "/form", "n_node", n_node, INT)                                                                      \
    X(hf_summary, "/form", "n_free", n_free, INT)                                                                      \
    X(hf_summary, "/form", "n_cable", n_cable, INT)                                                                    \
    X(hf_summary, "/form", "n_gene", n_gene, INT)                                                                      \
    X(hf_summary, "/form", "half_bandwidth", half_bandwidth, INT)                                                      \
    X(hf_summary, "/form", "pretension_N", pretension_N, REAL)                                                         \
    X(hf_summary, "/form", "form_wall_s", form_wall_s, REAL)                                                           \
    HF_RESULT_MEMBERS(X, "/form", "", form)

/* only when has_polish */
#define HF_SUMMARY_POLISH_MEMBERS(X)                                                                                   \
    X(hf_summary, "/polish", "polish_is_result", polish_is_result, FLAG)                                               \
    X(hf_summary, "/polish", "polish_iterations", polish_iterations, INT)                                              \
    X(hf_summary, "/polish", "polish_evaluations", polish_evaluations, INT)                                            \
    X(hf_summary, "/polish", "polish_converged", polish_converged, FLAG)                                               \
    X(hf_summary, "/polish", "polish_wall_s", polish_wall_s, REAL)                                                     \
    HF_RESULT_MEMBERS(X, "/polish", "", polish)

/* only when has_optimize */
#define HF_SUMMARY_GA_MEMBERS(X)                                                                                       \
    X(hf_summary, "/ga", "solver", solver, INT)                                                                        \
    X(hf_summary, "/ga", "base_psi_m", base_psi_m, REAL)                                                               \
    X(hf_summary, "/ga", "n_leader", n_leader, INT)                                                                    \
    X(hf_summary, "/ga", "planes", planes, INT)                                                                        \
    X(hf_summary, "/ga", "best_generation", best_generation, INT)                                                      \
    X(hf_summary, "/ga", "best_individual", best_individual, INT)                                                      \
    X(hf_summary, "/ga", "generations", generations, INT)                                                              \
    X(hf_summary, "/ga", "evaluations", evaluations, LONG)                                                             \
    X(hf_summary, "/ga", "infeasible", infeasible, LONG)                                                               \
    X(hf_summary, "/ga", "optimize_stop", optimize_stop, GA_STOP)                                                      \
    X(hf_summary, "/ga", "optimize_wall_s", optimize_wall_s, REAL)                                                     \
    X(hf_summary, "/ga", "optimize_cpu_s", optimize_cpu_s, REAL)                                                       \
    HF_RESULT_MEMBERS(X, "/ga", "best_", best)

/* only when has_truss: when there is a group /truss */
#define HF_SUMMARY_TRUSS_MEMBERS(X)                                                                                    \
    X(hf_summary, "/truss", "mass_kg", truss_mass_kg, REAL)                                                            \
    X(hf_summary, "/truss", "n_node", truss_nodes, INT)                                                                \
    X(hf_summary, "/truss", "n_member", truss_members, INT)

/* What is stored of an hf_truss and of an hf_carrier_state, below /truss; per_cable = per member. */
#define HF_TRUSS_NUMBER_COLUMN(name, units, otherwise, description)                                                    \
    {"member/" #name, HF_KIND_REAL, 1, 1, units, description, offsetof(hf_truss, name)},
#define HF_TRUSS_COLUMNS(X)                                                                                            \
    X(hf_truss, "node/position_m", position_m, REAL, 0, 3, "m", "position without load")                               \
    X(hf_truss, "node/mass_kg", mass_kg, REAL, 0, 1, "kg", "mass of the hinges")                                       \
    X(hf_truss, "member/end", end, INT, 1, 2, "", "the two nodes, as indices from 0 into /truss/node")                 \
    X(hf_truss, "member/joint", joint, JOINT, 1, 1, "", "rigid: clamped to its nodes; pinned: axial force alone")      \
    X(hf_truss, "member/unit", unit, UNIT, 1, 1, "", "basic unit that the member belongs to")

#define HF_TRUSS_STATE_COLUMNS(X)                                                                                      \
    X(hf_carrier_state, "node/displacement", displacement, REAL, 0, 6, "m, rad",                                       \
      "under the pull of the net: along x, y, z, about x, y, z")                                                       \
    X(hf_carrier_state, "node/reaction", reaction, REAL, 0, 6, "N, N m", "of the supports on the truss")               \
    X(hf_carrier_state, "member/end_force", end_force, REAL, 1, 12, "N, N m",                                          \
      "local, of the nodes on the member: Nx (compression), Vy, Vz, Tx, My, Mz at the first end, then at the second")

/* Of a store that is being written, for modules that add groups of their own. */
struct hf_store;
hf_hdf5 *hf_store_io(struct hf_store *store, hf_messages *messages);

#define HF_HDF5_MEMBER(type, object, name, member, kind)                                                               \
    {object, name, HF_KIND_##kind, offsetof(type, member), sizeof(((type *)0)->member)},

#endif

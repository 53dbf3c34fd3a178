/* status - result codes with their texts and exit codes from one list, and messages for people.
 * Stability: stable.
 *
 * There are three classes of errors. A programmer's error is an assert. A bad candidate gets a status, its numbers are
 * NaN, and the batch goes on. A failed run returns a status and messages to its caller; the library never prints and
 * never exits. */
#ifndef HIFDM_STATUS_H
#define HIFDM_STATUS_H

#include <hifdm/api.h>
#include <stdbool.h>
#include <stddef.h>

HF_API_BEGIN

/* X(name, value, exit code of the program, word stored in files, sentence for people).
 * The values are stored in HDF5 files: never renumber them. */
#define HF_STATUS_LIST(X)                                                                                              \
    X(OK, 0, 0, "ok", "done")                                                                                          \
    X(NOT_CONVERGED, 1, 3, "not_converged", "the iteration limit was reached before the stopping rule held")           \
    X(SINGULAR, 2, 4, "singular", "the force density matrix is singular or not positive definite")                     \
    X(STRAIGHT_CHAIN, 3, 4, "straight_chain", "a straight chain of length-controlled cables carries lateral load")     \
    X(COLLAPSED, 4, 4, "collapsed", "nodes ran together: a cable shrank to a small part of its theoretical length")    \
    X(NOT_FINITE, 5, 4, "not_finite", "a position or force density is no longer a finite number")                      \
    X(RATIO_CAP, 6, 4, "ratio_cap", "the boundary tension ratio exceeds optimize.boundary_ratio_cap")                  \
    X(NOT_EVALUATED, 7, 3, "not_evaluated", "not evaluated")                                                           \
    X(NO_FEASIBLE, 8, 3, "no_feasible", "no design met the constraints")                                               \
    X(TRUSS_TOO_SOFT, 9, 4, "truss_too_soft", "the truss gives way to the pretension of its net without end")          \
    X(MECHANISM, 10, 4, "mechanism", "the truss is a mechanism, or not held by enough supports")                       \
    X(OUT_OF_LIMITS, 12, 4, "out_of_limits", "the shape breaks a row of optimize.limits")                              \
    X(POINTS_FAILED, 11, 3, "points_failed", "some points of the sweep failed")                                        \
    X(BAD_USAGE, 20, 2, "bad_usage", "the command line is not understood")                                             \
    X(BAD_CASE, 21, 2, "bad_case", "the case has errors")                                                              \
    X(NO_MEMORY, 30, 5, "no_memory", "out of memory")                                                                  \
    X(IO, 31, 5, "io", "input/output failed")                                                                          \
    X(EXISTS, 32, 5, "exists", "the output file exists")                                                               \
    X(NO_LAPACK, 35, 5, "no_lapack", "LAPACK cannot be loaded")                                                        \
    X(DIFFERENT, 34, 1, "different", "the files differ")                                                               \
    X(INTERRUPTED, 33, 75, "interrupted", "told to stop before the end")

typedef enum {
#define HF_STATUS_ENUM(name, value, exit_code, word, text) HF_##name = value,
    HF_STATUS_LIST(HF_STATUS_ENUM)
#undef HF_STATUS_ENUM
} hf_status;

const char *hf_status_word(hf_status status);  /* one token, as stored in files; "unknown" for a value not listed */
hf_status hf_status_of_word(const char *word); /* HF_IO for a word not listed, as another version may store */
const char *hf_status_text(hf_status status);  /* a sentence */
/* 0 done, 1 two files differ, 2 usage or case, 3 not converged, 4 ill-posed, 5 input/output, 75 told to stop */
int hf_status_exit_code(hf_status status);

/* Has a design with this status a shape: is it feasible, or infeasible by a limit alone? */
static inline bool hf_status_has_shape(hf_status status)
{
    return status == HF_OK || status == HF_RATIO_CAP || status == HF_OUT_OF_LIMITS;
}

/* Evaluate `expression` once; return its status from the calling function unless it is HF_OK. */
#define HF_TRY(expression)                                                                                             \
    do {                                                                                                               \
        hf_status hf_try_status_ = (expression);                                                                       \
        if (hf_try_status_ != HF_OK) return hf_try_status_;                                                            \
    } while (0)

/* Who knows where a key of a case stands: writes "case.yaml:7:3: optimize.goals.0.set" or the like into text[size]. */
typedef void hf_place_find(const void *context, const char *key, char *text, size_t size);

/* A growing list of lines for people. Zero-initialise; call hf_messages_free when done. When memory runs out,
 * lines are lost, but the counts stay correct. */
typedef struct {
    char *text; /* lines ending in '\n', or NULL while empty */
    size_t length, capacity;
    int n_error, n_warning;
    hf_place_find *find_place; /* of keys that messages name; NULL: messages name the key alone */
    const void *place_context; /* borrowed */
} hf_messages;

#define HF_PLACE_SIZE 1280 /* room for a path, a line, a column and a key */

#if defined(__GNUC__)
#define HF_PRINTF(format_index, first) __attribute__((format(printf, format_index, first)))
#else
#define HF_PRINTF(format_index, first)
#endif

/* Append "error: ..." or "warning: ..."; hf_error returns `code`, so that a caller can `return hf_error(...)`. */
hf_status hf_error(hf_messages *messages, hf_status code, const char *format, ...) HF_PRINTF(3, 4);
void hf_warning(hf_messages *messages, const char *format, ...) HF_PRINTF(2, 3);
/* Write where a key stands, for the begin of a message: "case.yaml:7:3: optimize.goals.0.set", or the key alone where
 * nobody knows its place. Returns text. */
const char *hf_messages_place(const hf_messages *messages, char text[HF_PLACE_SIZE], const char *key_format, ...)
    HF_PRINTF(3, 4);
void hf_messages_free(hf_messages *messages); /* frees all lines; the list can be used again */

HF_API_END
#endif

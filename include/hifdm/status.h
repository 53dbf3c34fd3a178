/* status - a list of result codes with their texts and exit statuses, and messages for the user.
 * Stability: stable.
 *
 * The library distinguishes three classes of errors. A programming error causes an assertion to fail. For a design
 * without a shape, the library returns a status and sets the numbers to NaN. The batch continues with the other
 * designs. A run that fails returns a status and messages to its caller. The library never prints and never exits. */
#pragma once

#include <hifdm/api.h>
#include <stdbool.h>
#include <stddef.h>

HF_API_BEGIN

/* Each row X(name, value, word stored in files, ...) defines a status. The designated member .exit_code is the exit
 * status of the program. The designated member .text is a text for the user. HDF5 files contain the values. Therefore,
 * never renumber the values. The glossary explains each word. */
#define HF_STATUS_LIST(X)                                                                                              \
    X(OK, 0, "ok", .exit_code = 0, .text = "done")                                                                     \
    X(NOT_CONVERGED, 1, "not_converged", .exit_code = 3,                                                               \
      .text = "the iteration reached its limit before it converged")                                                   \
    X(SINGULAR, 2, "singular", .exit_code = 4,                                                                         \
      .text = "the force density matrix is singular or not positive definite")                                         \
    X(STRAIGHT_CHAIN, 3, "straight_chain", .exit_code = 4,                                                             \
      .text = "a straight chain of cables that keep their lengths carries a lateral load")                             \
    X(COLLAPSED, 4, "collapsed", .exit_code = 4,                                                                       \
      .text = "nodes ran together: a cable shrank to a small part of its length at the target positions")              \
    X(NOT_FINITE, 5, "not_finite", .exit_code = 4, .text = "a position or force density is no longer a finite number") \
    X(RATIO_CAP, 6, "ratio_cap", .exit_code = 4,                                                                       \
      .text = "the boundary tension ratio exceeds optimize.boundary_ratio_cap")                                        \
    X(NOT_EVALUATED, 7, "not_evaluated", .exit_code = 3, .text = "not evaluated")                                      \
    X(NO_FEASIBLE, 8, "no_feasible", .exit_code = 3, .text = "no design met the constraints")                          \
    X(TRUSS_TOO_SOFT, 9, "truss_too_soft", .exit_code = 4,                                                             \
      .text = "the truss is too soft for the pretension of its net")                                                   \
    X(MECHANISM, 10, "mechanism", .exit_code = 4, .text = "the truss is a mechanism, or too few supports hold it")     \
    X(OUT_OF_LIMITS, 12, "out_of_limits", .exit_code = 4, .text = "the shape breaks a limit or a requirement")         \
    X(POINTS_FAILED, 11, "points_failed", .exit_code = 3, .text = "some points of the sweep failed")                   \
    X(BAD_USAGE, 20, "bad_usage", .exit_code = 2, .text = "the command line is not understood")                        \
    X(BAD_CASE, 21, "bad_case", .exit_code = 2, .text = "the case has errors")                                         \
    X(NO_MEMORY, 30, "no_memory", .exit_code = 5, .text = "out of memory")                                             \
    X(IO, 31, "io", .exit_code = 5, .text = "input/output failed")                                                     \
    X(EXISTS, 32, "exists", .exit_code = 5, .text = "the output file exists")                                          \
    X(NO_LAPACK, 35, "no_lapack", .exit_code = 5, .text = "LAPACK cannot be loaded")                                   \
    X(DIFFERENT, 34, "different", .exit_code = 1, .text = "the files differ")                                          \
    X(REQUIREMENT_FAILED, 36, "requirement_failed", .exit_code = 6, .text = "the result fails a requirement")          \
    X(INTERRUPTED, 33, "interrupted", .exit_code = 75, .text = "told to stop before the end")

/* A result code. HF_OK is 0. */
typedef enum {
#define HF_STATUS_ENUM(name, value, ...) HF_##name = value,
    HF_STATUS_LIST(HF_STATUS_ENUM)
#undef HF_STATUS_ENUM
} hf_status;

/* Returns a constant string with the word that files use for a status. Returns "unknown" for a value that is not in the
 * list. */
const char *hf_status_word(hf_status status);
/* Returns the status that belongs to a word. Returns HF_IO for a word that is not in the list because another version
 * may have stored the word. */
hf_status hf_status_of_word(const char *word);
/* Returns a constant string that describes the status to the user. Returns "unknown status" for a value that is not in
 * the list. */
const char *hf_status_text(hf_status status);
/* Returns the exit status of the program for a status:
 *
 *   0    done
 *   1    two files differ
 *   2    wrong usage or errors in the case
 *   3    not converged, not evaluated, no feasible design, or failed points in a sweep
 *   4    ill-posed: the net or the truss has no shape, or the design violates a constraint
 *   5    input or output failed, memory ran out, or LAPACK is missing
 *   6    the result fails a requirement (--strict)
 *   75   interrupted before the end */
int hf_status_exit_code(hf_status status);

/* Returns true if a design with this status has a shape. A design with a shape is feasible or violates only a
 * constraint. */
static inline bool hf_status_has_shape(hf_status status)
{
    return status == HF_OK || status == HF_RATIO_CAP || status == HF_OUT_OF_LIMITS;
}

/* Evaluates `expression` once. If the status of the expression is not HF_OK, the calling function returns this
 * status. */
#define HF_TRY(expression)                                                                                             \
    do {                                                                                                               \
        hf_status hf_try_status_ = (expression);                                                                       \
        if (hf_try_status_ != HF_OK) return hf_try_status_;                                                            \
    } while (0)

/* Finds the location of a key of a case and writes it to text[size]. An example of a location is "case.yaml:7:3:
 * optimize.objective.0.set". */
typedef void hf_location_find(const void *context, const char *key, char *text, size_t size);

/* Contains a list of messages for the user. The list grows as needed. Initialise the list to zero and call
 * hf_messages_free at the end. If memory runs out, some lines are lost but the counts remain correct. */
typedef struct {
    char *text;              /* lines, each ending with '\n'; NULL: there are none */
    size_t length, capacity; /* numbers of bytes used and allocated */
    int n_error, n_warning;  /* numbers of errors and warnings */
    /* callback that finds the location of a key in a message; NULL: messages contain only the key */
    hf_location_find *find_location;
    const void *location_context; /* first argument of find_location; borrowed */
    /* callback that receives each line as soon as it is complete, with its '\n'; NULL: none */
    void (*report)(const char *line);
} hf_messages;

#define HF_LOCATION_SIZE 1280 /* size for a path, a line, a column and a key */

#if defined(__GNUC__)
#define HF_PRINTF(format_index, first) __attribute__((format(printf, format_index, first)))
#else
#define HF_PRINTF(format_index, first)
#endif

/* Appends the line "error: ..." and returns `code`. A caller can therefore write `return hf_error(...)`. If `messages`
 * is NULL, the function appends no line. The argument `format` is a printf format. */
hf_status hf_error(hf_messages *messages, hf_status code, const char *format, ...) HF_PRINTF(3, 4);
/* Appends the line "warning: ...", unless `messages` is NULL. The argument `format` is a printf format. */
void hf_warning(hf_messages *messages, const char *format, ...) HF_PRINTF(2, 3);
/* Writes the location of a key to `text`, for the beginning of a message. An example of a location is "case.yaml:7:3:
 * optimize.objective.0.set". If the location is unknown, the function writes only the key. The argument `key_format` is
 * a printf format. Returns the argument `text`. */
const char *hf_messages_location(const hf_messages *messages, char text[HF_LOCATION_SIZE], const char *key_format, ...)
    HF_PRINTF(3, 4);
/* Frees all lines. After this call, the list can be used again. */
void hf_messages_free(hf_messages *messages);

HF_API_END

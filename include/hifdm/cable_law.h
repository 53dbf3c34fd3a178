/* cable_law - the laws that a cable can obey, and everything that depends on the law (METHOD.md section 2).
 * Stability: internal; may change in any version.
 *
 * The names and words of the laws are stable, because files contain them.
 *
 * A new law is one row of HF_LAW_LIST and one case in each function below; the compiler reports a missing case. Solvers
 * test flags and call these functions, so they need no change. A kernel with its own formulas for the laws states as a
 * set of flags which laws it can solve (hf_law_is_served). A net with any other law is solved by another method.
 *
 * Lengths are in m, tensions in N, force densities in N/m. The order of the floating-point operations must not change,
 * because it determines the last bits of stored data sets. */
#ifndef HIFDM_CABLE_LAW_H
#define HIFDM_CABLE_LAW_H

#include <hifdm/api.h>
#include <math.h>
#include <stdbool.h>

HF_API_BEGIN

/* What solvers may assume of a law. */
enum {
    HF_LAW_ITERATES = 1,       /* the force density depends on the shape, so one linear solve is not enough */
    HF_LAW_IS_CONVEX = 2,      /* the potential is convex under tension */
    HF_LAW_GIVES_TENSION = 4,  /* T is the target value, whatever the length */
    HF_LAW_HAS_MULTIPLIER = 8, /* T is an unknown of its own; the law gives the required length at this T */
    HF_LAW_IS_RIGID = 16,   /* with a multiplier: the required length is the same at every T; there is no potential */
    HF_LAW_GOES_SLACK = 32, /* with a multiplier: T may be zero; the cable then carries no force */
    HF_LAW_NEEDS_EA = 64,   /* the law depends on the axial stiffness EA of the cable */
    HF_LAW_MAY_PUSH = 128   /* the target value may be below zero: a strut */
};

/* X(name, word, target, unit of target, flags): one row for each law. Files contain the words, in the order of the
 * rows. `target` is the name of the target value in messages; NULL: a cable may have no value.
 *
 *   tension         T = T*, Eq. 7
 *   length          l = L*, Eq. 8
 *   force_density   q is constant, Eq. 5
 *   elastic         T = EA max(l/l0 - 1, 0) with the unstressed length l0 */
#define HF_LAW_LIST(X)                                                                                                 \
    X(HF_LAW_TENSION, "tension", NULL, "N", HF_LAW_ITERATES | HF_LAW_IS_CONVEX | HF_LAW_GIVES_TENSION)                 \
    X(HF_LAW_LENGTH, "length", NULL, "m",                                                                              \
      HF_LAW_ITERATES | HF_LAW_IS_CONVEX | HF_LAW_HAS_MULTIPLIER | HF_LAW_IS_RIGID)                                    \
    X(HF_LAW_FORCE_DENSITY, "force_density", "", "N/m", HF_LAW_IS_CONVEX | HF_LAW_MAY_PUSH)                            \
    X(HF_LAW_ELASTIC, "elastic", "unstressed length", "m",                                                             \
      HF_LAW_ITERATES | HF_LAW_IS_CONVEX | HF_LAW_HAS_MULTIPLIER | HF_LAW_GOES_SLACK | HF_LAW_NEEDS_EA)

#define HF_LAW_NAME(name, word, target, unit, flags) name,
/* The law of a cable; files contain the values. */
typedef enum { HF_LAW_LIST(HF_LAW_NAME) } hf_law;
#undef HF_LAW_NAME

#define HF_LAW_ONE_MORE(name, word, target, unit, flags) +1
enum { HF_N_LAW = HF_LAW_LIST(HF_LAW_ONE_MORE) };
#undef HF_LAW_ONE_MORE

extern const char *const hf_law_word[HF_N_LAW];        /* "tension", "length", "force_density", "elastic" */
extern const char *const hf_law_target_name[HF_N_LAW]; /* names of the target values; NULL: the value may be left out */
extern const char *const hf_law_target_unit[HF_N_LAW]; /* units of the target values */

/* The values of one cable on which its law depends. */
typedef struct {
    hf_law law;                /* law in force */
    double target;             /* T* (N), L* (m), q (N/m) or l0 (m) by law */
    double EA_N;               /* axial stiffness; NaN if the law does not need it */
    double length_at_target_m; /* length between the target positions of its ends */
} hf_law_cable;

/* Returns true if the law has any of these flags. */
static inline bool hf_law_has(hf_law law, unsigned flags)
{
#define HF_LAW_FLAGS(name, word, target, unit, flags) flags,
    static const unsigned char flags_of[HF_N_LAW] = {HF_LAW_LIST(HF_LAW_FLAGS)};
#undef HF_LAW_FLAGS
    return (flags_of[law] & flags) != 0;
}

/* Returns true if a kernel for laws with the flags `served` can solve this law, because the law has no other flag. */
static inline bool hf_law_is_served(hf_law law, unsigned served)
{
    return !hf_law_has(law, ~served);
}

/* Returns the target value of a cable without a value: its length between target positions, length_at_target_m, under
 * law length; NaN for the other laws, which have no default or use the pretension. */
static inline double hf_law_default_target(hf_law law, double length_at_target_m)
{
    switch (law) {
    case HF_LAW_LENGTH:
        return length_at_target_m;
    case HF_LAW_TENSION:
    case HF_LAW_FORCE_DENSITY:
    case HF_LAW_ELASTIC:
        break;
    }
    return (double)NAN;
}

/* Size of the text of hf_law_target_fault, bytes. */
#define HF_LAW_FAULT_SIZE 160

/* Checks the target value of a cable, NaN if the user gave none. length_at_target_m is the length between the target
 * positions of its ends, m. Returns NULL if the value is valid, otherwise `text`, into which the fault is written. */
const char *hf_law_target_fault(hf_law law, double target, double length_at_target_m, char text[HF_LAW_FAULT_SIZE]);

/* Returns the length that a law with a multiplier requires at this tension, m; NaN for other laws. This form needs no
 * special case for stiff cables: in the limit of infinite EA the law elastic is the law length (METHOD M3). */
static inline double hf_law_required_length_m(hf_law_cable c, double tension_N)
{
    switch (c.law) {
    case HF_LAW_LENGTH:
        return c.target;
    case HF_LAW_ELASTIC:
        return c.target + c.target * tension_N / c.EA_N;
    case HF_LAW_TENSION:
    case HF_LAW_FORCE_DENSITY:
        break;
    }
    return (double)NAN;
}

/* Returns the tension of a cable of this length, N; NaN for a rigid law, under which the length does not determine the
 * tension. */
static inline double hf_law_tension_N(hf_law_cable c, double length_m)
{
    switch (c.law) {
    case HF_LAW_TENSION:
        return c.target;
    case HF_LAW_FORCE_DENSITY:
        return c.target * length_m;
    case HF_LAW_ELASTIC:
        return c.EA_N * fmax(length_m / c.target - 1, 0);
    case HF_LAW_LENGTH:
        break;
    }
    return (double)NAN;
}

/* Returns the unstressed length of a cable that has this tension at this length, m (METHOD M32). For a slack cable
 * whose law has a multiplier, this is the length that the law requires without tension. c.EA_N is needed whatever the
 * law. */
static inline double hf_law_cut_m(hf_law_cable c, double length_m, double tension_N, bool is_slack)
{
    if (is_slack && hf_law_has(c.law, HF_LAW_HAS_MULTIPLIER)) return hf_law_required_length_m(c, 0);
    return length_m / (1 + tension_N / c.EA_N);
}

/* Returns the axial stiffness of the law, phi'' = dT/dl, at this length, N/m; INFINITY for a rigid law. */
static inline double hf_law_stiffness_N_per_m(hf_law_cable c, double length_m)
{
    switch (c.law) {
    case HF_LAW_FORCE_DENSITY:
        return c.target;
    case HF_LAW_ELASTIC:
        return length_m > c.target ? c.EA_N / c.target : 0;
    case HF_LAW_LENGTH:
        return (double)INFINITY;
    case HF_LAW_TENSION:
        break;
    }
    return 0;
}

/* ---- what follows from the flags ---- */

/* Returns the force density at this length, N/m: from the tension that the law gives, otherwise q_N_per_m. */
static inline double hf_law_held_q_N_per_m(hf_law_cable c, double length_m, double q_N_per_m)
{
    return hf_law_has(c.law, HF_LAW_GIVES_TENSION) ? c.target / length_m : q_N_per_m;
}

/* Minimum force density that Eq. 8 gives a slack cable, N/m. It is far below all forces, also in nets with pretensions
 * of 1e-300 N, for which 1e-100 would be too much. It is enough to give a position to a node that only slack cables
 * hold. */
#define HF_LAW_MIN_Q_N_PER_M 1e-305

/* Returns the next force density of the fixed-point iteration, N/m. Eq. 7 multiplies q by the required over the present
 * tension; with T = q l the result is the required tension over l. Eq. 8 multiplies q by the present over the required
 * length; for an elastic cable the required length grows with the tension. */
static inline double hf_law_next_q_N_per_m(hf_law_cable c, double length_m, double tension_N, double q_N_per_m)
{
    if (hf_law_has(c.law, HF_LAW_GIVES_TENSION)) return c.target / length_m;
    if (!hf_law_has(c.law, HF_LAW_HAS_MULTIPLIER)) return q_N_per_m;
    double next = q_N_per_m * (length_m / hf_law_required_length_m(c, tension_N));
    return next < HF_LAW_MIN_Q_N_PER_M ? HF_LAW_MIN_Q_N_PER_M : next; /* a NaN remains */
}

/* Returns the tension with which an iteration begins, N: otherwise_N, unless the cable can go slack and is taut at its
 * target positions. Such a cable begins with its tension there, limited to a factor HF_LAW_FIRST_RANGE of otherwise_N.
 * Without the limit a stiff cable that is just taut would hold nothing, and one that was cut too short would hold
 * everything. */
#define HF_LAW_FIRST_RANGE 10.0
static inline double hf_law_first_tension_N(hf_law_cable c, double otherwise_N)
{
    bool is_taut = hf_law_has(c.law, HF_LAW_GOES_SLACK) && c.length_at_target_m > hf_law_required_length_m(c, 0);
    if (!is_taut) return otherwise_N;
    double tension_N = hf_law_tension_N(c, c.length_at_target_m);
    return fmin(fmax(tension_N, otherwise_N / HF_LAW_FIRST_RANGE), otherwise_N * HF_LAW_FIRST_RANGE);
}

HF_API_END
#endif

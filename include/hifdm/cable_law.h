/* cable_law - the laws that a cable can obey, and everything that depends on which one it is (METHOD.md section 2).
 * Stability: internal; may change in any version.
 * (The names and words of the laws are stable, because files contain them.)
 *
 * A new law is one row of HF_LAW_LIST and one case in each of the functions below; the compiler names a case that is
 * missing. Solvers test flags and call these functions, so they need no change. A kernel with its own formulas for the
 * laws states as a set of flags which laws it can solve (hf_law_is_served); a net with any other law is solved by
 * another method.
 *
 * Lengths in m, tensions in N, force densities in N/m. The order of the floating-point operations must stay: stored
 * data sets change in their last bits when the order changes. */
#ifndef HIFDM_CABLE_LAW_H
#define HIFDM_CABLE_LAW_H

#include <hifdm/api.h>
#include <math.h>
#include <stdbool.h>

HF_API_BEGIN

/* What solvers may assume of a law. */
enum {
    HF_LAW_ITERATES = 1,       /* the force density depends on the shape: one linear solve is not enough */
    HF_LAW_IS_CONVEX = 2,      /* the potential is convex under tension */
    HF_LAW_GIVES_TENSION = 4,  /* T is the target, whatever the length */
    HF_LAW_HAS_MULTIPLIER = 8, /* T is an unknown of its own; the law gives the wanted length at this T */
    HF_LAW_IS_RIGID = 16,      /* with a multiplier: the wanted length is the same at every T; no potential */
    HF_LAW_GOES_SLACK = 32,    /* with a multiplier: T may be zero, and the cable then carries no force */
    HF_LAW_NEEDS_EA = 64,      /* the law depends on the axial stiffness EA of the cable */
    HF_LAW_MAY_PUSH = 128      /* the target may be below zero: a strut */
};

/* X(name, word, target, unit of target, flags): one row per law. Files contain the words, in the order of the rows.
 * `target` is the name that messages use for the value of a cable; NULL: a cable may leave its value out.
 *
 * tension: T = T*, Eq. 7.  length: l = L*, Eq. 8.  force_density: q is held, Eq. 5.
 * elastic: T = EA max(l/l0 - 1, 0), where l0 is the length to which the cable was cut. */
#define HF_LAW_LIST(X)                                                                                                 \
    X(HF_LAW_TENSION, "tension", NULL, "N", HF_LAW_ITERATES | HF_LAW_IS_CONVEX | HF_LAW_GIVES_TENSION)                 \
    X(HF_LAW_LENGTH, "length", NULL, "m",                                                                              \
      HF_LAW_ITERATES | HF_LAW_IS_CONVEX | HF_LAW_HAS_MULTIPLIER | HF_LAW_IS_RIGID)                                    \
    X(HF_LAW_FORCE_DENSITY, "force_density", "", "N/m", HF_LAW_IS_CONVEX | HF_LAW_MAY_PUSH)                            \
    X(HF_LAW_ELASTIC, "elastic", "unstressed length", "m",                                                             \
      HF_LAW_ITERATES | HF_LAW_IS_CONVEX | HF_LAW_HAS_MULTIPLIER | HF_LAW_GOES_SLACK | HF_LAW_NEEDS_EA)

#define HF_LAW_NAME(name, word, target, unit, flags) name,
typedef enum { HF_LAW_LIST(HF_LAW_NAME) } hf_law;
#undef HF_LAW_NAME

#define HF_LAW_ONE_MORE(name, word, target, unit, flags) +1
enum { HF_N_LAW = HF_LAW_LIST(HF_LAW_ONE_MORE) };
#undef HF_LAW_ONE_MORE

extern const char *const hf_law_word[HF_N_LAW];        /* "tension", "length", "force_density", "elastic" */
extern const char *const hf_law_target_name[HF_N_LAW]; /* NULL: the target may be left out */
extern const char *const hf_law_target_unit[HF_N_LAW];

/* The values of one cable on which its law depends. */
typedef struct {
    hf_law law;
    double target;        /* T* (N), L* (m), q (N/m) or l0 (m) by law */
    double EA_N;          /* NaN when the law does not need it */
    double theoretical_m; /* length between the theoretical positions of its ends */
} hf_law_cable;

/* True when the law has any of these flags. */
static inline bool hf_law_has(hf_law law, unsigned flags)
{
#define HF_LAW_FLAGS(name, word, target, unit, flags) flags,
    static const unsigned char flags_of[HF_N_LAW] = {HF_LAW_LIST(HF_LAW_FLAGS)};
#undef HF_LAW_FLAGS
    return (flags_of[law] & flags) != 0;
}

/* True when a kernel made for laws with the flags `served` can solve this law, which then has no other flag. */
static inline bool hf_law_is_served(hf_law law, unsigned served)
{
    return !hf_law_has(law, ~served);
}

/* Target of a cable whose value is left out; NaN where the law has no default or its default is the pretension. */
static inline double hf_law_default_target(hf_law law, double theoretical_m)
{
    switch (law) {
    case HF_LAW_LENGTH:
        return theoretical_m;
    case HF_LAW_TENSION:
    case HF_LAW_FORCE_DENSITY:
    case HF_LAW_ELASTIC:
        break;
    }
    return (double)NAN;
}

#define HF_LAW_FAULT_SIZE 160

/* What is wrong with the value that a user gives a cable (NaN: none), written into text; NULL when it is right. */
const char *hf_law_target_fault(hf_law law, double target, double theoretical_m, char text[HF_LAW_FAULT_SIZE]);

/* Length, m, that a law with a multiplier demands at this tension; NaN for other laws. This form needs no special case
 * for stiff cables: in the limit of infinite EA the law elastic is the law length. */
static inline double hf_law_wanted_length_m(hf_law_cable c, double tension_N)
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

/* Tension of a cable of this length; NaN for a rigid law, under which the length does not determine the tension. */
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

/* Length, m, to which a cable must be cut to have this tension at this length. A slack cable has the length that its
 * law gives, where it gives one. EA_N is needed whatever the law. */
static inline double hf_law_cut_m(hf_law_cable c, double length_m, double tension_N, bool is_slack)
{
    if (is_slack && hf_law_has(c.law, HF_LAW_HAS_MULTIPLIER)) return hf_law_wanted_length_m(c, 0);
    return length_m / (1 + tension_N / c.EA_N);
}

/* Stiffness along the cable, phi'' = dT/dl, N/m; infinite for a rigid law. */
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

/* Change of the potential phi, J, from length `from_m` to `to_m`. `square` is to_m^2 - from_m^2, m^2; the caller gives
 * it so that no digits are lost when the lengths are nearly equal. NaN for a rigid law. */
static inline double hf_law_energy_change_J(hf_law_cable c, double from_m, double to_m, double square)
{
    double longer = square / (from_m + to_m), l0 = c.target;
    switch (c.law) {
    case HF_LAW_TENSION:
        return c.target * longer;
    case HF_LAW_FORCE_DENSITY:
        return c.target * square / 2;
    case HF_LAW_ELASTIC: {
        double over = fmax(from_m - l0, 0), beyond = fmax(to_m - l0, 0);
        return c.EA_N / (2 * l0) * (from_m > l0 && to_m > l0 ? longer : beyond - over) * (over + beyond);
    }
    case HF_LAW_LENGTH:
        break;
    }
    return (double)NAN;
}

/* ---- what follows from the flags ---- */

/* Force density at this length with the tension that the law gives; q_N_per_m where it gives none. */
static inline double hf_law_held_q_N_per_m(hf_law_cable c, double length_m, double q_N_per_m)
{
    return hf_law_has(c.law, HF_LAW_GIVES_TENSION) ? c.target / length_m : q_N_per_m;
}

/* What Eq. 8 leaves to a slack cable, N/m: far below all forces, also of nets with pretensions of 1e-300 N, for which
 * 1e-100 is too much; and enough for a node that hangs on slack cables alone to have a place. */
#define HF_LAW_LEAST_Q_N_PER_M 1e-305

/* Next force density of the fixed-point iteration. Eq. 7 scales q by the wanted over the present tension; with T = q l
 * the result is the wanted tension over l. Eq. 8 scales q by the present over the wanted length; the wanted length of
 * an elastic cable grows with the tension. */
static inline double hf_law_next_q_N_per_m(hf_law_cable c, double length_m, double tension_N, double q_N_per_m)
{
    if (hf_law_has(c.law, HF_LAW_GIVES_TENSION)) return c.target / length_m;
    if (!hf_law_has(c.law, HF_LAW_HAS_MULTIPLIER)) return q_N_per_m;
    double next = q_N_per_m * (length_m / hf_law_wanted_length_m(c, tension_N));
    return next < HF_LAW_LEAST_Q_N_PER_M ? HF_LAW_LEAST_Q_N_PER_M : next; /* a NaN stays one */
}

/* Tension in the theoretical shape of a cable that can go slack and is taut there, but within HF_LAW_FIRST_RANGE of
 * otherwise_N: a stiff cable that is just taut would hold nothing, and one that was cut too short would hold all.
 * `otherwise_N` for other cables. */
#define HF_LAW_FIRST_RANGE 10.0
static inline double hf_law_first_tension_N(hf_law_cable c, double otherwise_N)
{
    bool is_taut = hf_law_has(c.law, HF_LAW_GOES_SLACK) && c.theoretical_m > hf_law_wanted_length_m(c, 0);
    if (!is_taut) return otherwise_N;
    double tension_N = hf_law_tension_N(c, c.theoretical_m);
    return fmin(fmax(tension_N, otherwise_N / HF_LAW_FIRST_RANGE), otherwise_N * HF_LAW_FIRST_RANGE);
}

HF_API_END
#endif

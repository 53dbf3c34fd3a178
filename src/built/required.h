/* required - measures the figures that rows of `requirements` bound, and gives the verdicts (METHOD section 14).
 *
 *     rows -> columns: each figure that a bound needs, once, with the load cases in which it is needed
 *     shape -> a value of each column, and the cable or support with this value
 *     values in all load cases -> margin of each row -> verdict
 *
 * Load case 0 is the nominal net, 1 + k is load case k of the case. */
#pragma once

#include <hifdm/load_cases.h>
#include <hifdm/requirements.h>
#include <hifdm/workspace.h>
#include "surface/antenna.h"
#include "surface/surface_measure.h"

enum { HF_REQUIRED_COLUMNS = 2 * HF_REQUIREMENT_ROWS_MAX, HF_REQUIRED_STATES = 1 + HF_LOAD_CASES_MAX };

/* One figure of a shape. */
typedef struct {
    hf_required_figure figure;
    bool is_minimum; /* of `tension`: the minimum tension of the set, else the maximum */
    hf_focus feed;
    int antenna;         /* of a figure at a frequency: the antenna that it needs; else -1 */
    double frequency_Hz; /* of that antenna, or NaN */
    const char *set;     /* its name; "": all cables, or a figure without a set */
    int n_cable;
    const int *cable;       /* [n_cable] cables of the set, ascending */
    unsigned nominal, many; /* bits of the load cases in which the design, or the samples, need it */
} hf_required_column;

typedef struct {
    int n;                                                           /* number of rows; 0: nothing is required */
    const hf_requirement_settings *row;                              /* [n] borrowed */
    int n_state;                                                     /* number of load cases, with the nominal net */
    unsigned states[HF_REQUIREMENT_ROWS_MAX];                        /* [n] bits of the load cases of each row */
    int low[HF_REQUIREMENT_ROWS_MAX], high[HF_REQUIREMENT_ROWS_MAX]; /* [n] columns of at_least and at_most, or -1 */
    int n_column;
    hf_required_column column[HF_REQUIRED_COLUMNS];
    unsigned nominal, many;                      /* bits of the load cases that any column needs */
    int n_share, share[HF_REQUIREMENT_ROWS_MAX]; /* rows with a share */
    const hf_scene *scene;
    const hf_load_cases *load_cases;
    const double *mass_kg_per_m; /* [n_cable]; NULL without a row about the mass */
    /* [n_node + 1], and the cables of each support, ascending: cable[start[i]] to cable[start[i + 1] - 1]. Nodes that
     * are no supports have none. NULL without a row about the pull. */
    int *support_start, *support_cable;
    int n_antenna; /* number of different frequencies of rows */
    double frequency_Hz[HF_REQUIREMENT_ROWS_MAX];
    hf_antenna *antenna;         /* [n_antenna] made by hf_required_radio_make */
    double mesh_tension_N_per_m; /* of the mesh of the antennas */
    void *block, *antenna_block;
} hf_required;

/* Prepares the rows of a case for a net. All arguments are borrowed; mass_kg_per_m is NULL unless a row needs it. The
 * rows have been checked, so that each set has a cable. Returns HF_OK or HF_NO_MEMORY; the caller calls
 * hf_required_free in any case. */
hf_status hf_required_create(int n, const hf_requirement_settings *row, const hf_scene *scene,
                             const hf_load_cases *load_cases, const double *mass_kg_per_m, hf_required *required);
void hf_required_free(hf_required *required);

#define HF_REQUIRED_NAME_SIZE (HF_SET_NAME_SIZE + 32)

/* Writes the name of a column, such as "tension_min_ties" or "gain_refocused_8GHz". Returns `name`. */
const char *hf_required_column_name(const hf_required_column *column, char name[HF_REQUIRED_NAME_SIZE]);

/* Returns the name of load case `state`, "nominal" for 0. */
const char *hf_required_state_name(const hf_required *required, int state);

/* A shape to measure. */
typedef struct {
    const hf_model *model;                /* of the net with this shape */
    const double *position_m, *tension_N; /* [3][n_node] by row, [n_cable] */
    const double *displacement_m; /* [3 n_attachment] displacements of the attachments by the forces of the net */
    const unsigned char *loose;   /* [n_node] nodes that psi leaves out; NULL: none */
    int n_loose;
    hf_surface_paths paths; /* errors of the surface; NaN if no column needs them */
    /* [n_antenna] figures at the frequencies, and bounds of their errors; may be NULL if no column needs them */
    const hf_antenna_figures *radio, *radio_error;
    const hf_workspace *work; /* laws and target values in effect, for error bounds; may be NULL without them */
} hf_required_shape;

/* Returns the minimum or maximum tension of the set of a column. *item becomes its cable. */
double hf_required_extreme_N(const hf_required_column *column, const double *tension_N, bool is_minimum, double *item);

/* Returns the figure of a column for a shape. *item becomes the cable or support with this value, or stays. */
double hf_required_figure_of(const hf_required *required, const hf_required_column *column,
                             const hf_required_shape *shape, double *item);

/* Returns whether load case `state` of the samples (is_many) or of the design needs errors of the surface. */
bool hf_required_needs_surface(const hf_required *required, bool is_many, int state);

/* Measures the columns that load case `state` needs. value [n_column] becomes NaN for the other ones. item [n_column]
 * becomes the index of the cable or support with this value, -1 if there is none. */
void hf_required_measure(const hf_required *required, bool is_many, int state, const hf_required_shape *shape,
                         double *value, double *item);

/* Bounds the errors of these values, error [n_column], if no node is further than bound_m from its exact position and
 * psi no further than psi_bound_m from its exact value (NaN: not known). NaN: no bound is known. */
void hf_required_bound_errors(const hf_required *required, int state, const hf_required_shape *shape, double bound_m,
                              double psi_bound_m, const double *value, double *error);

/* Returns whether a row has two bounds other than 0. Its distances are then relative to the bounds, because the nearer
 * one must be found. */
bool hf_required_has_two_bounds(const hf_requirement_settings *row);

/* Returns the distance of a value from one bound of a row, which the row must have; it is negative outside. It is
 * relative to the bound if hf_required_has_two_bounds. -INFINITY: no value. */
double hf_required_distance(const hf_requirement_settings *row, bool is_high, double value);

/* Returns the smallest distance of row i from its bounds over its load cases, as hf_required_distance. The values of
 * load case `state` are value[state * stride], of each column. It is -INFINITY if a value is NaN. *state and *column
 * become those of the minimum. */
double hf_required_margin(const hf_required *required, int i, const double *value, size_t stride, int *state,
                          int *column);

/* Gives the verdict on row i for the nominal net, from value, item and error [n_state][n_column]. */
void hf_required_judge_nominal(const hf_required *required, int i, const double *value, const double *item,
                               const double *error, hf_requirement_verdict *to);

/* Copies to the verdict the figures of a net for row i: value[state * stride + column] and item, of the same form.
 * is_worst: it is the worst net, else the one with the value of the row. */
void hf_required_note(const hf_required *required, int i, bool is_worst, const double *value, const double *item,
                      size_t stride, hf_requirement_verdict *to);

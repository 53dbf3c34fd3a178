/* pattern - the far field of a reflector by physical optics over its facets (METHOD section 13).
 * Stability: internal. This header may change in any version.
 *
 * Pipeline at one frequency:
 *
 *   hf_feed_make           target surface and facets -> feed
 *   hf_pattern_create      settings, facets, feed -> directions, quadrature points
 *   hf_pattern_sum_block   currents of a block of facets -> sums over its quadrature points (M44), in any thread
 *   hf_pattern_finish      sums of all blocks -> gain by polarisation
 *   hf_pattern_figures     gain of a cut -> beam width, sidelobes
 *
 * All positions and directions are in the frame of the scene. A direction has the angle theta from +z and the angle phi
 * from +x towards +y. A cut is a half plane of constant phi, extended to negative theta. The time dependence is exp(+j
 * w t). */
#pragma once

#include <hifdm/api.h>
#include <hifdm/facets.h>

#include <signal.h>
#include <stddef.h>

HF_API_BEGIN

/* Describes the feed that illuminates a surface. */
typedef struct {
    hf_feed_kind kind;     /* kind of the feed, not HF_FEED_AUTO */
    double position_m[3];  /* position of a point feed, or x and z of a line feed */
    double axis[3], co[3]; /* unit vectors of the axis and of the polarisation on the axis */
    double cos_power;      /* exponent q: the field is cos^q of the angle from the axis, and 0 behind the feed */
    double beam[3];        /* unit vector of the axis after reflection by the target surface */
    double scale;          /* gain = scale |N|^2 / wavelength^2, with N of (M44) */
} hf_feed;

/* Determines the feed that surface->pattern describes. The array position_m [n_node][3] contains the positions of the
 * facet nodes in m. By default, the feed is at the focus of the target surface and points to the middle of the
 * aperture. By default, the exponent cos_power makes the field of the feed 10 dB weaker at the edge of the facets than
 * on the axis. The kind surface->kind must not be HF_SURFACE_AUTO. The surface must have at least one facet. Returns
 * the number of facets whose front side, towards +z, the feed does not illuminate. If the feed does not illuminate all
 * facets, the far field of the surface cannot be computed. */
int hf_feed_make(const hf_surface_settings *surface, const hf_facets *facets, const double *position_m, hf_feed *feed);

/* Describes a surface that a feed illuminates. */
typedef struct {
    const hf_facets *facets;  /* facets of the surface, borrowed */
    const double *position_m; /* [n_node][3] positions */
    const double *sag_m;      /* [n_facet][4] sags of the mesh as in hf_facet_mesh_sags; NULL: flat facets */
} hf_pattern_surface;

#define HF_PATTERN_BLOCKS 32 /* number of blocks of facets that the threads share */

/* Contains the far field of a surface at one frequency. */
typedef struct {
    const hf_pattern_settings *settings; /* settings; borrowed */
    hf_pattern_surface surface;          /* the surface */
    hf_feed feed;                        /* feed of the surface */
    double wavelength_m;                 /* wavelength */
    int n_thread;                        /* number of threads, each with its own scratch memory */
    const volatile sig_atomic_t *stop;   /* NULL or a flag; if *stop != 0, the sums end early and are invalid */
    int n_padded;                        /* number of angles of a cut, rounded up to whole vectors */
    int n_node, n_node_padded;       /* number of angles at which a facet is summed; n_node 0: the angles of the cut */
    long n_point;                    /* total number of quadrature points of all facets */
    double *gauss_at, *gauss_weight; /* Gauss-Legendre quadrature on [0, 1]; row n is the rule of n points */
    double *direction;               /* [n_cut][3][n_padded] unit vectors of the angles */
    double *node_direction; /* [n_cut][3][n_node_padded] unit vectors of the angles at which a facet is summed */
    double *between;        /* [n_node][n_padded] weight of each summed angle in each angle of the cut */
    double *sum;            /* [HF_PATTERN_BLOCKS][n_cut][6][n_padded] sums of the blocks */
    double *local, *point;  /* [n_thread] scratch memory */
    void *block;            /* owned memory behind the arrays */
} hf_far_field;

/* Determines the size of the sums at one frequency. Sets n_point, n_node and the settings of *pattern. Allocates no
 * memory. */
void hf_pattern_plan(const hf_pattern_settings *settings, const hf_pattern_surface *surface, const hf_feed *feed,
                     double frequency_Hz, hf_far_field *pattern);

/* Returns the number of angles, over all cuts, for which hifdm sums each quadrature point. */
int hf_pattern_angles(const hf_far_field *pattern);

/* Allocates and prepares the memory for the sums at one frequency with n_thread threads. The far field borrows settings
 * and surface. Returns HF_OK or HF_NO_MEMORY. Call hf_pattern_free even if hf_pattern_create fails. */
hf_status hf_pattern_create(const hf_pattern_settings *settings, const hf_pattern_surface *surface, const hf_feed *feed,
                            double frequency_Hz, int n_thread, hf_far_field *pattern);

/* Sums block i of the surface with the scratch memory of thread `room`. The index i must be below HF_PATTERN_BLOCKS.
 * This function is a callback for hf_parallel_each. The argument `pattern` points to a struct hf_far_field. The sums do
 * not depend on the thread number. */
void hf_pattern_sum_block(void *pattern, int room, int i);

/* Computes the gain in dBi from the sums of all blocks. The gain is relative to an isotropic radiator with the power of
 * the feed. The arrays co_dBi and cross_dBi [n_cut][n_theta] receive the co-polar and the cross-polar gain by Ludwig's
 * third definition. The function overwrites the sums of the first block. */
void hf_pattern_finish(hf_far_field *pattern, double *co_dBi, double *cross_dBi);

/* Frees the memory of the sums. */
void hf_pattern_free(hf_far_field *pattern);

#define HF_PATTERN_WIDTH_STEPS 4.0 /* minimum number of angle steps in a half-power width */

/* These constants are the reasons why the values of a cut are doubtful. */
typedef enum {
    HF_CUT_FINE,   /* the figures are reliable */
    HF_CUT_COARSE, /* the half-power width has fewer than HF_PATTERN_WIDTH_STEPS angle steps, so lobes are missed */
    HF_CUT_AT_END  /* the maximum is at the first or the last angle */
} hf_cut_doubt;

/* Describes the gain, the beamwidth and the sidelobes of one cut of the far field. If the range of angles is too small
 * to determine a value, the value is NaN. If the cut is doubtful, the half-power width and the sidelobes are NaN. */
typedef struct {
    double gain_dBi, beam_deg;   /* maximum and its angle, from a parabola through three angles */
    double half_power_width_deg; /* half-power width of the beam */
    double first_sidelobe_dB;    /* higher one of the two lobes beside the beam, relative to the beam */
    double highest_sidelobe_dB;  /* highest lobe of the cut, relative to the beam */
    hf_cut_doubt doubt;          /* reason why figures are NaN; not stored */
} hf_cut_figures;

/* Computes the gain, the beamwidth and the sidelobes of a cut from its co-polar gain co_dBi [n_theta] in dBi. The
 * angles are at equal steps from theta_deg[0] to theta_deg[1]. */
hf_cut_figures hf_pattern_figures(int n_theta, const double theta_deg[2], const double *co_dBi);

/* ---- the far field of a shape ---- */

/* Contains the results of all cuts of a shape at all frequencies, in the order of the tables. */
typedef struct {
    int n_frequency, n_cut; /* number of frequencies and number of cuts; 0: there is no pattern */
    double frequency_Hz[HF_LIST_MAX], phi_deg[HF_PATTERN_CUTS]; /* frequencies and angles of the cuts */
    hf_feed feed;                                               /* the feed */
    hf_cut_figures figure[HF_LIST_MAX * HF_PATTERN_CUTS];       /* [n_frequency][n_cut] the figures */
} hf_pattern_summary;

/* Contains the gain of a shape at all frequencies and angles. */
typedef struct {
    int n_frequency, n_cut, n_theta;            /* numbers of frequencies, cuts and angles */
    double *frequency_Hz, *phi_deg, *theta_deg; /* [n_frequency], [n_cut], [n_theta] */
    double *co_dBi, *cross_dBi;                 /* [n_frequency][n_cut][n_theta] gain by polarisation */
    void *block;                                /* owned memory behind the arrays */
} hf_pattern_table;

/* Allocates a table with these numbers of frequencies, cuts and angles. Returns HF_OK or HF_NO_MEMORY. Call
 * hf_pattern_table_free even if hf_pattern_table_create fails. */
hf_status hf_pattern_table_create(int n_frequency, int n_cut, int n_theta, hf_pattern_table *table);
/* Frees the table. */
void hf_pattern_table_free(hf_pattern_table *table);

HF_API_END

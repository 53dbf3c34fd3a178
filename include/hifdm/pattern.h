/* pattern - the far field of a reflector: physical optics over its facets (METHOD section 13).
 * Stability: internal; may change in any version.
 *
 * Everything in the frame of the scene. A direction has the angle theta from +z, and phi from +x towards +y; a cut is a
 * half plane phi with theta of both signs. Time goes as exp(+j w t). */
#ifndef HIFDM_PATTERN_H
#define HIFDM_PATTERN_H

#include <hifdm/api.h>
#include <hifdm/facets.h>

#include <signal.h>
#include <stddef.h>

HF_API_BEGIN

/* What illuminates a surface. */
typedef struct {
    hf_feed_kind kind;     /* not HF_FEED_AUTO */
    double position_m[3];  /* of a point; of a line x and z */
    double axis[3], co[3]; /* unit vectors: where it looks, and the polarisation there; of a line across y */
    double cos_power;      /* q: the field goes as cos^q of the angle from the axis, 0 behind */
    double beam[3];        /* unit vector into which the wanted surface sends what meets the point it looks at */
    double scale;          /* gain = scale |N|^2 / wavelength^2, with N of (M44) */
} hf_feed;

/* Work out the feed of surface->pattern for facets at position_m [n_node][3]: what the case leaves open is the focus of
 * the wanted surface, the middle of the aperture as its aim, and a field 10 dB weaker at the edge of the facets.
 * surface->kind is known, and there is a facet. Returns the number of facets that it does not see from the side of +z:
 * such a surface has no pattern. */
int hf_feed_make(const hf_surface_settings *surface, const hf_facets *facets, const double *position_m, hf_feed *feed);

/* A shape to be illuminated: facets with what bends them. sag_m [n_facet][4] as hf_facet_mesh_sags; NULL: flat. */
typedef struct {
    const hf_facets *facets;
    const double *position_m; /* [n_node][3] */
    const double *sag_m;
} hf_pattern_surface;

#define HF_PATTERN_BLOCKS 32 /* parts of the surface, which threads share */

/* One frequency. */
typedef struct {
    const hf_pattern_settings *settings;
    hf_pattern_surface surface;
    hf_feed feed;
    double wavelength_m;
    int n_thread;                      /* rooms of scratch */
    const volatile sig_atomic_t *stop; /* NULL, or a flag: *stop != 0 ends the sums early, which then mean nothing */
    int n_padded;                      /* angles of a cut, filled up to whole lanes */
    int n_node, n_node_padded;         /* angles at which a facet is summed; n_node 0: at those of the cut themselves */
    long n_point;                      /* of quadrature, over all facets */
    double *gauss_at, *gauss_weight;   /* Gauss-Legendre on [0, 1], row n of the rule of n points */
    double *direction;                 /* [n_cut][3][n_padded] unit vectors of the angles */
    double *node_direction;            /* [n_cut][3][n_node_padded] */
    double *between;                   /* [n_node][n_padded] what each node gives to an angle */
    double *sum;                       /* [HF_PATTERN_BLOCKS][n_cut][6][n_padded] of the blocks */
    double *local, *point;             /* [n_thread] scratch of each room */
    void *block;                       /* owned memory */
} hf_far_field;

/* What the sums at one frequency will take, without memory for them: n_point, n_node and the settings of *pattern. */
void hf_pattern_plan(const hf_pattern_settings *settings, const hf_pattern_surface *surface, const hf_feed *feed,
                     double frequency_Hz, hf_far_field *pattern);

/* Angles of all cuts at which each point of quadrature is summed. */
int hf_pattern_angles(const hf_far_field *pattern);

/* Lay out the sums at one frequency for n_thread rooms. HF_OK or HF_NO_MEMORY; free in any case. */
hf_status hf_pattern_create(const hf_pattern_settings *settings, const hf_pattern_surface *surface, const hf_feed *feed,
                            double frequency_Hz, int n_thread, hf_far_field *pattern);

/* Sum block i < HF_PATTERN_BLOCKS of the surface in the scratch of a room; for hf_parallel_each, context: the pattern.
 * The sums are the same in every room. */
void hf_pattern_sum_block(void *pattern, int room, int i);

/* With all blocks summed: gain over isotropic radiation of the power of the feed, by polarisation after Ludwig's third
 * definition, dBi; co_dBi, cross_dBi [n_cut][n_theta]. */
void hf_pattern_finish(hf_far_field *pattern, double *co_dBi, double *cross_dBi);

void hf_pattern_free(hf_far_field *pattern);

#define HF_PATTERN_WIDTH_STEPS 4.0 /* of angle, in the width of a beam whose figures are told */

/* What speaks against the figures of a cut. */
typedef enum {
    HF_CUT_FINE,
    HF_CUT_COARSE, /* fewer than HF_PATTERN_WIDTH_STEPS steps of angle in the half-power width: lobes are missed */
    HF_CUT_AT_END  /* the highest angle is the first or the last */
} hf_cut_doubt;

/* Of one cut; NaN where the angles do not reach it, and but for the highest point where there is a doubt. */
typedef struct {
    double gain_dBi, beam_deg;   /* the highest point, by the parabola through the highest angle and its neighbours */
    double half_power_width_deg; /* around it */
    double first_sidelobe_dB;    /* the higher one of the two beside the beam, below it */
    double highest_sidelobe_dB;  /* of all of the cut */
    hf_cut_doubt doubt;          /* not stored */
} hf_cut_figures;

hf_cut_figures hf_pattern_figures(int n_theta, const double theta_deg[2], const double *co_dBi);

/* ---- of a shape ---- */

/* Figures of the cuts at all frequencies, in the order of the tables. */
typedef struct {
    int n_frequency, n_cut; /* 0: no pattern */
    double frequency_Hz[HF_LIST_MAX], phi_deg[HF_PATTERN_CUTS];
    hf_feed feed;
    hf_cut_figures figure[HF_LIST_MAX * HF_PATTERN_CUTS]; /* [n_frequency][n_cut] */
} hf_pattern_summary;

/* All angles. */
typedef struct {
    int n_frequency, n_cut, n_theta;
    double *frequency_Hz, *phi_deg, *theta_deg;
    double *co_dBi, *cross_dBi; /* [n_frequency][n_cut][n_theta] */
    void *block;                /* owned memory */
} hf_pattern_table;

hf_status hf_pattern_table_create(int n_frequency, int n_cut, int n_theta, hf_pattern_table *table);
void hf_pattern_table_free(hf_pattern_table *table);

HF_API_END
#endif

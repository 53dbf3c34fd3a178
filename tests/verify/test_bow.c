/* The bow of a net without ties between ribs: uniform tension everywhere, the whole perimeter fixed, no load.
 *
 * Source: METHOD section 9, measured with an independent Newton solver to 1e-13 N. Nodes equally spaced in
 * projected x over 10 m and in y over s. Both z-rms and psi are over the free nodes alone (39 x 7, 39 x 7, 39 x 3);
 * the fixed perimeter, whose deviation is zero, is left out of sum and count. The bow is that of the middle node. The
 * figures are held to half a unit of their last printed digit. Iterations go on to 1e-11 N, where the remaining error
 * of the slow convergence is a hundredth of that. */
#include "figures.h"
#include "nets.h"

#include <hifdm/surface.h>

static const struct bay {
    const char *focal_length, *length, *cells;
    int ny;
    double z_rms_mm, psi_mm, bow_mm;
} bays[] = {
    {"focal_length_m=5", "length_m=2", "cells_per_module=[40, 8]", 9, 36.43448, 56.49882, 53.72267},
    {"focal_length_m=7.2", "length_m=2", "cells_per_module=[40, 8]", 9, 24.93227, 32.65275, 35.97847},
    {"focal_length_m=5", "length_m=1", "cells_per_module=[40, 4]", 5, 9.90239, 20.81539, 13.22080},
};

#define CYLINDER "scene.parabolic_cylinder."
#define WHERE "%s, %s: "
#define OF_BAY bay->focal_length, bay->length

START_TEST(bow_between_ribs)
{
    const struct bay *bay = &bays[_i];
    char focal_length[80], length[80], cells[80];
    snprintf(focal_length, sizeof focal_length, CYLINDER "%s", bay->focal_length);
    snprintf(length, sizeof length, CYLINDER "%s", bay->length);
    snprintf(cells, sizeof cells, CYLINDER "%s", bay->cells);
    struct net net;
    OPEN_CASE(&net, "configs/reflector.yaml", focal_length, length, cells, CYLINDER "modules=[1, 1]",
              CYLINDER "spacing=equal_projected", CYLINDER "supports=perimeter", CYLINDER "scallop=0",
              "form.method=iterative_fdm", "form.residual_tolerance=1e-12");
    ck_assert_int_eq(find_shape(&net), HF_OK);
    ck_assert_int_eq(net.model.n_free, 39 * (bay->ny - 2));
    ck_assert_int_eq(net.model.n_inner_node, net.model.n_free);

    hf_surface_measures surface;
    hf_facets none = {0};
    net.settings.surface.focal_length_m = net.settings.parabolic_cylinder.focal_length_m;
    ck_assert_int_eq(
        hf_surface_measure(&net.settings.surface, &none, &net.model, net.work.position_m, net.work.tension_N, &surface),
        HF_OK);
    VERIFY(1e3 * surface.z_rms_m, bay->z_rms_mm, 0.5e-5, WHERE "RMS in z, mm, as the surface has it", OF_BAY);

    double sum = 0;
    for (int i = 0; i < net.scene.n_node; i++) {
        double dz = found_m(&net, i, 2) - net.scene.position_m[3 * i + 2];
        sum += dz * dz;
    }
    int middle = bay->ny / 2 * 41 + 20;
    double bow_m = found_m(&net, middle, 2) - net.scene.position_m[3 * middle + 2]; /* towards the focal line */
    VERIFY(1e3 * sqrt(sum / net.model.n_free), bay->z_rms_mm, 0.5e-5, WHERE "RMS in z, mm", OF_BAY);
    VERIFY(1e3 * net.result.psi_m, bay->psi_mm, 0.5e-5, WHERE "psi, mm", OF_BAY);
    VERIFY(1e3 * bow_m, bay->bow_mm, 0.5e-5, WHERE "bow of the middle node, mm", OF_BAY);
    close_net(&net);
}
END_TEST

Suite *suite_verify_bow(void)
{
    Suite *suite = suite_create("verify/bow");
    TCase *tests = tcase_create("bow");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, bow_between_ribs, 0, 3);
    return suite;
}

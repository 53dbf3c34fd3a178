/* prestress - tensions that hold every free node of a net at its theoretical place (form.prestress: exact).
 *
 * At fixed positions equilibrium is linear in the tensions, A T + p = 0, where column e of A has the unit vector of
 * cable e at its first end and the opposite at its second. Of all such tensions with T >= least the one is taken that
 * is nearest to what the cables are wanted to have (METHOD section 11):
 *
 *     minimise  sum w_e (T_e - wanted_e)^2 / 2
 *
 * Cables whose law gives a tension want it; the others take what balance needs, evenly within their family. */
#ifndef HIFDM_PRESTRESS_H
#define HIFDM_PRESTRESS_H

#include <hifdm/scene.h>
#include <hifdm/settings.h>
#include <hifdm/status.h>
#include <signal.h>

/* Put every cable of the checked scene under law force_density, with the force densities, N/m, that hold its nodes.
 * HF_OK; HF_BAD_CASE, naming the nodes that no tensions hold; HF_INTERRUPTED, soon after *stop is set (NULL: never);
 * HF_NO_MEMORY. The scene changes under HF_OK alone. */
hf_status hf_prestress_hold(hf_scene *scene, const hf_form_settings *form, const volatile sig_atomic_t *stop,
                            hf_messages *messages);

/* The family of a cable: the smallest set that it is in (the first of several), 0..n_set-1, or n_set + its group where
 * it is in none. */
int hf_prestress_family(const hf_scene *scene, int i_cable);

#endif

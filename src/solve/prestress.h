/* prestress - tensions that hold every free node of a net at its target position (form.prestress: exact).
 *
 * At fixed positions equilibrium is linear in the tensions, A T + P = 0. Column e of A has the unit vector of cable e
 * at its first end and the opposite at its second. Among all tensions with T >= the minimum tension, it finds those
 * nearest to the tensions t that the laws require (METHOD section 11):
 *
 *     minimise  sum w_e (T_e - t_e)^2 / 2
 *
 * A cable whose law gives a tension requires that one. The others take what balance needs, evenly within their
 * family. */
#pragma once

#include <hifdm/scene.h>
#include <hifdm/settings.h>
#include <hifdm/status.h>
#include <signal.h>

/* Puts every cable of the checked scene under law force_density, with the force densities, N/m, that hold its nodes.
 * Returns HF_OK; HF_BAD_CASE with the names of the nodes that no tensions hold; HF_INTERRUPTED soon after *stop is set
 * (NULL: never); HF_NO_MEMORY; or the status of hf_model_build. The scene changes under HF_OK alone. */
hf_status hf_prestress_hold(hf_scene *scene, const hf_form_settings *form, const volatile sig_atomic_t *stop,
                            hf_messages *messages);

/* Returns the family of a cable: the smallest set that contains it (the first of several), 0..n_set-1. A cable in no
 * set has the family n_set + its group. */
int hf_prestress_family(const hf_scene *scene, int i_cable);

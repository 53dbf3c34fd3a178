/* Makes the net and the truss that a case describes, and frees a case. */
#include "case/config_scene.h"

#include "net/scene_import.h"
#include "truss/truss_import.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool hf_config_scene_is_one(const hf_case *c, char what[HF_CONFIG_WHAT_SIZE])
{
    int n_present = 0;
    char present[256] = "", all[256] = "";
    const struct {
        const char *name;
        bool is_present;
    } source[] = {
#define SOURCE(section, type, KEYS, help) {#section, c->has_##section},
        HF_GENERATORS(SOURCE)
#undef SOURCE
            {"import", c->has_import}};
    for (size_t i = 0; i < sizeof source / sizeof *source; i++) {
        size_t n_all = strlen(all), n = strlen(present);
        snprintf(all + n_all, sizeof all - n_all, "%s%s", i ? " or " : "", source[i].name);
        if (source[i].is_present)
            snprintf(present + n, sizeof present - n, "%s%s", n_present++ ? " and " : "", source[i].name);
    }
    if (n_present)
        snprintf(what, HF_CONFIG_WHAT_SIZE, "has both %s; keep one", present);
    else
        snprintf(what, HF_CONFIG_WHAT_SIZE, "needs either %s", all);
    return n_present == 1;
}

hf_surface_settings hf_config_scene_surface(const hf_case *c)
{
    hf_surface_settings known = {0};
#define KNOW(section, type, KEYS, help)                                                                                \
    if (c->has_##section) hf_scene_##section##_surface(&c->section, &known);
    HF_GENERATORS(KNOW)
#undef KNOW
    return known;
}

hf_status hf_config_scene(const hf_case *settings, hf_scene *scene, hf_messages *messages)
{
    if (settings->has_import)
        HF_TRY(hf_scene_import(settings->nodes_path, settings->cables_path, settings->EA_N, scene, messages));
#define MAKE(section, type, KEYS, help)                                                                                \
    if (settings->has_##section) HF_TRY(hf_scene_##section(&settings->section, settings->EA_N, scene, messages));
    HF_GENERATORS(MAKE)
#undef MAKE
    return hf_scene_check(scene, messages);
}

hf_status hf_config_truss(const hf_case *settings, hf_truss *truss, hf_messages *messages)
{
    if (settings->has_truss_import)
        HF_TRY(hf_truss_import(settings->truss_nodes_path, settings->truss_members_path, truss, messages));
    else
        HF_TRY(hf_truss_generate(&settings->truss, &settings->parabolic_cylinder, truss, messages));
    return hf_truss_check(truss, messages);
}

hf_status hf_config_carrier(const hf_case *settings, const hf_scene *scene, hf_carrier *carrier, hf_messages *messages)
{
    hf_truss truss;
    *carrier = (hf_carrier){0};
    hf_status status = hf_config_truss(settings, &truss, messages);
    if (status == HF_OK) return hf_carrier_build(&truss, settings->truss.match_tolerance_m, scene, carrier, messages);
    hf_truss_free(&truss);
    return status;
}

void hf_case_free(hf_case *settings)
{
    free(settings->text);
    free(settings->overrides);
    *settings = (hf_case){0};
}

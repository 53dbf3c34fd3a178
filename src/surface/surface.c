/* surface - gain losses by Ruze's formula, and the errors by which a shape is judged. */
#include <hifdm/surface.h>

#include "base/elementary.h"

#include <math.h>

double hf_surface_highest_Hz(const hf_surface_settings *s)
{
    double highest_Hz = 0;
    for (int k = 0; k < s->frequencies_Hz.n; k++)
        highest_Hz = fmax(highest_Hz, s->frequencies_Hz.value[k]);
    return highest_Hz;
}

double hf_surface_ruze_dB(double half_path_rms_m, double frequency_Hz)
{
    double phase = 4 * HF_PI * half_path_rms_m * frequency_Hz / HF_LIGHT_M_PER_S;
    return HF_DB_PER_LN * phase * phase;
}

double hf_surface_gain_loss_dB(double half_path_rms_m, double frequency_Hz)
{
    double loss_dB = hf_surface_ruze_dB(half_path_rms_m, frequency_Hz);
    return loss_dB <= HF_RUZE_MOST_DB ? loss_dB : (double)NAN;
}

hf_surface_errors hf_surface_errors_of(const hf_surface_measures *m, bool of_facets)
{
    if (of_facets)
        return (hf_surface_errors){m->facet_half_path_rms_m, m->facet_fit_half_path_rms_m, m->facet_gain_loss_dB,
                                   m->facet_fit_gain_loss_dB};
    return (hf_surface_errors){m->half_path_rms_m, m->fit.half_path_rms_m, m->gain_loss_dB, m->fit_gain_loss_dB};
}

double hf_surface_frequency_of_loss_Hz(double half_path_rms_m, double loss_dB)
{
    return sqrt(loss_dB / HF_DB_PER_LN) * HF_LIGHT_M_PER_S / (4 * HF_PI * half_path_rms_m);
}

void hf_surface_blank(hf_surface_measures *of)
{
    const double none = (double)NAN;
#define BLANK_REAL(member) of->member = none;
#define BLANK_INT(member)
#define BLANK_TRUTH(member)
#define BLANK(type, member, kind, ...) BLANK_##kind(member)
#define BLANK_FIT(type, member, kind, ...) BLANK_##kind(fit.member)
#define BLANK_LOSS(member, unit, description) of->member[k] = none;
    HF_SURFACE_LIST(BLANK)
    HF_SURFACE_FIT_LIST(BLANK_FIT)
    for (int k = 0; k < HF_LIST_MAX; k++) {
        HF_SURFACE_LOSS_LIST(BLANK_LOSS)
    }
}

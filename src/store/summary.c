#include <hifdm/summary.h>

#include "base/json.h"

#include <math.h>
#include <string.h>

int hf_summary_has_best_shape(const hf_summary *s)
{
    return s->has_optimize && s->best.status == HF_OK && s->finished;
}

double hf_summary_utilisation(const hf_summary *s)
{
    double available_s = s->optimize_wall_s * s->threads;
    return available_s > 0 ? s->optimize_cpu_s / available_s : (double)NAN;
}

/* The members of an object at these places, in their order. The one at place 1 stands alone and opens the object. */
static void write_fields(const hf_result_field *field, int n, int from, int to, const void *owner, FILE *f)
{
    for (int place = from; place <= to; place++)
        for (int i = 0; i < n; i++) {
            const void *value = (const char *)owner + field[i].offset;
            int number;
            if (field[i].json != place) continue;
            if (place > 1) fputs(", ", f);
            if (field[i].kind == HF_RESULT_REAL) {
                hf_json_number(field[i].key, *(const double *)value, f);
                continue;
            }
            memcpy(&number, value, sizeof number); /* enumerations have the size of an int */
            if (field[i].kind == HF_RESULT_STATUS)
                hf_json_text(field[i].key, hf_status_word((hf_status)number), f);
            else if (field[i].kind == HF_RESULT_STOP_REASON)
                hf_json_text(field[i].key, hf_stop_reason_word(number), f);
            else if (field[i].kind == HF_RESULT_COUPLING_STOP)
                hf_json_text(field[i].key, hf_coupling_stop_word(number), f);
            else
                fprintf(f, "\"%s\": %d", field[i].key, number);
        }
}

enum { LAST_PLACE = 9 };

static void write_result(const hf_form_result *r, FILE *f)
{
    write_fields(hf_result_field_of, HF_RESULT_N, 1, HF_RESULT_JSON_COUNTS - 1, r, f);
    if (r->coupling.iterations > 0) {
        fputs(", ", f);
        hf_json_number("max_displacement_m", r->coupling.max_displacement_m, f);
    }
    write_fields(hf_result_field_of, HF_RESULT_N, HF_RESULT_JSON_COUNTS, LAST_PLACE, r, f);
}

static void write_list(const char *key, int n, const double *value, FILE *f)
{
    fprintf(f, ", \"%s\": [", key);
    for (int k = 0; k < n; k++) {
        if (k) fputs(", ", f);
        hf_json_value(value[k], 17, f);
    }
    fputc(']', f);
}

/* The member "surface" of a stage, behind its others; nothing when the case asks for none. */
static void write_surface(const hf_summary *s, int stage, FILE *f)
{
    const hf_surface_measures *m = &s->measures[stage];
    const hf_surface_fit *fit = &m->fit;
    const struct {
        const char *key;
        double value;
    } number[] = {
        {"z_rms_m", m->z_rms_m},
        {"normal_rms_m", m->normal_rms_m},
        {"half_path_rms_m", m->half_path_rms_m},
        {"fit_normal_rms_m", fit->normal_rms_m},
        {"fit_half_path_rms_m", fit->half_path_rms_m},
        {"fit_focal_length_m", fit->focal_length_m},
        {"fit_shift_x_m", fit->shift_x_m},
        {"fit_shift_z_m", fit->shift_z_m},
        {"fit_rotation_x_rad", fit->rotation_x_rad},
        {"fit_rotation_y_rad", fit->rotation_y_rad},
        {"fit_rotation_z_rad", fit->rotation_z_rad},
        {"faceting_rms_m", m->faceting_rms_m},
        {"deviation_p50_m", m->deviation_p50_m},
        {"deviation_p90_m", m->deviation_p90_m},
        {"deviation_p95_m", m->deviation_p95_m},
        {"deviation_p99_m", m->deviation_p99_m},
        {"deviation_max_m", m->deviation_max_m},
    };
    if (!m->is_measured) return;
    fputs(",\n  \"surface\": {", f);
    for (size_t i = 0; i < sizeof number / sizeof *number; i++) {
        if (i) fputs(", ", f);
        hf_json_number(number[i].key, number[i].value, f);
    }
    fprintf(f, ", \"fit_converged\": %s", fit->converged ? "true" : "false");
    write_list("frequency_Hz", s->surface.frequencies_Hz.n, s->surface.frequencies_Hz.value, f);
    write_list("gain_loss_dB", s->surface.frequencies_Hz.n, m->gain_loss_dB, f);
    write_list("fit_gain_loss_dB", s->surface.frequencies_Hz.n, m->fit_gain_loss_dB, f);
    fputc('}', f);
}

static void write_truss(const hf_summary *s, FILE *f)
{
    fputs(",\n \"truss\": {", f);
    hf_json_number("mass_kg", s->truss_mass_kg, f);
    fprintf(f, ", \"nodes\": %d, \"members\": %d}", s->truss_nodes, s->truss_members);
}

static void write_coupling(const hf_coupling_result *r, FILE *f)
{
    fputs(",\n \"coupling\": {", f);
    write_fields(hf_coupling_field_of, HF_COUPLING_N, 1, LAST_PLACE, r, f);
    fputc('}', f);
}

static void write_optimize(const hf_summary *s, FILE *f)
{
    fputs(",\n \"optimize\": {", f);
    write_result(&s->best, f);
    fprintf(f, ", \"generations\": %d, \"evaluations\": %ld, \"infeasible\": %ld, ", s->generations, s->evaluations,
            s->infeasible);
    hf_json_number("base_psi_m", s->base_psi_m, f);
    fputs(", ", f);
    fprintf(f, "\"best_generation\": %d, \"best_individual\": %d, ", s->best_generation, s->best_individual);
    hf_json_number("wall_s", s->optimize_wall_s, f);
    fputs(", ", f);
    hf_json_number("cpu_s", s->optimize_cpu_s, f);
    fputs(", ", f);
    fprintf(f, "\"independent_genes\": %d, ", s->n_leader);
    hf_json_text("solver", hf_solver_word[s->solver], f);
    fputs(", ", f);
    hf_json_text("stop_reason", hf_ga_stop_word[s->optimize_stop], f);
    write_surface(s, 1, f);
    fputc('}', f);
}

static void write_polish(const hf_summary *s, FILE *f)
{
    fputs(",\n \"polish\": {", f);
    write_result(&s->polish, f);
    fprintf(f, ", \"lm_iterations\": %d, \"evaluations\": %d, \"is_result\": %s, ", s->polish_iterations,
            s->polish_evaluations, s->polish_is_result ? "true" : "false");
    hf_json_number("wall_s", s->polish_wall_s, f);
    fputs(", ", f);
    hf_json_text("stop_reason", s->polish_converged ? "converged" : "max_iterations", f);
    write_surface(s, 2, f);
    fputc('}', f);
}

void hf_summary_write_json(const hf_summary *s, hf_status status, const char *messages, const char *path, FILE *f)
{
    fputs("{", f);
    hf_json_text("status", hf_status_word(status), f);
    if (s->has_truss) write_truss(s, f);
    if (s->form.status != HF_NOT_EVALUATED) {
        fputs(",\n \"form\": {", f);
        write_result(&s->form, f);
        fputs(", ", f);
        hf_json_text("stop_reason", hf_stop_reason_word((int)s->form.stop_reason), f);
        fputs(", ", f);
        hf_json_number("wall_s", s->form_wall_s, f);
        write_surface(s, 0, f);
        fputc('}', f);
    }
    if (s->has_coupling && s->form.coupling.iterations > 0) write_coupling(&s->form.coupling, f);
    if (s->has_optimize) write_optimize(s, f);
    if (s->has_polish) write_polish(s, f);
    fprintf(f, ",\n \"threads\": %d, \"seed\": %llu, ", s->threads, (unsigned long long)s->seed);
    hf_json_text("version", s->version, f);
    fputs(",\n ", f);
    hf_json_text("case", s->case_path, f);
    if (path) {
        fputs(", ", f);
        hf_json_text("file", path, f);
    }
    fputs(",\n ", f);
    hf_json_lines("warnings", "warning: ", messages, f);
    if (status != HF_OK) {
        fputs(",\n ", f);
        hf_json_lines("errors", "error: ", messages, f);
    }
    fputs("}\n", f);
}

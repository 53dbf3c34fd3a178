#include <hifdm/summary.h>

#include "base/json.h"

#include <math.h>
#include <string.h>

bool hf_summary_has_best_shape(const hf_summary *s)
{
    return s->has_optimize && s->best.status == HF_OK && s->finished;
}

double hf_summary_utilisation(const hf_summary *s)
{
    double available_s = s->optimize_wall_s * s->threads;
    return available_s > 0 ? s->optimize_cpu_s / available_s : (double)NAN;
}

/* Write the members of an object with places from..to, in that order. */
static void write_fields(const hf_result_field *field, int n, int from, int to, const void *owner, hf_json *j)
{
    for (int place = from; place <= to; place++)
        for (int i = 0; i < n; i++) {
            const void *value = (const char *)owner + field[i].offset;
            int number;
            if (field[i].json != place) continue;
            if (field[i].kind == HF_RESULT_REAL) {
                hf_json_number(j, field[i].key, *(const double *)value);
                continue;
            }
            memcpy(&number, value, sizeof number); /* enumerations have the size of an int */
            if (field[i].kind == HF_RESULT_STATUS)
                hf_json_text(j, field[i].key, hf_status_word((hf_status)number));
            else if (field[i].kind == HF_RESULT_STOP_REASON)
                hf_json_text(j, field[i].key, hf_stop_reason_word(number));
            else if (field[i].kind == HF_RESULT_COUPLING_STOP)
                hf_json_text(j, field[i].key, hf_coupling_stop_word(number));
            else
                hf_json_integer(j, field[i].key, number);
        }
}

enum { LAST_PLACE = 9 };

static void write_result(const hf_form_result *r, hf_json *j)
{
    write_fields(hf_result_field_of, HF_RESULT_N, 1, HF_RESULT_JSON_COUNTS - 1, r, j);
    if (r->coupling.iterations > 0) hf_json_number(j, "max_displacement_m", r->coupling.max_displacement_m);
    write_fields(hf_result_field_of, HF_RESULT_N, HF_RESULT_JSON_COUNTS, LAST_PLACE, r, j);
}

/* The member "surface" of a stage, after its others; nothing when the surface was not measured. */
static void write_surface(const hf_summary *s, int stage, hf_json *j)
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
    hf_json_line(j, "  ");
    hf_json_open(j, "surface", '{');
    for (size_t i = 0; i < sizeof number / sizeof *number; i++)
        hf_json_number(j, number[i].key, number[i].value);
    hf_json_bool(j, "fit_converged", fit->converged);
    hf_json_list(j, "frequency_Hz", s->surface.frequencies_Hz.value, s->surface.frequencies_Hz.n);
    hf_json_list(j, "gain_loss_dB", m->gain_loss_dB, s->surface.frequencies_Hz.n);
    hf_json_list(j, "fit_gain_loss_dB", m->fit_gain_loss_dB, s->surface.frequencies_Hz.n);
    hf_json_close(j, '}');
}

static void write_truss(const hf_summary *s, hf_json *j)
{
    hf_json_line(j, " ");
    hf_json_open(j, "truss", '{');
    hf_json_number(j, "mass_kg", s->truss_mass_kg);
    hf_json_integer(j, "nodes", s->truss_nodes);
    hf_json_integer(j, "members", s->truss_members);
    hf_json_close(j, '}');
}

static void write_coupling(const hf_coupling_result *r, hf_json *j)
{
    hf_json_line(j, " ");
    hf_json_open(j, "coupling", '{');
    write_fields(hf_coupling_field_of, HF_COUPLING_N, 1, LAST_PLACE, r, j);
    hf_json_close(j, '}');
}

static void write_optimize(const hf_summary *s, hf_json *j)
{
    hf_json_line(j, " ");
    hf_json_open(j, "optimize", '{');
    write_result(&s->best, j);
    hf_json_integer(j, "generations", s->generations);
    hf_json_integer(j, "evaluations", s->evaluations);
    hf_json_integer(j, "infeasible", s->infeasible);
    hf_json_number(j, "base_psi_m", s->base_psi_m);
    hf_json_integer(j, "best_generation", s->best_generation);
    hf_json_integer(j, "best_individual", s->best_individual);
    hf_json_number(j, "wall_s", s->optimize_wall_s);
    hf_json_number(j, "cpu_s", s->optimize_cpu_s);
    hf_json_integer(j, "independent_genes", s->n_leader);
    hf_json_text(j, "solver", hf_solver_word[s->solver]);
    hf_json_text(j, "stop_reason", hf_population_stop_word[s->optimize_stop]);
    write_surface(s, 1, j);
    hf_json_close(j, '}');
}

static void write_polish(const hf_summary *s, hf_json *j)
{
    hf_json_line(j, " ");
    hf_json_open(j, "polish", '{');
    write_result(&s->polish, j);
    hf_json_integer(j, "lm_iterations", s->polish_iterations);
    hf_json_integer(j, "evaluations", s->polish_evaluations);
    hf_json_bool(j, "is_result", s->polish_is_result);
    hf_json_number(j, "wall_s", s->polish_wall_s);
    hf_json_text(j, "stop_reason", s->polish_converged ? "converged" : "max_iterations");
    write_surface(s, 2, j);
    hf_json_close(j, '}');
}

void hf_summary_write_json(const hf_summary *s, hf_status status, const char *messages, const char *path, FILE *f)
{
    hf_json writer = {.file = f}, *j = &writer;
    hf_json_open(j, NULL, '{');
    hf_json_text(j, "status", hf_status_word(status));
    if (s->has_truss) write_truss(s, j);
    if (s->form.status != HF_NOT_EVALUATED) {
        hf_json_line(j, " ");
        hf_json_open(j, "form", '{');
        write_result(&s->form, j);
        hf_json_text(j, "stop_reason", hf_stop_reason_word((int)s->form.stop_reason));
        hf_json_number(j, "wall_s", s->form_wall_s);
        write_surface(s, 0, j);
        hf_json_close(j, '}');
    }
    if (s->has_coupling && s->form.coupling.iterations > 0) write_coupling(&s->form.coupling, j);
    if (s->has_optimize) write_optimize(s, j);
    if (s->has_polish) write_polish(s, j);
    hf_json_line(j, " ");
    hf_json_integer(j, "threads", s->threads);
    hf_json_unsigned(j, "seed", s->seed);
    hf_json_text(j, "version", s->version);
    hf_json_line(j, " ");
    hf_json_text(j, "case", s->case_path);
    if (path) hf_json_text(j, "file", path);
    hf_json_line(j, " ");
    hf_json_lines(j, "warnings", "warning: ", messages);
    if (status != HF_OK) {
        hf_json_line(j, " ");
        hf_json_lines(j, "errors", "error: ", messages);
    }
    hf_json_close(j, '}');
    fputc('\n', f);
}

/* Writes a stored Pareto front as one CSV file:
 *
 *   id,mark,status,steps[,converged][,requirements_failed,requirements_undecided,relative_margin_min],NAME...,
 *   slope_NAME...,VARIABLE...
 *
 * converged (1 or 0) exists only for fronts by Levenberg-Marquardt, the verdicts only for cases with requirements.
 * slope_NAME is the change of the minimised objective per unit of objective NAME; it is empty where it is unknown.
 * Points are numbered from 1 in the order of the front. `hifdm evaluate` reads the file as a table of designs when the
 * rows of failed points are removed. Numbers have 17 significant digits. */
#include "out/export.h"

#include "base/csv.h"
#include "out/print.h"

#include <math.h>
#include <stdlib.h>

typedef struct {
    const hf_summary *summary;
    hf_front front;
    char *variable;
    size_t variable_size;
} view;

/* Writes a number, "inf", or an empty cell for NaN, with a comma before it. */
static void write_number(double value, FILE *f)
{
    if (isfinite(value))
        fprintf(f, ",%.17g", value);
    else
        fputs(isinf(value) ? ",inf" : ",", f);
}

static void write_front(const void *context, FILE *f)
{
    const view *v = context;
    const hf_front *front = &v->front;
    bool is_judged = hf_front_is_judged(v->summary->front);
    fputs(front->minimised >= 0 ? "id,mark,status,steps,converged" : "id,mark,status,steps", f);
    if (is_judged) fputs(",requirements_failed,requirements_undecided,relative_margin_min", f);
    for (int k = 0; k < front->n_objective; k++)
        fprintf(f, ",%s", v->summary->objectives.name[k]);
    for (int k = 0; k < front->n_objective; k++)
        if (front->minimised >= 0 && k != front->minimised) fprintf(f, ",slope_%s", v->summary->objectives.name[k]);
    for (int k = 0; k < front->n_variable; k++) {
        fputc(',', f);
        hf_csv_write_id(v->variable + (size_t)k * v->variable_size, f);
    }
    fputc('\n', f);
    for (int i = 0; i < front->n_point; i++) {
        const hf_front_point *p = &front->point[i];
        fprintf(f, "%d,%s,%s,%d", i + 1, hf_front_mark_word[p->mark], hf_status_word(p->status), p->steps);
        if (front->minimised >= 0) fprintf(f, ",%d", p->is_converged);
        if (is_judged && p->judgement.n_required == 0) fputs(",,,", f);
        if (is_judged && p->judgement.n_required > 0) {
            fprintf(f, ",%d,%d", p->judgement.n_failed, p->judgement.n_undecided);
            write_number(p->judgement.relative_margin_min, f);
        }
        for (int k = 0; k < front->n_objective; k++)
            write_number(p->objective[k], f);
        for (int k = 0; k < front->n_objective; k++)
            if (front->minimised >= 0 && k != front->minimised)
                write_number(p->multiplier[k] > 0 ? -p->multiplier[k] : p->multiplier[k], f);
        for (int k = 0; k < front->n_variable; k++)
            write_number(front->design[(size_t)i * (size_t)front->n_variable + (size_t)k], f);
        fputc('\n', f);
    }
}

static hf_status export_front(const hf_export_request *o, const hf_export_stored *stored, hf_messages *messages)
{
    view v = {.summary = &stored->summary};
    static hf_export_file file = {"", write_front, ""};
    if (!v.summary->front)
        return hf_error(messages, HF_BAD_USAGE,
                        "%s: this run has no Pareto front, because the case has no list optimize.front", o->file);
    hf_status status = hf_store_read_front(o->file, &v.front, &v.variable, &v.variable_size, messages);
    if (status == HF_OK) status = hf_export_files(o, &file, 1, &v, messages);
    hf_print_line(o->said, "%s: %d points of the front of %d objectives in %s", o->file, v.front.n_point,
                  v.front.n_objective, o->output);
    hf_front_free(&v.front);
    free(v.variable);
    return status;
}

const hf_exporter hf_exporter_front = {
    .option = "--front",
    .argument = "FILE",
    .help = "write the objectives, slopes and design of each point of the Pareto front to a CSV file",
    .write = export_front,
};

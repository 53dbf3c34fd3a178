/* Writes the far field of a shape as one CSV file:
 *
 *   frequency_Hz,phi_deg,theta_deg,co_dBi,cross_dBi
 *
 * Numbers have 17 significant digits. */
#include "out/export.h"

#include "out/print.h"
#include "surface/facet_mesh.h"

static void write_pattern(const void *context, FILE *f)
{
    const hf_pattern_table *t = context;
    const int n = t->n_cut * t->n_theta;
    fputs("frequency_Hz,phi_deg,theta_deg,co_dBi,cross_dBi\n", f);
    for (int k = 0; k < t->n_frequency * n; k++)
        fprintf(f, "%.17g,%.17g,%.17g,%.17g,%.17g\n", t->frequency_Hz[k / n], t->phi_deg[k % n / t->n_theta],
                t->theta_deg[k % t->n_theta], t->co_dBi[k], t->cross_dBi[k]);
}

/* Reports why this shape has no far field. Returns HF_BAD_USAGE. */
static hf_status refuse(const char *file, const hf_summary *s, hf_stage stage, hf_messages *messages)
{
    double pull_ratio = s->stage[stage].surface.mesh_pull_ratio;
    char words[64];
    if (pull_ratio > HF_FACET_PULL_MOST)
        return hf_error(messages, HF_BAD_USAGE,
                        "%s: this shape has no far field, because the mesh pulls on %s. The pillow formula is valid "
                        "only up to a mesh force N l of %g times the cable tension. Raise the cable tensions, or lower "
                        "surface.mesh_tension_N_per_m",
                        file, hf_facet_mesh_pull_words(pull_ratio, words), HF_FACET_PULL_MOST);
    return hf_error(messages, HF_BAD_USAGE,
                    "%s: this shape has no far field, because the case has no section surface.pattern", file);
}

static hf_status export_pattern(const hf_export_request *o, const hf_export_stored *stored, hf_messages *messages)
{
    hf_pattern_table table;
    static hf_export_file file = {"", write_pattern, ""};
    if (!stored->summary.stage[stored->stage].pattern)
        return refuse(o->file, &stored->summary, stored->stage, messages);
    HF_TRY(hf_store_read_pattern(o->file, stored->stage, &table, messages));
    hf_status status = hf_export_files(o, &file, 1, &table, messages);
    hf_print_line(o->said, "%s: far field at %d frequenc%s in %d cut%s of %d angles in %s", o->file, table.n_frequency,
                  table.n_frequency == 1 ? "y" : "ies", table.n_cut, table.n_cut == 1 ? "" : "s", table.n_theta,
                  o->output);
    hf_pattern_table_free(&table);
    return status;
}

const hf_exporter hf_exporter_pattern = {
    .option = "--pattern",
    .argument = "FILE",
    .help = "write the gain of the far field for each frequency, cut and angle to a CSV file",
    .takes_stage = true,
    .write = export_pattern,
};

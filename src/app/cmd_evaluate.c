/* `hifdm evaluate` evaluates a table of designs, for optimisers and parameter studies outside this program.
 *
 * in : one design per row, one column per design variable, with its name (hf_model_variable_name). Without
 *      optimize.variables, there is a column for each boundary cable with a free end: its id, with its pretension
 *      in N. The columns may be in any order. An optional column `id` names the rows.
 * out: id,status,psi_m,residual_N,inner_tension_ratio,boundary_tension_ratio,iterations,violation,merit, and one
 *      column per row of optimize.objective or optimize.front (hf_objectives_name). A front has no merit.
 *      One row per design, in the order of the input, with 17 significant digits. A missing value is nan. Without a
 *      column `id`, the rows are numbered from 1.
 * --jacobian: id,figure and a column per design variable. For every feasible design, the table has the derivatives
 *      of psi_m, or of each objective and of the merit.
 * --residuals: id,block,row,value and a column per design variable. For every design with a shape, the table has the
 *      residuals, positions and tensions (hf_problem_residuals), and their derivatives.
 *
 *      case -> form-finding -> table -> batch -> results, and derivatives of feasible designs
 *
 * Contents: the table - the initial design - evaluation - derivatives - writing - the command */
#include "app/output.h"

#include "base/arena.h"
#include "base/clock.h"
#include "base/csv.h"
#include "base/file_out.h"
#include "base/json.h"
#include "base/path.h"
#include "base/text.h"
#include "out/export.h"
#include "out/print.h"
#include "run/diagnose.h"
#include "run/problem_parts.h"
#include <hifdm/store.h>

#include <math.h>
#include <string.h>
#include <unistd.h>

#define COLUMN_SPARE 64 /* columns that a table may have besides one per design variable */

typedef struct {
    hf_problem problem;
    hf_csv table;
    char (*variable)[HF_VARIABLE_NAME_SIZE]; /* [n_variable], names of the design variables */
    const char **name;      /* [n_variable + 1], names of the columns: those of the design variables, then "id" */
    int *where;             /* [n_variable + 1], their columns in the table, or -1 */
    double *design;         /* [n_row][n_variable] */
    hf_form_result *result; /* [n_row] */
    double *derivative;     /* [n_feasible][n_slope][n_variable]; NULL without --jacobian */
    void *columns, *rows, *slopes; /* blocks of the arrays above */
    int n_feasible, best;          /* best: row of the minimum merit, or -1; -1 with objectives */
    double wall_s;
} job;

static void job_free(job *j)
{
    hf_csv_free(&j->table);
    hf_arena_free_block(j->columns);
    hf_arena_free_block(j->rows);
    hf_arena_free_block(j->slopes);
    hf_problem_free(&j->problem);
}

/* Reports that memory ran out for the table. Returns HF_NO_MEMORY. */
static hf_status no_memory(const job *j, hf_messages *messages)
{
    return hf_error(messages, HF_NO_MEMORY, "out of memory for %d designs of %d design variables", j->table.n_row,
                    j->problem.model.n_variable);
}

/* ---- the table ---- */

/* Names the columns of the table. Returns HF_OK, HF_NO_MEMORY, or HF_BAD_CASE if two design variables have the same
 * name. */
static hf_status name_columns(job *j, hf_messages *messages)
{
    const hf_model *m = &j->problem.model;
    size_t n = (size_t)m->n_variable + 1;
    if (HF_ARENA_ARRAYS(&j->columns, HF_ARRAY(j->variable, n), HF_ARRAY(j->name, n), HF_ARRAY(j->where, n)) != HF_OK)
        return no_memory(j, messages);
    for (int k = 0; k < m->n_variable; k++) {
        hf_model_variable_name(m, &j->problem.scene, k, j->variable[k], sizeof j->variable[k]);
        j->name[k] = j->variable[k];
    }
    j->name[m->n_variable] = "id";
    /* Cables have different ids, and so have supports. Only a cable and a variable of a support can have the same
     * name. */
    for (int k = 0; k < m->n_variable; k++) {
        for (int i = 0; m->variable_cable[k] < 0 && i < m->n_variable; i++)
            if (m->variable_cable[i] >= 0 && !strcmp(j->name[i], j->name[k]))
                return hf_error(messages, HF_BAD_CASE,
                                "optimize.variables: cable '%s' has the same name as a design variable of a support. "
                                "Rename the cable",
                                j->name[i]);
    }
    return HF_OK;
}

/* Returns the id that the user gave to a row, or NULL without a column `id`. */
static const char *row_id(const job *j, int row)
{
    int column = j->where[j->problem.model.n_variable];
    return column < 0 ? NULL : hf_csv_cell(&j->table, row, column);
}

/* Reads the design of a row. Faults are added to those of the table. */
static void read_row(job *j, int row)
{
    hf_csv *t = &j->table;
    double *design = j->design + (size_t)row * (size_t)j->problem.model.n_variable;
    for (int k = 0; k < j->problem.model.n_variable; k++) {
        if (j->where[k] < 0) continue;
        design[k] = hf_csv_number(t, row, j->where[k], row_id(j, row), j->name[k]);
        bool is_cable = j->problem.model.variable_cable[k] >= 0; /* the value for a support may have either sign */
        if (!is_cable || design[k] > 0 || isnan(design[k])) continue;
        char what[512];
        snprintf(what, sizeof what, "%s must be above zero, not ", j->name[k]);
        hf_csv_fault(t, t->line[row], row_id(j, row), what, hf_csv_cell(t, row, j->where[k]));
    }
}

static hf_status read_table(job *j, const char *path, hf_messages *messages)
{
    int n_variable = j->problem.model.n_variable;
    hf_csv *t = &j->table;
    int most = n_variable > j->problem.scene.n_cable ? n_variable : j->problem.scene.n_cable;
    hf_status status = hf_csv_read(path, most + COLUMN_SPARE, t, messages);
    /* A fault in one line does not end the reading: one run reports the faults of all lines. */
    if (status == HF_NO_MEMORY || t->n_row == 0 || t->n_fault > HF_FAULT_MAX) return status;
    t->names_are_ids = true;
    status = hf_csv_find_columns(t, j->name, n_variable + 1, n_variable, j->where);
    if (t->n_fault > HF_FAULT_MAX) return status;
    size_t n = (size_t)t->n_row;
    if (HF_ARENA_ARRAYS(&j->rows, HF_ARRAY(j->design, n * (size_t)n_variable), HF_ARRAY(j->result, n)) != HF_OK)
        return no_memory(j, messages);
    for (int row = 0; row < t->n_row; row++)
        read_row(j, row);
    return hf_csv_close_faults(t);
}

/* ---- the initial design ---- */

/* Runs the form-finding. The solve of each design starts from its tensions and force densities. */
static hf_status find_initial(job *j, hf_messages *messages)
{
    hf_problem *p = &j->problem;
    HF_TRY(hf_problem_allocate(p, messages));
    hf_evaluate_form(&p->model, &p->settings.form, &p->workspace, NULL, &p->form);
    HF_TRY(hf_problem_explain(p, messages));
    return hf_problem_base(p, messages);
}

/* ---- evaluation ---- */

/* Evaluates the designs exactly as `hifdm run` evaluates its individuals: the results have the same bits. The cap on
 * the boundary tension ratio is that of the section optimize. */
static hf_status evaluate(job *j, int threads, hf_messages *messages)
{
    double start_s = hf_clock_s();
    if (hf_problem_batch(&j->problem, threads) != HF_OK) return no_memory(j, messages);
    HF_TRY(hf_problem_share(&j->problem, messages));
    hf_batch_run(&j->problem.batch, j->table.n_row, j->design, NULL, j->result);
    j->wall_s = hf_clock_s() - start_s;
    for (int i = 0; i < j->table.n_row; i++) {
        if (j->result[i].status != HF_OK) continue;
        j->n_feasible++;
        if (!hf_problem_has_merit(&j->problem)) continue;
        if (j->best < 0 || j->result[i].merit < j->result[j->best].merit) j->best = i;
    }
    return HF_OK;
}

/* ---- derivatives ---- */

static hf_status differentiate(job *j, hf_messages *messages)
{
    size_t n = (size_t)hf_problem_n_slope(&j->problem) * (size_t)j->problem.model.n_variable;
    if (HF_ARENA_ARRAYS(&j->slopes, HF_ARRAY(j->derivative, n * (size_t)j->n_feasible)) != HF_OK)
        return no_memory(j, messages);
    return hf_problem_slopes(&j->problem, j->table.n_row, j->design, j->result, j->derivative, messages);
}

/* Computes the residuals residual [n_row] and their derivatives jacobian [n_row][n_variable] of a design. If there are
 * none, all are NaN. Returns HF_OK or HF_NO_MEMORY. */
static hf_status find_residuals(job *j, int row, size_t n_row, double *residual, double *jacobian,
                                hf_messages *messages)
{
    size_t n = (size_t)j->problem.model.n_variable;
    hf_messages said = {0};
    hf_status status = hf_problem_residuals(&j->problem, j->design + (size_t)row * n, ~0u, residual, jacobian, &said);
    hf_messages_free(&said);
    if (status == HF_NO_MEMORY) return no_memory(j, messages);
    for (size_t i = 0; i < n_row * (n + 1) && status != HF_OK; i++)
        *(i < n_row ? residual + i : jacobian + i - n_row) = (double)NAN;
    return HF_OK;
}

/* ---- writing ---- */

static void write_number(double value, FILE *f)
{
    if (isnan(value)) /* printf would print the sign of a NaN */
        fputs(",nan", f);
    else
        fprintf(f, ",%.17g", value);
}

static void write_row_id(const job *j, int row, FILE *f)
{
    if (row_id(j, row))
        hf_csv_write_id(row_id(j, row), f);
    else
        fprintf(f, "%d", row + 1);
}

static void write_figure(const hf_result_field *field, const hf_form_result *r, FILE *f)
{
    const void *value = (const char *)r + field->offset;
    if (field->kind == HF_RESULT_REAL)
        write_number(*(const double *)value, f);
    else if (field->kind == HF_RESULT_STATUS)
        fprintf(f, ",%s", hf_status_word(*(const hf_status *)value));
    else
        fprintf(f, ",%d", *(const int *)value);
}

static void write_results(const void *context, FILE *f)
{
    const job *j = context;
    const hf_objectives *objectives = &j->problem.objectives;
    const hf_result_field *field[HF_RESULT_N_INDIVIDUAL];
    int n_field = hf_problem_list_figures(&j->problem, field);
    fputs("id", f);
    for (int k = 0; k < n_field; k++)
        fprintf(f, ",%s", field[k]->name);
    for (int k = 0; k < objectives->n_objective; k++) {
        char name[HF_OBJECTIVE_NAME_SIZE];
        fprintf(f, ",%s", hf_objectives_name(objectives, k, name));
    }
    fputc('\n', f);
    for (int i = 0; i < j->table.n_row; i++) {
        write_row_id(j, i, f);
        for (int k = 0; k < n_field; k++)
            write_figure(field[k], &j->result[i], f);
        /* A design that only breaks a limit has a shape, and therefore objectives. */
        for (int k = 0; k < objectives->n_objective; k++)
            write_number(hf_status_has_shape(j->result[i].status) ? j->result[i].objective[k] : (double)NAN, f);
        fputc('\n', f);
    }
}

static void write_variable_names(const job *j, FILE *f)
{
    for (int k = 0; k < j->problem.model.n_variable; k++) {
        fputc(',', f);
        hf_csv_write_id(j->name[k], f);
    }
    fputc('\n', f);
}

static void write_jacobian(const void *context, FILE *f)
{
    const job *j = context;
    int n_variable = j->problem.model.n_variable;
    const double *value = j->derivative;
    fputs("id,figure", f);
    write_variable_names(j, f);
    for (int i = 0; i < j->table.n_row; i++) {
        if (j->result[i].status != HF_OK) continue;
        for (int k = 0; k < hf_problem_n_slope(&j->problem); k++) {
            char name[HF_OBJECTIVE_NAME_SIZE];
            write_row_id(j, i, f);
            fprintf(f, ",%s", hf_problem_slope_name(&j->problem, k, name));
            for (int variable = 0; variable < n_variable; variable++)
                write_number(*value++, f);
            fputc('\n', f);
        }
    }
}

/* The table of residuals may be large. It is therefore written while it is computed. */
typedef struct {
    job *j;
    size_t n_row;                /* of one design */
    double *residual, *jacobian; /* [n_row], [n_row][n_variable] */
    hf_status status;
    hf_messages *messages;
} residual_table;

/* Writes the name of a row of a block: a coordinate of a node, a cable, or the number of a residual. */
static void write_row_name(const hf_scene *s, const char *block, int row, FILE *f)
{
    fputc(',', f);
    if (!strcmp(block, "tension_N")) {
        hf_csv_write_id(s->cable_id[row], f);
    } else if (!strcmp(block, "position_m")) {
        char name[HF_VARIABLE_NAME_SIZE];
        snprintf(name, sizeof name, "%s.%c", s->node_id[row / 3], "xyz"[row % 3]);
        hf_csv_write_id(name, f);
    } else {
        fprintf(f, "%d", row + 1);
    }
}

static void write_residuals_of(const residual_table *t, int i, FILE *f)
{
    const hf_problem *p = &t->j->problem;
    const double *residual = t->residual, *rate = t->jacobian;
    char name[HF_OBJECTIVE_NAME_SIZE];
    for (int block = 0, n; (n = hf_problem_block(p, block, name)) >= 0; block++)
        for (int row = 0; row < n; row++) {
            write_row_id(t->j, i, f);
            fprintf(f, ",%s", name);
            write_row_name(&p->scene, name, row, f);
            write_number(*residual++, f);
            for (int k = 0; k < p->model.n_variable; k++)
                write_number(*rate++, f);
            fputc('\n', f);
        }
}

static void write_residuals(const void *context, FILE *f)
{
    residual_table *t = *(residual_table *const *)context;
    fputs("id,block,row,value", f);
    write_variable_names(t->j, f);
    for (int i = 0; i < t->j->table.n_row && t->status == HF_OK; i++) {
        if (!hf_status_has_shape(t->j->result[i].status)) continue;
        t->status = find_residuals(t->j, i, t->n_row, t->residual, t->jacobian, t->messages);
        if (t->status == HF_OK) write_residuals_of(t, i, f);
    }
}

/* Adds the table of residuals to the files. */
static hf_status add_residuals(job *j, hf_file_out_set *files, const char *path, hf_messages *messages)
{
    residual_table table = {.j = j, .messages = messages}, *t = &table;
    char name[HF_OBJECTIVE_NAME_SIZE];
    void *block = NULL;
    for (int i = 0, n; (n = hf_problem_block(&j->problem, i, name)) >= 0; i++)
        t->n_row += (size_t)n;
    if (HF_ARENA_ARRAYS(&block, HF_ARRAY(t->residual, t->n_row),
                        HF_ARRAY(t->jacobian, t->n_row * (size_t)j->problem.model.n_variable)) != HF_OK)
        return no_memory(j, messages);
    hf_status status = hf_file_out_set_write(files, path, write_residuals, &t, messages);
    hf_arena_free_block(block);
    return status == HF_OK ? t->status : status;
}

static void write_template(const void *context, FILE *f)
{
    const job *j = context;
    fputs("id", f);
    write_variable_names(j, f);
    fputs("initial", f);
    for (int k = 0; k < j->problem.model.n_variable; k++)
        write_number(j->problem.initial[k], f);
    fputc('\n', f);
}

static void print_summary(const job *j, const char *path, FILE *f)
{
    char best[400] = "", row[16]; /* a longer id is truncated */
    snprintf(row, sizeof row, "%d", j->best + 1);
    hf_print_text counted = hf_print_counted(j->problem.model.n_inner_node, j->problem.model.n_free);
    const char *id = j->best >= 0 && row_id(j, j->best) ? row_id(j, j->best) : row;
    if (j->best >= 0 && j->problem.objectives.n_objective)
        snprintf(best, sizeof best, "; best merit %.6g, %s", j->result[j->best].merit, id);
    else if (j->best >= 0)
        snprintf(best, sizeof best, "; best psi %.4f mm%s%s, %s", j->result[j->best].psi_m * 1e3,
                 *counted.text ? " of " : "", counted.text, id);
    hf_print_line(f, "%d designs, %d feasible%s; %s, %.0f evaluations/s by %s on %d thread%s; results in %s",
                  j->table.n_row, j->n_feasible, best, hf_print_duration(j->wall_s).text, j->table.n_row / j->wall_s,
                  hf_solver_word[j->problem.solver], j->problem.batch.n_thread,
                  j->problem.batch.n_thread == 1 ? "" : "s", path);
}

/* Prints the best design, and with optimize.objective its objectives. */
static void print_best(const job *from, hf_json *j)
{
    const hf_objectives *objectives = &from->problem.objectives;
    const hf_form_result *best = from->best < 0 ? NULL : &from->result[from->best];
    hf_json_number(j, "best_psi_m", best ? best->psi_m : (double)NAN);
    hf_json_integer(j, "best_row", from->best + 1);
    if (objectives->n_objective == 0) return;
    hf_json_number(j, "best_merit", best ? best->merit : (double)NAN);
    hf_json_open(j, "best_objectives", '{');
    for (int k = 0; k < objectives->n_objective; k++) {
        char name[HF_OBJECTIVE_NAME_SIZE];
        hf_json_number(j, hf_objectives_name(objectives, k, name), best ? best->objective[k] : (double)NAN);
    }
    hf_json_close(j, '}');
}

static void print_json(const job *from, const char *path, const hf_options *o, hf_status status, const char *messages,
                       FILE *f)
{
    hf_json j = {.file = f};
    hf_json_open(&j, NULL, '{');
    hf_json_text(&j, "status", hf_status_word(status));
    if (status == HF_OK && from->result) {
        hf_json_line(&j, " ");
        hf_json_integer(&j, "designs", from->table.n_row);
        hf_json_integer(&j, "feasible", from->n_feasible);
        if (hf_problem_has_merit(&from->problem)) print_best(from, &j);
        hf_json_integer(&j, "threads", from->problem.batch.n_thread);
        hf_json_text(&j, "solver", hf_solver_word[from->problem.solver]);
        hf_json_number(&j, "wall_s", from->wall_s);
        hf_json_number(&j, "cpu_s", from->problem.batch.cpu_s);
    }
    hf_json_line(&j, " ");
    hf_json_text(&j, "version", hf_store_version());
    hf_json_text(&j, "case", from->problem.settings.path);
    if (status == HF_OK) hf_json_text(&j, "file", path);
    if (status == HF_OK && o->jacobian) hf_json_text(&j, "jacobian", o->jacobian);
    if (status == HF_OK && o->residuals) hf_json_text(&j, "residuals", o->residuals);
    hf_json_end(&j, status != HF_OK, messages);
}

/* ---- the command ---- */

static hf_status execute(job *j, const hf_options *o, const char *path, FILE *file, hf_messages *messages)
{
    HF_TRY(hf_problem_load(o->file, NULL, o->set, o->n_set, NULL, &j->problem, messages));
    if (j->problem.model.n_variable == 0)
        return hf_error(messages, HF_BAD_CASE,
                        "%s: no boundary cable has a free end, so the case has no design variables. Add the list "
                        "optimize.variables to the case",
                        o->file);
    HF_TRY(hf_output_check(o, &j->problem, o->designs, path, messages));
    HF_TRY(hf_output_check(o, &j->problem, o->designs, o->jacobian, messages));
    HF_TRY(hf_output_check(o, &j->problem, o->designs, o->residuals, messages));
    HF_TRY(name_columns(j, messages));
    if (o->designs) HF_TRY(read_table(j, o->designs, messages));
    HF_TRY(find_initial(j, messages));
    if (o->template_path) return hf_file_out_write(path, write_template, j, messages);
    if (o->jacobian || o->residuals) HF_TRY(hf_problem_has_slopes(&j->problem, messages));
    HF_TRY(evaluate(j, o->threads, messages));
    static hf_file_out_set files; /* all tables are written, or none */
    hf_status status = HF_OK;
    if (o->jacobian) status = differentiate(j, messages);
    if (status == HF_OK && o->jacobian)
        status = hf_file_out_set_write(&files, o->jacobian, write_jacobian, j, messages);
    if (status == HF_OK && o->residuals) status = add_residuals(j, &files, o->residuals, messages);
    if (status == HF_OK && path) status = hf_file_out_set_write(&files, path, write_results, j, messages);
    status = hf_file_out_set_end(&files, status, messages);
    if (status == HF_OK && !path) write_results(j, file);
    return status;
}

static hf_status check_options(const hf_options *o, hf_messages *messages)
{
    static const char *const option[] = {"-o", "--jacobian", "--residuals"};
    static const char *const what[] = {"the table of results", "the table of derivatives"};
    const char *const path[] = {o->output, o->jacobian, o->residuals};
    if (!o->designs == !o->template_path)
        return hf_error(messages, HF_BAD_USAGE,
                        "'hifdm evaluate' needs either the option --designs FILE or the option --template FILE");
    if (o->template_path && o->output)
        return hf_error(messages, HF_BAD_USAGE, "the options -o and --template cannot be combined");
    for (int i = 1; i < 3; i++) {
        if (o->template_path && path[i])
            return hf_error(messages, HF_BAD_USAGE, "the option %s needs --designs FILE", option[i]);
        for (int k = 0; k < i && path[i]; k++) {
            if (path[k] && hf_path_will_be_same(path[i], path[k]))
                return hf_error(messages, HF_BAD_USAGE, "the options %s and %s must name different files", option[i],
                                option[k]);
            if (path[k]) HF_TRY(hf_file_out_spare(path[k], what[k], path[i], messages));
        }
    }
    if (o->designs && o->json && !o->output)
        return hf_error(messages, HF_BAD_USAGE,
                        "the option --json needs -o FILE, because JSON and the table cannot share the standard output");
    return HF_OK;
}

/* Runs the command: evaluates options->designs and writes the table to options->output, or to `file` without one. With
 * options->template_path, writes a table with the initial design as its only row instead. `file` also receives a line
 * for people or, with options->json, one JSON object. Returns HF_OK, also if designs are infeasible, HF_BAD_USAGE,
 * HF_BAD_CASE for a faulty case or table, HF_EXISTS, HF_IO, HF_NO_MEMORY, or the status of a form-finding that
 * failed. */
static hf_status command_evaluate(const hf_options *options, FILE *file, hf_messages *messages)
{
    HF_TRY(check_options(options, messages));
    static job j; /* too large for a small stack */
    memset(&j, 0, sizeof j);
    j.best = -1;
    const char *path = options->template_path ? options->template_path : options->output;
    hf_status status = execute(&j, options, path, file, messages);
    if (options->json)
        print_json(&j, path, options, status, messages->text, file);
    else if (status == HF_OK && path && !options->quiet && options->designs)
        print_summary(&j, path, file);
    else if (status == HF_OK && path && !options->quiet)
        hf_print_line(file, "%d %s after form-finding in %s", j.problem.model.n_variable,
                      j.problem.model.variable ? "variables; their values" : "adjustable cables; their tensions", path);
    job_free(&j);
    return status;
}

const hf_command hf_cmd_evaluate = {
    .name = "evaluate",
    .argument = "CASE",
    .help = "evaluate a table of designs and write a table of their results",
    .about = "Use this command to evaluate the designs of your own optimiser. Each row of the input table is a design "
             "with one value for each design variable of the case. The list optimize.variables defines the design "
             "variables. Without the list optimize.variables, the design variables are the pretensions in N of all "
             "boundary cables with a free end. Each row of the output table contains psi, the residual, the tension "
             "ratios and the objectives of one design. The results are bit-identical to the results of hifdm run. The "
             "command uses all cores.",
    .examples = "hifdm evaluate case.yaml --template base.csv\n"
                "hifdm evaluate case.yaml --designs designs.csv -o results.csv\n"
                "hifdm evaluate case.yaml --designs designs.csv -o results.csv --jacobian slopes.csv",
    .uses_threads = true,
    .run = command_evaluate,
};

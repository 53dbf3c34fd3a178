/* Writes the page of one result: reads what it shows from the result file and writes it as JSON. Contents: texts, net
 * and shapes, series, the far field, the page with a second result, reading. */
#include "out/report.h"

#include "base/arena.h"
#include "base/path.h"
#include "out/cut.h"
#include "out/print_summary.h"
#include "out/report_required.h"
#include "out/words.h"
#include "surface/facet_mesh.h"
#include "store/ledger.h"
#include "store/store_read.h"
#include "store/store_series.h"
#include <hifdm/metrics.h>

#include <limits.h>
#include <math.h>
#include <string.h>

#define POINTS_MAX 1000 /* points of a series on the page, about what a screen can show */
/* Size of the answer: usually 100 bytes, 20 more for each frequency, and the error of a failed run. Longer text is
 * cut. */
#define ANSWER_SIZE 8192
#define ANGLES_MAX 1000       /* angles of a cut on the page, about what a screen can show */
#define GAINS_MAX 100000      /* gains of all cuts of a shape, about 600 kB */
#define PROVENANCE_SIZE 16384 /* usually 500 bytes; lines that do not fit are left out */

/* The series of a page: their paths in the file, and their numbers of columns. Those of a chart have a group and a key
 * on the page. The first row of a group sets the length of its series; those of another length are left out. */
enum { PSI_BY_CUT, CABLE_SHARE, TRUSS_POSITION, TRUSS_DISPLACEMENT, TRUSS_END, FIRST_CHART };
static const struct {
    const char *group, *path, *key;
    int columns;
} series_table[] = {
    [PSI_BY_CUT] = {"", "/tolerance/psi_by_cut", "", 1},   /* [n_cable] of the as-built net */
    [CABLE_SHARE] = {"", "/tolerance/cable_share", "", 1}, /* [n_cable] shares in its error */
    [TRUSS_POSITION] = {"", "/truss/node/position_m", "", 3},
    [TRUSS_DISPLACEMENT] = {"", "/truss/node/displacement", "", 6},
    [TRUSS_END] = {"", "/truss/member/end", "", 2},
    [FIRST_CHART] = {"history", "/form/history/psi_m", "psi_m", 1},
    {"history", "/form/history/inner_tension_ratio", "inner_tension_ratio", 1},
    {"history", "/form/history/boundary_tension_ratio", "boundary_tension_ratio", 1},
    {"history", "/form/history/residual_N", "residual_N", 1},
    {"search", "/search/population/best_psi_m", "best_psi_m", 1},
    {"search", "/search/population/mean_psi_m", "mean_psi_m", 1},
    {"search", "/search/population/worst_psi_m", "worst_psi_m", 1},
    {"search", "/search/population/n_infeasible", "n_infeasible", 1},
    {"coupling", "/coupling/history/step_m", "step_m", 1},
    {"coupling", "/coupling/history/psi_m", "psi_m", 1},
    {"coupling", "/coupling/history/deflection_max_m", "deflection_max_m", 1},
};
enum { N_SERIES = sizeof series_table / sizeof *series_table };

enum { N_SHAPE = HF_N_STAGE + HF_LOAD_CASES_MAX }; /* shapes of the stages, then of the load cases */

/* Holds everything that a page shows. */
typedef struct page {
    const char *path;
    hf_summary summary;
    hf_scene scene;
    bool has_shape[N_SHAPE];
    hf_shape shape[N_SHAPE];
    hf_series load_case_displacement[HF_LOAD_CASES_MAX]; /* [n][6] of the truss in a load case; may be empty */
    hf_series series[N_SERIES];                          /* each may be empty */
    hf_facets facets;                                    /* empty when the case does not measure the surface */
    hf_facet_errors facet_error[N_SHAPE];                /* errors of each shape, in facet_block */
    void *facet_block;
    hf_pattern_table pattern[HF_N_STAGE]; /* without angles: empty */
    hf_report_curves required;            /* samples of the figures that requirements bound */
    char provenance[PROVENANCE_SIZE];
    hf_texts case_text, overrides; /* one text each */
    const struct page *other;      /* the result for comparison, or NULL */
    const hf_report_part *part;    /* an addition of the command, or NULL */
} page;

/* ---- texts ---- */

/* Writes small numbers as a string of digits. */
static void write_codes(const char *key, const unsigned char *value, int n, FILE *f)
{
    fprintf(f, ",\"%s\":\"", key);
    for (int i = 0; i < n; i++)
        fputc('0' + value[i], f);
    fputc('"', f);
}

/* Returns the heading of the page: the title of the case or, without a title, the name of the case file. */
static const char *heading(const hf_summary *s)
{
    return *s->title ? s->title : hf_path_name(s->case_path);
}

/* Returns the text that `print` prints, the answer or the gain losses; "" when it prints nothing. */
static const char *said_of(const hf_summary *s, void (*print)(const hf_summary *s, FILE *f), char text[ANSWER_SIZE])
{
    *text = '\0';
    FILE *f = fmemopen(text, ANSWER_SIZE, "w");
    if (!f) return text;
    print(s, f);
    fclose(f);
    return text;
}

static void write_answers(const hf_summary *s, hf_json *j)
{
    char said[ANSWER_SIZE];
    hf_json_text(j, "answer", said_of(s, hf_print_answer, said));
    hf_json_text(j, "gain_loss", said_of(s, hf_print_gain_loss, said));
}

/* Writes the answer of the page; of two results both, each with the name of its file. */
static void write_headline(const page *p, char text[ANSWER_SIZE])
{
    FILE *f = fmemopen(text, ANSWER_SIZE, "w");
    if (!f) return;
    if (p->other) fprintf(f, "%s: ", hf_path_name(p->path));
    hf_print_answer(&p->summary, f);
    if (p->other) fprintf(f, "; %s: ", hf_path_name(p->other->path));
    if (p->other) hf_print_answer(&p->other->summary, f);
    fclose(f);
}

/* ---- net and shapes ---- */

static void write_integers(const char *key, const int *value, int n, FILE *f)
{
    hf_json_packed packed = hf_json_pack(key, "i32", f);
    for (int i = 0; i < n; i++)
        hf_json_pack_value(&packed, value[i]);
    hf_json_pack_end(&packed);
}

static void write_sets(const hf_scene *s, FILE *f)
{
    fputs(",\"sets\":[", f);
    for (int k = 0; k < s->n_set; k++) {
        fputs(k ? ",{\"name\":" : "{\"name\":", f);
        hf_json_string(s->set_name[k], f);
        write_integers("cable", s->set_cable + s->set_start[k], s->set_start[k + 1] - s->set_start[k], f);
        fputc('}', f);
    }
    fputc(']', f);
}

static void write_net(const page *p, FILE *f)
{
    const hf_scene *s = &p->scene;
    fprintf(f, ",\n\"net\":{\"n_node\":%d,\"n_cable\":%d", s->n_node, s->n_cable);
    hf_json_strings("role_word", hf_role_word, 3, f);
    hf_json_strings("group_word", hf_group_word, 2, f);
    hf_json_strings("law_word", hf_law_word, HF_N_LAW, f);
    hf_json_strings("node_id", s->node_id, s->n_node, f);
    hf_json_pack_values("position_m", "f64", s->position_m, 3 * s->n_node, f);
    write_codes("role", s->role, s->n_node, f);
    hf_json_strings("cable_id", s->cable_id, s->n_cable, f);
    write_integers("end", s->end, 2 * s->n_cable, f);
    write_codes("group", s->group, s->n_cable, f);
    write_sets(s, f);
    const hf_series *psi_by_cut = &p->series[PSI_BY_CUT], *share = &p->series[CABLE_SHARE];
    if (psi_by_cut->n == s->n_cable && !isnan(psi_by_cut->value[0]))
        hf_json_pack_values("psi_by_cut", "f32", psi_by_cut->value, s->n_cable, f);
    if (share->n == s->n_cable) hf_json_pack_values("cable_share", "f32", share->value, s->n_cable, f);
    if (p->facets.n_facet) write_integers("facets", p->facets.corner, 4 * p->facets.n_facet, f);
    fputc('}', f);
}

/* Writes the displacements of the nodes of the truss without rotations, or nothing when there are none. */
static void write_displacement(const char *key, const hf_series *d, FILE *f)
{
    if (!d->n) return;
    hf_json_packed packed = hf_json_pack(key, "f32", f);
    for (int i = 0; i < 3 * d->n; i++)
        hf_json_pack_value(&packed, d->value[6 * (i / 3) + i % 3]);
    hf_json_pack_end(&packed);
}

/* Writes cutting lengths and their differences from the target positions for a stage. A cable without EA has NaN.
 * Writes nothing when no cable has EA. */
static void write_cuts(const page *p, const hf_shape *shape, FILE *f)
{
    const hf_scene *s = &p->scene;
    double reference_N = hf_model_reference_N(s, p->summary.pretension_N);
    if (!s->EA_N) return;
    for (int is_change = 0; is_change < 2; is_change++) {
        hf_json_packed packed = is_change ? hf_json_pack("unstressed_minus_target_m", "f32", f)
                                          : hf_json_pack("unstressed_length_m", "f64", f);
        for (int e = 0; e < s->n_cable; e++) {
            hf_cut c = hf_cut_of(s, shape, reference_N, e);
            hf_json_pack_value(&packed, is_change ? c.unstressed_minus_target_m : c.l0_m);
        }
        hf_json_pack_end(&packed);
    }
}

/* Writes a shape as displacements from the target positions. In single precision a displacement has a resolution of
 * nanometres, a position only of micrometres. */
static void write_shape(const page *p, int stage, FILE *f)
{
    const hf_shape *shape = &p->shape[stage];
    if (stage < HF_N_STAGE) {
        fprintf(f, "{\"stage\":\"%s\"", hf_stage_word[stage]);
    } else { /* names consist of letters, digits, _ and - */
        const char *name = p->summary.load_case[stage - HF_N_STAGE].name;
        fprintf(f, "{\"stage\":\"load case %s\",\"load_case\":\"%s\"", name, name);
        write_displacement("truss_displacement_m", &p->load_case_displacement[stage - HF_N_STAGE], f);
    }
    hf_json_packed packed = hf_json_pack("displacement_m", "f32", f);
    for (int i = 0; i < 3 * p->scene.n_node; i++)
        hf_json_pack_value(&packed, shape->position_m[i] - p->scene.position_m[i]);
    hf_json_pack_end(&packed);
    hf_json_pack_values("length_m", "f32", shape->length_m, p->scene.n_cable, f);
    hf_json_pack_values("tension_N", "f32", shape->tension_N, p->scene.n_cable, f);
    write_codes("law", shape->law, p->scene.n_cable, f);
    if (stage < HF_N_STAGE) write_cuts(p, shape, f);
    if (p->facets.n_facet) {
        const hf_facet_errors *e = &p->facet_error[stage];
        hf_json_pack_values("facet_normal_mean_m", "f32", e->normal_mean_m, p->facets.n_facet, f);
        hf_json_pack_values("facet_normal_rms_m", "f32", e->normal_rms_m, p->facets.n_facet, f);
        hf_json_pack_values("facet_fit_normal_mean_m", "f32", e->fit_normal_mean_m, p->facets.n_facet, f);
    }
    fputc('}', f);
}

static void write_shapes(const page *p, int n, FILE *f)
{
    const char *comma = "";
    fputs(",\n\"slack_below_N\":", f);
    hf_json_value(HF_SLACK_RATIO * hf_model_reference_N(&p->scene, p->summary.pretension_N), 17, f);
    fputs(",\n\"shapes\":[", f);
    for (int i = 0; i < n; i++) {
        if (!p->has_shape[i]) continue;
        fputs(comma, f);
        write_shape(p, i, f);
        comma = ",\n";
    }
    fputc(']', f);
}

static void write_truss(const page *p, FILE *f)
{
    const hf_series *node = &p->series[TRUSS_POSITION], *end = &p->series[TRUSS_END];
    if (!node->n || !end->n) return;
    fprintf(f, ",\n\"truss\":{\"n_node\":%d,\"n_member\":%d", node->n, end->n);
    hf_json_pack_values("position_m", "f64", node->value, 3 * node->n, f);
    hf_json_pack_values("end", "i32", end->value, 2 * end->n, f);
    if (p->series[TRUSS_DISPLACEMENT].n == node->n)
        write_displacement("displacement_m", &p->series[TRUSS_DISPLACEMENT], f);
    fputc('}', f);
}

/* Writes key, unit and description of each figure of a result. The page can then show a figure that it has no text
 * for. */
static void write_figures(hf_json *j)
{
    hf_json_open_line(j, "", "figures", '[');
    for (const hf_result_field *figure = hf_result_field_of; figure < hf_result_field_of + HF_RESULT_N; figure++) {
        if (!figure->json) continue;
        hf_json_open(j, NULL, '{');
        hf_json_text(j, "key", hf_result_key(figure));
        hf_json_text(j, "units", figure->units ? figure->units : "");
        hf_json_text(j, "description", figure->description);
        hf_json_close(j, '}');
    }
    hf_json_close(j, ']');
}

/* Writes the units of objectives by their names. */
static void write_objective_units(const hf_summary *s, hf_json *j)
{
    hf_json_open_line(j, "", "objective_unit", '{');
    for (int k = 0; k < s->objectives.n; k++)
        hf_json_text(j, s->objectives.name[k], hf_ledger_objective_unit(s->objectives.name[k]));
    hf_json_close(j, '}');
}

static void write_word(hf_json *j, const hf_word *w, const char *name)
{
    hf_json_open(j, NULL, '{');
    hf_json_text(j, "word", name);
    if (!strcmp(w->kind, "term")) hf_json_bool(j, "term", true);
    if (strstr(w->kind, "_reason")) hf_json_text(j, "of", w->kind);
    hf_json_text(j, "text", w->text);
    hf_json_close(j, '}');
}

/* Writes terms, descriptions of figures, and the words of stop reasons and bounds, as `hifdm explain` prints them.
 * Figures and reasons also have their earlier names. */
static void write_words(hf_json *j)
{
    hf_json_open_line(j, "", "words", '[');
    for (int i = 0; i < hf_word_count(); i++) {
        const hf_word w = hf_word_at(i);
        bool is_term = !strcmp(w.kind, "term");
        if (!is_term && strncmp(w.kind, "figure", 6) != 0 && !strstr(w.kind, "_reason")) continue;
        write_word(j, &w, w.word);
        for (const char *p = w.formerly; !is_term && *p; p = hf_word_next(p))
            write_word(j, &w, p);
    }
    hf_json_close(j, ']');
}

/* ---- series ---- */

static void write_series(const page *p, FILE *f)
{
    for (int i = FIRST_CHART, k; i < N_SERIES; i = k) {
        int n = p->series[i].n, stride = (n + POINTS_MAX - 1) / POINTS_MAX;
        if (n) fprintf(f, ",\n\"%s\":{\"n\":%d,\"stride\":%d", series_table[i].group, n, stride);
        for (k = i; k < N_SERIES && series_table[k].group == series_table[i].group; k++)
            if (n && p->series[k].n == n) hf_json_values(series_table[k].key, p->series[k].value, n, stride, 9, f);
        if (n) fputc('}', f);
    }
}

/* ---- the far field ---- */

static double highest(const double *value, int n)
{
    double most = -(double)INFINITY;
    for (int i = 0; i < n; i++)
        most = fmax(most, value[i]);
    return most;
}

/* Returns the number of neighbouring angles that share a point. */
static int stride_of(const hf_pattern_table *t)
{
    int most = GAINS_MAX / (t->n_frequency * t->n_cut);
    if (most > ANGLES_MAX) most = ANGLES_MAX;
    return (t->n_theta + most - 1) / most;
}

/* Writes one cut. The maximum of each few neighbours is kept, because a sidelobe can lie between two of the angles that
 * remain. */
static void write_cut(const hf_pattern_table *t, int k, const hf_cut_figures *c, FILE *f)
{
    hf_json j = {.file = f};
    const double *co_dBi = t->co_dBi + (size_t)k * (size_t)t->n_theta;
    int stride = stride_of(t), i_cut = k % t->n_cut;
    double cross_dBi = highest(t->cross_dBi + (size_t)k * (size_t)t->n_theta, t->n_theta);
    hf_json_open(&j, NULL, '{');
    HF_JSON_NUMBERS(&j, {"frequency_Hz", t->frequency_Hz[k / t->n_cut]}, {"phi_deg", t->phi_deg[i_cut]},
                    {"gain_dBi", c->gain_dBi}, {"beam_deg", c->beam_deg},
                    {"half_power_width_deg", c->half_power_width_deg}, {"first_sidelobe_dB", c->first_sidelobe_dB},
                    {"highest_sidelobe_dB", c->highest_sidelobe_dB}, {"cross_dB", cross_dBi - c->gain_dBi});
    fputs(",\"co_dBi\":[", f);
    for (int i = 0; i < t->n_theta; i += stride) {
        if (i) fputc(',', f);
        hf_json_value(highest(co_dBi + i, t->n_theta - i < stride ? t->n_theta - i : stride), 5, f);
    }
    fputc(']', f);
    hf_json_close(&j, '}');
}

/* Writes the far field of a shape: stage, feed, theta_deg, and for each frequency and cut its figures and the gains at
 * these angles. Figures outside the range of the angles are null. */
static void write_pattern(const char *stage, const hf_pattern_summary *s, const hf_pattern_table *t, FILE *f)
{
    hf_json j = {.file = f};
    int stride = stride_of(t);
    hf_json_open(&j, NULL, '{');
    hf_json_text(&j, "stage", stage);
    hf_json_text(&j, "feed", hf_feed_word[s->feed.kind]);
    HF_JSON_NUMBERS(&j, {"cos_power", s->feed.cos_power}, {"angles", t->n_theta}, {"stride", stride});
    fputs(",\"theta_deg\":[", f);
    for (int i = 0; i < t->n_theta; i += stride) {
        int last = i + stride < t->n_theta ? i + stride - 1 : t->n_theta - 1;
        if (i) fputc(',', f);
        hf_json_value((t->theta_deg[i] + t->theta_deg[last]) / 2, 7, f);
    }
    fputs("],\n\"cut\":[", f);
    for (int k = 0; k < t->n_frequency * t->n_cut; k++) {
        if (k) fputs(",\n", f);
        write_cut(t, k, &s->figure[k], f);
    }
    fputc(']', f);
    hf_json_close(&j, '}');
}

static void write_patterns(const page *p, FILE *f)
{
    int n = 0;
    for (int i = 0; i < HF_N_STAGE; i++) {
        if (!p->pattern[i].n_theta) continue;
        fputs(n++ ? ",\n" : ",\n\"pattern\":[", f);
        write_pattern(hf_stage_word[i], p->summary.stage[i].pattern, &p->pattern[i], f);
    }
    if (n) fputc(']', f);
}

/* ---- the page with a second result ---- */

/* Writes a text of the case as a list of one text, "" if it is not there. */
static void write_stored(const char *key, const hf_texts *text, FILE *f)
{
    hf_json_strings(key, &(const char *){text->n ? hf_texts_at(text, 0) : ""}, 1, f);
}

static void write_other(const page *p, const page *other, FILE *f)
{
    hf_json j = {.file = f, .is_due = true};
    write_stored("case_text", &p->case_text, f);
    write_stored("overrides", &p->overrides, f);
    hf_json_open_line(&j, "", "other", '{');
    write_answers(&other->summary, &j);
    hf_report_curves_write(&other->summary, &other->required, f);
    write_stored("case_text", &other->case_text, f);
    write_stored("overrides", &other->overrides, f);
    write_objective_units(&other->summary, &j);
    fputs(",\"summary\":", f);
    hf_summary_write_json(&other->summary, hf_summary_status(&other->summary), other->summary.warnings, other->path, f);
    if (!hf_scene_difference(&p->scene, &other->scene)) write_shapes(other, HF_N_STAGE, f);
    write_patterns(other, f);
    hf_json_close(&j, '}');
}

static void write_data(const void *context, FILE *f)
{
    const page *p = context;
    const hf_summary *s = &p->summary;
    hf_json j = {.file = f};
    hf_json_open(&j, NULL, '{');
    hf_json_text(&j, "title", heading(s));
    write_answers(s, &j);
    hf_json_line(&j, "");
    hf_json_lines(&j, "provenance", "", p->provenance);
    fputs(",\n\"summary\":", f);
    hf_summary_write_json(s, hf_summary_status(s), s->warnings, p->path, f);
    fprintf(f, ",\"seed\":\"%llu\"", (unsigned long long)s->seed); /* a JSON number would lose its last digits */
    bool has_variables = s->stage[HF_STAGE_SEARCH].exists || s->stage[HF_STAGE_REFINE].exists || s->front;
    fprintf(f, ",\"n_free\":%d,\"n_variable\":%d,\"pretension_N\":", s->n_free, has_variables ? s->n_variable : 0);
    hf_json_value(s->has_own_tensions ? (double)NAN : s->pretension_N, 17, f);
    hf_report_curves_write(s, &p->required, f);
    hf_report_limits_write(p->path, &j);
    write_figures(&j);
    write_objective_units(s, &j);
    write_words(&j);
    write_net(p, f);
    write_shapes(p, N_SHAPE, f);
    write_truss(p, f);
    write_series(p, f);
    write_patterns(p, f);
    if (p->other) write_other(p, p->other, f);
    if (!p->other && s->front) write_stored("overrides", &p->overrides, f);
    if (p->part) {
        hf_json_open_line(&j, "", p->part->key, '{');
        p->part->write(p->part->context, &j);
        hf_json_close(&j, '}');
    }
    fputs("}\n", f);
}

/* ---- reading ---- */

/* Checks that the members of the truss end at its nodes. */
static hf_status check_truss(const page *p, hf_messages *messages)
{
    const hf_series *end = &p->series[TRUSS_END];
    for (int i = 0; i < 2 * end->n; i++)
        if (!(end->value[i] >= 0 && end->value[i] < p->series[TRUSS_POSITION].n))
            return hf_error(messages, HF_IO,
                            "%s: this file is damaged, because the data set /truss/member/end refers to a missing node",
                            p->path);
    return HF_OK;
}

static hf_status read_shapes(page *p, hf_messages *messages)
{
    hf_series there = {0};
    HF_TRY(hf_store_read_series(p->path, "/form/tension_N", 1, &there, messages));
    p->has_shape[HF_STAGE_FORM] = there.n > 0; /* a failed form-finding stores no shape */
    hf_series_free(&there);
    p->has_shape[HF_STAGE_SEARCH] = hf_summary_has_shape(&p->summary, HF_STAGE_SEARCH);
    p->has_shape[HF_STAGE_REFINE] = p->summary.stage[HF_STAGE_REFINE].exists;
    for (int i = 0; i < HF_N_STAGE; i++) {
        if (p->has_shape[i]) HF_TRY(hf_store_read_shape(p->path, (hf_stage)i, &p->shape[i], messages));
        if (p->summary.stage[i].pattern) HF_TRY(hf_store_read_pattern(p->path, (hf_stage)i, &p->pattern[i], messages));
    }
    return HF_OK;
}

static hf_status read_load_cases(page *p, hf_messages *messages)
{
    char of_truss[HF_SET_NAME_SIZE + 48];
    for (int k = 0; k < p->summary.n_load_case; k++) {
        const hf_load_case_summary *s = &p->summary.load_case[k];
        if (s->result.status != HF_OK) continue;
        HF_TRY(hf_store_read_load_case(p->path, s->name, &p->shape[HF_N_STAGE + k], messages));
        p->has_shape[HF_N_STAGE + k] = true;
        snprintf(of_truss, sizeof of_truss, "/load_cases/%s/truss/node/displacement", s->name);
        HF_TRY(hf_store_read_series(p->path, of_truss, 6, &p->load_case_displacement[k], messages));
        if (p->load_case_displacement[k].n != p->series[TRUSS_POSITION].n) p->load_case_displacement[k].n = 0;
    }
    return HF_OK;
}

static hf_status map_facets(page *p)
{
    double *error_m;
    if (!(p->summary.surface.focal_length_m > 0)) return HF_OK;
    HF_TRY(hf_facets_find(&p->scene, &p->summary.surface, &p->facets));
    size_t n = (size_t)p->facets.n_facet;
    HF_TRY(HF_ARENA_ARRAYS(&p->facet_block, HF_ARRAY(error_m, 4 * N_SHAPE * n)));
    for (int i = 0; i < N_SHAPE; i++, error_m += 4 * n) {
        const hf_facet_shape shape = {p->shape[i].position_m, p->scene.n_cable, p->scene.end, p->shape[i].tension_N,
                                      NULL};
        p->facet_error[i] = (hf_facet_errors){error_m, error_m + n, error_m + 2 * n, error_m + 3 * n};
        if (p->has_shape[i]) HF_TRY(hf_facet_map(&p->summary.surface, &p->facets, &shape, &p->facet_error[i]));
    }
    return HF_OK;
}

static hf_status read_page(page *p, hf_messages *messages)
{
    HF_TRY(hf_store_read_summary(p->path, &p->summary, messages));
    HF_TRY(hf_store_read_scene(p->path, &p->scene, messages));
    HF_TRY(hf_store_read_provenance(p->path, p->provenance, sizeof p->provenance, messages));
    for (int i = 0; i < N_SERIES; i++)
        HF_TRY(hf_store_read_series(p->path, series_table[i].path, series_table[i].columns, &p->series[i], messages));
    HF_TRY(hf_store_read_texts(p->path, "/case/text", &p->case_text, messages));
    HF_TRY(hf_store_read_texts(p->path, "/case/overrides", &p->overrides, messages));
    HF_TRY(read_shapes(p, messages));
    HF_TRY(read_load_cases(p, messages));
    HF_TRY(hf_report_curves_read(p->path, &p->summary, &p->required, messages));
    if (map_facets(p) != HF_OK) return hf_error(messages, HF_NO_MEMORY, "%s: out of memory", p->path);
    return check_truss(p, messages);
}

static void free_page(page *p)
{
    hf_summary_free(&p->summary);
    hf_scene_free(&p->scene);
    for (int i = 0; i < N_SHAPE; i++)
        hf_shape_free(&p->shape[i]);
    for (int k = 0; k < HF_LOAD_CASES_MAX; k++)
        hf_series_free(&p->load_case_displacement[k]);
    for (int i = 0; i < HF_N_STAGE; i++)
        hf_pattern_table_free(&p->pattern[i]);
    for (int i = 0; i < N_SERIES; i++)
        hf_series_free(&p->series[i]);
    hf_facets_free(&p->facets);
    hf_report_curves_free(&p->required);
    hf_arena_free_block(p->facet_block);
    hf_texts_free(&p->case_text);
    hf_texts_free(&p->overrides);
}

hf_status hf_report_result(const char *path, const char *other, const hf_report_part *part, const char *output,
                           hf_messages *messages)
{
    static page p, beside;
    p = (page){.path = path, .part = part};
    beside = (page){.path = other};
    hf_status status = read_page(&p, messages);
    if (status == HF_OK && other) {
        status = read_page(&beside, messages);
        p.other = &beside;
    }
    char title[2 * NAME_MAX + 8], answer[ANSWER_SIZE] = "";
    if (other) snprintf(title, sizeof title, "%s and %s", hf_path_name(path), hf_path_name(other));
    if (status == HF_OK) write_headline(&p, answer);
    const hf_report_page text = {other ? title : heading(&p.summary), answer, write_data, &p};
    if (status == HF_OK && part)
        status = hf_file_out_set_write(part->files, output, hf_report_page_write, &text, messages);
    else if (status == HF_OK)
        status = hf_file_out_write(output, hf_report_page_write, &text, messages);
    free_page(&p);
    free_page(&beside);
    return status;
}

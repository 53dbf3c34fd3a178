/* Implements <hifdm/store.h>, from the new file to the finished result:
 *
 *     hf_store_create        locks the result; writes provenance, case and scene into the temporary file
 *     hf_store_form, ...     write shapes, truss, front, far field and load cases
 *     hf_store_generation    appends a record to the journal; writes rows into the temporary file when enough wait
 *     hf_store_publish       writes the summary, gives the file the visible name, empties the journal
 *     hf_store_complete      writes the summary of the finished run and closes the file
 *     hf_store_settle        syncs the file, gives it the visible name, removes the journal
 *
 * Sections: case and scene, beginning, shapes, generations, summary, publishing, the end. */
#include <hifdm/store.h>

#include "base/clock.h"
#include "base/path.h"
#include "store/provenance.h"
#include "store/store_internal.h"
#include "store/vtkhdf.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A publication is due when PUBLISH_RATIO times the duration of the last one has passed. Publishing then takes 2 % of
 * the run. At least PUBLISH_S must have passed, so that most short runs are published only at their beginning and their
 * end. The tests of the store, of resuming and of interrupting pass with ratios from 5 to 500 and times from 0.05 to 5
 * s. */
#define PUBLISH_RATIO 50
#define PUBLISH_S 2
/* Bytes that a search may write beside those of its file, as a part of the file that it will have: the journal, and the
 * copies that publishing makes. Files smaller than SMALL_BYTES are copied whenever it is time. */
#define BESIDE_PART 0.9
#define SMALL_BYTES (1 << 20)
/* Maximum difference between the tensions of a resumed run and the stored ones, as part of the largest tension. A
 * stopping rule may leave a difference of 1e-6 between two builds. The tests of the store, of resuming and of
 * interrupting pass from 1e-9 to 1e-4; with 1e-2 one fails. */
#define SAME_SHAPE 1e-5

#define SETUP_BYTES (1 << 20) /* HDF5 1.10.8 needs less than 400 kB to set itself up */

bool hf_store_quiet(void)
{
    void *room = malloc(SETUP_BYTES); /* HDF5 1.10 crashes if its set-up gets no memory */
    free(room);
    if (!room) return false;
    hf_hdf5_lock();
    H5dont_atexit();
    hf_hdf5_quiet();
    hf_hdf5_unlock(HF_OK);
    return true;
}

/* ---- case, scene ---- */

static void write_text(hf_hdf5 *io, hid_t group, const char *name, const char *description, const char *text)
{
    size_t length = strlen(text) ? strlen(text) : 1; /* HDF5 has no type of 0 bytes; the NUL serves as padding */
    hf_hdf5_write_array(io, group, &(hf_hdf5_array){name, HF_KIND_CHARS, 0, {length}, "", description}, text);
}

static void write_case(hf_hdf5 *io, const hf_case *settings)
{
    hid_t group = hf_hdf5_make_group(io, "/case");
    write_text(io, group, "text", "the case file", settings->text);
    write_text(io, group, "overrides", "the --set arguments, a line each",
               settings->overrides ? settings->overrides : "");
    hf_hdf5_put_chars(io, group, ".", "sha256", settings->sha256);
    hf_layout_pass_taken(io, true, &settings->taken);
    hf_hdf5_close(io, group);
}

static void write_sets(hf_hdf5 *io, hid_t group, const hf_scene *scene)
{
    if (scene->n_set == 0) return;
    hf_hdf5_close(io, hf_hdf5_make_group(io, "/scene/set"));
    hf_hdf5_write_ids(io, group, "set/name", scene->set_name, scene->n_set, "name of the set of cables");
    hf_hdf5_write_list(io, group, "set/start", HF_KIND_INT, scene->n_set + 1, 0, "",
                       "where the cables of each set begin in `cable`, and the number of all", scene->set_start);
    hf_hdf5_write_list(io, group, "set/cable", HF_KIND_INT, scene->set_start[scene->n_set], 0, "",
                       "index into /scene/cable, ascending in each set", scene->set_cable);
}

static void write_scene(hf_hdf5 *io, const hf_scene *scene)
{
    hid_t group = hf_hdf5_make_group(io, "/scene");
    HF_HDF5_CLOSE(io, hf_hdf5_make_group(io, "/scene/node"), hf_hdf5_make_group(io, "/scene/cable"));
    hf_hdf5_write_ids(io, group, "node/id", scene->node_id, scene->n_node, "name of the node");
    hf_hdf5_write_ids(io, group, "cable/id", scene->cable_id, scene->n_cable, "name of the cable");
    hf_layout_pass_columns(io, true, group, hf_layout_scene, scene->n_node, scene->n_cable, scene);
    double *length_m = hf_hdf5_take(io, (size_t)scene->n_cable, sizeof *length_m);
    for (int e = 0; length_m && e < scene->n_cable; e++)
        length_m[e] = hf_scene_length_at_target(scene, e);
    hf_hdf5_write_list(io, group, "cable/length_m", HF_KIND_REAL, scene->n_cable, 0, "m",
                       "length between the target positions of the two nodes", length_m);
    free(length_m);
    write_sets(io, group, scene);
    if (scene->n_facet > 0)
        hf_hdf5_write_list(io, group, "facet", HF_KIND_INT, scene->n_facet, 4, "",
                           "that the import names: nodes around each, of a triangle the last one twice", scene->facet);
    hf_hdf5_close(io, group);
}

/* ---- beginning ---- */

hf_status hf_store_create(const char *path, bool restart, const hf_case *settings, const hf_scene *scene,
                          const hf_truss *truss, int argc, char *const *argv, hf_store **store, hf_messages *messages)
{
    hf_status status;
    struct stat info;
    *store = NULL;
    hf_store *s = hf_store_new(path, restart, &status, messages);
    if (!s) return status;
    if (restart) s->f.io.status = hf_store_look_before(s->f.out.path, &s->f.earlier, messages);
    if (s->f.io.status == HF_OK) s->f.io.status = hf_store_file_demand_room(&s->f, messages);
    hf_hdf5_lock();
    double begin_s = hf_clock_s();
    const hf_optimize_settings *o = &settings->optimize;
    s->rows.every = o->store == HF_KEEP_BEST ? HF_GENERATIONS_BEST : o->store == HF_KEEP_EVERY ? o->store_every : 1;
    int seen = hf_path_look_at_link(s->f.out.path, &info);
    if (!restart && seen < 0)
        s->f.io.status = hf_error(messages, HF_IO, "%s: cannot get the status of this file: %s", path, strerror(errno));
    else if (!restart && seen > 0)
        s->f.io.status = hf_error(messages, HF_EXISTS,
                                  "%s: this file already exists. Use --restart (in a sweep: --retry failed) to replace "
                                  "the file, or use -o to choose another name",
                                  path);
    if (s->f.io.status == HF_OK && hf_store_identify(settings, scene, truss, s->identity) != HF_OK)
        s->f.io.status = hf_error(messages, HF_NO_MEMORY, "%s: out of memory", path);
    if (s->f.io.status == HF_OK) {
        hf_store_file_create(&s->f);
        hf_provenance_put(&s->f.io, argc, argv);
        hf_hdf5_put_chars(&s->f.io, s->f.io.file, "/", "identity", s->identity);
        signed char keeps = s->f.earlier != HF_EARLIER_NONE;
        hf_hdf5_put(&s->f.io, s->f.io.file, "/", HF_KEEPS_EARLIER, HF_KIND_FLAG, 0, &keeps);
        write_case(&s->f.io, settings);
        write_scene(&s->f.io, scene);
    }
    s->publish_s = hf_clock_s() - begin_s;
    return hf_store_hand_over(s, store);
}

int hf_store_generations(const hf_store *s)
{
    return s ? s->rows.n_stored + s->rows.n_waiting + s->n_journal : 0;
}

/* ---- shapes ---- */

static void write_shape(hf_hdf5 *io, hid_t group, const hf_model *m, const hf_workspace *w)
{
    hf_shape shape = {.position_m = hf_hdf5_take(io, (size_t)m->n_node, 3 * sizeof(double)),
                      .length_m = w->length_m,
                      .tension_N = w->tension_N,
                      .q_N_per_m = w->q_N_per_m,
                      .law = w->law};
    if (!shape.position_m) return;
    hf_model_positions(m, w->position_m, shape.position_m);
    hf_layout_pass_columns(io, true, group, hf_layout_shape, m->n_node, m->n_cable, &shape);
    free(shape.position_m);
}

/* Compares a shape with the stored one. A session on another machine, or of another build, may find it with other
 * bits. */
static void compare_shape(hf_store *s, const hf_model *m, const hf_workspace *w)
{
    double *stored = hf_hdf5_take(&s->f.io, (size_t)m->n_cable, sizeof *stored), largest_N = 0, apart_N = 0;
    if (stored) hf_hdf5_read_list(&s->f.io, s->f.io.file, "/form/tension_N", HF_KIND_REAL, m->n_cable, 0, stored);
    bool is_same = s->f.io.status != HF_OK || memcmp(stored, w->tension_N, (size_t)m->n_cable * sizeof *stored) == 0;
    for (int e = 0; !is_same && e < m->n_cable; e++) {
        double gap_N = fabs(stored[e] - w->tension_N[e]);
        largest_N = fmax(largest_N, fabs(stored[e]));
        apart_N = gap_N <= apart_N || isnan(apart_N) ? apart_N : gap_N;
    }
    free(stored);
    if (is_same) return;
    if (!(apart_N <= SAME_SHAPE * largest_N))
        s->f.io.status = hf_error(s->f.io.messages, HF_EXISTS,
                                  "%s: this machine or build computes another shape, with tensions that differ by %.2g "
                                  "N. Use --restart (in a sweep: --retry failed) to restart the run",
                                  s->f.out.path, apart_N);
    else
        hf_warning(s->f.io.messages,
                   "%s: this machine or build computes the shape with other last bits than the machine or build that "
                   "began the run. The result will not be bit-identical to the result of an uninterrupted run",
                   s->f.out.path);
}

hf_status hf_store_form(hf_store *s, const hf_model *m, const hf_workspace *w, const hf_history *history,
                        hf_messages *messages)
{
    if (!s) return HF_OK;
#define HISTORY(member, units, description)                                                                            \
    HF_LAYOUT_COLUMN(hf_history, #member, member, REAL, 0, 1, units, description)
    static const hf_layout_column history_column[] = {
        HISTORY(psi_m, "m", "RMS distance of the inner nodes to their target positions, after each linear solve"),
        HISTORY(residual_N, "N", "maximum nodal force out of balance"),
        HISTORY(inner_tension_ratio, "", "maximum over minimum tension of the inner cables"),
        HISTORY(boundary_tension_ratio, "", "maximum over minimum tension of the boundary cables"),
        HISTORY(length_error, "", "maximum |l/L*-1| over taut cables of law length"),
        {0}};
    hf_hdf5 *io = hf_store_enter(s, messages);
    if (s->is_resumed) {
        compare_shape(s, m, w);
        return hf_hdf5_unlock(hf_store_judge(s));
    }
    hid_t group = hf_hdf5_make_group(io, "/form");
    write_shape(io, group, m, w);
    hf_hdf5_close(io, group);
    if (history) {
        group = hf_hdf5_make_group(io, "/form/history");
        hf_layout_pass_columns(io, true, group, history_column, history->n, 0, history);
        hf_hdf5_close(io, group);
    }
    if (m->n_attachment) hf_layout_write_coupling(io, m, w, history ? &history->coupling : NULL);
    return hf_hdf5_unlock(io->status);
}

hf_status hf_store_shape(hf_store *s, hf_stage stage, const hf_model *m, const hf_workspace *w, const double *design,
                         hf_messages *messages)
{
    if (!s) return HF_OK;
    hf_hdf5 *io = hf_store_enter(s, messages);
    hid_t group = hf_hdf5_make_group(io, hf_stage_group[stage]);
    for (const hf_layout_column *c = hf_layout_shape; c->name; c++) /* an interrupted session may have left a shape */
        hf_layout_renew(io, group, c->name);
    hf_layout_renew(io, group, "design");
    write_shape(io, group, m, w);
    hf_layout_write_variables(io, group, "design", m->variable, m->n_variable, design);
    hf_hdf5_close(io, group);
    return hf_hdf5_unlock(io->status);
}

hf_status hf_store_built(hf_store *s, const char *name, const hf_model *m, const hf_workspace *w,
                         const hf_carrier *carrier, const hf_carrier_state *truss, hf_messages *messages)
{
    char path[HF_LAYOUT_LOAD_CASE_SIZE];
    if (!s) return HF_OK;
    hf_hdf5 *io = hf_store_enter(s, messages);
    hf_hdf5_close(io, hf_hdf5_make_group(io, "/load_cases"));
    snprintf(path, sizeof path, "/load_cases/%s", name);
    hf_layout_renew(io, io->file, path);
    hid_t group = hf_hdf5_make_group(io, path);
    write_shape(io, group, m, w);
    hf_hdf5_close(io, group);
    if (truss) {
        strncat(path, "/truss", sizeof path - strlen(path) - 1);
        group = hf_layout_make_truss(io, path);
        hf_layout_pass_columns(io, true, group, hf_layout_truss_state, carrier->truss.n_node, carrier->truss.n_member,
                               truss);
        hf_hdf5_close(io, group);
    }
    return hf_hdf5_unlock(io->status);
}

/* ---- generations ---- */

/* Writes what each design variable of optimize.variables varies: its row there, and the support that it displaces with
 * the direction. */
static void write_rows(hf_hdf5 *io, hid_t group, const hf_model *m)
{
    int n = m->n_variable;
    int *of = hf_hdf5_take(io, (size_t)n, sizeof *of), *support = hf_hdf5_take(io, (size_t)n, sizeof *support);
    double *direction = hf_hdf5_take(io, (size_t)n, 3 * sizeof *direction);
    for (int i = 0; io->status == HF_OK && i < n; i++) {
        of[i] = m->variable[i].setting;
        support[i] = m->variable[i].support_row < 0 ? -1 : m->node_of_row[m->variable[i].support_row];
        memcpy(direction + 3 * i, m->variable[i].direction, 3 * sizeof *direction);
    }
    hf_hdf5_write_list(io, group, "row", HF_KIND_INT, n, 0, "", "row of optimize.variables", of);
    hf_hdf5_write_list(io, group, "node", HF_KIND_INT, n, 0, "", "index into /scene/node; -1: varies a cable", support);
    hf_hdf5_write_list(io, group, "direction", HF_KIND_REAL, n, 3, "", "direction in which this support is displaced",
                       direction);
    free(of);
    free(support);
    free(direction);
}

hf_status hf_store_variables(hf_store *s, const hf_model *m, const hf_population *population, hf_messages *messages)
{
    if (!s) return HF_OK;
    if (s->rows.block) return s->f.io.status; /* another session has written them */
    const int n = population->n_variable;
    hf_hdf5 *io = hf_store_enter(s, messages);
    hid_t group = hf_hdf5_make_group(io, "/variable");
    hf_hdf5_write_list(io, group, "cable", HF_KIND_INT, n, 0, "", "index into /scene/cable", m->variable_cable);
    hf_hdf5_write_list(io, group, "group", HF_KIND_INT, n, 0, "", "number of the group that is varied together",
                       m->variable_group);
    if (m->variable_leader && m->n_leader < n)
        hf_hdf5_write_list(io, group, "leader", HF_KIND_INT, n, 0, "",
                           "design variable whose step each takes, by symmetry", m->variable_leader);
    if (m->variable) write_rows(io, group, m);
    hf_layout_write_variables(io, group, "initial", m->variable, n, population->initial);
    hf_layout_write_variables(io, group, "lower", m->variable, n, population->lower);
    hf_layout_write_variables(io, group, "upper", m->variable, n, population->upper);
    hf_hdf5_close(io, group);
    hf_hdf5_close(io, hf_hdf5_make_group(io, "/search"));
    group = hf_hdf5_make_group(io, HF_GENERATIONS_GROUP);
    hf_hdf5_put(io, group, ".", "n_individual", HF_KIND_INT, 0, &population->n_individual);
    hf_hdf5_put(io, group, ".", "n_variable", HF_KIND_INT, 0, &n);
    hf_hdf5_put(io, group, ".", "generations_limit", HF_KIND_INT, 0, &population->generation_limit);
    hf_hdf5_put(io, group, ".", "store_every", HF_KIND_INT, 0, &s->rows.every);
    if (population->n_objective) hf_hdf5_put(io, group, ".", "n_objective", HF_KIND_INT, 0, &population->n_objective);
    hf_hdf5_close(io, group);
    if (io->status == HF_OK) io->status = hf_journal_restart(&s->f.journal, s->identity, messages);
    s->rows = (hf_generations){.has_rows = population->has_rows,
                               .n_individual = population->n_individual,
                               .n_variable = n,
                               .n_objective = population->n_objective,
                               .limit = population->generation_limit,
                               .every = s->rows.every};
    if (io->status == HF_OK && hf_generations_create(&s->rows) != HF_OK) hf_hdf5_no_memory(io);
    return hf_hdf5_unlock(io->status);
}

hf_status hf_store_generation(hf_store *s, const hf_model *m, const hf_population *population, hf_messages *messages)
{
    if (!s) return HF_OK;
    struct iovec piece[HF_GENERATIONS_PAYLOAD];
    hf_generations *g = &s->rows;
    s->f.io.messages = messages;
    HF_TRY(s->f.io.status);
    HF_TRY(hf_store_variables(s, m, population, messages)); /* a run has written them already */
    int generation = g->n_stored + g->n_waiting;
    hf_generations_add(g, population, piece);
    s->f.io.status = hf_journal_append(&s->f.journal, generation, piece, HF_GENERATIONS_PAYLOAD, messages);
    if (s->f.io.status != HF_OK || !hf_generations_are_due(g)) return s->f.io.status;
    /* The journal has the generation already. While another run uses HDF5, making room can wait, unless no room is
     * left. */
    if (hf_generations_are_full(g))
        hf_hdf5_lock();
    else if (!hf_hdf5_try_lock())
        return HF_OK;
    double begin_s = hf_clock_s();
    hf_store_file_open(&s->f);
    s->publish_s += hf_clock_s() - begin_s; /* the copy is part of the cost of publishing */
    hf_generations_make_room(&s->f.io, g);
    HF_TRY(hf_hdf5_unlock(s->f.io.status));
    hf_store_file_flow(&s->f);
    return HF_OK;
}

/* ---- summary ---- */

static void put_summary(hf_store *s, const hf_summary *summary, bool finished)
{
    hf_hdf5 *io = &s->f.io;
    signed char is_finished = finished;
    for (hf_layout_part part = HF_LAYOUT_N_PART; part-- > 0;) {
        /* The search is written before its first generation, too, as far as it is known. */
        bool has_begun = s->rows.block && (part == HF_LAYOUT_SEARCH || part == HF_LAYOUT_SEARCH_STAGE);
        if (part != HF_LAYOUT_TOLERANCE && (has_begun || hf_layout_has(summary, part)))
            hf_layout_pass_part(io, true, part, summary);
    }
    hf_hdf5_put(io, io->file, "/", "finished", HF_KIND_FLAG, 0, &is_finished);
    for (hf_stage i = HF_STAGE_SEARCH; i < HF_N_STAGE; i++)
        if (summary->stage[i].exists)
            hf_hdf5_put_chars(io, io->file, hf_stage_group[i], "algorithm", hf_summary_algorithm(summary, i));
    if (finished)
        hf_layout_pass_stages(io, true, summary);
    else if (summary->front)
        hf_layout_pass_objectives(io, true, summary); /* they name the objectives of the front */
    if (finished) hf_layout_put_tolerance(io, summary);
    if (finished) hf_layout_put_requirements(io, summary);
    if (finished) hf_vtkhdf_put_result(io, summary);
    if (finished) hf_renamed_link(io, s->rows.has_rows || hf_hdf5_has(io, io->file, "/variable/row"));
    hf_hdf5_put_chars(io, io->file, "/", "status", finished ? hf_status_word(summary->status) : "unfinished");
    hf_provenance_put_time(&s->f.io, finished ? "finished_utc" : "published_utc");
}

/* ---- publishing ---- */

/* Writes the waiting generations and the summary, and closes the file. */
static void complete(hf_store *s, const hf_summary *summary, bool finished)
{
    hf_store_file_open(&s->f);
    hf_generations_write(&s->f.io, &s->rows);
    put_summary(s, summary, finished);
    hf_store_put_refine(s, finished);
    hf_store_file_close(&s->f);
}

/* Fails if generations of the journal were not restored, because this session stopped before that. They would be
 * lost. */
static hf_status demand_restored(hf_store *s, hf_messages *messages)
{
    if (s->n_journal == 0) return HF_OK;
    return s->f.io.status = hf_error(
               messages, HF_EXISTS,
               "%s: this machine or build computes other generations than the machine or build that began the run. The "
               "stored generations are kept. Use --restart (in a sweep: --retry failed) to restart the run",
               s->f.out.path);
}

/* Returns true if one more copy of the file would make the search write more bytes than BESIDE_PART allows. */
static bool is_too_much(const hf_store *s)
{
    int n = s->rows.n_stored + s->rows.n_waiting;
    int64_t size = hf_store_file_size(&s->f);
    if (n == 0 || n >= s->rows.limit || size < SMALL_BYTES) return false;
    double at_end = (double)size * s->rows.limit / n;
    return (double)(size + s->f.beside + s->f.journal.size) > BESIDE_PART * at_end;
}

hf_status hf_store_publish(hf_store *s, const hf_summary *summary, bool at_once, hf_messages *messages)
{
    if (!s) return HF_OK;
    double now_s = hf_clock_s();
    s->f.io.messages = messages;
    HF_TRY(s->f.io.status);
    if (s->is_continued) return HF_OK; /* the earlier result remains until there is a finished one */
    double since_s = now_s - s->published_at_s;
    bool is_due = at_once || (since_s >= PUBLISH_S && since_s >= PUBLISH_RATIO * s->publish_s);
    if (is_due && !at_once && is_too_much(s)) {
        s->published_at_s = now_s; /* asked again later */
        is_due = false;
    }
    if (!is_due) {
        s->f.io.status = hf_journal_tend(&s->f.journal, now_s, messages);
        return s->f.io.status;
    }
    HF_TRY(demand_restored(s, messages));
    hf_hdf5_lock();
    complete(s, summary, false);
    hf_store_judge(s);
    hf_hdf5_unlock(HF_OK); /* other stores need not wait for the sync of this file */
    /* Before the first generation no sync is needed, because a resumed run computes everything again. */
    hf_store_file_publish(&s->f, s->rows.n_stored > 0, false);
    if (s->f.io.status == HF_OK && !hf_journal_is_empty(&s->f.journal)) {
        s->f.beside += s->f.journal.size;
        s->f.io.status = hf_journal_rotate(&s->f.journal, messages);
    }
    s->published_at_s = hf_clock_s();
    s->publish_s = s->published_at_s - now_s;
    return s->f.io.status;
}

/* ---- the end ---- */

hf_status hf_store_complete(hf_store *s, const hf_summary *summary, hf_messages *messages)
{
    if (!s) return HF_OK;
    s->f.io.messages = messages;
    if (s->f.io.status != HF_OK)
        return hf_error(messages, s->f.io.status,
                        "%s: this file is incomplete, because hifdm could not write an earlier part of the file",
                        s->f.out.path);
    HF_TRY(demand_restored(s, messages));
    hf_hdf5_lock();
    complete(s, summary, true);
    hf_generations_free(&s->rows); /* frees memory now, because hf_store_settle may come much later */
    return hf_hdf5_unlock(hf_store_judge(s));
}

hf_status hf_store_settle(hf_store *s, hf_messages *messages)
{
    if (!s) return HF_OK;
    s->f.io.messages = messages;
    hf_store_file_publish(&s->f, true, true);
    hf_status status = s->f.io.status;
    if (status == HF_OK) s->f.journal.size = 0; /* the result has its records, so the journal counts as empty */
    hf_store_abandon(s, messages);
    return status;
}

hf_status hf_store_finish(hf_store *s, const hf_summary *summary, hf_messages *messages)
{
    hf_store_complete(s, summary, messages);
    return hf_store_settle(s, messages);
}

void hf_store_abandon(hf_store *s, hf_messages *messages)
{
    if (!s) return;
    bool is_open = s->f.io.file >= 0;
    if (is_open) hf_hdf5_lock();
    hf_store_free(s, messages);
    if (is_open) hf_hdf5_unlock(HF_OK);
}

void hf_store_end(hf_store *s)
{
    hf_store_abandon(s, NULL);
}

/* Resumes an unfinished result:
 *
 *     hf_store_resume            copies the visible file and counts the records of the journal
 *     hf_store_continue          does the same with a finished file, without what comes after its refinement
 *     hf_store_restore_initial      reads the initial design of the search
 *     hf_store_restore           puts the optimiser into the state of the last generation of the file; then, for each
 *                                record, proposes its designs again, compares their hash and takes its results
 *     hf_store_restore_refine    reads the state of the refinement
 *
 * hf_store_recover does the same without a run: it makes the optimiser from the file alone and publishes the result.
 * Sections: state of the file, proposing again, refinement, recovery. */
#include "store/provenance.h"
#include "store/store_internal.h"
#include "store/store_read.h"

#include "base/clock.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- state of the file ---- */

/* Returns true if this record is the generation that follows those of the file. Otherwise *status is HF_OK if the file
 * has the generation already, and HF_EXISTS if the record does not fit. The hf_journal_take that calls this returns
 * *status. */
static bool is_news(hf_store *s, int generation, const void *payload, size_t bytes, int next, hf_status *status)
{
    const hf_generations *g = &s->rows;
    *status = HF_OK;
    if (generation < next) return false; /* published before the journal was rotated */
    if (generation == next && generation < g->limit && hf_generations_are_payload(g, payload, bytes)) return true;
    *status = hf_error(s->f.io.messages, HF_EXISTS,
                       "%s: this result does not match %s. The next record of this journal is generation %d with %zu "
                       "bytes, which is not generation %d of this result. Was the file copied or replaced? Use "
                       "--restart (in a sweep: --retry failed) to restart the run",
                       s->f.out.path, s->f.journal.path, generation, bytes, next);
    return false;
}

static hf_status count_record(void *context, int generation, const void *payload, size_t bytes)
{
    hf_store *s = context;
    hf_status status;
    s->n_journal += is_news(s, generation, payload, bytes, s->rows.n_stored + s->n_journal, &status);
    return status;
}

/* Limits of optimize.population and optimize.generations, as in the table of keys. They keep a damaged file from taking
 * all memory. */
#define INDIVIDUALS_MAX 100000
#define GENERATIONS_MAX 1000000

/* Reads the sizes of the population, the limit of generations, and which of their individuals the file holds. */
static void read_sizes(hf_hdf5 *io, hf_generations *g)
{
    hf_hdf5_get(io, io->file, HF_GENERATIONS_GROUP, "n_individual", HF_KIND_INT, &g->n_individual, sizeof(int));
    hf_hdf5_get(io, io->file, HF_GENERATIONS_GROUP, "n_variable", HF_KIND_INT, &g->n_variable, sizeof(int));
    hf_hdf5_get(io, io->file, HF_GENERATIONS_GROUP, "generations_limit", HF_KIND_INT, &g->limit, sizeof(int));
    /* Files of earlier versions do not have this attribute. */
    if (io->status == HF_OK && H5Aexists_by_name(io->file, HF_GENERATIONS_GROUP, "store_every", H5P_DEFAULT) > 0)
        hf_hdf5_get(io, io->file, HF_GENERATIONS_GROUP, "store_every", HF_KIND_INT, &g->every, sizeof(int));
    /* Only populations of a front have this attribute. */
    if (io->status == HF_OK && H5Aexists_by_name(io->file, HF_GENERATIONS_GROUP, "n_objective", H5P_DEFAULT) > 0)
        hf_hdf5_get(io, io->file, HF_GENERATIONS_GROUP, "n_objective", HF_KIND_INT, &g->n_objective, sizeof(int));
    int n_stored = io->status == HF_OK && g->n_variable == 0
                       ? 0
                       : hf_hdf5_length(io, io->file, "/variable/group", HF_LAYOUT_COUNT_MAX);
    if (io->status == HF_OK && (g->n_individual < 1 || g->n_individual > INDIVIDUALS_MAX || g->n_variable != n_stored ||
                                g->n_objective < 0 || g->n_objective > HF_FRONT_OBJECTIVES_MAX || g->limit < 1 ||
                                g->limit > GENERATIONS_MAX || g->every < 0 || g->every > GENERATIONS_MAX))
        hf_hdf5_damaged(io, io->file, HF_GENERATIONS_GROUP, "has impossible sizes");
}

static void note_session(hf_store *s)
{
    char host[256] = "";
    int n = 1;
    if (gethostname(host, sizeof host - 1) != 0) host[0] = '\0';
    if (s->f.io.status == HF_OK && H5Aexists(s->f.io.file, "sessions") > 0)
        hf_hdf5_get(&s->f.io, s->f.io.file, "/", "sessions", HF_KIND_INT, &n, sizeof n);
    hf_hdf5_put(&s->f.io, s->f.io.file, "/", "sessions", HF_KIND_INT, 0, &(int){n + 1});
    hf_hdf5_put_chars(&s->f.io, s->f.io.file, "/", "resumed_host", host);
    hf_hdf5_put_chars(&s->f.io, s->f.io.file, "/", "resumed_version", hf_store_version());
    hf_provenance_put_job(&s->f.io);
    hf_provenance_put_time(&s->f.io, "resumed_utc");
}

/* Checks an object of a resumed file. Data that are written later, by name, must go into this file and nowhere else.
 * Links, and data sets with values in other files, are therefore damage. */
static void demand_plain(void *context, const char *path, hid_t object, H5I_type_t type)
{
    hf_hdf5 *io = context;
    (void)object;
    if (type == H5I_GROUP || type == H5I_DATASET)
        hf_hdf5_close(io, hf_hdf5_open(io, io->file, path, type));
    else
        hf_hdf5_damaged(io, io->file, path, type == H5I_BADID ? "is a link to another place" : "is no data set");
}

static void refuse_without_state(hf_hdf5 *io)
{
    if (io->status != HF_OK) return;
    io->status = hf_error(io->messages, HF_EXISTS,
                          "%s: the option --more needs the state of the refinement, but an earlier version wrote this "
                          "result without it. Use --restart with a larger value of optimize.refine_steps",
                          io->path);
}

/* The names in an unfinished file must be those of this version, because the run goes on writing into it. */
static void refuse_other_format(hf_store *s)
{
    hf_hdf5 *io = &s->f.io;
    int version = 0;
    hf_hdf5_get(io, io->file, "/", "format_version", HF_KIND_INT, &version, sizeof version);
    if (s->is_continued && version != HF_FORMAT_VERSION) refuse_without_state(io);
    if (io->status == HF_OK && version != HF_FORMAT_VERSION)
        io->status = hf_error(io->messages, HF_EXISTS,
                              "%s: this version cannot resume an unfinished result of hifdm 0.2. Finish the run with "
                              "hifdm 0.2, or restart the run with --restart (in a sweep: --retry failed)",
                              s->f.out.path);
}

/* Removes from a finished file what its run wrote after the refinement, and the names of version 0.2, which are links.
 * What remains is the content of an unfinished file. */
static void remove_later_stages(hf_hdf5 *io)
{
    static const char *const later[] = {"/truss", "/load_cases", "/tolerance", "/requirements", "/VTKHDF"};
    hf_renamed_unlink(io);
    for (int i = 0; i < HF_HDF5_COUNT(later); i++)
        hf_layout_renew(io, io->file, later[i]);
    hf_hdf5_put(io, io->file, "/", HF_KEEPS_EARLIER, HF_KIND_FLAG, 0, &(signed char){0});
    if (io->status == HF_OK && !hf_hdf5_has(io, io->file, HF_REFINE_STATE)) refuse_without_state(io);
}

static void read_state(hf_store *s)
{
    hf_hdf5 *io = &s->f.io;
    signed char finished = 0;
    refuse_other_format(s);
    if (s->is_continued) remove_later_stages(io);
    hf_hdf5_walk(io, demand_plain, io);
    hf_hdf5_get(io, io->file, "/", "finished", HF_KIND_FLAG, &finished, 1);
    hf_hdf5_get(io, io->file, "/", "identity", HF_KIND_CHARS, s->identity, sizeof s->identity);
    if (hf_store_keeps_earlier(io)) s->f.earlier = HF_EARLIER_KEPT;
    if (io->status == HF_OK && finished && !s->is_continued)
        io->status = hf_error(io->messages, HF_EXISTS, "%s: this result is finished, so there is nothing to resume",
                              s->f.out.path);
    if (!hf_hdf5_has(io, io->file, "/variable")) { /* the run stopped before its search, or has none */
        if (io->status == HF_OK) io->status = hf_journal_restart(&s->f.journal, s->identity, io->messages);
        return;
    }
    read_sizes(io, &s->rows);
    s->rows.has_rows = hf_hdf5_has(io, io->file, "/variable/row");
    if (io->status == HF_OK && hf_generations_create(&s->rows) != HF_OK) hf_hdf5_no_memory(io);
    if (io->status == HF_OK) hf_generations_count(io, &s->rows);
    if (io->status == HF_OK) io->status = hf_journal_replay(&s->f.journal, s->identity, count_record, s, io->messages);
}

static hf_status open_earlier(const char *path, bool is_continued, hf_store **store, hf_messages *messages)
{
    hf_status status;
    *store = NULL;
    hf_store *s = hf_store_new(path, false, &status, messages);
    if (!s) return status;
    hf_hdf5_lock();
    s->is_resumed = true;
    s->is_continued = is_continued;
    s->rows = (hf_generations){.n_individual = 1, .limit = 1, .every = 1}; /* unless the file says otherwise */
    s->published_at_s = hf_clock_s();                                      /* the content so far is visible */
    hf_store_file_adopt(&s->f);
    hf_store_file_open(&s->f);
    read_state(s);
    if (s->f.io.status == HF_OK) note_session(s);
    hf_store_judge(s);
    return hf_store_hand_over(s, store);
}

hf_status hf_store_resume(const char *path, hf_store **store, hf_messages *messages)
{
    return open_earlier(path, false, store, messages);
}

hf_status hf_store_continue(const char *path, hf_store **store, hf_messages *messages)
{
    return open_earlier(path, true, store, messages);
}

static void read_initial(hf_hdf5 *io, hid_t place, const char *name, int n_variable, double *initial)
{
    hf_hdf5_read_list(io, place, name, HF_KIND_REAL, n_variable, 0, initial);
    for (int k = 0; k < n_variable && io->status == HF_OK; k++)
        if (!(initial[k] >= 0 && isfinite(initial[k])))
            hf_hdf5_damaged(io, io->file, "/variable", "has an initial design that is none");
}

hf_status hf_store_restore_initial(hf_store *s, int n_variable, double *initial, hf_messages *messages)
{
    if (!s || !s->rows.block) return HF_OK;
    hf_hdf5 *io = hf_store_enter(s, messages);
    if (hf_hdf5_has(io, io->file, "/variable/initial")) /* earlier versions stored none */
        read_initial(io, io->file, "/variable/initial", n_variable, initial);
    return hf_hdf5_unlock(hf_store_judge(s));
}

/* ---- proposing again ---- */

typedef struct {
    hf_store *store;
    hf_optimiser *optimiser; /* just created, or before hf_optimiser_tell of the last generation that was taken */
    int n_taken;
    bool drops; /* generations whose designs this build proposes differently are dropped; else an error */
} breeding;

/* Takes a record of the journal. Its designs are proposed again from the generation before it. */
static hf_status breed_record(void *context, int generation, const void *payload, size_t bytes)
{
    breeding *b = context;
    hf_store *s = b->store;
    hf_generations *g = &s->rows;
    hf_optimiser *o = b->optimiser;
    const hf_optimiser before = *o; /* its arrays do not change, see hf_optimiser_kind */
    hf_status status;
    if (!is_news(s, generation, payload, bytes, g->n_stored + g->n_waiting, &status)) return status;
    int goes_on = 1;
    if (generation > 0) {
        hf_optimiser_tell(o);
        goes_on = hf_optimiser_next(o);
    }
    const hf_population *earlier = generation > 0 ? &o->next : NULL;
    if (!goes_on || !hf_generations_take_payload(g, payload, earlier, &o->population)) {
        *o = before;
        if (b->drops) return HF_DIFFERENT;
        return hf_error(
            s->f.io.messages, HF_EXISTS,
            "%s: from generation %d on, this machine or build computes other designs than the machine or build that "
            "began the run. Only the machine or build that began the run can recover %s. Nothing was changed",
            s->f.out.path, generation + 1, s->f.journal.path);
    }
    if (!hf_generations_are_sound(&o->population))
        return hf_error(s->f.io.messages, HF_EXISTS,
                        "%s: the journal %s is damaged, because no run stores a record like its generation %d. Use "
                        "--restart (in a sweep: --retry failed) to restart the run",
                        s->f.out.path, s->f.journal.path, generation);
    o->is_fresh = false; /* the generation of the record has been ranked */
    hf_generations_add(g, &o->population, NULL);
    b->n_taken++;
    if (hf_generations_are_full(g)) hf_generations_make_room(&s->f.io, g);
    return s->f.io.status;
}

static void breed_journal(hf_store *s, hf_optimiser *optimiser, int drops)
{
    hf_hdf5 *io = &s->f.io;
    breeding b = {s, optimiser, 0, drops};
    struct hf_repair *repair = optimiser->repair;
    if (io->status != HF_OK) return;
    optimiser->repair = NULL; /* the journal has designs that were moved */
    io->status = hf_journal_replay(&s->f.journal, s->identity, breed_record, &b, io->messages);
    optimiser->repair = repair;
    int first = s->rows.n_stored + s->rows.n_waiting;
    hf_generations_write(io, &s->rows);
    if (io->status == HF_OK && b.n_taken < s->n_journal)
        hf_warning(io->messages,
                   "%s: this machine or build computes other designs than the machine or build that began the run. "
                   "hifdm evaluates the unpublished generations %d to %d again",
                   s->f.out.path, first + 1, first + s->n_journal - b.n_taken);
    s->n_journal = 0;
}

static hf_status restore(hf_store *s, hf_optimiser *optimiser, int drops, hf_summary *summary, hf_messages *messages)
{
    if (hf_store_generations(s) == 0) return HF_OK;
    hf_hdf5 *io = hf_store_enter(s, messages);
    if (!hf_generations_are_of(&s->rows, &optimiser->population))
        hf_hdf5_damaged(io, io->file, HF_GENERATIONS_GROUP, "has other sizes than the case");
    /* The summary of the search as it was published last. Files of earlier versions have none before the first
     * generation. */
    if (io->status == HF_OK && H5Aexists_by_name(io->file, "/search", "solver", H5P_DEFAULT) > 0) {
        hf_layout_pass_part(io, false, HF_LAYOUT_SEARCH, summary);
        hf_layout_pass_part(io, false, HF_LAYOUT_SEARCH_STAGE, summary);
    }
    if (s->rows.n_stored && io->status == HF_OK) {
        hf_generations_restore(io, &s->rows, &optimiser->population);
        optimiser->is_fresh = false;
    }
    if (s->n_journal) breed_journal(s, optimiser, drops);
    hf_generations_sum_up(io, &s->rows, summary);
    return hf_hdf5_unlock(hf_store_judge(s));
}

hf_status hf_store_restore(hf_store *s, hf_optimiser *optimiser, hf_summary *summary, hf_messages *messages)
{
    return restore(s, optimiser, 1, summary, messages);
}

/* ---- refinement ---- */

static hf_status make_refine(hf_store *s, size_t n)
{
    if (n == s->n_refine) return HF_OK;
    free(s->refine);
    s->refine = malloc(n * sizeof *s->refine);
    s->n_refine = s->refine ? n : 0;
    if (s->refine) return HF_OK;
    return s->f.io.status = hf_error(s->f.io.messages, HF_NO_MEMORY, "%s: out of memory", s->f.out.path);
}

hf_status hf_store_refine(hf_store *s, double wall_s, size_t n, const double *state, hf_messages *messages)
{
    if (!s) return HF_OK;
    s->f.io.messages = messages;
    HF_TRY(s->f.io.status);
    HF_TRY(make_refine(s, n));
    s->refine_wall_s = wall_s;
    memcpy(s->refine, state, n * sizeof *state);
    return HF_OK;
}

hf_status hf_store_restore_refine(hf_store *s, double *wall_s, size_t *n, const double **state, hf_messages *messages)
{
    *wall_s = 0;
    *n = 0;
    *state = NULL;
    if (!s || !s->is_resumed) return HF_OK;
    hf_hdf5 *io = hf_store_enter(s, messages);
    if (hf_hdf5_has(io, io->file, HF_REFINE_STATE)) {
        int n_value = hf_hdf5_length(io, io->file, HF_REFINE_STATE, HF_LAYOUT_COUNT_MAX);
        if (io->status == HF_OK && make_refine(s, (size_t)n_value) == HF_OK)
            hf_hdf5_read_list(io, io->file, HF_REFINE_STATE, HF_KIND_REAL, n_value, 0, s->refine);
        hf_hdf5_get(io, io->file, HF_REFINE_STATE, "wall_s", HF_KIND_REAL, &s->refine_wall_s, sizeof(double));
        if (io->status == HF_OK) {
            *wall_s = s->refine_wall_s;
            *n = s->n_refine;
            *state = s->refine;
        }
    }
    return hf_hdf5_unlock(io->status);
}

/* ---- recovery ---- */

/* The optimiser of an unfinished file, made from the file alone. Only the design variables of the model are set. */
typedef struct {
    hf_case settings;
    hf_model model;  /* owns variable_group, variable_leader and variable here */
    double *initial; /* [n_variable] */
    hf_optimiser optimiser;
} stored_search;

/* Reads the rows of optimize.variables that the design variables belong to. */
static void read_rows(hf_hdf5 *io, hid_t group, stored_search *a)
{
    const hf_optimize_settings *o = &a->settings.optimize;
    int *of = hf_hdf5_take(io, (size_t)a->model.n_variable, sizeof *of);
    hf_hdf5_read_list(io, group, "row", HF_KIND_INT, a->model.n_variable, 0, of);
    for (int k = 0; io->status == HF_OK && k < a->model.n_variable; k++) {
        if (of[k] < 0 || of[k] >= o->n_variable_row)
            hf_hdf5_damaged(io, io->file, "/variable", "has design variables of other rows than the case");
        else
            a->model.variable[k] = (hf_variable){.vary = o->variable_row[of[k]].vary,
                                                 .setting = of[k],
                                                 .support_row = -1,
                                                 .scales = o->variable_row[of[k]].link == HF_LINK_SCALE};
    }
    free(of);
}

static void read_variables(hf_hdf5 *io, stored_search *a)
{
    const int n = a->model.n_variable;
    hid_t group = hf_hdf5_open_group(io, "/variable");
    hf_hdf5_read_list(io, group, "group", HF_KIND_INT, n, 0, a->model.variable_group);
    bool has_leader = hf_hdf5_has(io, group, "leader");
    if (has_leader) hf_hdf5_read_list(io, group, "leader", HF_KIND_INT, n, 0, a->model.variable_leader);
    read_initial(io, group, "initial", n, a->initial);
    if (a->model.variable) read_rows(io, group, a);
    hf_hdf5_close(io, group);
    for (int k = 0; io->status == HF_OK && k < a->model.n_variable; k++) {
        if (!has_leader) a->model.variable_leader[k] = k;
        if (a->model.variable_group[k] < 0 || a->model.variable_group[k] >= a->model.n_variable ||
            a->model.variable_leader[k] < 0 || a->model.variable_leader[k] > k ||
            a->model.variable_leader[a->model.variable_leader[k]] != a->model.variable_leader[k])
            hf_hdf5_damaged(io, io->file, "/variable", "has impossible design variables");
        a->model.n_leader += a->model.variable_leader[k] == k;
        if (a->model.variable_group[k] >= a->model.n_variable_group)
            a->model.n_variable_group = a->model.variable_group[k] + 1;
    }
}

static void open_stored_search(hf_store *s, stored_search *a)
{
    hf_hdf5 *io = &s->f.io;
    size_t n = (size_t)s->rows.n_variable;
    a->model.n_variable = s->rows.n_variable;
    a->model.variable_group = hf_hdf5_take(io, n, sizeof *a->model.variable_group);
    a->model.variable_leader = hf_hdf5_take(io, n, sizeof *a->model.variable_leader);
    a->initial = hf_hdf5_take(io, n, sizeof *a->initial);
    if (s->rows.has_rows) a->model.variable = hf_hdf5_take(io, n, sizeof *a->model.variable);
    if (io->status != HF_OK) return;
    hf_store_read_case(io, &a->settings);
    read_variables(io, a);
    const hf_optimize_settings *o = &a->settings.optimize;
    if (io->status == HF_OK &&
        (o->population != s->rows.n_individual || o->generations != s->rows.limit || o->n_front != s->rows.n_objective))
        hf_hdf5_damaged(io, io->file, HF_GENERATIONS_GROUP, "has other sizes than the case");
    const hf_optimiser_kind *kind = hf_optimiser_plan_of(o).kind;
    if (io->status == HF_OK && !kind) hf_hdf5_damaged(io, io->file, "/case", "has no generations");
    if (io->status == HF_OK && hf_optimiser_create(kind, o, &a->model, a->initial, &a->optimiser) != HF_OK)
        hf_hdf5_no_memory(io);
}

/* Adds the generations of the journal to the file and publishes it. *a must be all zero. */
static hf_status recover(const char *path, stored_search *a, hf_summary *summary, hf_messages *messages)
{
    hf_store *s;
    HF_TRY(hf_store_resume(path, &s, messages));
    hf_hdf5_lock();
    s->f.io.messages = messages;
    if (s->n_journal)
        open_stored_search(s, a);
    else
        hf_generations_sum_up(&s->f.io, &s->rows, summary);
    hf_status status = hf_hdf5_unlock(s->f.io.status);
    if (status == HF_OK && s->n_journal) status = restore(s, &a->optimiser, 0, summary, messages);
    if (status == HF_OK) status = hf_store_publish(s, summary, true, messages);
    hf_optimiser_free(&a->optimiser);
    hf_case_free(&a->settings);
    free(a->model.variable_group);
    free(a->model.variable_leader);
    free(a->initial);
    free(a->model.variable);
    hf_store_abandon(s, messages);
    return status;
}

hf_status hf_store_recover(const char *path, hf_summary *summary, hf_messages *messages)
{
    HF_TRY(hf_store_read_summary(path, summary, messages));
    if (summary->finished) {
        hf_warning(messages, "%s: this result is finished, so there is nothing to recover", path);
        return HF_OK;
    }
    stored_search *a = calloc(1, sizeof *a);
    if (!a) return hf_error(messages, HF_NO_MEMORY, "%s: out of memory", path);
    hf_status status = recover(path, a, summary, messages);
    free(a);
    return status;
}

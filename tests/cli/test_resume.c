/* A run that was killed at any instant, told to stop, or had no room on the disk can be continued, with the same result
 * as an undisturbed run. Whatever happens, the result file opens, and no generation that was acknowledged is lost. */
#include "session.h"

#include <hifdm/settings.h>
#include <math.h>

/* ---- kill -9 ---- */

/* After a kill: h5dump opens the file, and file and journal together hold all that was acknowledged before. */
static void look_at_remains(const char *path, int *acknowledged)
{
    int in_journal = generations_in_journal(path, NULL);
    if (!is_there(path)) { /* killed before the first generation */
        ck_assert_int_eq(in_journal + *acknowledged, 0);
        return;
    }
    const char *const dump[] = {"h5dump", "-d", "/form/tension_N", path, NULL};
    struct command command = run_command(HANG_S, dump);
    ck_assert_msg(command.exit_code == 0, "h5dump cannot open what a kill left: %s", command.err);
    free_command(&command);
    int in_file = generations_in_file(path), now = in_journal > in_file ? in_journal : in_file;
    ck_assert_msg(now >= *acknowledged, "%d generations were stored, %d are left", *acknowledged, now);
    *acknowledged = now;
}

/* The journal alone brings back what was acknowledged: in a copy, without running. */
static void recover_a_copy(const char *path, int acknowledged)
{
    const char *copy = temp_path("copy.h5");
    SHELL(0,
          "rm -f \"$2\" \"$2.journal\"; cp \"$1\" \"$2\"; test ! -e \"$1.journal\" || cp \"$1.journal\" \"$2.journal\"",
          path, copy); /* after a recovery there is none until the next run makes one */
    HIFDM(0, "recover", copy);
    ck_assert_int_eq(generations_in_file(copy), acknowledged);
}

/* Killed between its last rename and its end. */
static bool is_finished(const char *path)
{
    HIFDM(0, "show", path);
    return !strstr(said.out, "unfinished");
}

static void demand_same(const char *path, const char *whole)
{
    HIFDM(0, "diff", path, whole);
    EXPECT(path, whole, "--",
           "[k for k in ('evaluations', 'infeasible', 'initial_psi_m', 'psi_m', 'best_generation', "
           "'best_individual', 'iterations') if a['search'].attrs[k] != b['search'].attrs[k]] == []");
}

#define EVERY_7 "optimize.store_every=7"

/* Each time after a random number of changes in the folder, from the first file that is made to thousands of
 * generations; once for each choice of what is stored. HIFDM_STRESS=1: 300 kills instead of 30 and 8. */
START_TEST(killed_runs_go_on_to_the_same_bits)
{
    const char *value = getenv("HIFDM_STRESS"), *store = keep(formatted("optimize.store=%s", hf_keep_word[_i]));
    int n_kill = _i == HF_KEEP_ALL ? 30 : 8, n_resumed = 0, n_finished = 0, acknowledged = 0;
    if (value && *value && strcmp(value, "0")) n_kill = 300;
    const char *c = storing_case("c.yaml", 5000), *path = temp("run.h5"), *whole = temp("whole.h5");
    struct rng rng = rng_start(0);
    double least = _i == HF_KEEP_ALL ? 1 : 20, most = 3000; /* few kills: those before the first generation are known */
    HIFDM(0, "run", c, "-o", whole, "--quiet", "--set", store, "--set", EVERY_7);
    for (int kills = 0; kills < n_kill;) {
        char threads[2] = {(char)('0' + rng_int(&rng, 1, 3)), '\0'}; /* another number each time */
        const char *const argv[] = {hifdm_program(), "run",   c,     "-o",    path,    "--quiet", "--threads",
                                    threads,         "--set", store, "--set", EVERY_7, NULL};
        n_resumed += acknowledged > 0;
        session s = start_program(argv);
        int n_change = (int)exp(rng_uniform(&rng, log(least), log(most)));
        while (s.n_change < n_change && wait_for_change(&s)) {
        }
        int code = end_by(&s, SIGKILL);
        if (code == 128 + SIGKILL) {
            kills++;
            look_at_remains(path, &acknowledged);
            if (kills % 7 == 0 && is_there(path) && !is_finished(path)) recover_a_copy(path, acknowledged);
            if (kills % 3 == 0 && acknowledged > 0) HIFDM(0, "recover", path); /* goes on from generations of a file */
        } else {
            char *err = read_file(temp_path("err"), NULL);
            ck_assert_msg(code == 0, "exit code %d: %s", code, err);
            free(err);
            demand_same(path, whole);
            SHELL(0, "test ! -e \"$1.journal\" && rm \"$1\"", path);
            acknowledged = 0;
            n_finished++;
            most = fmax(0.5 * most, 100); /* on a busy machine several changes are seen as one */
        }
    }
    HIFDM(0, "run", c, "-o", path, "--quiet", "--set", store, "--set", EVERY_7);
    demand_same(path, whole);
    ck_assert_msg(n_resumed >= n_kill / 4, "only %d of %d kills left something to go on with", n_resumed, n_kill);
    if (n_kill > 100) printf("%d kills, %d resumed, %d runs finished between\n", n_kill, n_resumed, n_finished);
}
END_TEST

/* More than were there when the journal was begun. */
static bool has_several_generations(const char *path)
{
    size_t end, first = 72 + 12;
    if (!has_generations(path)) return false;
    int n = generations_in_journal(path, &end);
    char *bytes = read_file(formatted("%s.journal", path), NULL);
    int32_t generation;
    if (end > first) memcpy(&generation, bytes + first, sizeof generation);
    free(bytes);
    return end > first && n >= generation + 4;
}

#define ROWS                                                                                                           \
    "optimize:\n"                                                                                                      \
    "  population: 8\n"                                                                                                \
    "  generations: 1000\n"                                                                                            \
    "  stagnation_generations: 1000\n"                                                                                 \
    "  refine: false\n"                                                                                                \
    "  variables:\n"                                                                                                   \
    "    - {set: edge, vary: tension, range: 20 %}\n"                                                                  \
    "    - {set: inner, vary: force_density, range: 10 %, link: set}\n"                                                \
    "    - {set: edge, vary: support_z, range: 0.01}\n"                                                                \
    "  objective: [{figure: psi}, {figure: evenness, set: edge, weight: 1e-3}]\n"                                      \
    "  limits: [{figure: ratio, set: edge, bounds: [1, 1.3]}]\n"

/* The limit keeps the base and the designs around it out. */
#define FRONT_ROWS                                                                                                     \
    "optimize:\n"                                                                                                      \
    "  population: 8\n"                                                                                                \
    "  generations: 1000\n"                                                                                            \
    "  variables: [{set: edge, vary: tension, range: 30 %}]\n"                                                         \
    "  front: [{figure: psi}, {figure: evenness, set: edge}]\n"                                                        \
    "  limits: [{figure: ratio, set: edge, bounds: [1, 1.3]}]\n"

/* Genes of cables and of supports, goals and limits, or objectives; whatever is stored, on other numbers of threads. */
START_TEST(a_killed_run_of_rows_goes_on_to_the_same_bits)
{
    bool is_front = _i > HF_KEEP_EVERY;
    const char *c = file_with("rows.yaml", is_front ? SMALL_SCENE FRONT_ROWS : SMALL_SCENE ROWS);
    const char *path = temp("run.h5"), *whole = temp("w.h5");
    const char *store = keep(formatted("optimize.store=%s", hf_keep_word[_i % (HF_KEEP_EVERY + 1)]));
    const char *const argv[] = {hifdm_program(), "run", c,       "-o",    path, "--quiet", "--threads", "2",
                                "--set",         store, "--set", EVERY_7, NULL};
    HIFDM(0, "run", c, "-o", whole, "--quiet", "--threads", "1", "--set", store, "--set", EVERY_7);
    session s = start_program(argv);
    ck_assert(freeze_when(&s, has_several_generations, path));
    ck_assert_int_eq(end_by(&s, SIGKILL), 128 + SIGKILL);
    HIFDM(0, "recover", path);
    ck_assert_int_ge(generations_in_file(path), 4);
    HIFDM(0, "run", c, "-o", path, "--quiet", "--threads", "1", "--set", store, "--set", EVERY_7);
    demand_same(path, whole);
    EXPECT(path, "--", "0 < a['search'].attrs['infeasible'] < a['search'].attrs['evaluations']");
}
END_TEST

/* A torn or spoilt tail is cut off: the generations before it count. */
START_TEST(a_torn_journal_gives_what_is_whole)
{
    const char *c = storing_case("c.yaml", 1000000), *path = temp("run.h5");
    const char *const argv[] = {hifdm_program(), "run", c, "-o", path, "--quiet", NULL};
    size_t end = 0;
    session s = start_program(argv);
    ck_assert(freeze_when(&s, has_several_generations, path));
    ck_assert_int_eq(end_by(&s, SIGKILL), 128 + SIGKILL);
    int n = generations_in_journal(path, &end); /* a record may be torn behind it */
    ck_assert_int_ge(n, generations_in_file(path) + 3);
    ck_assert_int_eq(truncate(keep(formatted("%s.journal", path)), (off_t)end - 5), 0);
    recover_a_copy(path, n - 1);
    ck_assert_int_eq(generations_in_journal(path, &end), n - 1);
    SHELL(0, "printf spoilt | dd of=\"$1.journal\" bs=1 seek=$2 conv=notrunc 2>/dev/null", path,
          keep(formatted("%zu", end - 100)));
    recover_a_copy(path, n - 2); /* the torn record and the one before it */
    const char *copy = temp_path("copy.h5");
    SHELL(0, "cp \"$1\" \"$2\" && cp \"$1.journal\" \"$2.journal\"", path, copy);
    HIFDM(0, "recover", copy);
    ERR("is damaged, so hifdm ignores its last ");
    SHELL(0, "cp \"$1\" \"$2\" && cp \"$1.journal\" \"$2.journal\"", path, copy);
    SHELL(0, "printf another | dd of=\"$1.journal\" bs=1 seek=10 conv=notrunc 2>/dev/null", copy);
    HIFDM(5, "recover", copy);
    ERR("belongs to another case. Delete this journal, replace it with the right journal");
    ck_assert_int_ge(generations_in_journal(copy, NULL), n - 2);                         /* it is as it was */
    SHELL(0, "head -c 30 \"$1.journal\" >\"$1.t\" && mv \"$1.t\" \"$1.journal\"", path); /* not even a header */
    HIFDM(0, "recover", path);
    write_file(keep(formatted("%s.journal", path)), "somebody's diary");
    HIFDM(5, "run", c, "-o", path);
    ERR("is not a journal of hifdm");
    ck_assert(file_is(keep(formatted("%s.journal", path)), "somebody's diary"));
}
END_TEST

/* The designs of a journal are bred again from what the file says: seed, bounds, groups and who follows whom. */
START_TEST(seed_and_symmetry_are_recovered)
{
    const char *c = storing_case("c.yaml", 4000), *path = temp("run.h5"), *whole = temp("whole.h5");
    const char *const more[] = {"--seed", "11", "--set", "optimize.symmetry=auto", NULL};
    HIFDM(0, "run", c, "-o", whole, "--quiet", "--seed", "11", "--set", "optimize.symmetry=auto");
    int n = 0;
    for (int i = 0; i < 30 && (n == 0 || n <= generations_in_file(path)); i++) { /* unless it was just published */
        session s = start_held_run(c, path, more);
        wait_for_generations(&s, path);
        end_by(&s, SIGKILL);
        n = generations_in_journal(path, NULL);
    }
    recover_a_copy(path, n);
    HIFDM(0, "recover", path);
    EXPECT(path, whole, "--",
           "[a['search'].attrs[k] == b['search'].attrs[k] for k in ('solver', 'n_leader', 'planes', 'initial_psi_m')] "
           "== [True] * 4",
           "a['search'].attrs['psi_m'] == a['search/population/best_psi_m'][:].min()",
           "a['search'].attrs['iterations'] == a['search/population/iterations'][a['search'].attrs['best_generation'], "
           "a['search'].attrs['best_individual']]",
           "np.isnan(a['search'].attrs['shortest_length_ratio'])");
    HIFDM(0, "run", c, "-o", path, "--quiet", "--seed", "11", "--set", "optimize.symmetry=auto");
    HIFDM(0, "diff", path, whole);
}
END_TEST

/* ---- told to stop ---- */

static const int stops[] = {SIGINT, SIGTERM, SIGUSR1, SIGHUP};

START_TEST(stopped_runs_publish_and_go_on)
{
    const char *c = storing_case("c.yaml", 3000), *path = temp("run.h5"), *whole = temp("whole.h5");
    const char *const more[] = {"--threads", "2", "--seed", "5", NULL};
    session s = start_held_run(c, path, more);
    wait_for_generations(&s, path);
    ck_assert_int_eq(end_by(&s, stops[_i]), 75);
    char *err = read_file(temp_path("err"), NULL);
    ck_assert_msg(strstr(err, "the run was interrupted. Run the same command again to resume") != NULL, "%s", err);
    free(err);
    SHELL(0, "ls \"$1\"*", path);
    ck_assert_str_eq(said.out, formatted("%s\n", path)); /* all of it is in the one file */
    ck_assert_int_gt(generations_in_file(path), 0);
    HIFDM(0, "show", path);
    OUT("unfinished");
    ck_assert_ptr_null(strstr(said.out, "0 of ")); /* variables at their bounds are counted at the end */
    HIFDM(0, "export", path, "--csv", temp("csv"));
    ERR("this run is unfinished, so the exported shape is that of the form-finding. Run the same command again");
    EXPECT(path, "--", "not a.attrs['finished'] and attribute(a, 'status') == 'unfinished'");
    HIFDM(0, "run", c, "-o", path, "--seed", "5", "--threads", "1", "--quiet");
    HIFDM(0, "run", c, "-o", whole, "--seed", "5", "--quiet");
    HIFDM(0, "diff", path, whole);
    EXPECT(path, whole, "--", "a.attrs['finished'] and attribute(a, 'status') == 'ok'", "a.attrs['sessions'] == 2",
           "str({k: v for k, v in a['search'].attrs.items() if k[-2:] != '_s'}) == "
           "str({k: v for k, v in b['search'].attrs.items() if k[-2:] != '_s'})");
}
END_TEST

/* In a form-finding or a Levenberg-Marquardt that would take long. */
START_TEST(stops_are_heard_between_generations_too)
{
    const char *path = temp("run.h5");
    const char *const form[] = {hifdm_program(),
                                "run",
                                REFLECTOR,
                                "-o",
                                path,
                                "--set",
                                "form.method=hifdm",
                                "--set",
                                "form.max_iterations=10000000",
                                "--set",
                                "form.residual_tolerance=1e-13",
                                "--set",
                                "scene.parabolic_cylinder.cells_per_module=[6, 6]",
                                "--progress",
                                "jsonl",
                                NULL};
    const char *const refine[] = {hifdm_program(),
                                  "run",
                                  REFLECTOR,
                                  "-o",
                                  path,
                                  "--set",
                                  "optimize.method=lm",
                                  "--set",
                                  "optimize.refine_steps=100000",
                                  "--set",
                                  "scene.parabolic_cylinder.cells_per_module=[5, 5]",
                                  "--progress",
                                  "jsonl",
                                  NULL};
    const char *const *const argv[] = {form, refine};
    bool (*const has_begun[])(const char *) = {says_form, says_refine};
    for (int i = 0; i < 2; i++) {
        session s = start_program(argv[i]);
        ck_assert(wait_until(&s, has_begun[i], temp("err")));
        int code = end_by(&s, SIGTERM);
        ck_assert_msg(code == 75, "run %d: exit code %d", i, code);
        SHELL(0, "rm -f \"$1\"; ls \"$1\".* 2>/dev/null; true", path);
        ck_assert_str_eq(said.out, "");
    }
}
END_TEST

/* Seconds of Levenberg-Marquardt: variables enough. */
#define LONG_REFINE                                                                                                    \
    "scene:\n  paraboloid: {aperture_m: 9, focal_length_m: 6, offset_m: 5.5, rings: 5, rear_distance_m: 2.4}\n"        \
    "surface: {frequencies_Hz: [6e9]}\n"                                                                               \
    "form: {pretension_N: 10, prestress: exact}\n"                                                                     \
    "truss:\n  ring: {cells_per_bay: 2, bracing: single, held: bay}\n"                                                 \
    "optimize:\n  method: lm\n  refine_steps: 60\n"                                                                    \
    "  variables: [{set: all, vary: force_density, range: 50 %}]\n"                                                    \
    "  objective: [{figure: facets, along: half_path, feed: refocused}, {figure: evenness, set: front, weight: "       \
    "1e-3}]\n"                                                                                                         \
    "  limits: [{figure: tension, set: all, bounds: [1, 60]}]\n"

/* Steps by the saddle-point system. */
#define LONG_SPARSE                                                                                                    \
    "scene:\n  paraboloid: {aperture_m: 12, focal_length_m: 6, rings: 14, rear_distance_m: 3.6}\n"                     \
    "form: {pretension_N: 10, prestress: exact}\n"                                                                     \
    "truss:\n  ring: {cells_per_bay: 1, held: bay, longeron: {diameter_m: 0.03, wall_m: 0.001}}\n"                     \
    "optimize:\n  method: lm\n  refine_steps: 7\n  boundary_ratio_cap: 1000\n"                                         \
    "  variables: [{set: all, vary: force_density, bounds: [0.1, null]}]\n"                                            \
    "  objective: [{figure: psi}, {figure: evenness, set: front, weight: 1e-5}]\n"

/* hifdm reports steps once a second. Another step runs after the first report. The runs take about five seconds. */
static bool says_step(const char *err)
{
    char *text = read_file(err, NULL);
    const char *first = strstr(text, "\"step\": "), *next = first ? strstr(first + 1, "\"step\": ") : NULL;
    bool has_next = next && strchr(next, '\n');
    free(text);
    return has_next;
}

/* Levenberg-Marquardt says how far it is, and neither a signal nor a kill undoes its steps. */
START_TEST(a_stopped_refinement_goes_on_to_the_same_bits)
{
    const char *c = file_with("c.yaml", _i ? LONG_SPARSE : LONG_REFINE), *path = temp("run.h5"),
               *whole = temp("whole.h5");
    const char *const argv[] = {hifdm_program(), "run", c, "-o", path, "--threads", "2", "--progress", "jsonl", NULL};
    session s = start_program(argv);
    ck_assert(wait_until(&s, says_step, temp("err")));
    ck_assert_int_eq(end_by(&s, SIGTERM), 75);
    char *err = read_file(temp_path("err"), NULL);
    const char *at = strstr(err, "interrupted after ");
    int n_stopped, iteration = -1;
    ck_assert_msg(at && sscanf(at, "interrupted after %d steps of the refinement, at psi ", &n_stopped) == 1, "%s",
                  err);
    ck_assert(strstr(at, " and a merit of ") && strstr(at, ". Run the same command again to resume"));
    ck_assert_int_gt(n_stopped, 0);
    free(err);
    s = start_program(argv);
    ck_assert(wait_until(&s, says_step, temp("err"))); /* published as well, from a second on */
    ck_assert_int_eq(end_by(&s, SIGKILL), 128 + SIGKILL);
    err = read_file(temp_path("err"), NULL);
    ck_assert_int_eq(sscanf(strstr(err, "\"step\": "), "\"step\": %d", &iteration), 1);
    ck_assert_int_eq(iteration, n_stopped);
    free(err);
    HIFDM(0, "run", c, "-o", path, "--quiet", "--progress", "jsonl", "--threads", "1");
    HIFDM(0, "run", c, "-o", whole, "--quiet", "--threads", "2");
    HIFDM(0, "diff", path, whole);
    /* the killed session counts where it had published before: it tells of a step first */
    EXPECT(path, whole, "--", "a.attrs['sessions'] in (2, 3)",
           "str({k: v for k, v in a['refine'].attrs.items() if k[-2:] != '_s'}) == "
           "str({k: v for k, v in b['refine'].attrs.items() if k[-2:] != '_s'})",
           "all(a['refine'].attrs[k] > 1 for k in a['refine'].attrs if k[-6:] == 'wall_s')");
}
END_TEST

/* ---- who may go on, and with what ---- */

START_TEST(another_case_is_told_key_by_key)
{
    const char *c = file_with("c.yaml", SMALL_SCENE SMALL_GA), *path = temp("run.h5");
    HIFDM(0, "run", c, "-o", path, "--quiet");
    HIFDM(0, "run", c, "-o", path);
    ERR("this file is the finished result of this case. Use --restart to compute the result again");
    OUT("\n  search          ");
    HIFDM(5, "run", c, "-o", path, "--set", "form.pretension_N=11", "--set", "optimize.elites=3");
    ERR("finished result of another case. The differences are: form.pretension_N, optimize.elites. Use --restart");
    HIFDM(5, "run", c, "-o", path, "--seed", "8");
    ERR("The differences are: optimize.seed.");
    HIFDM(5, "run", file_with("c.yaml", "# a remark\n" SMALL_SCENE SMALL_GA), "-o", path);
    ERR("no key, but comments and layout");
    HIFDM(5, "run", file_with("c.yaml", SMALL_SCENE), "-o", path);
    ERR("The differences are: optimize,");
    HIFDM(0, "recover", path);
    ERR("this result is finished, so there is nothing to recover");
    OUT("\n  search          ");
    HIFDM(0, "run", file_with("c.yaml", SMALL_SCENE), "-o", path, "--restart", "--quiet");
    EXPECT(path, "--", "'search' not in a");
    const char *net = net_with("id,x_m,y_m,z_m,role\na,0,0,0,support\nb,2,0,0,support\nc,1,1,0.5,inner\n"
                               "d,1,-1,0.5,support\n",
                               "id,i,j,group,law,value\nac,a,c,inner,tension,10\nbc,b,c,inner,tension,10\n"
                               "dc,d,c,inner,tension,10\n");
    SHELL(0, "mkdir \"$1\"", temp("elsewhere")); /* files that the case names are beside the case */
    HIFDM(0, "run", net, "-o", temp("elsewhere/net.h5"), "--quiet");
    HIFDM(5, "run", net, "-o", temp("elsewhere/net.h5"), "--set", "form.pretension_N=11");
    ERR("The differences are: form.pretension_N. Use");
}
END_TEST

START_TEST(a_second_process_is_refused)
{
    const char *c = storing_case("c.yaml", 1000000), *path = temp("run.h5");
    const char *const argv[] = {hifdm_program(), "run", c, "-o", path, "--quiet", NULL};
    session s = start_program(argv);
    wait_for_generations(&s, path);
    HIFDM(5, "run", c, "-o", path);
    ERR("another process is writing this result");
    HIFDM(5, "run", c, "-o", path, "--restart");
    HIFDM(5, "recover", path);
    generations_in_file(path); /* reading is free */
    ck_assert_int_eq(end_by(&s, SIGINT), 75);
}
END_TEST

/* Samples of a point that was taken from a front are told of once a second. */
static bool says_samples(const char *err)
{
    char *text = read_file(err, NULL);
    bool has_some = false;
    for (const char *at = text; !has_some && (at = strstr(at, "\"sample\": ")) != NULL;)
        has_some = atol(at += strlen("\"sample\": ")) > 0;
    free(text);
    return has_some;
}

START_TEST(a_stopped_point_goes_on_to_the_same_bits)
{
#define OF_POINT                                                                                                       \
    SMALL_SCENE "  EA_inner_N: 47000\n  EA_boundary_N: 47000\noptimize:\n  method: lm\n  front_points: 3\n"            \
                "  front: [{figure: psi}, {figure: ratio, set: boundary}]\n"
    const char *c = file_with("c.yaml", OF_POINT "tolerance: {sigma_cut_m: 1e-4, samples: 150000}\n"),
               *front = temp("f.h5"), *path = temp("run.h5"), *whole = temp("whole.h5");
    HIFDM(0, "run", file_with("f.yaml", OF_POINT), "-o", front, "--quiet");
    const char *point = keep(formatted("%s:2", front));
    const char *const argv[] = {hifdm_program(), "run", c, "--point", point, "-o", path, "--progress", "jsonl", NULL};
    session s = start_program(argv);
    ck_assert(wait_until(&s, says_samples, temp("err")));
    ck_assert_int_eq(end_by(&s, SIGTERM), 75);
    s = start_program(argv);
    ck_assert(wait_until(&s, says_samples, temp("err")));
    ck_assert_int_eq(end_by(&s, SIGKILL), 128 + SIGKILL);
    HIFDM(5, "run", c, "--point", keep(formatted("%s:3", front)), "-o", path);
    ERR("is the unfinished result of another case. The differences are: it has --point ");
    HIFDM(0, "run", c, "--point", point, "-o", path, "--quiet", "--threads", "1");
    HIFDM(0, "run", c, "--point", point, "-o", whole, "--quiet", "--threads", "2");
    HIFDM(0, "diff", path, whole);
}
END_TEST

/* ---- trouble with the folder ---- */

START_TEST(a_vanished_folder_is_told)
{
    SHELL(0, "mkdir \"$1\"", temp("gone"));
    const char *c = storing_case("c.yaml", 1000000), *path = temp("gone/run.h5");
    const char *const argv[] = {hifdm_program(), "run", c, "-o", path, "--quiet", NULL};
    session s = start_session(temp("gone"), false, argv);
    wait_for_generations(&s, path);
    SHELL(0, "rm -r \"$1\"", temp("gone"));
    ck_assert_int_eq(end_of(&s), 5); /* at the next publication, or within HF_JOURNAL_SYNC_S */
    char *err = read_file(temp_path("err"), NULL);
    ck_assert_msg(strstr(err, path) != NULL, "%s", err);
    free(err);
}
END_TEST

/* A limit on file sizes stands for the full disk. What was acknowledged stays, and with room the run goes on. */
START_TEST(a_full_disk_loses_nothing)
{
    static const char *const limits[] = {"150", "300", "1000", "3000"}; /* blocks of 512 or 1024 bytes */
    const char *c = storing_case("c.yaml", 3000), *path = temp("run.h5"), *whole = temp("whole.h5");
    SHELL(0,
          "trap '' XFSZ; ulimit -f $3; \"$0\" run \"$1\" -o \"$2\" --quiet 2>\"$2.err\"; [ $? = 5 ] && grep -q 'File "
          "too large' \"$2.err\" && rm \"$2.err\"",
          c, path, limits[_i]);
    int acknowledged = 0;
    look_at_remains(path, &acknowledged);
    if (is_there(path)) recover_a_copy(path, acknowledged);
    HIFDM(0, "run", c, "-o", path, "--quiet");
    HIFDM(0, "run", c, "-o", whole, "--quiet");
    HIFDM(0, "diff", path, whole);
}
END_TEST

Suite *suite_cli_resume(void)
{
    Suite *suite = suite_create("cli/resume");
    TCase *tcase = tcase_create("resume");
    tcase_add_loop_test(tcase, killed_runs_go_on_to_the_same_bits, 0, 3);
    tcase_add_loop_test(tcase, a_killed_run_of_rows_goes_on_to_the_same_bits, 0, 6);
    tcase_add_test(tcase, a_torn_journal_gives_what_is_whole);
    tcase_add_test(tcase, seed_and_symmetry_are_recovered);
    tcase_add_loop_test(tcase, stopped_runs_publish_and_go_on, 0, sizeof stops / sizeof *stops);
    tcase_add_loop_test(tcase, a_stopped_refinement_goes_on_to_the_same_bits, 0, 2);
    tcase_add_test(tcase, a_stopped_point_goes_on_to_the_same_bits);
    tcase_add_test(tcase, stops_are_heard_between_generations_too);
    tcase_add_test(tcase, another_case_is_told_key_by_key);
    tcase_add_test(tcase, a_second_process_is_refused);
    tcase_add_test(tcase, a_vanished_folder_is_told);
    tcase_add_loop_test(tcase, a_full_disk_loses_nothing, 0, 4);
    suite_add_tcase(suite, tcase);
    return suite;
}

/* Reads the options of the command line. options.h describes the interface.
 *
 *     table of options -> for each word: command, option with its value, or file -> hf_options
 *
 * Contents: reading a value - the table - reading a command line */
#include "app/options.h"

#include "base/text.h"
#include "store/ledger.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#define THREADS_MAX 4096  /* maximum of --threads; a larger number is probably a typing error */
#define TASKS_MAX 1000000 /* maximum of --tasks */
#define RENAME_IT "rename it, because version 0.4 refuses the old name"

/* ---- reading a value ---- */

/* Returns the address of the member of hf_options that an option sets. */
static void *place_of(const hf_option *option, hf_options *o)
{
    return (char *)o + option->offset;
}

static hf_status read_text(const hf_option *option, const char *value, hf_options *o, hf_messages *messages)
{
    (void)messages;
    *(const char **)place_of(option, o) = value;
    return HF_OK;
}

static hf_status read_flag(const hf_option *option, const char *value, hf_options *o, hf_messages *messages)
{
    (void)value;
    (void)messages;
    *(bool *)place_of(option, o) = true;
    return HF_OK;
}

static hf_status read_set(const hf_option *option, const char *value, hf_options *o, hf_messages *messages)
{
    (void)option;
    (void)messages;
    o->set[o->n_set++] = value;
    return HF_OK;
}

static hf_status read_count(const hf_option *option, const char *value, int most, int *to, hf_messages *messages)
{
    uint64_t number;
    if (!hf_text_uint64(value, &number) || number < 1 || number > (uint64_t)most)
        return hf_error(messages, HF_BAD_USAGE, "%s must be from 1 to %d, not '%s'", option->name, most, value);
    *to = (int)number;
    return HF_OK;
}

static hf_status read_threads(const hf_option *option, const char *value, hf_options *o, hf_messages *messages)
{
    return read_count(option, value, THREADS_MAX, &o->threads, messages);
}

static hf_status read_seed(const hf_option *option, const char *value, hf_options *o, hf_messages *messages)
{
    if (!hf_text_uint64(value, &o->seed))
        return hf_error(messages, HF_BAD_USAGE, "%s must be a whole number from 0 to 2^64-1, not '%s'", option->name,
                        value);
    o->has_seed = true;
    return HF_OK;
}

static hf_status read_tolerance(const hf_option *option, const char *value, hf_options *o, hf_messages *messages)
{
    double *tolerance = place_of(option, o);
    if (!hf_text_double(value, tolerance) || *tolerance < 0)
        return hf_error(messages, HF_BAD_USAGE, "%s must be a number from 0 on, not '%s'", option->name, value);
    return HF_OK;
}

static hf_status read_progress(const hf_option *option, const char *value, hf_options *o, hf_messages *messages)
{
    for (int i = 0; hf_progress_word[i]; i++) {
        if (strcmp(value, hf_progress_word[i]) != 0) continue;
        o->progress = (hf_progress_mode)i;
        return HF_OK;
    }
    return hf_error(messages, HF_BAD_USAGE, "%s must be auto, none, line, log or jsonl, not '%s'", option->name, value);
}

static hf_status read_stage(const hf_option *option, const char *value, hf_options *o, hf_messages *messages)
{
    static const char *const old[HF_N_STAGE] = {
        [HF_STAGE_FORM] = "", [HF_STAGE_SEARCH] = "optimize", [HF_STAGE_REFINE] = "polish"};
    for (int i = 0; i < HF_N_STAGE; i++) {
        bool is_new = !strcmp(value, hf_stage_word[i]);
        if (!is_new && (!*value || strcmp(value, old[i]) != 0)) continue;
        if (!is_new) hf_warning(messages, "--stage %s is now --stage %s: " RENAME_IT, old[i], hf_stage_word[i]);
        o->stage = hf_stage_word[i];
        return HF_OK;
    }
    return hf_error(messages, HF_BAD_USAGE, "%s must be form, search or refine, not '%s'", option->name, value);
}

static hf_status read_task(const hf_option *option, const char *value, hf_options *o, hf_messages *messages)
{
    uint64_t number;
    if (!hf_text_uint64(value, &number) || number >= TASKS_MAX)
        return hf_error(messages, HF_BAD_USAGE, "%s must be a whole number from 0 on, not '%s'", option->name, value);
    o->task = (int)number;
    return HF_OK;
}

static hf_status read_tasks(const hf_option *option, const char *value, hf_options *o, hf_messages *messages)
{
    return read_count(option, value, TASKS_MAX, &o->tasks, messages);
}

/* Turns a list of states such as "failed,missing" into bits 1 << hf_point_state. Returns 0 if a word is unknown. */
static unsigned states_of(const char *text)
{
    static const hf_point_state state[] = {HF_POINT_MISSING, HF_POINT_FAILED, HF_POINT_OUTDATED};
    unsigned states = 0;
    for (const char *p = text;; p++) {
        size_t n = strcspn(p, ",");
        int k = 0;
        while (k < 3 && (strlen(hf_point_state_word[state[k]]) != n || strncmp(hf_point_state_word[state[k]], p, n)))
            k++;
        if (k == 3) return 0;
        states |= 1u << state[k];
        p += n;
        if (!*p) return states;
    }
}

static hf_status read_retry(const hf_option *option, const char *value, hf_options *o, hf_messages *messages)
{
    o->retry = states_of(value);
    if (o->retry) return HF_OK;
    return hf_error(messages, HF_BAD_USAGE, "%s must be of missing, failed, outdated, with commas, not '%s'",
                    option->name, value);
}

static hf_status read_man(const hf_option *option, const char *value, hf_options *o, hf_messages *messages)
{
    (void)option;
    (void)value;
    (void)messages;
    o->help_as = HF_HELP_MAN;
    return HF_OK;
}

static hf_status read_bash(const hf_option *option, const char *value, hf_options *o, hf_messages *messages)
{
    (void)option;
    (void)value;
    (void)messages;
    o->help_as = HF_HELP_BASH;
    return HF_OK;
}

static hf_status read_new(const hf_option *option, const char *value, hf_options *o, hf_messages *messages)
{
    hf_new_case asked = !strcmp(option->name, "--import")     ? HF_NEW_IMPORT
                        : !strcmp(option->name, "--cylinder") ? HF_NEW_CYLINDER
                                                              : HF_NEW_PARABOLOID;
    (void)value;
    if (o->new_case != HF_NEW_UNSAID && o->new_case != asked)
        return hf_error(messages, HF_BAD_USAGE, "%s excludes the kind that was asked for before it", option->name);
    o->new_case = asked;
    return HF_OK;
}

/* ---- the table ---- */

#define AT(member) offsetof(hf_options, member)
#define CASE_COMMANDS "run check evaluate tolerance"
#define SET_COMMANDS CASE_COMMANDS " adjust"

static const hf_option option_table[] = {
    {"--output", "-o", "FILE", "result file (default: the case's name with .h5, in this folder)", "run tolerance",
     read_text, AT(output), NULL},
    {"--point", NULL, "FILE:N",
     "take point N of the front in the result FILE for the design; the case and --set are those of its run",
     "run tolerance", read_text, AT(point), NULL},
    {"--designs", NULL, "FILE",
     "CSV: a column for each variable (without optimize.variables: adjustable cable, N), optionally id", "evaluate",
     read_text, AT(designs), NULL},
    {"--template", NULL, "FILE", "instead: write such a table, with the values after form-finding as its one row",
     "evaluate", read_text, AT(template_path), NULL},
    {"--jacobian", NULL, "FILE",
     "also write the exact derivatives of psi, or of objectives and merit, by each variable", "evaluate", read_text,
     AT(jacobian), NULL},
    {"--output", "-o", "FILE", "CSV of the results (default: standard output)", "evaluate", read_text, AT(output),
     NULL},
    {"--measured", NULL, "FILE",
     "CSV id,x_m,y_m,z_m[,sigma_m]: measured positions of nodes of the as-built net; some may be missing", "adjust",
     read_text, AT(measured), NULL},
    {"--result", NULL, "FILE", "result of this case that the net was cut from (default: its form-finding)", "adjust",
     read_text, AT(result), NULL},
    {"--output", "-o", "FILE", "CSV of the moves (default: none)", "adjust", read_text, AT(output), NULL},
    {"--report", NULL, "FILE", "the page of that result with the moves on it", "adjust", read_text, AT(report), NULL},
    {"--output", "-o", "FILE", "merged file (default: the study's name with .h5, in this folder)", "merge", read_text,
     AT(output), NULL},
    {"--dir", NULL, "DIR", "folder of the results (default: the study's name with .d, in this folder)",
     "sweep status merge", read_text, AT(folder), NULL},
    {"--task", NULL, "I", "with --tasks N: only every N-th point, from I = 0 on; default from Slurm's array", "sweep",
     read_task, 0, NULL},
    {"--task", NULL, "I", "with --tasks N: only every N-th chunk of samples, from I = 0 on, kept beside FILE",
     "tolerance", read_task, 0, NULL},
    {"--tasks", NULL, "N", "number of tasks that share the points", "sweep", read_tasks, 0, NULL},
    {"--tasks", NULL, "N", "without --task: merge the samples of N tasks, and compute the missing ones", "tolerance",
     read_tasks, 0, NULL},
    {"--retry", NULL, "missing|failed|outdated", "which points to run (default: missing); several with commas", "sweep",
     read_retry, 0, NULL},
    {"--output", "-o", "FILE", "the page (default: the result's name with .html, in this folder)", "report", read_text,
     AT(output), NULL},
    {"--restart", NULL, NULL,
     "replace FILE and its journal; without it, the command resumes an unfinished result of this case", "run tolerance",
     read_flag, AT(force), NULL},
    {"--force", NULL, NULL, "replace existing files (of run: the same as --restart)",
     "run export evaluate report merge tolerance adjust", read_flag, AT(force), NULL},
    {"--set", NULL, "KEY=VALUE", "override one key of the case, like form.pretension_N=12; may be repeated",
     SET_COMMANDS, read_set, 0, NULL},
    {"--threads", NULL, "N", "threads (default: one per core); the results do not depend on it",
     CASE_COMMANDS " sweep adjust", read_threads, 0, NULL},
    {"--seed", NULL, "S", "seed of the genetic algorithm instead of optimize.seed", "run", read_seed, 0, NULL},
    {"--json", NULL, NULL, "one JSON object on standard output", "run show recover evaluate status tolerance adjust",
     read_flag, AT(json), NULL},
    {"--progress", NULL, "auto|none|line|log|jsonl",
     "on standard error: line for a terminal, log every 30 s, jsonl for programs", "run tolerance", read_progress, 0,
     NULL},
    {"--quiet", NULL, NULL, "no progress and no summary; warnings and errors stay",
     "run evaluate sweep merge tolerance adjust", read_flag, AT(quiet), NULL},
    {"--verbose", "-v", NULL, "the summary with certificates, ratios of sets, times and all else", "run tolerance show",
     read_flag, AT(verbose), NULL},
    {"--rtol", NULL, "R", "numbers are equal when |a-b| <= atol + R |b| (default 0: to the bit)", "diff",
     read_tolerance, AT(rtol), NULL},
    {"--atol", NULL, "A", "see --rtol", "diff", read_tolerance, AT(atol), NULL},
#define EXPORTER(name)                                                                                                 \
    {NULL, NULL, NULL, NULL, "export", read_text, AT(export_to[HF_EXPORTER_##name]), &hf_exporter_##name},
    HF_EXPORTERS(EXPORTER)
#undef EXPORTER
        {"--stage", NULL, "form|search|refine", "which shape (default: the result of the run)", "export adjust",
         read_stage, 0, NULL},
    {"--load-case", NULL, "NAME", "the shape in this load case of the as-built net (`load_cases`)", "export", read_text,
     AT(load_case), NULL},
    {"--paraboloid", NULL, NULL, "a round reflector: two nets that are tied to each other (the default)", "new",
     read_new, 0, NULL},
    {"--cylinder", NULL, NULL, "a parabolic cylinder: one net, optimised", "new", read_new, 0, NULL},
    {"--import", NULL, NULL, "a net of your own in two tables, nodes and cables", "new", read_new, 0, NULL},
    {"--man", NULL, NULL, "print the manual page, for man(1)", "help", read_man, 0, NULL},
    {"--bash", NULL, NULL, "print the completion for bash", "help", read_bash, 0, NULL},
    {"--help", "-h", NULL, "print this", NULL, read_flag, AT(help), NULL},
};
enum { N_OPTION = sizeof option_table / sizeof *option_table };
const int hf_n_option = N_OPTION;

hf_option hf_option_at(int i)
{
    hf_option option = option_table[i];
    if (!option.exporter) return option;
    option.name = option.exporter->option;
    option.argument = option.exporter->argument;
    option.help = option.exporter->help;
    return option;
}

/* Returns true if `word` is one of the words, which are separated by blanks. */
static bool is_listed(const char *words, const char *word)
{
    size_t length = strlen(word);
    for (const char *p = words; *p;) {
        size_t n = strcspn(p, " ");
        if (n == length && !strncmp(p, word, n)) return true;
        p += n + (p[n] == ' ');
    }
    return false;
}

bool hf_option_goes_with(const hf_option *option, const hf_command *command)
{
    return !option->commands || is_listed(option->commands, command->name);
}

/* ---- reading a command line ---- */

/* Reports an unknown word with the most similar known one, or with the command that lists the known words; `where`
 * follows 'hifdm help' in that command. Returns HF_BAD_USAGE. */
static hf_status unknown(const char *kind, const char *word, const char *const *names, int n_name, const char *where,
                         hf_messages *messages)
{
    const char *near = hf_text_nearest(word, names, n_name);
    if (near) return hf_error(messages, HF_BAD_USAGE, "unknown %s '%s'; did you mean '%s'?", kind, word, near);
    return hf_error(messages, HF_BAD_USAGE, "unknown %s '%s'; 'hifdm help%s' lists them", kind, word, where);
}

static bool needs_argument(const hf_command *command)
{
    return command->argument && *command->argument != '[';
}

/* Returns true for a command with two arguments: "A B" in its row, or "A [B]" if the second is optional. */
static bool takes_two(const hf_command *command)
{
    return command->argument && strchr(command->argument, ' ');
}

static hf_status find_command(const char *word, const hf_command **command, hf_messages *messages)
{
    const char *names[HF_N_COMMAND];
    for (int i = 0; i < HF_N_COMMAND; i++) {
        const hf_command *c = *command = hf_command_table[i];
        names[i] = c->name;
        bool is_dashed = !strncmp(word, "--", 2) && !strcmp(word + 2, c->name); /* --help, --version */
        if (!strcmp(word, c->name) || (is_dashed && !needs_argument(c))) return HF_OK;
        if (!strcmp(word, "-h") && c == &hf_cmd_help) return HF_OK;
    }
    return unknown("command", word, names, HF_N_COMMAND, "", messages);
}

static hf_status find_option(const char *word, const hf_command *command, hf_option *option, hf_messages *messages)
{
    const char *names[N_OPTION];
    bool is_old = !strncmp(word, "--case", 6) && (!word[6] || word[6] == '='), is_elsewhere = false;
    const char *name = is_old ? "--load-case" : word;
    size_t length = strcspn(name, "=");
    for (int i = 0; i < N_OPTION; i++) {
        hf_option o = hf_option_at(i);
        names[i] = o.name;
        bool is_long = strlen(o.name) == length && !strncmp(name, o.name, length);
        bool is_short = o.letter && !strcmp(word, o.letter);
        if (!is_long && !is_short) continue;
        *option = o;
        is_elsewhere = true;
        if (!hf_option_goes_with(&o, command)) continue;
        if (is_old) hf_warning(messages, "--case is now --load-case: " RENAME_IT);
        return HF_OK;
    }
    if (is_elsewhere)
        return hf_error(messages, HF_BAD_USAGE, "'%s' does not go with this command; 'hifdm help %s' lists what does",
                        word, command->name);
    char where[32];
    snprintf(where, sizeof where, " %s", command->name);
    return unknown("option", word, names, N_OPTION, where, messages);
}

static hf_status read_file(const char *word, const hf_command *command, hf_options *o, hf_messages *messages)
{
    if (command->argument && !o->file)
        o->file = word;
    else if (takes_two(command) && !o->second)
        o->second = word;
    else if (command->argument && strstr(command->argument, "...")) /* such a command reads them from argv */
        return HF_OK;
    else
        return hf_error(messages, HF_BAD_USAGE, "'%s' is one argument too many for 'hifdm %s'", word, command->name);
    return HF_OK;
}

static hf_status read_words(int argc, char *const *argv, const hf_command *command, hf_options *o,
                            hf_messages *messages)
{
    bool files_alone = false; /* after "--" */
    for (int i = 2; i < argc; i++) {
        hf_option option;
        const char *value = NULL, *equals = strchr(argv[i], '=');
        if (!files_alone && !strcmp(argv[i], "--")) {
            files_alone = true;
            continue;
        }
        if (files_alone || argv[i][0] != '-' || !argv[i][1]) {
            HF_TRY(read_file(argv[i], command, o, messages));
            continue;
        }
        HF_TRY(find_option(argv[i], command, &option, messages));
        if (option.argument) {
            bool is_joined = equals && argv[i][1] == '-';
            if (!is_joined && i + 1 == argc)
                return hf_error(messages, HF_BAD_USAGE, "'%s' needs %s behind it", argv[i], option.argument);
            value = is_joined ? equals + 1 : argv[++i];
            if (!*value && option.read == read_text) /* a file or a folder */
                return hf_error(messages, HF_BAD_USAGE, "'%s' needs %s behind it, not an empty word", option.name,
                                option.argument);
        } else if (equals) {
            return hf_error(messages, HF_BAD_USAGE, "'%s' takes no value", option.name);
        }
        HF_TRY(option.read(&option, value, o, messages));
    }
    return HF_OK;
}

hf_status hf_options_parse(int argc, char *const *argv, hf_options *options, hf_messages *messages)
{
    const hf_command *command;
    *options = (hf_options){.argc = argc, .argv = argv, .task = -1};
    if (argc < 2) return hf_error(messages, HF_BAD_USAGE, "a command is missing; 'hifdm help' lists them");
    HF_TRY(find_command(argv[1], &command, messages));
    options->command = command;
    options->set = calloc((size_t)argc, sizeof *options->set);
    if (!options->set) return hf_error(messages, HF_NO_MEMORY, "out of memory");
    HF_TRY(read_words(argc, argv, command, options, messages));
    if (command == &hf_cmd_help && options->file && !options->help)
        HF_TRY(find_command(options->file, &options->topic, messages));
    if (options->help) { /* hifdm COMMAND --help */
        options->command = &hf_cmd_help;
        options->topic = command;
    }
    if (options->command == &hf_cmd_help) return HF_OK;
    uint64_t cpus;
    const char *slurm = getenv("SLURM_CPUS_PER_TASK");
    if (!options->threads && slurm && hf_text_uint64(slurm, &cpus) && cpus >= 1 && cpus <= THREADS_MAX)
        options->threads = (int)cpus;
    if (needs_argument(command) && !options->file)
        return hf_error(messages, HF_BAD_USAGE, "'hifdm %s' needs a %s", command->name, command->argument);
    if (takes_two(command) && !strchr(command->argument, '[') && !options->second)
        return hf_error(messages, HF_BAD_USAGE, "'hifdm %s' needs a second file", command->name);
    return HF_OK;
}

void hf_options_free(hf_options *options)
{
    free(options->set);
    *options = (hf_options){0};
}

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
#define STEPS_MAX 100000  /* maximum of --more, as of optimize.refine_steps */
#define RENAME_IT "rename it, because version 0.4 refuses the old name"

/* ---- reading a value ---- */

typedef hf_option_reading reading;

/* Returns the address of the member of hf_options that an option sets. */
static void *place_of(const reading *r)
{
    return (char *)r->options + r->option->offset;
}

/* Reports that the value must be something else. Returns HF_BAD_USAGE. */
static hf_status refuse(const reading *r, const char *what)
{
    return hf_error(r->messages, HF_BAD_USAGE, "%s must be %s, not '%s'", r->option->name, what, r->value);
}

static hf_status read_text(const reading *r)
{
    *(const char **)place_of(r) = r->value;
    return HF_OK;
}

static hf_status read_flag(const reading *r)
{
    *(bool *)place_of(r) = true;
    return HF_OK;
}

static hf_status read_choice(const reading *r)
{
    *(int *)place_of(r) = r->option->number;
    return HF_OK;
}

/* Reads a choice that excludes others. */
static hf_status read_only_choice(const reading *r)
{
    int *choice = place_of(r);
    if (*choice && *choice != r->option->number)
        return hf_error(r->messages, HF_BAD_USAGE, "the option %s cannot be combined with the export option before it",
                        r->option->name);
    return read_choice(r);
}

static hf_status read_set(const reading *r)
{
    r->options->set[r->options->n_set++] = r->value;
    return HF_OK;
}

static hf_status read_count(const reading *r)
{
    uint64_t number;
    char range[32];
    snprintf(range, sizeof range, "from 1 to %d", r->option->number);
    if (!hf_text_uint64(r->value, &number) || number < 1 || number > (uint64_t)r->option->number)
        return refuse(r, range);
    *(int *)place_of(r) = (int)number;
    return HF_OK;
}

static hf_status read_task(const reading *r)
{
    uint64_t number;
    if (!hf_text_uint64(r->value, &number) || number >= TASKS_MAX) return refuse(r, "a whole number >= 0");
    *(int *)place_of(r) = (int)number;
    return HF_OK;
}

static hf_status read_seed(const reading *r)
{
    r->options->has_seed = hf_text_uint64(r->value, place_of(r));
    return r->options->has_seed ? HF_OK : refuse(r, "a whole number from 0 to 2^64-1");
}

static hf_status read_tolerance(const reading *r)
{
    double *tolerance = place_of(r);
    return hf_text_double(r->value, tolerance) && *tolerance >= 0 ? HF_OK : refuse(r, "a number >= 0");
}

static hf_status read_progress(const reading *r)
{
    int i = 0;
    while (hf_progress_word[i] && strcmp(r->value, hf_progress_word[i]) != 0)
        i++;
    if (!hf_progress_word[i]) return refuse(r, "auto, none, line, log or jsonl");
    r->options->progress = (hf_progress_mode)i;
    return HF_OK;
}

static hf_status read_stage(const reading *r)
{
    static const char *const old[HF_N_STAGE] = {
        [HF_STAGE_FORM] = "", [HF_STAGE_SEARCH] = "optimize", [HF_STAGE_REFINE] = "polish"};
    for (int i = 0; i < HF_N_STAGE; i++) {
        bool is_new = !strcmp(r->value, hf_stage_word[i]);
        if (!is_new && (!*r->value || strcmp(r->value, old[i]) != 0)) continue;
        if (!is_new) hf_warning(r->messages, "--stage %s is now --stage %s: " RENAME_IT, old[i], hf_stage_word[i]);
        r->options->stage = hf_stage_word[i];
        return HF_OK;
    }
    return refuse(r, "form, search or refine");
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

static hf_status read_retry(const reading *r)
{
    r->options->retry = states_of(r->value);
    return r->options->retry ? HF_OK : refuse(r, "a list of missing, failed and outdated, separated by commas");
}

/* ---- the table ---- */

#define AT(member) offsetof(hf_options, member)
#define CASE_COMMANDS "run check evaluate tolerance"
#define SET_COMMANDS CASE_COMMANDS " adjust"

static const hf_option option_table[] = {
    {"--output", "-o", "FILE", "result file (default: the case's name with .h5, in this folder)", "run tolerance",
     read_text, AT(output), 0},
    {"--point", NULL, "FILE:N",
     "take point N of the front in the result FILE for the design; the case and --set are those of its run",
     "run tolerance", read_text, AT(point), 0},
    {"--more", NULL, "N", "continue the refinement of the finished result FILE by N steps", "run", read_count, AT(more),
     STEPS_MAX},
    {"--designs", NULL, "FILE",
     "CSV: a column for each variable (without optimize.variables: adjustable cable, N), optionally id", "evaluate",
     read_text, AT(designs), 0},
    {"--template", NULL, "FILE", "instead: write such a table, with the values after form-finding as its one row",
     "evaluate", read_text, AT(template_path), 0},
    {"--jacobian", NULL, "FILE",
     "also write the exact derivatives of psi, or of objectives and merit, by each variable", "evaluate", read_text,
     AT(jacobian), 0},
    {"--residuals", NULL, "FILE",
     "also write residuals, positions and tensions, with exact derivatives by each variable", "evaluate", read_text,
     AT(residuals), 0},
    {"--output", "-o", "FILE", "CSV of the results (default: standard output)", "evaluate", read_text, AT(output), 0},
    {"--measured", NULL, "FILE",
     "CSV id,x_m,y_m,z_m[,sigma_m]: measured positions of nodes of the as-built net; some may be missing", "adjust",
     read_text, AT(measured), 0},
    {"--load-case", NULL, "NAME", "load case of the as-built net in which the positions were measured (default: none)",
     "adjust", read_text, AT(load_case), 0},
    {"--result", NULL, "FILE", "result of this case that the net was cut from (default: its form-finding)", "adjust",
     read_text, AT(result), 0},
    {"--output", "-o", "FILE", "CSV of the adjustments (default: none)", "adjust", read_text, AT(output), 0},
    {"--report", NULL, "FILE", "the page of that result with the adjustments on it", "adjust", read_text, AT(report),
     0},
    {"--output", "-o", "FILE", "merged file (default: the study's name with .h5, in this folder)", "merge", read_text,
     AT(output), 0},
    {"--dir", NULL, "DIR", "folder of the results (default: the study's name with .d, in this folder)",
     "sweep status merge", read_text, AT(folder), 0},
    {"--task", NULL, "I", "with --tasks N: only every N-th point, from I = 0 on; default from Slurm's array", "sweep",
     read_task, AT(task), 0},
    {"--task", NULL, "I", "with --tasks N: only every N-th chunk of samples, from I = 0 on, kept beside FILE",
     "tolerance", read_task, AT(task), 0},
    {"--tasks", NULL, "N", "number of tasks that share the points", "sweep", read_count, AT(tasks), TASKS_MAX},
    {"--tasks", NULL, "N", "without --task: merge the samples of N tasks, and compute the missing ones", "tolerance",
     read_count, AT(tasks), TASKS_MAX},
    {"--retry", NULL, "missing|failed|outdated", "which points to run (default: missing); several with commas", "sweep",
     read_retry, 0, 0},
    {"--output", "-o", "FILE", "the page (default: the result's name with .html, in this folder)", "report", read_text,
     AT(output), 0},
    {"--restart", NULL, NULL,
     "replace FILE and its journal; without it, the command resumes an unfinished result of this case", "run tolerance",
     read_flag, AT(force), 0},
    {"--force", NULL, NULL, "replace existing files (of run: the same as --restart)",
     "run export evaluate report merge tolerance adjust", read_flag, AT(force), 0},
    {"--set", NULL, "KEY=VALUE", "override one key of the case, like form.pretension_N=12; may be repeated",
     SET_COMMANDS, read_set, 0, 0},
    {"--threads", NULL, "N", "threads (default: one per core); the results do not depend on it",
     CASE_COMMANDS " sweep adjust", read_count, AT(threads), THREADS_MAX},
    {"--seed", NULL, "S", "seed of the genetic algorithm instead of optimize.seed", "run", read_seed, AT(seed), 0},
    {"--json", NULL, NULL, "one JSON object on standard output", "run show recover evaluate status tolerance adjust",
     read_flag, AT(json), 0},
    {"--progress", NULL, "auto|none|line|log|jsonl",
     "on standard error: line for a terminal, log every 30 s, jsonl for programs", "run tolerance", read_progress, 0,
     0},
    {"--quiet", NULL, NULL, "no progress and no summary; warnings and errors stay",
     "run evaluate sweep merge tolerance adjust", read_flag, AT(quiet), 0},
    {"--verbose", "-v", NULL, "the summary with certificates, ratios of sets, times and all else", "run tolerance show",
     read_flag, AT(verbose), 0},
    {"--strict", NULL, NULL, "end with exit status 6 if the result fails a requirement", "run tolerance", read_flag,
     AT(strict), 0},
    {"--rtol", NULL, "R", "numbers are equal when |a-b| <= atol + R |b| (default 0: to the bit)", "diff",
     read_tolerance, AT(rtol), 0},
    {"--atol", NULL, "A", "see --rtol", "diff", read_tolerance, AT(atol), 0},
#define EXPORTER(name)                                                                                                 \
    {NULL, NULL, NULL, NULL, "export", read_text, AT(export_to[HF_EXPORTER_##name]), HF_EXPORTER_##name},
    HF_EXPORTERS(EXPORTER)
#undef EXPORTER
        {"--stage", NULL, "form|search|refine", "which shape (default: the result of the run)", "export adjust",
         read_stage, 0, 0},
    {"--load-case", NULL, "NAME", "the shape in this load case of the as-built net (`load_cases`)", "export", read_text,
     AT(load_case), 0},
    {"--paraboloid", NULL, NULL, "a round reflector: two nets that are tied to each other (the default)", "new",
     read_only_choice, AT(new_case), HF_NEW_PARABOLOID},
    {"--cylinder", NULL, NULL, "a parabolic cylinder: one net, optimised", "new", read_only_choice, AT(new_case),
     HF_NEW_CYLINDER},
    {"--import", NULL, NULL, "a net of your own in two tables, nodes and cables", "new", read_only_choice, AT(new_case),
     HF_NEW_IMPORT},
    {"--man", NULL, NULL, "print the manual page, for man(1)", "help", read_choice, AT(help_as), HF_HELP_MAN},
    {"--bash", NULL, NULL, "print the completion for bash", "help", read_choice, AT(help_as), HF_HELP_BASH},
    {"--help", "-h", NULL, "print this", NULL, read_flag, AT(help), 0},
};
enum { N_OPTION = sizeof option_table / sizeof *option_table };
const int hf_n_option = N_OPTION;

hf_option hf_option_at(int i)
{
    hf_option option = option_table[i];
    if (option.name) return option;
    const hf_exporter *exporter = hf_exporter_table[option.number];
    option.name = exporter->option;
    option.argument = exporter->argument;
    option.help = exporter->help;
    return option;
}

bool hf_option_goes_with(const hf_option *option, const hf_command *command)
{
    size_t length = strlen(command->name);
    for (const char *p = option->commands; p && *p;) {
        size_t n = strcspn(p, " ");
        if (n == length && !strncmp(p, command->name, n)) return true;
        p += n + (p[n] == ' ');
    }
    return !option->commands;
}

/* ---- reading a command line ---- */

/* Reports an unknown word with the most similar known one, or with the command that lists the known words; `where`
 * follows 'hifdm help' in that command. Returns HF_BAD_USAGE. */
static hf_status unknown(const char *kind, const char *word, const char *const *names, int n_name, const char *where,
                         hf_messages *messages)
{
    const char *near = hf_text_nearest(word, names, n_name);
    if (near) return hf_error(messages, HF_BAD_USAGE, "unknown %s '%s'; did you mean '%s'?", kind, word, near);
    return hf_error(messages, HF_BAD_USAGE, "unknown %s '%s'. 'hifdm help%s' lists the valid names", kind, word, where);
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

static bool is_help(const hf_command *command)
{
    return !strcmp(command->name, "help");
}

static hf_status find_command(const char *word, const hf_command *const *commands, const hf_command **command,
                              hf_messages *messages)
{
    const char *names[HF_N_COMMAND];
    for (int i = 0; i < HF_N_COMMAND; i++) {
        const hf_command *c = *command = commands[i];
        names[i] = c->name;
        bool is_dashed = !strncmp(word, "--", 2) && !strcmp(word + 2, c->name); /* --help, --version */
        if (!strcmp(word, c->name) || (is_dashed && !needs_argument(c))) return HF_OK;
        if (!strcmp(word, "-h") && is_help(c)) return HF_OK;
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
        return hf_error(messages, HF_BAD_USAGE,
                        "'%s' is not an option of this command. 'hifdm help %s' lists the options of the command", word,
                        command->name);
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
        return hf_error(messages, HF_BAD_USAGE, "'%s' is an unexpected argument of 'hifdm %s'", word, command->name);
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
                return hf_error(messages, HF_BAD_USAGE, "the option '%s' must be followed by %s", argv[i],
                                option.argument);
            value = is_joined ? equals + 1 : argv[++i];
            if (!*value && option.read == read_text) /* a file or a folder */
                return hf_error(messages, HF_BAD_USAGE,
                                "the option '%s' must be followed by %s, not by an empty string", option.name,
                                option.argument);
        } else if (equals) {
            return hf_error(messages, HF_BAD_USAGE, "'%s' has no value", option.name);
        }
        HF_TRY(option.read(&(reading){&option, value, o, messages}));
    }
    return HF_OK;
}

hf_status hf_options_parse(int argc, char *const *argv, const hf_command *const *commands, hf_options *options,
                           hf_messages *messages)
{
    const hf_command *command;
    *options = (hf_options){.commands = commands, .argc = argc, .argv = argv, .task = -1};
    if (argc < 2) return hf_error(messages, HF_BAD_USAGE, "the command is missing. 'hifdm help' lists all commands");
    HF_TRY(find_command(argv[1], commands, &command, messages));
    options->command = command;
    options->set = calloc((size_t)argc, sizeof *options->set);
    if (!options->set) return hf_error(messages, HF_NO_MEMORY, "out of memory");
    HF_TRY(read_words(argc, argv, command, options, messages));
    if (is_help(command) && options->file && !options->help)
        HF_TRY(find_command(options->file, commands, &options->topic, messages));
    if (options->help) { /* hifdm COMMAND --help */
        HF_TRY(find_command("help", commands, &options->command, messages));
        options->topic = command;
    }
    if (is_help(options->command)) return HF_OK;
    uint64_t cpus;
    const char *slurm = getenv("SLURM_CPUS_PER_TASK");
    if (!options->threads && slurm && hf_text_uint64(slurm, &cpus) && cpus >= 1 && cpus <= THREADS_MAX)
        options->threads = (int)cpus;
    if (needs_argument(command) && !options->file)
        return hf_error(messages, HF_BAD_USAGE, "'hifdm %s' needs the argument %s", command->name, command->argument);
    if (takes_two(command) && !strchr(command->argument, '[') && !options->second)
        return hf_error(messages, HF_BAD_USAGE, "'hifdm %s' needs a second file", command->name);
    return HF_OK;
}

void hf_options_free(hf_options *options)
{
    free(options->set);
    *options = (hf_options){0};
}

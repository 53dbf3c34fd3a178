/* Contents: the tables - reading */
#include "app/options.h"

#include "store/ledger.h"
#include "base/text.h"

#include <stdlib.h>
#include <string.h>

#define BIT(command) (1u << (command))
#define SWEEP_COMMANDS (BIT(HF_COMMAND_SWEEP) | BIT(HF_COMMAND_STATUS) | BIT(HF_COMMAND_MERGE))
#define THREADS_MAX 4096
#define TASKS_MAX 1000000

/* In the order of hf_progress_mode. */
static const char *const progress_word[] = {"auto", "none", "line", "log", "jsonl", NULL};

const hf_command_row hf_command_table[] = {
    {"run", "CASE", "run what the case file contains and store it in one HDF5 file", HF_COMMAND_RUN},
    {"check", "CASE", "validate; print what will run, what is skipped, sizes, memory and expected time",
     HF_COMMAND_CHECK},
    {"evaluate", "CASE", "evaluate a table of designs (boundary pretensions), to a table on standard output or -o",
     HF_COMMAND_EVALUATE},
    {"sweep", "STUDY",
     "run the points of a sweep that are missing, on all cores; each once, a failed one stops no other",
     HF_COMMAND_SWEEP},
    {"status", "STUDY", "count what is done, running, failed and missing, and say why", HF_COMMAND_STATUS},
    {"merge", "STUDY", "one HDF5 file with a table of all points and links to their result files", HF_COMMAND_MERGE},
    {"show", "FILE", "print the summary of a result file", HF_COMMAND_SHOW},
    {"recover", "FILE", "add the generations of FILE.journal to an unfinished result; `run` does that by itself",
     HF_COMMAND_RECOVER},
    {"diff", "A B", "compare two result files, data set by data set; times and provenance (attributes) do not count",
     HF_COMMAND_DIFF},
    {"report", "FILE", "write a result as one HTML page to look at: net, histories, tensions, summary",
     HF_COMMAND_REPORT},
    {"export", "FILE", "write a result as CSV files, for ParaView, or as a cut list", HF_COMMAND_EXPORT},
    {"schema", NULL, "print every key of a case file: type, range, default, meaning", HF_COMMAND_SCHEMA},
    {"help", "[COMMAND]", "tell what a command does, its options, and examples", HF_COMMAND_HELP},
    {"version", NULL, "print the version", HF_COMMAND_VERSION},
};
enum { N_COMMAND = sizeof hf_command_table / sizeof *hf_command_table };
const int hf_n_command = N_COMMAND;

typedef enum {
    OPTION_OUTPUT,
    OPTION_SET,
    OPTION_THREADS,
    OPTION_SEED,
    OPTION_JSON,
    OPTION_QUIET,
    OPTION_FORCE,
    OPTION_CSV,
    OPTION_VTK,
    OPTION_CUTLIST,
    OPTION_DESIGNS,
    OPTION_TEMPLATE,
    OPTION_STAGE,
    OPTION_RTOL,
    OPTION_ATOL,
    OPTION_PROGRESS,
    OPTION_DIR,
    OPTION_TASK,
    OPTION_TASKS,
    OPTION_RETRY,
    OPTION_MAN,
    OPTION_BASH,
    OPTION_HELP
} option_id;

const hf_option_row hf_option_table[] = {
    {"--output", "-o", "FILE", "result file (default: the case's name with .h5, in this folder)", BIT(HF_COMMAND_RUN),
     OPTION_OUTPUT},
    {"--designs", NULL, "FILE", "CSV: a column for each adjustable cable by its id, optionally id; N; a design per row",
     BIT(HF_COMMAND_EVALUATE), OPTION_DESIGNS},
    {"--template", NULL, "FILE", "instead: write such a table, with the tensions after form-finding as its one row",
     BIT(HF_COMMAND_EVALUATE), OPTION_TEMPLATE},
    {"--output", "-o", "FILE", "CSV of the results (default: standard output)", BIT(HF_COMMAND_EVALUATE),
     OPTION_OUTPUT},
    {"--output", "-o", "FILE", "merged file (default: the study's name with .h5, in this folder)",
     BIT(HF_COMMAND_MERGE), OPTION_OUTPUT},
    {"--dir", NULL, "DIR", "folder of the results (default: the study's name with .d, in this folder)", SWEEP_COMMANDS,
     OPTION_DIR},
    {"--task", NULL, "I", "with --tasks N: only every N-th point, from I = 0 on; default from Slurm's array",
     BIT(HF_COMMAND_SWEEP), OPTION_TASK},
    {"--tasks", NULL, "N", "number of tasks that share the points", BIT(HF_COMMAND_SWEEP), OPTION_TASKS},
    {"--retry", NULL, "missing|failed|outdated", "which points to run (default: missing); several with commas",
     BIT(HF_COMMAND_SWEEP), OPTION_RETRY},
    {"--output", "-o", "FILE", "the page (default: the result's name with .html, in this folder)",
     BIT(HF_COMMAND_REPORT), OPTION_OUTPUT},
    {"--restart", NULL, NULL,
     "begin anew, whatever FILE and its journal hold; without it an unfinished result of this case goes on",
     BIT(HF_COMMAND_RUN), OPTION_FORCE},
    {"--force", NULL, NULL, "replace existing files (of run: the same as --restart)",
     BIT(HF_COMMAND_RUN) | BIT(HF_COMMAND_EXPORT) | BIT(HF_COMMAND_EVALUATE) | BIT(HF_COMMAND_REPORT) |
         BIT(HF_COMMAND_MERGE),
     OPTION_FORCE},
    {"--set", NULL, "KEY=VALUE", "override one key of the case, like form.pretension_N=12; may be repeated",
     BIT(HF_COMMAND_RUN) | BIT(HF_COMMAND_CHECK) | BIT(HF_COMMAND_EVALUATE), OPTION_SET},
    {"--threads", NULL, "N", "threads (default: one per core); the results do not depend on it",
     BIT(HF_COMMAND_RUN) | BIT(HF_COMMAND_CHECK) | BIT(HF_COMMAND_EVALUATE) | BIT(HF_COMMAND_SWEEP), OPTION_THREADS},
    {"--seed", NULL, "S", "seed of the genetic algorithm instead of optimize.seed", BIT(HF_COMMAND_RUN), OPTION_SEED},
    {"--json", NULL, NULL, "one JSON object on standard output",
     BIT(HF_COMMAND_RUN) | BIT(HF_COMMAND_SHOW) | BIT(HF_COMMAND_RECOVER) | BIT(HF_COMMAND_EVALUATE) |
         BIT(HF_COMMAND_STATUS),
     OPTION_JSON},
    {"--progress", NULL, "auto|none|line|log|jsonl",
     "on standard error: line for a terminal, log every 30 s, jsonl for programs", BIT(HF_COMMAND_RUN),
     OPTION_PROGRESS},
    {"--quiet", NULL, NULL, "no progress and no summary; warnings and errors stay",
     BIT(HF_COMMAND_RUN) | BIT(HF_COMMAND_EVALUATE) | BIT(HF_COMMAND_SWEEP) | BIT(HF_COMMAND_MERGE), OPTION_QUIET},
    {"--rtol", NULL, "R", "numbers are equal when |a-b| <= atol + R |b| (default 0: to the bit)", BIT(HF_COMMAND_DIFF),
     OPTION_RTOL},
    {"--atol", NULL, "A", "see --rtol", BIT(HF_COMMAND_DIFF), OPTION_ATOL},
    {"--csv", NULL, "DIR", "write nodes.csv and cables.csv, and truss_nodes.csv and members.csv of a truss, into DIR",
     BIT(HF_COMMAND_EXPORT), OPTION_CSV},
    {"--vtk", NULL, "DIR", "write every shape of the run into DIR, for ParaView (VTKHDF)", BIT(HF_COMMAND_EXPORT),
     OPTION_VTK},
    {"--cutlist", NULL, "FILE", "write unstressed lengths to FILE, the jig and totals beside it",
     BIT(HF_COMMAND_EXPORT), OPTION_CUTLIST},
    {"--stage", NULL, "form|optimize|polish", "which shape (default: the result of the run)", BIT(HF_COMMAND_EXPORT),
     OPTION_STAGE},
    {"--man", NULL, NULL, "print the manual page, for man(1)", BIT(HF_COMMAND_HELP), OPTION_MAN},
    {"--bash", NULL, NULL, "print the completion for bash", BIT(HF_COMMAND_HELP), OPTION_BASH},
    {"--help", "-h", NULL, "print this", ~0u, OPTION_HELP},
};
enum { N_OPTION = sizeof hf_option_table / sizeof *hf_option_table };
const int hf_n_option = N_OPTION;

int hf_option_goes_with(const hf_option_row *option, const hf_command_row *command)
{
    return (option->commands & BIT(command->command)) != 0;
}

/* ---- reading ---- */

/* `where`: behind 'hifdm help', to have them listed. */
static hf_status unknown(const char *kind, const char *word, const char *const *names, int n_name, const char *where,
                         hf_messages *messages)
{
    const char *near = hf_text_nearest(word, names, n_name);
    if (near) return hf_error(messages, HF_BAD_USAGE, "unknown %s '%s'; did you mean '%s'?", kind, word, near);
    return hf_error(messages, HF_BAD_USAGE, "unknown %s '%s'; 'hifdm help%s' lists them", kind, word, where);
}

static int needs_argument(const hf_command_row *command)
{
    return command->argument && *command->argument != '[';
}

static hf_status find_command(const char *word, const hf_command_row **row, hf_messages *messages)
{
    const char *names[N_COMMAND];
    for (int i = 0; i < N_COMMAND; i++) {
        *row = &hf_command_table[i];
        names[i] = hf_command_table[i].name;
        int dashed = !strncmp(word, "--", 2) && !strcmp(word + 2, names[i]); /* --help, --version */
        if (!strcmp(word, names[i]) || (dashed && !needs_argument(*row))) return HF_OK;
        if (!strcmp(word, "-h") && hf_command_table[i].command == HF_COMMAND_HELP) return HF_OK;
    }
    return unknown("command", word, names, N_COMMAND, "", messages);
}

static hf_status find_option(const char *word, const hf_command_row *command, const hf_option_row **row,
                             hf_messages *messages)
{
    const char *names[N_OPTION];
    size_t length = strcspn(word, "=");
    int elsewhere = 0;
    for (int i = 0; i < N_OPTION; i++) {
        const hf_option_row *o = &hf_option_table[i];
        names[i] = o->name;
        int is_long = strlen(o->name) == length && !strncmp(word, o->name, length);
        int is_short = o->letter && !strcmp(word, o->letter);
        if (!is_long && !is_short) continue;
        *row = o;
        if (hf_option_goes_with(o, command)) return HF_OK;
        elsewhere = 1;
    }
    if (elsewhere)
        return hf_error(messages, HF_BAD_USAGE, "'%s' does not go with this command; 'hifdm help %s' lists what does",
                        word, command->name);
    char where[32];
    snprintf(where, sizeof where, " %s", command->name);
    return unknown("option", word, names, N_OPTION, where, messages);
}

static hf_status read_progress(const char *value, int *mode, hf_messages *messages)
{
    for (*mode = 0; progress_word[*mode]; ++*mode)
        if (!strcmp(value, progress_word[*mode])) return HF_OK;
    return hf_error(messages, HF_BAD_USAGE, "--progress must be auto, none, line, log or jsonl, not '%s'", value);
}

/* "failed,missing" -> bits; 0 when a word is unknown. */
static unsigned read_states(const char *text)
{
    static const char *const word[] = {"missing", "failed", "outdated"};
    static const unsigned bit[] = {1u << HF_POINT_MISSING, 1u << HF_POINT_FAILED, 1u << HF_POINT_OUTDATED};
    unsigned states = 0;
    for (const char *p = text;; p++) {
        size_t n = strcspn(p, ",");
        int k = 0;
        while (k < 3 && (strlen(word[k]) != n || strncmp(word[k], p, n)))
            k++;
        if (k == 3) return 0;
        states |= bit[k];
        p += n;
        if (!*p) return states;
    }
}

/* Where the value goes of an option whose value may be anything; NULL for the others. */
static const char **text_of(int id, hf_options *o)
{
    switch (id) {
    case OPTION_OUTPUT:
        return &o->output;
    case OPTION_CSV:
        return &o->csv;
    case OPTION_VTK:
        return &o->vtk;
    case OPTION_CUTLIST:
        return &o->cutlist;
    case OPTION_DESIGNS:
        return &o->designs;
    case OPTION_TEMPLATE:
        return &o->template_path;
    case OPTION_DIR:
        return &o->folder;
    default:
        return NULL;
    }
}

/* What an option without a value sets to 1; NULL for the others. */
static int *flag_of(int id, hf_options *o)
{
    switch (id) {
    case OPTION_FORCE:
        return &o->force;
    case OPTION_JSON:
        return &o->json;
    case OPTION_QUIET:
        return &o->quiet;
    case OPTION_HELP:
        return &o->help;
    default:
        return NULL;
    }
}

static hf_status apply(const hf_option_row *row, const char *value, hf_options *o, hf_messages *messages)
{
    uint64_t number = 0;
    int is_number = value && hf_text_uint64(value, &number);
    const char **text = text_of(row->id, o);
    int *flag = flag_of(row->id, o);
    if (text) *text = value;
    if (flag) *flag = 1;
    switch (row->id) {
    case OPTION_SET:
        o->set[o->n_set++] = value;
        break;
    case OPTION_THREADS:
        if (!is_number || number < 1 || number > THREADS_MAX)
            return hf_error(messages, HF_BAD_USAGE, "--threads must be from 1 to %d, not '%s'", THREADS_MAX, value);
        o->threads = (int)number;
        break;
    case OPTION_SEED:
        if (!is_number)
            return hf_error(messages, HF_BAD_USAGE, "--seed must be a whole number from 0 to 2^64-1, not '%s'", value);
        o->has_seed = 1;
        o->seed = number;
        break;
    case OPTION_RTOL:
    case OPTION_ATOL:
        if (!hf_text_double(value, row->id == OPTION_RTOL ? &o->rtol : &o->atol) || o->rtol < 0 || o->atol < 0)
            return hf_error(messages, HF_BAD_USAGE, "%s must be a number from 0 on, not '%s'", row->name, value);
        break;
    case OPTION_PROGRESS:
        return read_progress(value, &o->progress, messages);
    case OPTION_STAGE:
        if (strcmp(value, "form") && strcmp(value, "optimize") && strcmp(value, "polish"))
            return hf_error(messages, HF_BAD_USAGE, "--stage must be form, optimize or polish, not '%s'", value);
        o->stage = value;
        break;
    case OPTION_TASK:
        if (!is_number || number >= TASKS_MAX)
            return hf_error(messages, HF_BAD_USAGE, "--task must be a whole number from 0 on, not '%s'", value);
        o->task = (int)number;
        break;
    case OPTION_TASKS:
        if (!is_number || number < 1 || number > TASKS_MAX)
            return hf_error(messages, HF_BAD_USAGE, "--tasks must be from 1 to %d, not '%s'", TASKS_MAX, value);
        o->tasks = (int)number;
        break;
    case OPTION_RETRY:
        o->retry = read_states(value);
        if (!o->retry)
            return hf_error(messages, HF_BAD_USAGE,
                            "--retry must be of missing, failed, outdated, with commas, not '%s'", value);
        break;
    case OPTION_MAN:
        o->help_as = HF_HELP_MAN;
        break;
    case OPTION_BASH:
        o->help_as = HF_HELP_BASH;
        break;
    }
    return HF_OK;
}

static hf_status read_words(int argc, char *const *argv, const hf_command_row *command, hf_options *o,
                            hf_messages *messages)
{
    for (int i = 2; i < argc; i++) {
        const hf_option_row *row = NULL;
        const char *value = NULL, *equals = strchr(argv[i], '=');
        if (argv[i][0] != '-' || !argv[i][1]) {
            if (o->file && command->command == HF_COMMAND_DIFF && !o->second) {
                o->second = argv[i];
                continue;
            }
            if (!command->argument || o->file)
                return hf_error(messages, HF_BAD_USAGE, "'%s' is one argument too many for 'hifdm %s'", argv[i],
                                command->name);
            o->file = argv[i];
            continue;
        }
        HF_TRY(find_option(argv[i], command, &row, messages));
        if (row->argument) {
            int joined = equals && argv[i][1] == '-';
            if (!joined && i + 1 == argc)
                return hf_error(messages, HF_BAD_USAGE, "'%s' needs %s behind it", argv[i], row->argument);
            value = joined ? equals + 1 : argv[++i];
        } else if (equals) {
            return hf_error(messages, HF_BAD_USAGE, "'%s' takes no value", row->name);
        }
        HF_TRY(apply(row, value, o, messages));
    }
    return HF_OK;
}

hf_status hf_options_parse(int argc, char *const *argv, hf_options *options, hf_messages *messages)
{
    const hf_command_row *command;
    *options = (hf_options){.task = -1};
    if (argc < 2) return hf_error(messages, HF_BAD_USAGE, "a command is missing; 'hifdm help' lists them");
    HF_TRY(find_command(argv[1], &command, messages));
    options->command = command->command;
    options->set = calloc((size_t)argc, sizeof *options->set);
    if (!options->set) return hf_error(messages, HF_NO_MEMORY, "out of memory");
    HF_TRY(read_words(argc, argv, command, options, messages));
    if (options->command == HF_COMMAND_HELP && options->file && !options->help)
        HF_TRY(find_command(options->file, &options->topic, messages));
    if (options->help) { /* hifdm COMMAND --help */
        options->command = HF_COMMAND_HELP;
        options->topic = command;
    }
    if (options->command == HF_COMMAND_HELP) return HF_OK;
    uint64_t cpus;
    const char *slurm = getenv("SLURM_CPUS_PER_TASK");
    if (!options->threads && slurm && hf_text_uint64(slurm, &cpus) && cpus >= 1 && cpus <= THREADS_MAX)
        options->threads = (int)cpus;
    if (needs_argument(command) && !options->file)
        return hf_error(messages, HF_BAD_USAGE, "'hifdm %s' needs a %s", command->name, command->argument);
    if (options->command == HF_COMMAND_DIFF && !options->second)
        return hf_error(messages, HF_BAD_USAGE, "'hifdm diff' needs a second file");
    if (options->command == HF_COMMAND_EXPORT && !options->csv && !options->vtk && !options->cutlist)
        return hf_error(messages, HF_BAD_USAGE, "'hifdm export' needs --csv DIR, --vtk DIR or --cutlist FILE");
    if (options->stage && !options->csv && !options->cutlist)
        return hf_error(messages, HF_BAD_USAGE, "--stage does not go with --vtk alone, which writes every shape");
    if (options->command == HF_COMMAND_EVALUATE && !options->designs == !options->template_path)
        return hf_error(messages, HF_BAD_USAGE, "'hifdm evaluate' needs either --designs FILE or --template FILE");
    if (options->template_path && options->output)
        return hf_error(messages, HF_BAD_USAGE, "'-o' does not go with --template");
    if (options->designs && options->json && !options->output)
        return hf_error(messages, HF_BAD_USAGE,
                        "--json needs -o FILE here: without it the table takes standard output");
    return HF_OK;
}

void hf_options_free(hf_options *options)
{
    free(options->set);
    *options = (hf_options){0};
}

/* Contents: the texts - plain text - manual page - completion for bash */
#include "app/help.h"

#include <hifdm/config.h>
#include <hifdm/store.h>

#include <string.h>

#define SUMMARY "shape and pretension of the cable net of a large deployable mesh reflector"

/* ---- the texts ---- */

/* By command; what the tables of options cannot tell. */
static const struct {
    const char *about, *examples;
} text_of[] = {
    [HF_COMMAND_RUN] = {"What the case file contains decides what runs: form-finding always, the genetic algorithm and "
                        "Levenberg-Marquardt with a section optimize. Every generation is stored. A run that was "
                        "killed or told to stop goes on when the same command is given again; a finished one is kept "
                        "unless --restart is given.",
                        "hifdm run configs/chen2022.yaml\n"
                        "hifdm run case.yaml --set form.pretension_N=12 --seed 7 -o twelve.h5"},
    [HF_COMMAND_CHECK] = {"The form-finding is tried, the optimisation is not, and nothing is written. All errors of "
                          "the case are told in one go, with "
                          "file, line and column.",
                          "hifdm check case.yaml --threads 64"},
    [HF_COMMAND_EVALUATE] = {"For an optimiser of your own: a row of the table is a design, one pretension in N for "
                             "each boundary cable with a free end; a row of the answer is its psi, residual and "
                             "tension ratios, to the same bits as in hifdm run. All cores work.",
                             "hifdm evaluate case.yaml --template base.csv\n"
                             "hifdm evaluate case.yaml --designs designs.csv -o results.csv"},
    [HF_COMMAND_SWEEP] =
        {"A study is a base case and axes over its keys. Points that are done are not run again, so the "
         "same command goes on after whatever stopped it. In a Slurm array every task takes its share.",
         "hifdm sweep study.yaml\n"
         "hifdm sweep study.yaml --task 0 --tasks 8\n"
         "hifdm sweep study.yaml --retry failed"},
    [HF_COMMAND_STATUS] = {"At any time, from any machine that sees the folder of the results.",
                           "hifdm status study.yaml"},
    [HF_COMMAND_MERGE] = {"At any time; points that are not there yet have the status not_evaluated.",
                          "hifdm merge study.yaml -o study.h5\n"
                          "hifdm report study.h5"},
    [HF_COMMAND_SHOW] = {"The same lines that hifdm run printed when it was done, warnings last.",
                         "hifdm show chen2022.h5\n"
                         "hifdm show chen2022.h5 --json"},
    [HF_COMMAND_RECOVER] = {"For a result whose run was killed: as far as it came, without running on.",
                            "hifdm recover night.h5"},
    [HF_COMMAND_DIFF] = {"Two runs of the same case and seed are equal to the bit, at any number of threads, with or "
                         "without interruptions. Exit status 1 and the first differences when the files differ.",
                         "hifdm diff monday.h5 tuesday.h5\n"
                         "hifdm diff mine.h5 yours.h5 --rtol 1e-9"},
    [HF_COMMAND_REPORT] = {"The page is one file for any browser; it needs no network.",
                           "hifdm report chen2022.h5 -o chen2022.html"},
    [HF_COMMAND_EXPORT] = {"Numbers have 17 significant digits: read back they are the stored ones, bit by bit.",
                           "hifdm export chen2022.h5 --csv best\n"
                           "hifdm export chen2022.h5 --csv found --stage form\n"
                           "hifdm export chen2022.h5 --vtk shapes --cutlist cut.csv"},
    [HF_COMMAND_SCHEMA] = {"The answer is itself a case file, with comments: every key at its default.",
                           "hifdm schema | less"},
    [HF_COMMAND_HELP] = {"hifdm COMMAND --help is the same as hifdm help COMMAND.", "hifdm help run\n"
                                                                                    "hifdm help --man | man -l -\n"
                                                                                    "eval \"$(hifdm help --bash)\""},
    [HF_COMMAND_VERSION] = {NULL, NULL},
};
enum { N_TEXT = sizeof text_of / sizeof *text_of };

static const struct {
    const char *code, *meaning;
} exit_table[] = {
    {"0", "done"},
    {"1", "files differ"},
    {"2", "bad usage or case"},
    {"3", "not converged, no feasible design, or points of a sweep failed"},
    {"4", "ill-posed"},
    {"5", "input/output"},
    {"75", "told to stop"},
};
enum { N_EXIT = sizeof exit_table / sizeof *exit_table };

static const char *about(const hf_command_row *command)
{
    return (int)command->command < N_TEXT ? text_of[command->command].about : NULL;
}

static const char *examples(const hf_command_row *command)
{
    return (int)command->command < N_TEXT ? text_of[command->command].examples : NULL;
}

static const char *space_before(const char *word)
{
    return word ? " " : "";
}

static const char *or_nothing(const char *word)
{
    return word ? word : "";
}

/* ---- plain text ---- */

#define WIDTH 100

/* Words of `text` from `column` on, in lines up to WIDTH that begin at `indent`. */
static void wrap(const char *text, int indent, int column, FILE *f)
{
    for (const char *p = text; *p;) {
        int n = (int)strcspn(p, " ");
        if (column > indent && column + 1 + n > WIDTH) {
            fputc('\n', f);
            column = 0;
        }
        int blanks = column < indent ? indent - column : column > 0;
        fprintf(f, "%*s%.*s", blanks, "", n, p);
        column += blanks + n;
        p += n + (p[n] == ' ');
    }
    fputc('\n', f);
}

static void print_row(const char *name, int indent, int help_column, const char *help, FILE *f)
{
    int column = fprintf(f, "%*s%s", indent, "", name);
    if (column >= help_column) {
        fputc('\n', f);
        column = 0;
    }
    wrap(help, help_column, column, f);
}

static void print_overview(FILE *f)
{
    fputs("hifdm - " SUMMARY "\n\n", f);
    for (int i = 0; i < hf_n_command; i++) {
        const hf_command_row *c = &hf_command_table[i];
        char name[64];
        snprintf(name, sizeof name, "hifdm %-8s %s", c->name, or_nothing(c->argument));
        print_row(name, 2, 27, c->help, f);
    }
    fputs("\n'hifdm help COMMAND' tells its options, and examples.\n\nexit status:\n", f);
    for (int i = 0; i < N_EXIT; i++)
        print_row(exit_table[i].code, 2, 6, exit_table[i].meaning, f);
}

static void print_command(const hf_command_row *c, FILE *f)
{
    fprintf(f, "hifdm %s%s%s [OPTION]...\n\n", c->name, space_before(c->argument), or_nothing(c->argument));
    wrap(c->help, 2, 0, f);
    if (about(c)) {
        fputc('\n', f);
        wrap(about(c), 2, 0, f);
    }
    fputs("\nOptions, anywhere behind the command:\n", f);
    for (int i = 0; i < hf_n_option; i++) {
        const hf_option_row *o = &hf_option_table[i];
        char name[96];
        if (!hf_option_goes_with(o, c)) continue;
        snprintf(name, sizeof name, "%s%s%s%s%s", or_nothing(o->letter), o->letter ? ", " : "", o->name,
                 space_before(o->argument), or_nothing(o->argument));
        print_row(name, 2, 26, o->help, f);
    }
    if (!examples(c)) return;
    fputs("\nExamples:\n", f);
    for (const char *p = examples(c); *p;) {
        int n = (int)strcspn(p, "\n");
        fprintf(f, "  %.*s\n", n, p);
        p += n + (p[n] == '\n');
    }
}

/* ---- manual page ---- */

/* Text as troff takes it: no request at the start of a line, a '-' that can be copied, lists that may be broken. */
static void put_roff(const char *text, FILE *f)
{
    int at_start = 1;
    for (const char *p = text; *p; p++) {
        if (at_start && (*p == '.' || *p == '\'')) fputs("\\&", f);
        at_start = *p == '\n';
        switch (*p) {
        case '\\':
            fputs("\\e", f);
            break;
        case '-':
            fputs("\\-", f);
            break;
        case ',':
            fputs(p[1] == ' ' ? "," : ",\\:", f);
            break;
        case '\'':
            fputs("\\(aq", f);
            break;
        case '^':
            fputs("\\(ha", f);
            break;
        case '~':
            fputs("\\(ti", f);
            break;
        case '`':
            fputs("\\(ga", f);
            break;
        default:
            fputc(*p, f);
        }
    }
}

/* "before", bold, "between", italic: a line of a page. */
static void put_line(const char *before, const char *bold, const char *between, const char *italic, FILE *f)
{
    put_roff(before, f);
    fputs("\\fB", f);
    put_roff(bold, f);
    fputs("\\fR", f);
    put_roff(between, f);
    fputs("\\fI", f);
    put_roff(or_nothing(italic), f);
    fputs("\\fR\n", f);
}

static void put_paragraph(const char *request, const char *text, FILE *f)
{
    fputs(request, f);
    put_roff(text, f);
    fputc('\n', f);
}

static void man_command(const hf_command_row *c, FILE *f)
{
    fprintf(f, ".SS hifdm %s%s%s\n", c->name, space_before(c->argument), or_nothing(c->argument));
    put_paragraph("", c->help, f);
    if (about(c)) put_paragraph(".PP\n", about(c), f);
    for (int i = 0; i < hf_n_option; i++) {
        const hf_option_row *o = &hf_option_table[i];
        if (!hf_option_goes_with(o, c) || o->commands == ~0u) continue;
        fputs(".TP\n", f);
        if (o->letter) {
            fputs("\\fB", f);
            put_roff(o->letter, f);
            fputs("\\fR, ", f);
        }
        put_line("", o->name, space_before(o->argument), o->argument, f);
        put_paragraph("", o->help, f);
    }
    if (!examples(c)) return;
    put_paragraph(".PP\n.nf\n.RS\n", examples(c), f);
    fputs(".RE\n.fi\n", f);
}

static void man_field(const hf_field *field, FILE *f)
{
    const char *value = field->default_value;
    fputs(".TP\n", f);
    put_line("", field->path, *field->unit ? ", " : "", field->unit, f);
    put_roff(field->help, f);
    fputs(".\n", f);
    for (int i = 0; field->words && field->words[i]; i++)
        put_line(i ? "| " : "", field->words[i], field->words[i + 1] ? "" : ".", NULL, f);
    if (!value)
        fputs("Required in its section.\n", f);
    else if (*value)
        put_line("Default: ", value, ".", NULL, f);
}

static void print_man(FILE *f)
{
    fprintf(f,
            ".\\\" Made by `hifdm help --man` from its tables of commands, options and keys.\n"
            ".TH HIFDM 1 \"\" \"hifdm %s\" \"User Commands\"\n.nh\n.ad l\n.SH NAME\nhifdm \\- " SUMMARY
            "\n.SH SYNOPSIS\n.nf\n",
            hf_store_version());
    for (int i = 0; i < hf_n_command; i++) {
        const hf_command_row *c = &hf_command_table[i];
        fprintf(f, "\\fBhifdm %s\\fR%s\\fI%s\\fR [\\fIoption\\fR]...\n", c->name, space_before(c->argument),
                or_nothing(c->argument));
    }
    fputs(".fi\n.SH DESCRIPTION\n", f);
    put_roff("hifdm reads a case file, finds the shape of the net by the hybrid iterative force density method, "
             "optimises the boundary tensions with a seeded genetic algorithm, and stores every generation in HDF5. "
             "Options may stand anywhere behind the command; long ones may be joined to their value by an equals "
             "sign. --help behind a command tells about it.\n",
             f);
    fputs(".SH COMMANDS\n", f);
    for (int i = 0; i < hf_n_command; i++)
        man_command(&hf_command_table[i], f);
    fputs(".SH CASE FILE\nYAML. Lengths are in metres, forces in newtons; the unit is the last part of a name.\n", f);
    for (int i = 0; i < hf_n_field; i++)
        man_field(&hf_field_table[i], f);
    fputs(".SH EXIT STATUS\n", f);
    for (int i = 0; i < N_EXIT; i++)
        fprintf(f, ".TP\n\\fB%s\\fR\n%s\n", exit_table[i].code, exit_table[i].meaning);
    fputs(".SH ENVIRONMENT\n.TP\n\\fBOMP_WAIT_POLICY\\fR\n", f);
    put_roff("passive, with GOMP_SPINCOUNT=2000, unless one of them is set: threads that spin for long while they wait "
             "for one that is not running lose more than they gain.\n",
             f);
    fputs(".TP\n\\fBOPENBLAS_NUM_THREADS\\fR\n", f);
    put_roff("1 unless it is set: nothing here uses the threads of the linear algebra.\n", f);
    fputs(".SH SEE ALSO\n", f);
    put_roff("Chen, Dong, Song, Chen, Li, Form-Finding Analysis of Mesh Reflector of Large Parabolic Cylindrical "
             "Antenna, Aerospace 2022, 9, 239: the equations that are cited by number.\n",
             f);
}

/* ---- completion for bash ---- */

static const char bash_head[] = "# Completion of hifdm for bash, made by `hifdm help --bash` from its tables.\n"
                                "\n"
                                "# Files that end in one of the arguments, and folders; without arguments all files.\n"
                                "_hifdm_files()\n"
                                "{\n"
                                "    local end\n"
                                "    compopt -o filenames 2>/dev/null\n"
                                "    [ $# -gt 0 ] || mapfile -t COMPREPLY < <(compgen -f -- \"$cur\")\n"
                                "    [ $# -eq 0 ] || mapfile -t COMPREPLY < <(\n"
                                "        for end; do compgen -f -X \"!*.$end\" -- \"$cur\"; done\n"
                                "        compgen -d -- \"$cur\")\n"
                                "}\n"
                                "\n"
                                "_hifdm()\n"
                                "{\n"
                                "    local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD-1]}\n"
                                "    local command=${COMP_WORDS[1]} words='' after_equals=''\n"
                                "    COMPREPLY=()\n"
                                "    if [ \"$COMP_CWORD\" = 1 ]; then\n"
                                "        mapfile -t COMPREPLY < <(compgen -W '";

/* Bash takes --name=value and KEY=VALUE apart at the '='. */
static const char bash_equals[] = "' -- \"$cur\")\n"
                                  "        return\n"
                                  "    fi\n"
                                  "    if [ \"$cur\" = = ]; then\n"
                                  "        cur= after_equals=yes\n"
                                  "    elif [ \"$prev\" = = ] && [ \"$COMP_CWORD\" -gt 2 ]; then\n"
                                  "        prev=${COMP_WORDS[COMP_CWORD-2]} after_equals=yes\n"
                                  "    fi\n"
                                  "    case $command:$prev in\n";

static const char bash_options[] = "    esac\n"
                                   "    if [ -n \"$words$after_equals\" ]; then\n"
                                   "        mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$cur\")\n"
                                   "        return\n"
                                   "    fi\n"
                                   "    case $command:$cur in\n";

static const char bash_tail[] = "    esac\n"
                                "    [ -z \"$words\" ] || mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$cur\")\n"
                                "}\n"
                                "\n"
                                "complete -F _hifdm hifdm\n";

static void bash_commands(FILE *f)
{
    for (int i = 0; i < hf_n_command; i++)
        fprintf(f, "%s%s", i ? " " : "", hf_command_table[i].name);
}

/* What may stand behind an option; a number is nobody's to guess. */
static void bash_value(const char *argument, FILE *f)
{
    if (!strcmp(argument, "FILE")) {
        fputs("_hifdm_files; return", f);
    } else if (!strcmp(argument, "DIR")) {
        fputs("compopt -o filenames 2>/dev/null; mapfile -t COMPREPLY < <(compgen -d -- \"$cur\"); return", f);
    } else if (!strcmp(argument, "KEY=VALUE")) {
        fputs("compopt -o nospace 2>/dev/null; words='", f);
        for (int i = 0; i < hf_n_field; i++)
            fprintf(f, "%s%s=", i ? " " : "", hf_field_table[i].path);
        fputs("'", f);
    } else if (strchr(argument, '|')) {
        fputs("words='", f);
        for (const char *p = argument; *p; p++)
            fputc(*p == '|' ? ' ' : *p, f);
        fputs("'", f);
    } else {
        fputs("return", f);
    }
    fputs(" ;;\n", f);
}

static void bash_values(FILE *f)
{
    for (int i = 0; i < hf_n_option; i++) {
        const hf_option_row *o = &hf_option_table[i];
        int n = 0;
        if (!o->argument) continue;
        fputs("    ", f);
        for (int k = 0; k < hf_n_command; k++) {
            const hf_command_row *c = &hf_command_table[k];
            if (!hf_option_goes_with(o, c)) continue;
            fprintf(f, "%s%s:%s", n++ ? " | " : "", c->name, o->name);
            if (o->letter) fprintf(f, " | %s:%s", c->name, o->letter);
        }
        fputs(") ", f);
        bash_value(o->argument, f);
    }
    for (int i = 0; i < hf_n_field; i++) {
        const hf_field *field = &hf_field_table[i];
        if (!field->words) continue;
        fprintf(f, "    *:%s) words='", field->path);
        for (int k = 0; field->words[k]; k++)
            fprintf(f, "%s%s", k ? " " : "", field->words[k]);
        fputs("' ;;\n", f);
    }
}

static void print_bash(FILE *f)
{
    fputs(bash_head, f);
    bash_commands(f);
    fputs(bash_equals, f);
    bash_values(f);
    fputs(bash_options, f);
    for (int i = 0; i < hf_n_command; i++) {
        const hf_command_row *c = &hf_command_table[i];
        fprintf(f, "    %s:-*) words='", c->name);
        for (int k = 0, n = 0; k < hf_n_option; k++)
            if (hf_option_goes_with(&hf_option_table[k], c))
                fprintf(f, "%s%s", n++ ? " " : "", hf_option_table[k].name);
        fputs("' ;;\n", f);
        if (!c->argument) continue;
        fprintf(f, "    %s:*) ", c->name);
        if (!strcmp(c->argument, "[COMMAND]")) {
            fputs("words='", f);
            bash_commands(f);
            fputs("' ;;\n", f);
        } else {
            int is_yaml = !strcmp(c->argument, "CASE") || !strcmp(c->argument, "STUDY");
            fprintf(f, "_hifdm_files %s ;;\n", is_yaml ? "yaml yml" : "h5");
        }
    }
    fputs(bash_tail, f);
}

void hf_help(const hf_options *options, FILE *file)
{
    if (options->help_as == HF_HELP_MAN)
        print_man(file);
    else if (options->help_as == HF_HELP_BASH)
        print_bash(file);
    else if (options->topic)
        print_command(options->topic, file);
    else
        print_overview(file);
}

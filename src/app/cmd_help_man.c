/* `hifdm help --man` prints the manual page, in the macros of man(7). */
#include "app/cmd_help.h"

#include <hifdm/config.h>
#include <hifdm/store.h>

#include <string.h>

/* The table stands in this file, because the other forms of the help call this file. */
const struct hf_help_exit hf_help_exit_table[HF_HELP_N_EXIT] = {
    {"0", "done"},
    {"1", "files differ"},
    {"2", "bad usage or case"},
    {"3", "not converged, no feasible design, or points of a sweep failed"},
    {"4", "ill-posed"},
    {"5", "input/output"},
    {"6", "the result fails a requirement (option --strict)"},
    {"75", "told to stop"},
};

/* Writes text escaped for troff. No line begins with a request, and '-' remains a plain hyphen that can be copied.
 * Lists of words may be broken between lines. */
static void put_roff(const char *text, FILE *f)
{
    static const char special[] = "\\-'^~`";
    static const char *const escape[] = {"\\e", "\\-", "\\(aq", "\\(ha", "\\(ti", "\\(ga"};
    bool at_start = true;
    for (const char *p = text; *p; p++) {
        const char *at = strchr(special, *p);
        if (at_start && (*p == '.' || *p == '\'')) fputs("\\&", f);
        at_start = *p == '\n';
        if (at)
            fputs(escape[at - special], f);
        else
            fputc(*p, f);
        if (*p == ',' && p[1] != ' ') fputs("\\:", f);
    }
}

/* Writes one line of the page: `before`, a word in bold, `between`, a word in italics. */
static void put_line(const char *before, const char *bold, const char *between, const char *italic, FILE *f)
{
    put_roff(before, f);
    fputs("\\fB", f);
    put_roff(bold, f);
    fputs("\\fR", f);
    put_roff(between, f);
    fputs("\\fI", f);
    put_roff(hf_help_or_nothing(italic), f);
    fputs("\\fR\n", f);
}

static void put_paragraph(const char *request, const char *text, FILE *f)
{
    fputs(request, f);
    put_roff(text, f);
    fputc('\n', f);
}

static void man_command(const hf_command *c, FILE *f)
{
    fprintf(f, ".SS hifdm %s%s%s\n", c->name, hf_help_space_before(c->argument), hf_help_or_nothing(c->argument));
    put_paragraph("", c->help, f);
    if (c->about) put_paragraph(".PP\n", c->about, f);
    for (int i = 0; i < hf_n_option; i++) {
        const hf_option o = hf_option_at(i);
        if (!hf_option_goes_with(&o, c) || !o.commands) continue;
        fputs(".TP\n", f);
        if (o.letter) fprintf(f, "\\fB\\%s\\fR, ", o.letter); /* "-o" with its hyphen escaped */
        put_line("", o.name, hf_help_space_before(o.argument), o.argument, f);
        put_paragraph("", o.help, f);
    }
    if (!c->examples) return;
    put_paragraph(".PP\n.nf\n.RS\n", c->examples, f);
    fputs(".RE\n.fi\n", f);
}

static void man_field(const hf_field *field, const char *path, const char *help, FILE *f)
{
    const char *value = field->default_value;
    fputs(".TP\n", f);
    put_line("", path, *field->unit ? ", " : "", field->unit, f);
    put_roff(help, f);
    fputc('\n', f);
    for (int i = 0; field->words && field->words[i]; i++)
        put_line(i ? "| " : "", field->words[i], field->words[i + 1] ? "" : ".", NULL, f);
    if (!value)
        fputs(path == field->path ? "Required in its section.\n" : "Required in its row.\n", f);
    else if (*value)
        put_line("Default: ", value, ".", NULL, f);
}

static void man_list(const hf_list *list, FILE *f)
{
    char path[128];
    fputs(".TP\n", f);
    put_line("", list->path, ", rows", NULL, f);
    put_roff(hf_config_help(list->path, NULL), f);
    fprintf(f, "\nN, below, is the number of a row, from 0 to %d.\n", list->max_row - 1);
    for (int i = 0; i < list->n_field; i++) {
        snprintf(path, sizeof path, "%s.N.%s", list->path, list->field[i].path);
        man_field(&list->field[i], path, hf_config_help(list->path, list->field[i].path), f);
    }
}

void hf_help_man(const hf_command *const *commands, FILE *f)
{
    fprintf(f,
            ".\\\" Made by `hifdm help --man` from its tables of commands, options and keys.\n"
            ".TH HIFDM 1 \"\" \"hifdm %s\" \"User Commands\"\n.nh\n.ad l\n.SH NAME\nhifdm \\- " HF_HELP_SUMMARY
            "\n.SH SYNOPSIS\n.nf\n",
            hf_store_version());
    for (int i = 0; i < HF_N_COMMAND; i++) {
        const hf_command *c = commands[i];
        fprintf(f, "\\fBhifdm %s\\fR%s\\fI%s\\fR [\\fIoption\\fR]...\n", c->name, hf_help_space_before(c->argument),
                hf_help_or_nothing(c->argument));
    }
    fputs(".fi\n.SH DESCRIPTION\n", f);
    put_roff("hifdm reads a case file, finds the shape of the net by the hybrid iterative force density method, "
             "optimises the boundary tensions with a seeded genetic algorithm, and stores every generation in HDF5. "
             "Options may stand anywhere behind the command; long ones may be joined to their value by an equals "
             "sign. After -- all words are files. --help behind a command prints its options.\n",
             f);
    fputs(".SH COMMANDS\n", f);
    for (int i = 0; i < HF_N_COMMAND; i++)
        man_command(commands[i], f);
    fputs(".SH CASE FILE\nYAML. Lengths are in metres, forces in newtons; the unit is the last part of a name.\n", f);
    for (int i = 0; i < hf_n_field; i++)
        man_field(&hf_field_table[i], hf_field_table[i].path, hf_config_help(hf_field_table[i].path, NULL), f);
    for (int i = 0; i < hf_n_list; i++)
        man_list(&hf_list_table[i], f);
    fputs(".SH EXIT STATUS\n", f);
    for (int i = 0; i < HF_HELP_N_EXIT; i++)
        fprintf(f, ".TP\n\\fB%s\\fR\n%s\n", hf_help_exit_table[i].code, hf_help_exit_table[i].meaning);
    fputs(".SH ENVIRONMENT\n.TP\n\\fBOMP_WAIT_POLICY\\fR\n", f);
    put_roff("passive, with GOMP_SPINCOUNT=2000, unless one of them is set: threads that spin for long while they wait "
             "for one that is not running lose more than they gain.\n",
             f);
    put_paragraph(".SH SEE ALSO\n",
                  "Chen, Dong, Song, Chen, Li, Form-Finding Analysis of Mesh Reflector of Large Parabolic Cylindrical "
                  "Antenna, Aerospace 2022, 9, 239: the equations that are cited by number.",
                  f);
    put_paragraph(
        ".PP\n",
        "In the source: src/manual (a page for each question), src/METHOD.md "
        "(the mathematics), src/ARCHITECTURE.md. make help lists the targets there: make api for pages of the "
        "library's interface, make literal for the paper's evaluation of an individual beside the default.",
        f);
}

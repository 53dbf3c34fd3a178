/* `hifdm help` prints the overview, or the help of one command. With --man or --bash it calls the other forms. */
#include "app/cmd_help.h"

#include <string.h>

#define WIDTH 100 /* width of the help in columns; a longer word has a line of its own */

void hf_help_wrap(const char *text, int indent, int column, FILE *f)
{
    for (const char *p = text; *p;) {
        int n = (int)strcspn(p, " \n");
        if (column > indent && column + 1 + n > WIDTH) {
            fputc('\n', f);
            column = 0;
        }
        int blanks = column < indent ? indent - column : column > 0;
        fprintf(f, "%*s%.*s", blanks, "", n, p);
        column += blanks + n;
        p += n;
        if (*p == '\n') {
            fputc('\n', f);
            column = 0;
        }
        p += *p != '\0';
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
    hf_help_wrap(help, help_column, column, f);
}

static void print_overview(const hf_command *const *commands, FILE *f)
{
    fputs("hifdm - " HF_HELP_SUMMARY "\n\n", f);
    for (int i = 0; i < HF_N_COMMAND; i++) {
        const hf_command *c = commands[i];
        char name[64];
        snprintf(name, sizeof name, "hifdm %-8s %s", c->name, hf_help_or_nothing(c->argument));
        print_row(name, 2, 27, c->help, f);
    }
    fputs("\n'hifdm help COMMAND' prints the options of a command, and examples.\n\nexit status:\n", f);
    for (int i = 0; i < HF_HELP_N_EXIT; i++)
        print_row(hf_help_exit_table[i].code, 2, 6, hf_help_exit_table[i].meaning, f);
}

static void print_command(const hf_command *c, FILE *f)
{
    fprintf(f, "hifdm %s%s%s [OPTION]...\n\n", c->name, hf_help_space_before(c->argument),
            hf_help_or_nothing(c->argument));
    hf_help_wrap(c->help, 2, 0, f);
    if (c->about) {
        fputc('\n', f);
        hf_help_wrap(c->about, 2, 0, f);
    }
    fputs("\nOptions, anywhere behind the command; after -- all words are files:\n", f);
    for (int i = 0; i < hf_n_option; i++) {
        const hf_option o = hf_option_at(i);
        char name[96];
        if (!hf_option_goes_with(&o, c)) continue;
        snprintf(name, sizeof name, "%s%s%s%s%s", hf_help_or_nothing(o.letter), o.letter ? ", " : "", o.name,
                 hf_help_space_before(o.argument), hf_help_or_nothing(o.argument));
        print_row(name, 2, 26, o.help, f);
    }
    if (!c->examples) return;
    fputs("\nExamples:\n", f);
    for (const char *p = c->examples; *p;) {
        int n = (int)strcspn(p, "\n");
        fprintf(f, "  %.*s\n", n, p);
        p += n + (p[n] == '\n');
    }
}

static hf_status command_help(const hf_options *o, FILE *file, hf_messages *messages)
{
    (void)messages;
    if (o->help_as == HF_HELP_MAN)
        hf_help_man(o->commands, file);
    else if (o->help_as == HF_HELP_BASH)
        hf_help_bash(o->commands, file);
    else if (o->topic)
        print_command(o->topic, file);
    else
        print_overview(o->commands, file);
    return HF_OK;
}

const hf_command hf_cmd_help = {
    .name = "help",
    .argument = "[COMMAND]",
    .help = "describe a command, its options and examples of its use",
    .about = "The commands `hifdm COMMAND --help` and `hifdm help COMMAND` print the same text.",
    .examples = "hifdm help run\n"
                "hifdm help --man | man -l -\n"
                "eval \"$(hifdm help --bash)\"",
    .run = command_help,
};

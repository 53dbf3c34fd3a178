/* `hifdm help --bash` prints the completion script for bash. */
#include "app/cmd_help.h"

#include "out/words.h"
#include <hifdm/config.h>

#include <string.h>

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

/* Bash splits --name=value and KEY=VALUE into words at the '='. The script must join them again. */
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

static void bash_commands(const hf_command *const *commands, FILE *f)
{
    for (int i = 0; i < HF_N_COMMAND; i++)
        fprintf(f, "%s%s", i ? " " : "", commands[i]->name);
}

/* Prints what may follow an option: files, folders or words. Nothing is proposed for a number. */
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
        for (int i = 0; i < hf_n_list; i++) {
            const hf_list *list = &hf_list_table[i];
            fprintf(f, " %s=", list->path);
            for (int k = 0; k < list->n_field; k++)
                fprintf(f, " %s.0.%s=", list->path, list->field[k].path);
        }
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

/* Prints the possible values of a key that is a word. `between` stands for the number of a row. */
static void bash_words(const char *list, const char *between, const hf_field *field, FILE *f)
{
    if (!field->words) return;
    fprintf(f, "    *:%s%s%s) words='", list, between, field->path);
    for (int k = 0; field->words[k]; k++)
        fprintf(f, "%s%s", k ? " " : "", field->words[k]);
    fputs("' ;;\n", f);
}

/* Prints the values of all options and keys. */
static void bash_values(const hf_command *const *commands, FILE *f)
{
    for (int i = 0; i < hf_n_option; i++) {
        const hf_option o = hf_option_at(i);
        int n = 0;
        if (!o.argument) continue;
        fputs("    ", f);
        for (int k = 0; k < HF_N_COMMAND; k++) {
            const hf_command *c = commands[k];
            if (!hf_option_goes_with(&o, c)) continue;
            fprintf(f, "%s%s:%s", n++ ? " | " : "", c->name, o.name);
            if (o.letter) fprintf(f, " | %s:%s", c->name, o.letter);
        }
        fputs(") ", f);
        bash_value(o.argument, f);
    }
    for (int i = 0; i < hf_n_field; i++)
        bash_words("", "", &hf_field_table[i], f);
    for (int i = 0; i < hf_n_list; i++)
        for (int k = 0; k < hf_list_table[i].n_field; k++)
            bash_words(hf_list_table[i].path, ".*.", &hf_list_table[i].field[k], f);
}

/* Prints each word of `hifdm explain` once. Terms of several words are left out, because bash would split them. */
static void bash_explained(FILE *f)
{
    fputs("words='", f);
    for (int i = 0; i < hf_word_count(); i++) {
        const char *word = hf_word_at(i).word;
        int first = 0;
        while (strcmp(hf_word_at(first).word, word) != 0)
            first++;
        if (first == i && !strchr(word, ' ')) fprintf(f, "%s%s", i ? " " : "", word);
    }
    fputs("' ;;\n", f);
}

void hf_help_bash(const hf_command *const *commands, FILE *f)
{
    fputs(bash_head, f);
    bash_commands(commands, f);
    fputs(bash_equals, f);
    bash_values(commands, f);
    fputs(bash_options, f);
    for (int i = 0; i < HF_N_COMMAND; i++) {
        const hf_command *c = commands[i];
        fprintf(f, "    %s:-*) words='", c->name);
        for (int k = 0, n = 0; k < hf_n_option; k++) {
            const hf_option o = hf_option_at(k);
            if (hf_option_goes_with(&o, c)) fprintf(f, "%s%s", n++ ? " " : "", o.name);
        }
        fputs("' ;;\n", f);
        if (!c->argument) continue;
        fprintf(f, "    %s:*) ", c->name);
        if (!strcmp(c->argument, "[COMMAND]")) {
            fputs("words='", f);
            bash_commands(commands, f);
            fputs("' ;;\n", f);
        } else if (!strcmp(c->argument, "[WORD...]")) {
            bash_explained(f);
        } else if (!strcmp(c->argument, "NAME")) {
            fputs("return ;;\n", f);
        } else {
            bool is_yaml = !strcmp(c->argument, "CASE") || !strcmp(c->argument, "STUDY");
            fprintf(f, "_hifdm_files %s ;;\n", is_yaml ? "yaml yml" : "h5");
        }
    }
    fputs(bash_tail, f);
}

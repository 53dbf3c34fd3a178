/* `hifdm schema` prints the reference of the case file: a YAML file with every key and comments. */
#include "app/cmd.h"

#include <hifdm/config.h>

#include <string.h>

static void print_range(const hf_field *field, FILE *f)
{
    static const char *const type[] = {"number",
                                       "whole number",
                                       "whole number",
                                       "two whole numbers",
                                       "",
                                       "text",
                                       "text or list of texts",
                                       "list of numbers",
                                       "number",
                                       "[low, high], of which one may be null",
                                       "[x, y, z]"};
    if (field->type == HF_FIELD_WORD) {
        for (int k = 0; field->words[k]; k++)
            fprintf(f, "%s%s", k ? " | " : "", field->words[k]);
        return;
    }
    fprintf(f, "%s", type[field->type]);
    if (field->type == HF_FIELD_TEXT || field->type == HF_FIELD_SET || field->min <= -1e300) return;
    if (field->min == HF_ABOVE_ZERO)
        fprintf(f, " > 0");
    else
        fprintf(f, " >= %.10g", field->min);
    if (field->max < 1e300) fprintf(f, ", <= %.10g", field->max);
    if (field->type == HF_FIELD_AMOUNT) fprintf(f, ", or a part like 30 %%");
}

static int depth_of(const char *path)
{
    int depth = 0;
    for (; *path; path++)
        depth += *path == '.';
    return depth;
}

static const char *last_word(const char *path)
{
    const char *dot = strrchr(path, '.');
    return dot ? dot + 1 : path;
}

static bool is_inside(const char *path, const char *section)
{
    size_t n = strlen(section);
    return !strncmp(path, section, n) && path[n] == '.' && !strchr(path + n + 1, '.');
}

static void print_field(const hf_field *field, FILE *f)
{
    int indent = 2 * depth_of(field->path);
    fprintf(f, "%*s# %s\n%*s# ", indent, "", hf_config_help(field->path, NULL), indent, "");
    print_range(field, f);
    if (*field->unit) fprintf(f, "; %s", field->unit);
    if (!field->default_value)
        fprintf(f, "; required\n%*s%s:\n", indent, "", last_word(field->path));
    else if (!*field->default_value && field->type != HF_FIELD_TEXT)
        fprintf(f, "; may be left out\n%*s# %s:\n", indent, "", last_word(field->path));
    else
        fprintf(f, "\n%*s%s: %s\n", indent, "", last_word(field->path),
                *field->default_value ? field->default_value : "\"\"");
}

/* Prints a list. It has no rows by default, so the keys of a row are printed in comments. */
static void print_list(const hf_list *list, FILE *f)
{
    int indent = 2 * depth_of(list->path);
    fprintf(f, "%*s# %s\n%*s# up to %d rows {key: value, ...} of these keys:\n", indent, "",
            hf_config_help(list->path, NULL), indent, "", list->max_row);
    for (const hf_field *field = list->field; field < list->field + list->n_field; field++) {
        fprintf(f, "%*s#   %s: ", indent, "", field->path);
        print_range(field, f);
        if (*field->unit) fprintf(f, "; %s", field->unit);
        if (!field->default_value)
            fprintf(f, "; required");
        else if (!*field->default_value)
            fprintf(f, "; may be left out");
        else
            fprintf(f, "; default %s", field->default_value);
        fprintf(f, ".\n%*s#     %s\n", indent, "", hf_config_help(list->path, field->path));
    }
    fprintf(f, "%*s%s: []\n", indent, "", last_word(list->path));
}

static hf_status command_schema(const hf_options *o, FILE *f, hf_messages *messages)
{
    (void)o;
    (void)messages;
    const hf_field *field = hf_field_table;
    const hf_section *section = hf_section_table;
    fputs("# Every key of a hifdm case file, with its default. Units are the last part of a name.\n", f);
    for (int i = 0; i < hf_n_field; i++)
        if (!strchr(field[i].path, '.')) print_field(&field[i], f);
    for (int s = 0; s < hf_n_section; s++) {
        int indent = 2 * depth_of(section[s].path);
        fprintf(f, "\n%*s# %s\n%*s%s:\n", indent, "", hf_config_help(section[s].path, NULL), indent, "",
                last_word(section[s].path));
        for (int i = 0; i < hf_n_field; i++)
            if (is_inside(field[i].path, section[s].path)) print_field(&field[i], f);
        for (int i = 0; i < hf_n_list; i++)
            if (is_inside(hf_list_table[i].path, section[s].path)) print_list(&hf_list_table[i], f);
    }
    for (int i = 0; i < hf_n_list; i++) {
        if (strchr(hf_list_table[i].path, '.')) continue;
        fputc('\n', f);
        print_list(&hf_list_table[i], f);
    }
    return HF_OK;
}

const hf_command hf_cmd_schema = {
    .name = "schema",
    .help = "print all keys of the case file with their types, ranges, defaults and meanings",
    .about = "The output is a commented case file in which every key has its default value.",
    .examples = "hifdm schema | less",
    .run = command_schema,
};

/* Implements merge.h: checks that the output is no input and may be replaced, then writes the temporary file group by
 * group and publishes it. Sections: columns, inputs, outputs, lists, requirements, points, links, the file. */
#include "store/merge.h"

#include "base/file_out.h"
#include "base/path.h"
#include "base/text.h"
#include "store/store_file.h"
#include <hifdm/store.h>

#include <errno.h>
#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    hf_hdf5 io;
    const hf_study *study;
    const hf_points *points;
    hf_file_out out;
    void *room; /* one list of any kind, of texts their pointers: [n_point][HF_REQUIREMENT_ROWS_MAX] of 8 bytes */
} merger;

/* ---- columns ---- */

static void write_column(merger *m, hid_t group, const char *name, const hf_hdf5_kind *kind, int columns,
                         const char *units, const char *description)
{
    hf_hdf5_write_list(&m->io, group, name, kind, m->points->n_point, columns, units, description, m->room);
}

/* Writes a column of the texts whose pointers are in m->room. */
static void write_texts(merger *m, hid_t group, const char *name, const char *description)
{
    hf_hdf5_write_ids(&m->io, group, name, m->room, m->points->n_point, description);
}

/* Stores the number of a text as item i of m->room. "": there is none. */
static void set_number(void *room, int i, const hf_hdf5_kind *kind, const char *text)
{
    if (kind->class == HF_HDF5_REAL)
        ((double *)room)[i] = *text ? strtod(text, NULL) : (double)NAN;
    else if (kind->class == HF_HDF5_LONG)
        ((long *)room)[i] = strtol(text, NULL, 10);
    else if (kind->class == HF_HDF5_UINT64)
        ((uint64_t *)room)[i] = strtoull(text, NULL, 10);
    else if (kind->class == HF_HDF5_INT)
        ((int *)room)[i] = atoi(text);
    else
        ((signed char *)room)[i] = (signed char)(!*text && kind == HF_KIND_STATUS ? (int)HF_NOT_EVALUATED : atoi(text));
}

/* ---- inputs ---- */

/* Returns true if all values of an amount are numbers, none a percentage such as 30 %. */
static bool has_numbers(const hf_study_axis *axis)
{
    double value;
    for (int k = 0; k < axis->n_value; k++)
        if (!hf_text_double(hf_study_axis_value(axis, k), &value)) return false;
    return true;
}

static void write_axis(merger *m, hid_t group, int i_axis)
{
    const hf_study_axis *axis = &m->study->axis[i_axis];
    const int *value = m->study->value + i_axis; /* of the points, n_axis apart */
    const hf_field *f = axis->key.field;
    const hf_list *list = axis->key.list;
    const char *help = axis->is_replicate ? "number of the run of this combination of the other axes"
                       : list             ? hf_config_help(list->path, f->path)
                                          : hf_config_help(f->path, NULL);
    hf_field_type type = f->type == HF_FIELD_AMOUNT && has_numbers(axis) ? HF_FIELD_DOUBLE : f->type;
    const hf_hdf5_kind *kind = type == HF_FIELD_DOUBLE                             ? HF_KIND_REAL
                               : type == HF_FIELD_UINT64                           ? HF_KIND_UINT64
                               : type == HF_FIELD_INT || type == HF_FIELD_INT_PAIR ? HF_KIND_INT
                                                                                   : NULL;
    for (int i = 0; i < m->points->n_point; i++) {
        const char *text = hf_study_axis_value(axis, value[(ptrdiff_t)i * m->study->n_axis]);
        if (!kind)
            ((const char **)m->room)[i] = text;
        else if (type == HF_FIELD_INT_PAIR)
            sscanf(text, "[%d ,%d", (int *)m->room + 2 * i, (int *)m->room + 2 * i + 1);
        else
            set_number(m->room, i, kind, text);
    }
    if (!kind)
        write_texts(m, group, axis->key.path, help);
    else
        write_column(m, group, axis->key.path, kind, type == HF_FIELD_INT_PAIR ? 2 : 0, f->unit, help);
}

/* ---- outputs ---- */

/* Writes one number of hf_summary for all points. A number that no point has is left out. */
static void write_output(merger *m, hid_t group, int column)
{
    hf_ledger_number number;
    char name[128], stage[96];
    int n_given = 0;
    if (!hf_ledger_column(column, &number) || hf_ledger_is_circumstance(&number)) return;
    const hf_hdf5_kind *kind = hf_layout_kind_of(number.field);
    for (int i = 0; i < m->points->n_point; i++) {
        const hf_point *p = &m->points->point[i];
        const char *text = p->field ? p->field[column] : "";
        n_given += *text != '\0';
        set_number(m->room, i, kind, text);
    }
    if (!n_given) return;
    snprintf(name, sizeof name, "%s%s%s", number.object + 1, number.object[1] ? "/" : "", number.field->name);
    snprintf(stage, sizeof stage, "/points%s", number.object);
    if (number.object[1]) hf_hdf5_close(&m->io, hf_hdf5_make_group(&m->io, stage));
    write_column(m, group, name, kind, 0, hf_ledger_unit(number.field->name), "as in the runs");
}

/* ---- lists ---- */

/* Returns the value of this name in the list of a point, or NaN if there is none. */
static double value_in(const hf_point *p, int list, const char *wanted)
{
    char name[HF_OBJECTIVE_NAME_SIZE];
    double value;
    const char *text = p->field ? p->field[hf_ledger_n_column() + list] : "";
    while (hf_ledger_next_value(list, &text, name, &value))
        if (!strcmp(name, wanted)) return value;
    return (double)NAN;
}

static void write_value(merger *m, hid_t group, int list, const char *value)
{
    char name[HF_OBJECTIVE_NAME_SIZE + 8], path[HF_OBJECTIVE_NAME_SIZE + 16];
    const char *key = value, *dot = list == HF_LEDGER_LIST_CASES ? strchr(value, '.') : NULL;
    snprintf(name, sizeof name, "%s", value);
    if (dot) {
        key = dot + 1;
        name[dot - value] = '/';
        snprintf(path, sizeof path, "/points" HF_LEDGER_LOAD_CASES "/%.*s", (int)(dot - value), value);
        hf_hdf5_close(&m->io, hf_hdf5_make_group(&m->io, path));
    }
    for (int i = 0; i < m->points->n_point; i++)
        ((double *)m->room)[i] = value_in(&m->points->point[i], list, value);
    write_column(m, group, name, HF_KIND_REAL, 0, hf_ledger_unit(key),
                 dot                              ? "of the load case of the as-built net"
                 : *hf_ledger_list_of[list].begin ? "value of the objective"
                                                  : "of the surface");
}

/* Writes one column for each name that any point has in this list. Points may have different names, because sets and
 * figures of objectives and frequencies can be axes. */
static void write_list(merger *m, int list)
{
    char(*done)[HF_OBJECTIVE_NAME_SIZE] = NULL, path[32], outer[32], name[HF_OBJECTIVE_NAME_SIZE];
    int n_done = 0;
    double value;
    hid_t group = -1;
    snprintf(path, sizeof path, "/points%s", hf_ledger_list_of[list].group);
    snprintf(outer, sizeof outer, "%.*s", hf_path_prefix_length(path) - 1, path);
    for (int i = 0; i < m->points->n_point && m->io.status == HF_OK; i++) {
        const hf_point *p = &m->points->point[i];
        const char *text = p->field ? p->field[hf_ledger_n_column() + list] : "";
        while (m->io.status == HF_OK && hf_ledger_next_value(list, &text, name, &value)) {
            int k = 0;
            while (k < n_done && strcmp(done[k], name) != 0)
                k++;
            if (k < n_done) continue;
            void *more = realloc(done, ((size_t)n_done + 1) * sizeof *done);
            if (!more) {
                m->io.status = hf_error(m->io.messages, HF_NO_MEMORY, "%s: out of memory", m->io.path);
                break;
            }
            done = more;
            memcpy(done[n_done++], name, sizeof name);
            if (group < 0) {
                hf_hdf5_close(&m->io, hf_hdf5_make_group(&m->io, outer));
                group = hf_hdf5_make_group(&m->io, path);
            }
            write_value(m, group, list, name);
        }
    }
    if (group >= 0) hf_hdf5_close(&m->io, group);
    free(done);
}

/* ---- requirements ---- */

/* Returns the name of requirement k in the names of a point, and its length in *n. Returns NULL if there is none. */
static const char *name_at(const hf_point *p, int k, size_t *n)
{
    const char *name = p->field ? p->field[hf_ledger_names_field()] : "";
    if (!*name) return NULL;
    for (; k > 0 && name; k--)
        if ((name = strchr(name, ';')) != NULL) name++;
    if (name) *n = strcspn(name, ";");
    return name;
}

/* Returns whether a name may be cut off here: at its end or before one of its parts. */
static bool is_part_end(const char *name, const char *end)
{
    return name == end || *name == ',' || !strncmp(name, " of ", 4);
}

/* Writes the parts of the name of requirement k that all points have in common, because axes may change a row. Without
 * a common part the name is the key of the row. Returns false if no point has such a row. */
static bool name_row(const merger *m, int k, char name[HF_LEDGER_REQUIREMENT_SIZE])
{
    bool has_any = false;
    for (int i = 0; i < m->points->n_point; i++) {
        size_t n, same = 0, length = strlen(name);
        const char *other = name_at(&m->points->point[i], k, &n);
        if (!other) continue;
        if (!has_any) snprintf(name, HF_LEDGER_REQUIREMENT_SIZE, "%.*s", (int)n, other);
        if (!has_any) length = strlen(name);
        has_any = true;
        while (same < length && same < n && name[same] == other[same])
            same++;
        while (same > 0 && !(is_part_end(name + same, name + length) && is_part_end(other + same, other + n)))
            same--;
        name[same] = '\0';
    }
    if (has_any && !*name) snprintf(name, HF_LEDGER_REQUIREMENT_SIZE, "requirements.%d", k);
    return has_any;
}

/* Writes one number of each requirement for all points. */
static void write_of_rows(merger *m, hid_t group, const char *figure, int n_row, const hf_hdf5_kind *kind,
                          const char *description)
{
    char name[HF_OBJECTIVE_NAME_SIZE];
    for (int i = 0; i < m->points->n_point; i++)
        for (int k = 0; k < n_row; k++) {
            snprintf(name, sizeof name, "%s_%d", figure, k);
            double value = value_in(&m->points->point[i], HF_LEDGER_LIST_REQUIREMENTS, name);
            ptrdiff_t at = (ptrdiff_t)i * n_row + k;
            if (kind == HF_KIND_REAL)
                ((double *)m->room)[at] = value;
            else
                ((signed char *)m->room)[at] =
                    (signed char)(value >= 0 && value < HF_VERDICT_N ? (int)value : (int)HF_VERDICT_NONE);
        }
    write_column(m, group, figure, kind, n_row, "", description);
}

/* Writes the verdicts on the requirements. A study without requirements has no such group. */
static void write_requirements(merger *m)
{
    static const char *const figure[][2] = {
        {"n_failed", "number of requirements that fail"},
        {"n_undecided", "number of requirements that are undecided"},
        {"relative_margin_min", "smallest relative margin; NaN: no requirement has one"}};
    char(*name)[HF_LEDGER_REQUIREMENT_SIZE] = calloc(HF_REQUIREMENT_ROWS_MAX, sizeof *name);
    const char *names[HF_REQUIREMENT_ROWS_MAX];
    int n_row = 0;
    if (!name) m->io.status = hf_error(m->io.messages, HF_NO_MEMORY, "%s: out of memory", m->io.path);
    while (name && n_row < HF_REQUIREMENT_ROWS_MAX && name_row(m, n_row, name[n_row])) {
        names[n_row] = name[n_row];
        n_row++;
    }
    if (n_row > 0) {
        hid_t group = hf_hdf5_make_group(&m->io, "/points" HF_LEDGER_REQUIREMENTS);
        hf_hdf5_write_ids(&m->io, group, "name", names, n_row, "requirement of each column; parts that vary left out");
        for (int k = 0; k < HF_HDF5_COUNT(figure); k++) {
            for (int i = 0; i < m->points->n_point; i++)
                ((double *)m->room)[i] = value_in(&m->points->point[i], HF_LEDGER_LIST_REQUIREMENTS, figure[k][0]);
            write_column(m, group, figure[k][0], HF_KIND_REAL, 0, "", figure[k][1]);
        }
        write_of_rows(m, group, "verdict", n_row, &hf_layout_verdict, "verdict on each requirement");
        write_of_rows(m, group, "value", n_row, HF_KIND_REAL, "of the nominal net, or of the share");
        write_of_rows(m, group, "at_least", n_row, HF_KIND_REAL, "minimum, in the unit of the figure; NaN: none");
        write_of_rows(m, group, "at_most", n_row, HF_KIND_REAL, "maximum, in the unit of the figure; NaN: none");
        write_of_rows(m, group, "margin", n_row, HF_KIND_REAL, "signed distance from the bound, unit of the figure");
        write_of_rows(m, group, "relative_margin", n_row, HF_KIND_REAL, "margin relative to the bound; NaN: it is 0");
        hf_hdf5_close(&m->io, group);
    }
    free(name);
}

/* ---- points ---- */

static void write_points(merger *m)
{
    hid_t group = hf_hdf5_make_group(&m->io, "/points");
    for (int i = 0; i < m->points->n_point; i++)
        ((const char **)m->room)[i] = m->study->id[i];
    write_texts(m, group, "id", "names the point by what it sets; its link in /runs, and how its result file begins");
    for (int i = 0; i < m->points->n_point; i++)
        ((signed char *)m->room)[i] = (signed char)m->points->point[i].status;
    write_column(m, group, "status", HF_KIND_STATUS, 0, "", "ok, what went wrong, or not_evaluated: not finished");
    for (int i = 0; i < m->points->n_point; i++)
        ((const char **)m->room)[i] = m->points->point[i].reason;
    write_texts(m, group, "reason", "what went wrong, if anything");
    hid_t input = hf_hdf5_make_group(&m->io, "/points/input");
    for (int a = 0; a < m->study->n_axis; a++)
        write_axis(m, input, a);
    hf_hdf5_close(&m->io, input);
    for (int i = 0; i < hf_ledger_n_column(); i++)
        write_output(m, group, i);
    hf_hdf5_close(&m->io, group);
    for (int list = 0; list < HF_LEDGER_LIST_REQUIREMENTS; list++)
        write_list(m, list);
    write_requirements(m);
}

/* ---- links ---- */

/* Writes the folder into to[size], relative to the folder of the output, or as an absolute path if there is no room.
 * Returns false and errno if a folder cannot be resolved. */
static bool relative_folder(const char *output, const char *folder, char *to, size_t size)
{
    char here[PATH_MAX + 1], there[PATH_MAX + 1]; /* one byte more for a slash */
    size_t used = 0, common = 0;
    if (!hf_path_folder(output, to, size) || !realpath(to, here) || !realpath(folder, there)) {
        *to = '\0';
        return false;
    }
    strcat(strcmp(here, "/") ? here : strcpy(here, ""), "/");
    strcat(there, "/");
    for (size_t i = 0; here[i] && here[i] == there[i]; i++)
        if (here[i] == '/') common = i + 1;
    *to = '\0';
    for (const char *p = here + common; *p && used + 4 < size; p++)
        if (*p == '/') used += (size_t)snprintf(to + used, size - used, "../");
    if (used + strlen(there + common) < size)
        strcpy(to + used, there + common);
    else
        snprintf(to, size, "%s", there); /* the absolute path always has room */
    used = strlen(to);
    if (used && to[used - 1] == '/') to[used - 1] = '\0';
    return true;
}

static void write_links(merger *m, const char *folder)
{
    char target[PATH_MAX + 64], file[HF_PATH_SIZE + 32];
    hid_t group = hf_hdf5_make_group(&m->io, "/runs");
    bool is_known = relative_folder(m->io.path, folder, target, PATH_MAX + 1);
    int why = errno;
    if (!*target) strcpy(target, ".");
    size_t n = strlen(target);
    for (int i = 0; i < m->study->n_point && m->io.status == HF_OK; i++) {
        const char *id = m->study->id[i];
        hf_ledger_content content = hf_ledger_file(folder, m->study, i, file);
        if (content == HF_LEDGER_UNSEEN)
            m->io.status =
                hf_error(m->io.messages, HF_IO, "%s: cannot get the status of this file: %s", file, strerror(errno));
        else if (content == HF_LEDGER_FILE && !is_known)
            m->io.status =
                hf_error(m->io.messages, HF_IO, "%s: cannot create links to %s: %s", m->io.path, folder, strerror(why));
        if (content != HF_LEDGER_FILE || !is_known) continue;
        snprintf(target + n, sizeof target - n, "/%s", hf_path_name(file));
        if (H5Lcreate_external(target, "/", group, id, H5P_DEFAULT, H5P_DEFAULT) < 0)
            hf_hdf5_fail(&m->io, "write", group, id);
    }
    hf_hdf5_close(&m->io, group);
}

/* ---- the file ---- */

static void write_text_file(merger *m, hid_t group, const char *name, const char *path, const char *description)
{
    char *text;
    size_t length;
    hf_hdf5_array array = {name, HF_KIND_TEXT, 0, {0}, "", description};
    if (m->io.status != HF_OK) return;
    m->io.status = hf_text_read_file(path, HF_IO, &text, &length, m->io.messages);
    hf_hdf5_write_array(&m->io, group, &array, &text);
    free(text);
}

static void write_all(merger *m, const char *folder)
{
    const hf_study *s = m->study;
    hf_hdf5_put_chars(&m->io, m->io.file, "/", "program", HF_PROGRAM);
    hf_hdf5_put(&m->io, m->io.file, "/", "format_version", HF_KIND_INT, 0, &(int){HF_FORMAT_VERSION});
    hf_hdf5_put_text(&m->io, m->io.file, "/", "version", hf_store_version());
    hf_hdf5_put_text(&m->io, m->io.file, "/", "study", s->path);
    hf_hdf5_put_text(&m->io, m->io.file, "/", "base", s->base);
    hf_hdf5_put_text(&m->io, m->io.file, "/", "fingerprint", s->fingerprint);
    hid_t group = hf_hdf5_make_group(&m->io, "/study");
    write_text_file(m, group, "text", s->path, "the study file");
    write_text_file(m, group, "base_text", s->base, "the base case");
    if (*s->title) hf_hdf5_write_ids(&m->io, group, "title", (const char *const[]){s->title}, 1, "of the study");
    hf_hdf5_close(&m->io, group);
    write_points(m);
    write_links(m, folder);
    hf_renamed_link(&m->io, false);
    /* HDF5 1.10 crashes in a close that cannot write. The file is flushed first, and stays open if that fails. */
    if (H5Fflush(m->io.file, H5F_SCOPE_GLOBAL) < 0)
        hf_hdf5_fail(&m->io, "write", -1, NULL);
    else
        hf_hdf5_close_file(&m->io);
}

/* Returns true if the file is a merge, which a later merge may replace. */
static bool is_replaceable(const char *path)
{
    hf_hdf5 io = {.path = path, .status = HF_OK, .file = -1};
    hf_hdf5_lock();
    hf_hdf5_open_file(&io, path);
    bool is = io.status == HF_OK && hf_hdf5_has(&io, io.file, "/points") && hf_hdf5_has(&io, io.file, "/runs");
    hf_hdf5_close_file(&io);
    hf_hdf5_unlock(HF_OK);
    return is;
}

static void look_at_output(const char *path)
{
    hf_hdf5_limit();
    is_replaceable(path);
}

static hf_status check_output(const char *path, hf_messages *messages)
{
    char how[128];
    bool is_there;
    HF_TRY(hf_file_out_look(path, &is_there, messages));
    if (!is_there) return HF_OK;
    hf_status tried = hf_hdf5_try(look_at_output, NULL, path, how, sizeof how, messages);
    if (tried == HF_EXISTS)
        return hf_error(messages, HF_EXISTS,
                        "%s: this file exists and is damaged. The process that read the file was ended by %s. Use "
                        "--force to replace the file, or use -o to choose another name",
                        path, how);
    HF_TRY(tried);
    if (is_replaceable(path)) return HF_OK;
    return hf_error(messages, HF_EXISTS,
                    "%s: this file exists and is not a merged study. Use --force to replace the file, or use -o to "
                    "choose another name",
                    path);
}

/* Returns 1 if the file belongs to the sweep: if it is the result of a point, also by a link, or lies in the folder of
 * the sweep and is no merge. Otherwise returns 0, or -1 and errno if the system cannot tell. */
static int is_of_sweep(const hf_study *s, const char *folder, const char *path)
{
    char file[HF_PATH_SIZE + 32], here[PATH_MAX], how[128];
    struct stat info;
    int is = hf_path_look(path, &info);
    if (is <= 0) return is;
    for (int i = 0; i < s->n_point; i++) {
        hf_ledger_file(folder, s, i, file);
        if ((is = hf_path_compare(file, path)) != 0) return is;
    }
    if (!hf_path_folder(path, here, sizeof here) || (is = hf_path_compare(here, folder)) <= 0) return is;
    hf_status tried = hf_hdf5_try(look_at_output, NULL, path, how, sizeof how, NULL);
    /* A file that is damaged or cannot be read is reported later, or may be replaced. */
    return tried == HF_OK && !is_replaceable(path);
}

/* Checks that the output is no input of the merge, because inputs are never replaced. */
static hf_status spare_inputs(const hf_study *s, const char *folder, const char *path, hf_messages *messages)
{
    static const char what[] = "an input of this merge";
    HF_TRY(hf_file_out_spare(s->path, what, path, messages));
    HF_TRY(hf_file_out_spare(s->base, what, path, messages));
    for (int i = 0; i < HF_STUDY_TABLE_MAX; i++)
        HF_TRY(hf_file_out_spare(s->table[i], what, path, messages));
    int is = is_of_sweep(s, folder, path);
    if (is == 0) return HF_OK;
    if (is < 0)
        return hf_error(messages, HF_IO, "%s: cannot determine whether this file belongs to the sweep in %s: %s", path,
                        folder, strerror(errno));
    return hf_error(messages, HF_EXISTS, "%s: this file belongs to the sweep in %s. Choose another name", path, folder);
}

static hf_status merge(merger *m, const char *folder, const char *output, bool force, hf_messages *messages)
{
    m->io = (hf_hdf5){.path = m->out.path, .messages = messages, .status = HF_OK, .file = -1};
    HF_TRY(hf_file_out_target(output, m->out.path, messages));
    HF_TRY(hf_store_file_check(m->out.path, messages));
    HF_TRY(spare_inputs(m->study, folder, m->out.path, messages));
    if (!force) HF_TRY(check_output(m->out.path, messages));
    m->room = calloc((size_t)m->study->n_point, HF_REQUIREMENT_ROWS_MAX * sizeof(double));
    if (!m->room) return hf_error(messages, HF_NO_MEMORY, "%s: out of memory", output);
    hf_hdf5_lock();
    m->io.status = hf_file_out_begin(output, &m->out, messages);
    if (m->io.status == HF_OK) {
        hf_hdf5_create_file(&m->io, &m->out);
        if (m->io.status == HF_OK) write_all(m, folder);
        if (m->io.status == HF_OK)
            m->io.status = hf_file_out_publish(&m->out, messages);
        else
            hf_file_out_drop(&m->out, messages);
    }
    free(m->room);
    return hf_hdf5_unlock(m->io.status);
}

hf_status hf_merge(const hf_study *study, const char *folder, const hf_points *points, const char *output, bool force,
                   hf_messages *messages)
{
    merger *m = calloc(1, sizeof *m);
    if (!m) return hf_error(messages, HF_NO_MEMORY, "%s: out of memory", output);
    m->study = study;
    m->points = points;
    hf_status status = merge(m, folder, output, force, messages);
    free(m);
    return status;
}

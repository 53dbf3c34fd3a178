/* Finds out what is at a path: nothing, a result of this case, or something else. A child process reads the file first,
 * because some damaged files crash HDF5. Then the identity in the file is compared with that of the case. Sections:
 * identity, look, before a restart. */
#include "store/store_read.h"

#include "base/file_io.h"
#include "base/file_out.h"
#include "base/path.h"
#include "base/sha256.h"
#include "base/text.h"
#include "store/compare.h"
#include "store/journal.h"
#include "store/store_internal.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- identity ---- */

/* Replaces the identity by the digest of the identity so far and of the digest of these bytes. */
static void extend(char identity[65], const void *data, size_t bytes)
{
    char both[128], hex[65];
    hf_sha256(bytes ? data : "", bytes, hex);
    memcpy(both, identity, 64);
    memcpy(both + 64, hex, 64);
    hf_sha256(both, sizeof both, identity);
}

static void extend_columns(char identity[65], const hf_layout_column *columns, int n_node, int n_cable,
                           const void *owner)
{
    for (const hf_layout_column *c = columns; c->name; c++) {
        const void *values;
        memcpy(&values, (const char *)owner + c->offset, sizeof values);
        size_t n = (size_t)(c->per_cable ? n_cable : n_node) * (size_t)c->columns;
        extend(identity, values, values ? n * hf_hdf5_kind_bytes(c->kind) : 0);
    }
}

/* Extends the identity by n ids. They are digested with their NULs, so that "a", "bc" differs from "ab", "c". */
static hf_status extend_ids(char identity[65], int n, const char *const *id)
{
    size_t size = 1, used = 0;
    for (int i = 0; i < n; i++)
        size += strlen(id[i]) + 1;
    char *text = malloc(size);
    if (!text) return HF_NO_MEMORY;
    for (int i = 0; i < n; i++)
        used += strlen(strcpy(text + used, id[i])) + 1;
    extend(identity, text, used);
    free(text);
    return HF_OK;
}

/* Extends the identity by the tables that rows of `cases` name. These were read with the case. A table that cannot be
 * read now is left out. */
static hf_status extend_tables(char identity[65], const hf_case *c)
{
    for (int i = 0; i < c->built.n_load_case; i++) {
        char *text = NULL;
        size_t n = 0;
        if (!*c->built.load_case[i].nodes_path) continue;
        hf_status status = hf_text_read_file(c->built.load_case[i].nodes_path, HF_BAD_CASE, &text, &n, NULL);
        if (status == HF_OK) extend(identity, text, n);
        free(text);
        if (status == HF_NO_MEMORY) return status;
    }
    return HF_OK;
}

hf_status hf_store_identify(const hf_case *settings, const hf_scene *scene, const hf_truss *truss, char identity[65])
{
    char words[128];
    int n = snprintf(words, sizeof words, "%s %llu", settings->sha256, (unsigned long long)settings->optimize.seed);
    hf_sha256(words, (size_t)n, identity);
    extend_columns(identity, hf_layout_scene, scene->n_node, scene->n_cable, scene);
    HF_TRY(extend_ids(identity, scene->n_node, scene->node_id));
    HF_TRY(extend_ids(identity, scene->n_cable, scene->cable_id));
    if (scene->n_facet > 0) extend(identity, scene->facet, 4 * (size_t)scene->n_facet * sizeof *scene->facet);
    if (scene->n_set > 0 && scene->cables_file) { /* sets of a generated net follow from the case */
        extend(identity, scene->set_start, ((size_t)scene->n_set + 1) * sizeof *scene->set_start);
        extend(identity, scene->set_cable, (size_t)scene->set_start[scene->n_set] * sizeof *scene->set_cable);
        HF_TRY(extend_ids(identity, scene->n_set, scene->set_name));
    }
    HF_TRY(extend_tables(identity, settings));
    if (settings->taken.point) extend(identity, settings->taken.sha256, 64);
    if (!truss) return HF_OK;
    extend_columns(identity, hf_layout_truss, truss->n_node, truss->n_member, truss);
    extend(identity, truss->fixed, (size_t)truss->n_node);
    HF_TRY(extend_ids(identity, truss->n_node, truss->node_id));
    return extend_ids(identity, truss->n_member, truss->member_id);
}

/* ---- look ---- */

/* Writes "--point night.h5:7" into text[size], with at most 250 bytes of the path. Returns text. */
static const char *name_point(const hf_front_origin *taken, char *text, size_t size)
{
    snprintf(text, size, taken->point ? "--point %.250s:%d" : "no --point", taken->path, taken->point);
    return text;
}

/* Writes into words[size] in which keys the stored case and this one differ, or which points they took. */
static void tell_difference(hf_hdf5 *io, const hf_case *now, char *words, size_t size)
{
    hf_case *then = calloc(1, sizeof *then);
    char one[300], other[300];
    hf_front_origin taken = {0};
    if (!then) {
        hf_hdf5_no_memory(io);
        return;
    }
    hf_layout_pass_taken(io, false, &taken);
    if (!hf_store_parse_case(io, now->path, then))
        snprintf(words, size, "%s", "keys that this version does not know");
    else if (hf_config_differences(then, now, words, size) > 0)
        ;
    else if (taken.point && taken.point == now->taken.point && strcmp(taken.sha256, now->taken.sha256) != 0)
        snprintf(words, size, "it has %s, whose design is another one in the front that is there now",
                 name_point(&now->taken, one, sizeof one));
    else if (strcmp(taken.sha256, now->taken.sha256) != 0)
        snprintf(words, size, "it has %s, and this run %s", name_point(&taken, one, sizeof one),
                 name_point(&now->taken, other, sizeof other));
    else
        snprintf(words, size, "%s",
                 "no key, but comments and layout of the case, or its tables of the net or of the truss");
    hf_case_free(then);
    free(then);
}

/* Removes the earlier result beside a finished one whose run has left its journal. */
static void forget_earlier(const char *path, const char *identity)
{
    char of_journal[HF_JOURNAL_IDENTITY + 1];
    bool has_records;
    if (hf_journal_peek(path, of_journal, &has_records) && *identity && !strcmp(of_journal, identity))
        hf_store_file_forget_earlier(path);
}

/* Removes the journal of a finished result. A run that was killed after its result had got its name leaves a journal,
 * and perhaps the temporary name of the result and the earlier result that it replaced. All of them are removed. */
static void remove_journal(const char *path, bool keeps_earlier, const char *identity)
{
    char target[HF_FILE_OUT_SIZE], name[HF_FILE_OUT_SIZE + 16];
    hf_journal journal;
    hf_status status = hf_file_out_target(path, target, NULL);
    snprintf(name, sizeof name, "%s.journal", target);
    if (status == HF_OK && access(name, F_OK) == 0) {
        status = hf_journal_open(target, false, &journal, NULL);
        if (status == HF_OK) hf_file_out_clean(target);
        if (status == HF_OK && keeps_earlier) forget_earlier(target, identity);
        hf_journal_close(&journal, status == HF_OK);
    }
}

static void ignore_difference(void *context, const char *name, const char *how)
{
    (void)context, (void)name, (void)how;
}

static const char *const *reader; /* a command that calls hf_store_read_like_a_run, or NULL */

void hf_store_set_reader(const char *const *command)
{
    reader = command;
}

void hf_store_read_like_a_run(const char *path)
{
    hf_summary *summary = calloc(1, sizeof *summary);
    hf_comparison comparison = {0};
    hf_hdf5_limit();
    hf_status status = summary ? hf_store_read_summary(path, summary, NULL) : HF_NO_MEMORY;
    if (status == HF_OK && !summary->finished) hf_compare_files(path, path, &comparison, ignore_difference, NULL, NULL);
    if (summary) hf_summary_free(summary);
    free(summary);
}

/* Reports the first message of `said` again, as a failure of the machine and not of the file. Frees `said` and returns
 * the status. */
static hf_status pass_on(hf_messages *said, hf_status status, hf_messages *messages)
{
    const char *why = said->text + strlen("error: ");
    hf_error(messages, status, "%.*s", (int)strcspn(why, "\n"), why);
    hf_messages_free(said);
    return status;
}

hf_status hf_store_look(const char *path, const hf_case *settings, const hf_scene *scene, const hf_truss *truss,
                        hf_store_state *state, hf_messages *messages)
{
    char now[65], then[65] = "", words[1024] = "";
    signed char finished = 0;
    struct stat info;
    *state = HF_STORE_NOTHING;
    int failed = stat(path, &info);
    if (failed && hf_file_io_fault(errno, HF_OK) != HF_OK)
        return hf_error(messages, HF_IO, "%s: cannot get the status of this file: %s", path, strerror(errno));
    if (failed || !S_ISREG(info.st_mode)) return HF_OK; /* hf_store_create reports what is wrong */
    hf_messages said = {0};
    hf_status tried = hf_hdf5_try(hf_store_read_like_a_run, reader, path, words, sizeof words, messages);
    if (tried == HF_EXISTS)
        return hf_error(messages, HF_EXISTS,
                        "%s: this file exists and is damaged. The process that read the file was ended by %s. Use "
                        "--restart (in a sweep: --retry failed) to replace the file, or use -o to choose another name",
                        path, words);
    HF_TRY(tried);
    if (hf_store_identify(settings, scene, truss, now) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "%s: out of memory", path);
    hf_hdf5 io = hf_store_open_result(path, &said);
    hf_hdf5_get(&io, io.file, "/", "finished", HF_KIND_FLAG, &finished, 1);
    hf_hdf5_get(&io, io.file, "/", "identity", HF_KIND_CHARS, then, sizeof then);
    if (io.status == HF_OK && strcmp(now, then) != 0) tell_difference(&io, settings, words, sizeof words);
    bool keeps = hf_store_keeps_earlier(&io);
    hf_store_close_result(&io);
    if (io.status != HF_OK && !io.is_damaged && said.text) return pass_on(&said, io.status, messages);
    bool is_cut = said.text && strstr(said.text, ": cannot open: truncated file");
    hf_messages_free(&said);
    if (io.status != HF_OK)
        return hf_error(messages, HF_EXISTS,
                        "%s: this file exists and is %s. Use --restart (in a sweep: --retry failed) to replace the "
                        "file, or use -o to choose another name",
                        path, is_cut ? "cut off: a truncated HDF5 file" : "not a result of hifdm");
    if (*words)
        return hf_error(messages, HF_EXISTS,
                        "%s: this file exists and is the %s result of another case. The differences are: %s. Use "
                        "--restart (in a sweep: --retry failed) to replace the file, or use -o to choose another name",
                        path, finished ? "finished" : "unfinished", words);
    *state = finished ? HF_STORE_FINISHED : HF_STORE_UNFINISHED;
    if (finished) remove_journal(path, keeps, then);
    return HF_OK;
}

/* ---- before a restart ---- */

bool hf_store_keeps_earlier(hf_hdf5 *io)
{
    signed char keeps = 0;
    if (io->status == HF_OK && H5Aexists(io->file, HF_KEEPS_EARLIER) > 0)
        hf_hdf5_get(io, io->file, "/", HF_KEEPS_EARLIER, HF_KIND_FLAG, &keeps, 1);
    return keeps;
}

hf_status hf_store_look_before(const char *path, hf_earlier *earlier, hf_messages *messages)
{
    char words[64], identity[65] = "";
    signed char finished = 0;
    struct stat info;
    hf_messages said = {0};
    *earlier = HF_EARLIER_NONE;
    int seen = hf_path_look(path, &info);
    if (seen < 0) return hf_error(messages, HF_IO, "%s: cannot get the status of this file: %s", path, strerror(errno));
    if (seen == 0 || !S_ISREG(info.st_mode)) return HF_OK;
    hf_status tried = hf_hdf5_try(hf_store_read_like_a_run, reader, path, words, sizeof words, messages);
    if (tried != HF_EXISTS) HF_TRY(tried);
    *earlier = HF_EARLIER_UNREAD;
    if (tried == HF_EXISTS) return HF_OK;
    hf_hdf5 io = hf_store_open_result(path, &said);
    hf_hdf5_get(&io, io.file, "/", "finished", HF_KIND_FLAG, &finished, 1);
    bool keeps = hf_store_keeps_earlier(&io), is_read = io.status == HF_OK;
    if (keeps) hf_hdf5_get(&io, io.file, "/", "identity", HF_KIND_CHARS, identity, sizeof identity);
    hf_store_close_result(&io);
    if (!is_read && !io.is_damaged && said.text) return pass_on(&said, io.status, messages);
    hf_messages_free(&said);
    if (is_read && finished && keeps) forget_earlier(path, identity);
    if (is_read) *earlier = finished ? HF_EARLIER_THERE : keeps ? HF_EARLIER_KEPT : HF_EARLIER_NONE;
    return HF_OK;
}

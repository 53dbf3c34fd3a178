/* Implements ledger.h. Sections: names, opening and writing, reading files, news of other processes, reading locks, the
 * whole. */
#include "store/ledger.h"

#include "base/clock.h"
#include "base/file_io.h"
#include "base/file_out.h"
#include "base/path.h"
#include "base/text.h"
#include "store/journal.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define HEADER "#hifdm-points-2"
#define HEADER_0_2 "#hifdm-points-1" /* of version 0.2, with the names of that version */
#define SYNC_S 5.0                   /* s; a power cut may lose the points that finished since the last sync */
/* Maximum bytes of one row: the reason, 25 for each number, the lists with their names. An objective takes 138, a
 * surface error 70. Each of 16 load cases has four figures and 68 surface errors of up to 135. Each of 32
 * requirements has a name of up to 255 and six numbers of up to 45. */
#define LINE_SIZE 430000
#define ROWS_MAX                                                                                                       \
    (HF_STUDY_POINT_MAX * (off_t)4096) /* maximum bytes of a file: every point has a row, few rows have 4096 bytes */
#define N_FIXED 4                      /* fields before the numbers: id, fingerprint, status, reason */

const char *const hf_point_state_word[HF_N_POINT_STATE] = {"missing", "running", "done", "failed", "outdated"};

/* ---- names ---- */

hf_ledger_content hf_ledger_file(const char *folder, const hf_study *study, int point, char path[HF_PATH_SIZE + 32])
{
    struct stat info;
    snprintf(path, HF_PATH_SIZE + 32, "%s/%s-%.8s.h5", folder, study->id[point], study->fingerprint);
    int seen = hf_path_look(path, &info);
    if (seen < 0) return HF_LEDGER_UNSEEN;
    if (seen == 0 || !S_ISREG(info.st_mode)) return HF_LEDGER_NO_FILE;
    return info.st_size > 0 ? HF_LEDGER_FILE : HF_LEDGER_EMPTY_FILE;
}

static off_t byte_of(const char *id)
{
    return (off_t)strtoull(id, NULL, 16);
}

/* ---- opening and writing ---- */

/* How far each file has been read, and which points were finished after that. */
struct hf_ledger_news {
    const hf_study *study;
    struct {
        char name[256];
        off_t at;
    } * file;
    int n_file;
    bool *is_finished; /* [n_point] */
};

hf_status hf_ledger_open(const char *folder, hf_ledger *l, hf_messages *messages)
{
    char path[HF_PATH_SIZE + 32];
    bool was_there;
    *l = (hf_ledger){.rows = -1, .claims = -1};
    pthread_mutex_init(&l->lock, NULL);
    if (snprintf(l->folder, sizeof l->folder, "%s", folder) >= (int)sizeof l->folder)
        return hf_error(messages, HF_IO, "%s: the path is too long", folder);
    HF_TRY(hf_file_out_folder(folder, messages));
    snprintf(path, sizeof path, "%s/claims", folder);
    l->claims = hf_file_out_keep(path, &was_there);
    if (l->claims < 0 && errno == EEXIST)
        return hf_error(messages, HF_IO, "%s: this is not a regular file. Remove it", path);
    if (l->claims < 0) return hf_error(messages, HF_IO, "%s: cannot open: %s", path, strerror(errno));
    return HF_OK;
}

hf_status hf_ledger_close(hf_ledger *l, hf_messages *messages)
{
    int why = l->rows >= 0 && hf_file_io_sync(l->rows, true) != 0 ? errno : 0;
    if (l->rows >= 0 && hf_file_io_close(l->rows) != 0 && !why) why = errno;
    if (l->claims >= 0) close(l->claims);
    if (l->news) {
        free(l->news->file);
        free(l->news->is_finished);
    }
    free(l->news);
    pthread_mutex_destroy(&l->lock);
    if (!why) return HF_OK;
    return hf_error(messages, HF_IO, "%s: cannot write to the disk: %s. The next sweep may run the last points again",
                    l->folder, strerror(why));
}

hf_lock hf_ledger_claim(hf_ledger *l, const char *id)
{
    return hf_file_io_lock_byte(l->claims, byte_of(id));
}

void hf_ledger_release(hf_ledger *l, const char *id)
{
    hf_file_io_unlock_byte(l->claims, byte_of(id));
}

/* Writes a line with one write(2). A process that is killed at any instant therefore leaves at most one incomplete
 * line. After a failure the written part of the line is cut off, because the next line must begin on a line of its
 * own. */
static hf_status write_line(hf_ledger *l, const char *line, size_t length, hf_messages *messages)
{
    if (hf_file_io_write(l->rows, line, length) == 0) {
        l->size += (int64_t)length;
        return HF_OK;
    }
    hf_status status =
        hf_error(messages, HF_IO, "%s: cannot write the result of a point: %s", l->folder, strerror(errno));
    if (hf_file_io_cut(l->rows, l->size) == 0) return status;
    close(l->rows); /* the next line begins another file */
    l->rows = -1;
    return status;
}

/* Makes the points file of this process and writes the names of the columns. */
static hf_status start_rows(hf_ledger *l, char line[LINE_SIZE], hf_messages *messages)
{
    char host[64] = "host", path[HF_PATH_SIZE + 128];
    if (gethostname(host, sizeof host - 1) != 0) strcpy(host, "host");
    host[sizeof host - 1] = '\0';
    for (int k = 1; l->rows < 0 && k < 10000; k++) {
        snprintf(path, sizeof path, k == 1 ? "%s/points-%s-%ld.tsv" : "%s/points-%s-%ld-%d.tsv", l->folder, host,
                 (long)getpid(), k);
        l->rows = hf_file_out_create(path);
        if (l->rows < 0 && errno != EEXIST) break;
    }
    if (l->rows < 0 || fcntl(l->rows, F_SETFL, O_APPEND) != 0)
        return hf_error(messages, HF_IO, "%s: cannot create: %s", path, strerror(errno));
    l->size = 0;
    size_t used = (size_t)snprintf(line, LINE_SIZE, HEADER "\tfingerprint\tstatus\treason");
    for (int i = 0; i < hf_ledger_n_field(); i++) {
        line[used++] = '\t';
        used += (size_t)hf_ledger_field_name(i, line + used, LINE_SIZE - used);
    }
    line[used++] = '\n';
    hf_status status = write_line(l, line, used, messages);
    if (status == HF_OK) return HF_OK;
    unlink(path); /* its lines are useless without the names of the columns */
    if (l->rows >= 0) close(l->rows);
    l->rows = -1;
    return status;
}

/* Copies at most HF_LEDGER_REASON_MAX bytes. Tabs, newlines and other control characters become blanks. Returns the
 * length. */
static size_t put_reason(const char *reason, char *to)
{
    size_t n = 0;
    for (; n < HF_LEDGER_REASON_MAX && reason[n]; n++)
        to[n] = (unsigned char)reason[n] < ' ' ? ' ' : reason[n];
    to[n] = '\0';
    hf_text_trim_utf8(to);
    return strlen(to);
}

hf_status hf_ledger_write(hf_ledger *l, const hf_study *study, int point, hf_status status, const char *reason,
                          const hf_summary *s, hf_messages *messages)
{
    char *line = malloc(2 * LINE_SIZE); /* the second half is for the names of the columns */
    if (!line) return hf_error(messages, HF_NO_MEMORY, "%s: out of memory for a row of the table of points", l->folder);
    size_t used =
        (size_t)snprintf(line, LINE_SIZE, "%s\t%s\t%s\t", study->id[point], study->fingerprint, hf_status_word(status));
    used += put_reason(reason, line + used);
    for (int i = 0; i < hf_ledger_n_field(); i++) {
        line[used++] = '\t';
        used += (size_t)hf_ledger_print_field(i, s, line + used, LINE_SIZE - used);
    }
    line[used++] = '\n';
    pthread_mutex_lock(&l->lock);
    hf_status result = l->rows < 0 ? start_rows(l, line + LINE_SIZE, messages) : HF_OK;
    if (result == HF_OK) result = write_line(l, line, used, messages);
    int file = l->rows;
    double now_s = hf_clock_s();
    bool is_due = now_s - l->synced_s >= SYNC_S;
    if (is_due) l->synced_s = now_s;
    pthread_mutex_unlock(&l->lock);
    free(line);
    if (result == HF_OK && is_due && hf_file_io_sync(file, true) != 0)
        return hf_error(messages, HF_IO, "%s: cannot write to the disk: %s", l->folder, strerror(errno));
    return result;
}

/* ---- reading files ---- */

typedef struct {
    const hf_study *study;
    hf_points *points;
    hf_point *failure; /* [n_point] rows of this base case; used if a success has lost its file */
} reading;

/* Splits a line at its tabs. Returns the number of fields, at most max. */
static int split(char *line, char **field, int max)
{
    int n = 0;
    for (char *p = line; p && n < max; n++) {
        field[n] = p;
        p = strchr(p, '\t');
        if (p) *p++ = '\0';
    }
    return n;
}

/* Takes a row into the state of its point. A success overrides a failure. A row of this base case overrides a row of
 * another one. */
static void take_row(reading *r, char **field, char **number)
{
    int i = hf_study_find(r->study, field[0]);
    if (i < 0) return;
    hf_point *p = &r->points->point[i];
    if (strcmp(field[1], r->study->fingerprint)) {
        if (p->state == HF_POINT_MISSING) p->state = HF_POINT_OUTDATED;
        return;
    }
    hf_status status = hf_status_of_word(field[2]);
    hf_point row = {status == HF_OK ? HF_POINT_DONE : HF_POINT_FAILED, status, field[3], number};
    if (row.state == HF_POINT_FAILED) r->failure[i] = row;
    if (p->state != HF_POINT_DONE) *p = row;
}

/* Maximum number of fields that are read from a row; this version writes about 120. */
enum { FIELD_MAX = 512 };

/* Replaces the name of a field, "/group/name", by that in version 0.2. It is not inlined, because its texts would add 3
 * KiB to the stack of its callers. */
__attribute__((noinline)) static void name_then(char *field, size_t size)
{
    char group[HF_HDF5_NAME_SIZE], object[HF_HDF5_NAME_SIZE], name[HF_HDF5_NAME_SIZE] = "";
    size_t n = (size_t)hf_path_prefix_length(field);
    snprintf(group, sizeof group, "%.*s", (int)(n > 1 ? n - 1 : n), field);
    if (hf_renamed(group, field + n, 0, object, name))
        snprintf(field, size, "%s/%s", object, name); /* "//seed" of the root */
}

/* Sets from[i] to the field of the file's rows that holds our field i, or -1, because files of other versions have
 * other fields. Returns the number of fields, 0 if the line is no header. */
static int read_header(char *line, int *from, int n_ours)
{
    char *name[FIELD_MAX];
    int n = split(line, name, FIELD_MAX);
    bool is_old = !strcmp(name[0], HEADER_0_2);
    for (int i = 0; i < n_ours; i++) {
        char wanted[2 * HF_HDF5_NAME_SIZE];
        hf_ledger_field_name(i, wanted, sizeof wanted);
        if (is_old) name_then(wanted, sizeof wanted);
        from[i] = -1;
        for (int k = N_FIXED; k < n; k++)
            if (!strcmp(name[k], wanted)) from[i] = k;
    }
    return is_old || !strcmp(name[0], HEADER) ? n : 0;
}

/* Keeps a block until hf_points_free. Returns false if it is NULL or memory runs out, and frees it then. */
static bool keep_block(hf_points *points, void *block)
{
    void **more = block ? realloc(points->block, ((size_t)points->n_block + 1) * sizeof *more) : NULL;
    if (!more) {
        free(block);
        return false;
    }
    points->block = more;
    points->block[points->n_block++] = block;
    return true;
}

/* Takes the rows of one file. Returns false if memory runs out. */
static bool read_rows(reading *r, char *text)
{
    int n_ours = hf_ledger_n_field(), from[FIELD_MAX], n_field = 0;
    char *field[FIELD_MAX], *end;
    long n_line = 0;
    for (const char *p = text; (p = strchr(p, '\n')) != NULL; p++)
        n_line++;
    char **number = malloc(((size_t)n_line + 1) * (size_t)n_ours * sizeof *number);
    if (!keep_block(r->points, number)) return false;
    for (char *line = text; (end = strchr(line, '\n')) != NULL; line = end + 1, number += n_ours) {
        *end = '\0';
        if (line == text) {
            n_field = read_header(line, from, n_ours);
        } else if (split(line, field, FIELD_MAX) == n_field && n_field >= N_FIXED) {
            for (int i = 0; i < n_ours; i++)
                number[i] = from[i] < 0 ? "" : field[from[i]];
            take_row(r, field, number);
        }
    }
    return true;
}

static hf_status tell_in_the_way(const char *path, hf_messages *messages)
{
    return hf_error(messages, HF_IO, "%s: this is not a regular file. Remove it", path);
}

/* Reads what the file holds now, from byte `at` on, as a text, which the caller frees. Rows that are added meanwhile
 * are left out. */
static hf_status read_text(const char *path, off_t at, char **text, hf_messages *messages)
{
    off_t size;
    *text = NULL;
    int file = hf_file_io_open_ordinary(path, &size);
    if (file < 0 && errno == EEXIST) return tell_in_the_way(path, messages);
    if (file < 0)
        return hf_error(messages, hf_file_io_fault(errno, HF_IO), "%s: cannot open: %s", path, strerror(errno));
    size_t length = size > at ? (size_t)(size - at) : 0;
    if (size <= ROWS_MAX) *text = malloc(length + 1);
    ssize_t n = *text ? hf_file_io_read_at(file, *text, length, at) : 0;
    int why = errno;
    close(file);
    if (size > ROWS_MAX)
        return hf_error(messages, HF_IO,
                        "%s: this file is larger than %lld MB, so it is not a table of hifdm. Remove it", path,
                        (long long)ROWS_MAX / 1000000);
    if (!*text) return hf_error(messages, HF_NO_MEMORY, "%s: out of memory", path);
    (*text)[n < 0 ? 0 : n] = '\0';
    if (n >= 0) return HF_OK;
    free(*text);
    return hf_error(messages, hf_file_io_fault(why, HF_IO), "%s: cannot read: %s", path, strerror(why));
}

static hf_status read_file(void *context, const char *path, hf_messages *messages)
{
    reading *r = context;
    char *text;
    HF_TRY(read_text(path, 0, &text, messages));
    return keep_block(r->points, text) && read_rows(r, text)
               ? HF_OK
               : hf_error(messages, HF_NO_MEMORY, "%s: out of memory", path);
}

static int is_rows(const struct dirent *entry)
{
    size_t n = strlen(entry->d_name);
    return !strncmp(entry->d_name, "points-", 7) && n > 4 && !strcmp(entry->d_name + n - 4, ".tsv");
}

static int by_name(const struct dirent **a, const struct dirent **b)
{
    return strcmp((*a)->d_name, (*b)->d_name);
}

/* Calls `take` for each file of rows in sorted order, until it fails. If a point has several rows, the same one
 * therefore always counts. */
static hf_status each_file(const char *folder, hf_status (*take)(void *, const char *path, hf_messages *),
                           void *context, hf_messages *messages)
{
    char path[HF_PATH_SIZE + 300];
    struct dirent **entry;
    hf_status status = HF_OK;
    int n = scandir(folder, &entry, is_rows, by_name);
    if (n < 0 && errno == ENOENT) return HF_OK;
    if (n < 0) return hf_error(messages, HF_IO, "%s: cannot read this folder: %s", folder, strerror(errno));
    for (int i = 0; i < n; i++) {
        snprintf(path, sizeof path, "%s/%s", folder, entry[i]->d_name);
        if (status == HF_OK) status = take(context, path, messages);
        free(entry[i]);
    }
    free(entry);
    return status;
}

/* ---- news of other processes ---- */

/* Returns the index of the file in the list, and adds it if it is new; -1 if memory runs out. */
static int place_of(struct hf_ledger_news *news, const char *name)
{
    for (int k = 0; k < news->n_file; k++)
        if (!strcmp(news->file[k].name, name)) return k;
    void *more = realloc(news->file, ((size_t)news->n_file + 1) * sizeof *news->file);
    if (!more) return -1;
    news->file = more;
    news->file[news->n_file].at = 0;
    snprintf(news->file[news->n_file].name, sizeof news->file->name, "%s", name);
    return news->n_file++;
}

/* Notes the points of the whole lines that a file has gained since the last call. A file that cannot be read has no
 * rows. */
static hf_status note_rows(void *context, const char *path, hf_messages *messages)
{
    struct hf_ledger_news *news = context;
    const hf_study *study = news->study;
    char *text, *line, *end, *field[3];
    int k = place_of(news, hf_path_name(path));
    if (k < 0 || read_text(path, news->file[k].at, &text, messages) != HF_OK) return HF_OK;
    for (line = text; (end = strchr(line, '\n')) != NULL; line = end + 1) {
        *end = '\0';
        int i =
            split(line, field, 3) == 3 && !strcmp(field[1], study->fingerprint) ? hf_study_find(study, field[0]) : -1;
        if (i >= 0) news->is_finished[i] = true;
    }
    news->file[k].at += line - text;
    free(text);
    return HF_OK;
}

hf_status hf_ledger_watch(hf_ledger *l, const hf_study *study, hf_messages *messages)
{
    l->news = calloc(1, sizeof *l->news);
    if (l->news) l->news->is_finished = calloc((size_t)study->n_point, sizeof(bool));
    if (!l->news || !l->news->is_finished)
        return hf_error(messages, HF_NO_MEMORY, "%s: out of memory for %d points", l->folder, study->n_point);
    l->news->study = study;
    each_file(l->folder, note_rows, l->news, NULL);
    memset(l->news->is_finished, 0, (size_t)study->n_point * sizeof(bool)); /* before the watch */
    return HF_OK;
}

bool hf_ledger_is_finished(hf_ledger *l, int point)
{
    pthread_mutex_lock(&l->lock);
    each_file(l->folder, note_rows, l->news, NULL);
    bool is_finished = l->news->is_finished[point];
    pthread_mutex_unlock(&l->lock);
    return is_finished;
}

/* ---- reading locks ---- */

/* Finds the points whose bytes from `from` to `to` - 1 are locked. The system returns one lock of a range, so the parts
 * before and after it are searched in turn. */
static void find_locks(reading *r, int file, off_t from, off_t to)
{
    while (from < to) {
        struct flock lock = {.l_type = F_WRLCK, .l_whence = SEEK_SET, .l_start = from, .l_len = to - from};
        char id[32];
        if (fcntl(file, F_GETLK, &lock) != 0 || lock.l_type == F_UNLCK) return;
        if (lock.l_start < from) lock.l_start = from; /* the lock of another program may cover several bytes */
        snprintf(id, sizeof id, "%012llx", (unsigned long long)lock.l_start);
        int i = hf_study_find(r->study, id);
        if (i >= 0) r->points->point[i] = (hf_point){HF_POINT_RUNNING, HF_NOT_EVALUATED, "", NULL};
        find_locks(r, file, from, lock.l_start);
        from = lock.l_start + 1;
    }
}

static hf_status find_running(reading *r, const char *folder, hf_messages *messages)
{
    char path[HF_PATH_SIZE + 32];
    off_t size;
    snprintf(path, sizeof path, "%s/claims", folder);
    int file = hf_file_io_open_ordinary(path, &size);
    if (file < 0) return errno == EEXIST ? tell_in_the_way(path, messages) : HF_OK;
    find_locks(r, file, 0, (off_t)1 << 48);
    close(file);
    return HF_OK;
}

/* ---- the whole ---- */

/* Finds points whose result file is lost. A point with a result file is done only if the file exists and is whole. The
 * file may have been removed, or a second run of the point may be unfinished. */
static hf_status find_lost(reading *r, const char *folder, hf_messages *messages)
{
    char path[HF_PATH_SIZE + 32], identity[HF_JOURNAL_IDENTITY + 1];
    bool has_records;
    if (!hf_study_has_files(r->study)) return HF_OK;
    for (int i = 0; i < r->study->n_point; i++) {
        hf_point *p = &r->points->point[i];
        if (p->state != HF_POINT_DONE) continue;
        hf_ledger_content content = hf_ledger_file(folder, r->study, i, path);
        if (content == HF_LEDGER_UNSEEN)
            return hf_error(messages, HF_IO, "%s: cannot get the status of this file: %s", path, strerror(errno));
        if (content == HF_LEDGER_FILE && !hf_journal_peek(path, identity, &has_records)) continue;
        *p = r->failure[i];
        r->points->n_lost += p->state == HF_POINT_MISSING;
    }
    return HF_OK;
}

hf_status hf_ledger_read(const char *folder, const hf_study *study, hf_points *points, hf_messages *messages)
{
    size_t n = (size_t)study->n_point;
    *points = (hf_points){.n_point = study->n_point};
    points->point = calloc(n, sizeof *points->point);
    reading r = {study, points, calloc(n, sizeof *r.failure)};
    if (!points->point || !r.failure) {
        free(r.failure);
        return hf_error(messages, HF_NO_MEMORY, "%s: out of memory for %d points", folder, study->n_point);
    }
    for (int i = 0; i < study->n_point; i++)
        points->point[i] = r.failure[i] = (hf_point){HF_POINT_MISSING, HF_NOT_EVALUATED, "", NULL};
    hf_status status = each_file(folder, read_file, &r, messages);
    if (status == HF_OK) status = find_running(&r, folder, messages);
    if (status == HF_OK) status = find_lost(&r, folder, messages);
    for (int i = 0; i < study->n_point; i++)
        points->count[points->point[i].state]++;
    free(r.failure);
    return status;
}

int hf_ledger_n_begun(const char *folder, const hf_study *study, const hf_points *points)
{
    char path[HF_PATH_SIZE + 32];
    int n = 0;
    DIR *names = hf_study_has_files(study) ? opendir(folder) : NULL;
    for (const struct dirent *entry; names && (entry = readdir(names)) != NULL;) {
        char id[HF_STUDY_ID_SIZE];
        snprintf(id, sizeof id, "%.12s", entry->d_name);
        int i = strlen(entry->d_name) > strlen(id) ? hf_study_find(study, id) : -1;
        n += i >= 0 && points->point[i].state == HF_POINT_MISSING &&
             hf_ledger_file(folder, study, i, path) == HF_LEDGER_FILE && !strcmp(hf_path_name(path), entry->d_name);
    }
    if (names) closedir(names);
    return n;
}

void hf_points_free(hf_points *points)
{
    for (int i = 0; i < points->n_block; i++)
        free(points->block[i]);
    free(points->block);
    free(points->point);
    *points = (hf_points){0};
}

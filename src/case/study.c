/* Makes the points of a sweep from its axes:
 *
 *     axes -> number of points -> values of each point -> ids (SHA-256), sorted
 *       -> load one point as a case -> fingerprint, sections, seed
 *     point -> overrides for hf_config_load
 *
 * Contents: values - samples - points - overrides of a point */
#include "case/study.h"

#include "base/random.h"
#include "base/sha256.h"
#include "base/text.h"
#include "case/config_rename.h"

#include <gsl/gsl_qrng.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TRIED_MOST 1000  /* maximum number of points that are loaded to find a valid one */
#define SPREAD_LEAST 100 /* fewer points are taken in order */

const char *const hf_study_files_word[3] = {"auto", "all", "none"};

/* ---- values ---- */

/* Writes the number with the fewest digits, from 15 to 17, that reads back as the same double. */
static void shortest(double value, char text[40])
{
    for (int digits = 15; digits <= 17; digits++) {
        double again = 0;
        snprintf(text, 40, "%.*g", digits, value + 0.0); /* + 0.0 turns -0 into 0 */
        if (hf_text_double(text, &again) && again == value) return;
    }
}

char *hf_study_canonical(const hf_key *key, const char *value)
{
    const hf_field *field = key->field;
    char number[48];
    double real;
    uint64_t whole;
    const char *percent = field->type == HF_FIELD_AMOUNT ? strchr(value, '%') : NULL;
    char part[64] = "";
    if (percent) snprintf(part, sizeof part, "%.*s", (int)strcspn(value, " %"), value);
    if (percent && hf_text_double(part, &real)) {
        shortest(real, number);
        strcat(number, " %");
        value = number;
    } else if ((field->type == HF_FIELD_DOUBLE || field->type == HF_FIELD_AMOUNT) && hf_text_double(value, &real)) {
        shortest(real, number);
        value = number;
    } else if ((field->type == HF_FIELD_INT || field->type == HF_FIELD_UINT64) && hf_text_uint64(value, &whole)) {
        snprintf(number, sizeof number, "%" PRIu64, whole);
        value = number;
    }
    size_t size = strlen(key->path) + strlen(value) + 2;
    char *text = malloc(size);
    if (text) snprintf(text, size, "%s=%s", key->path, value);
    return text;
}

void hf_study_range_value(const hf_field *field, double from, double to, bool is_log, double x, char text[40])
{
    double value = is_log ? from * pow(to / from, x) : from + (to - from) * x;
    if (is_log && !isnormal(to / from)) value = pow(from, 1 - x) * pow(to, x); /* to / from is out of range */
    if (!is_log && !isfinite(to - from)) value = from * (1 - x) + to * x;      /* to - from overflows */
    if (x >= 1) value = to;
    if (field->type == HF_FIELD_DOUBLE || field->type == HF_FIELD_AMOUNT) {
        /* 12 digits are the same on every machine, although pow(3) may differ in the last bit. */
        snprintf(text, 40, "%.12g", value + 0.0);
        if (strchr(text, 'e') && hf_text_double(text, &value)) shortest(value, text);
    } else {
        snprintf(text, 40, "%.0f", floor(value + 0.5));
    }
}

/* ---- samples ---- */

hf_status hf_study_sobol(int n, int n_axis, double *x)
{
    gsl_qrng *q = gsl_qrng_alloc(gsl_qrng_sobol, (unsigned)n_axis);
    if (!q) return HF_NO_MEMORY;
    for (int i = 0; i < n; i++)
        gsl_qrng_get(q, x + (size_t)i * (size_t)n_axis);
    gsl_qrng_free(q);
    return HF_OK;
}

hf_status hf_study_latin_hypercube(int n, int n_axis, uint64_t seed, double *x)
{
    int *row = malloc((size_t)n * sizeof *row);
    if (!row) return HF_NO_MEMORY;
    for (int axis = 0; axis < n_axis; axis++) {
        hf_random random = {seed ^ ((uint64_t)(unsigned)axis << 48)};
        for (int i = 0; i < n; i++) { /* Fisher-Yates; the bias of the remainder is negligible */
            int k = (int)(hf_random_next(&random) % ((uint64_t)i + 1));
            row[i] = row[k];
            row[k] = i;
        }
        for (int i = 0; i < n; i++)
            x[(size_t)i * (size_t)n_axis + (size_t)axis] = (row[i] + hf_random_uniform(&random)) / n;
    }
    free(row);
    return HF_OK;
}

/* ---- points ---- */

static hf_status out_of_memory(const hf_study *s, hf_messages *messages)
{
    return hf_error(messages, HF_NO_MEMORY, "%s: out of memory for the points of the sweep", s->path);
}

hf_status hf_study_count_points(hf_study *s, hf_messages *messages)
{
    double n = 1;
    int n_sampled = 0; /* all sampled axes count as one */
    const hf_study_axis *first = NULL;
    for (int a = 0; a < s->n_axis; a++) {
        const hf_study_axis *axis = &s->axis[a];
        if (axis->is_replicate) continue;
        if (!first) first = axis;
        if (s->is_zip && axis->n_value != first->n_value)
            return hf_error(messages, HF_BAD_CASE,
                            "%s:%d:%d: sweep.%s: this axis has %d values, but the axis %s has %d values. The setting "
                            "`combine: zip` needs the same number of values on all axes",
                            s->path, axis->line, axis->column, axis->key.path, axis->n_value, first->key.path,
                            first->n_value);
        if (s->is_zip)
            n = axis->n_value;
        else if (!axis->is_sampled || n_sampled++ == 0)
            n *= axis->n_value;
    }
    if (s->n_replicate) n *= s->n_replicate;
    if (n > HF_STUDY_POINT_MAX)
        return hf_error(messages, HF_BAD_CASE, "%s: sweep: the study has %.10g points, but the maximum is %d points",
                        s->path, n, HF_STUDY_POINT_MAX);
    s->n_point = (int)n;
    return HF_OK;
}

/* Writes the values of point i. The replicates change fastest, then the last axis. */
static void place_point(const hf_study *s, int i, int *value)
{
    int rest = s->n_replicate ? i / s->n_replicate : i, sampled = -1;
    for (int a = s->n_axis - 1; a >= 0; a--) {
        const hf_study_axis *axis = &s->axis[a];
        if (axis->is_replicate) {
            value[a] = i % s->n_replicate;
        } else if (s->is_zip) {
            value[a] = rest;
        } else if (axis->is_sampled && sampled >= 0) {
            value[a] = sampled;
        } else {
            value[a] = rest % axis->n_value;
            rest /= axis->n_value;
            if (axis->is_sampled) sampled = value[a];
        }
    }
}

int hf_study_spread(const hf_study *s, int k)
{
    static const double golden = 0.6180339887498949;
    long n = s->n_point, step = (long)(golden * (double)n), a = n, b = step;
    if (n <= SPREAD_LEAST) return k;
    while (b > 1) { /* ends when step and n have no common divisor, so that every point occurs once */
        long rest = a % b;
        a = b;
        b = rest;
        if (b == 0) {
            a = n;
            b = ++step;
        }
    }
    return (int)(step * k % n);
}

/* Digests the lines of a point, with the names of version 0.2. The axes are sorted, so the lines are sorted too.
 * Returns false if memory runs out. */
static bool digest_point(const hf_study *s, const int *value, char hex[65])
{
    size_t size = 1, used = 0;
    char old[HF_KEY_SIZE];
    for (int a = 0; a < s->n_axis; a++)
        size += strlen(s->axis[a].canonical[value[a]]) + HF_KEY_SIZE;
    char *text = malloc(size);
    if (!text) return false;
    for (int a = 0; a < s->n_axis; a++) {
        const char *line = s->axis[a].canonical[value[a]];
        if (s->axis[a].is_replicate && value[a] == 0) continue;
        bool is_long = strlen(line) >= HF_KEY_SIZE; /* such a value is a path, and no word with an old name */
        hf_config_old_name(is_long ? s->axis[a].key.path : line, old);
        used += (size_t)snprintf(text + used, size - used, "%s%s\n", old, is_long ? strchr(line, '=') : "");
    }
    hf_sha256(text, used, hex);
    free(text);
    return true;
}

static uint64_t number_of_id(const char *id)
{
    return strtoull(id, NULL, 16);
}

static int by_number(const void *a, const void *b)
{
    const hf_study_name *x = a, *y = b;
    return (x->number > y->number) - (x->number < y->number);
}

/* Sorts the ids. Returns HF_BAD_CASE if two points have the same values, because they would write the same result. */
static hf_status sort_names(hf_study *s, hf_messages *messages)
{
    s->by_id = malloc((size_t)s->n_point * sizeof *s->by_id);
    if (!s->by_id) return out_of_memory(s, messages);
    for (int i = 0; i < s->n_point; i++)
        s->by_id[i] = (hf_study_name){number_of_id(s->id[i]), i};
    qsort(s->by_id, (size_t)s->n_point, sizeof *s->by_id, by_number);
    for (int i = 1; i < s->n_point; i++) {
        char text[512];
        if (s->by_id[i].number != s->by_id[i - 1].number) continue;
        hf_study_point_text(s, s->by_id[i].point, text, sizeof text);
        return hf_error(messages, HF_BAD_CASE, "%s: sweep: two points of the study are identical: %s", s->path, text);
    }
    return HF_OK;
}

int hf_study_find(const hf_study *s, const char *id)
{
    hf_study_name key = {number_of_id(id), -1}, *found;
    found = bsearch(&key, s->by_id, (size_t)s->n_point, sizeof key, by_number);
    return found && !strcmp(s->id[found->point], id) ? found->point : -1;
}

static hf_status name_points(hf_study *s, hf_messages *messages)
{
    size_t n = (size_t)s->n_point;
    char hex[65];
    s->value = malloc(n * (size_t)s->n_axis * sizeof *s->value);
    s->id = calloc(n, sizeof *s->id);
    if (!s->value || !s->id) return out_of_memory(s, messages);
    for (int i = 0; i < s->n_point; i++) {
        int *value = s->value + (size_t)i * (size_t)s->n_axis;
        place_point(s, i, value);
        if (!digest_point(s, value, hex)) return out_of_memory(s, messages);
        memcpy(s->id[i], hex, HF_STUDY_ID_SIZE - 1);
    }
    return sort_names(s, messages);
}

void hf_study_tell_faults(const hf_study *s, int i, const hf_messages *found, hf_messages *messages)
{
    char text[256];
    hf_study_point_text(s, i, text, sizeof text);
    for (const char *line = found->text; line && *line; line = strchr(line, '\n') + 1) {
        int skip = strncmp(line, "error: ", 7) ? 0 : 7;
        hf_error(messages, HF_BAD_CASE, "%s: sweep: point %s: %.*s", s->path, text, (int)strcspn(line, "\n") - skip,
                 line + skip);
    }
}

/* Digests the base case and the tables that it imports. If an axis changes the tables, those of the loaded
 * point are used. */
static hf_status take_fingerprint(hf_study *s, const hf_case *c, hf_messages *messages)
{
    const char *table[HF_STUDY_TABLE_MAX] = {
        c->has_import ? c->nodes_path : NULL, c->has_import ? c->cables_path : NULL,
        c->has_truss_import ? c->truss_nodes_path : NULL, c->has_truss_import ? c->truss_members_path : NULL,
        c->has_import && *c->facets_path ? c->facets_path : NULL};
    char digests[(HF_STUDY_TABLE_MAX + 1) * 65], hex[65];
    size_t used = 0;
    hf_sha256(c->text, c->text_length, digests);
    used += 64;
    for (int i = 0; i < HF_STUDY_TABLE_MAX; i++) {
        char *text;
        size_t length;
        if (!table[i]) continue;
        snprintf(s->table[i], sizeof s->table[i], "%s", table[i]);
        HF_TRY(hf_text_read_file(table[i], HF_BAD_CASE, &text, &length, messages));
        hf_sha256(text, length, digests + used);
        used += 64;
        free(text);
    }
    hf_sha256(digests, used, hex);
    memcpy(s->fingerprint, hex, HF_STUDY_FINGERPRINT_SIZE - 1);
    return HF_OK;
}

/* Loads point i and sets what all points have in common. */
static hf_status learn_from(hf_study *s, int i, hf_case *c, hf_messages *messages)
{
    hf_study_overrides o;
    bool has_seed_axis = false;
    for (int a = 0; a < s->n_axis; a++)
        has_seed_axis |= !strcmp(s->axis[a].key.path, "optimize.seed");
    hf_study_point_overrides(s, i, &o);
    HF_TRY(hf_config_load(s->base, o.set, o.n_set, c, messages));
    HF_TRY(take_fingerprint(s, c, messages));
    s->has_optimize = c->has_optimize;
    s->has_search = c->has_optimize && c->optimize.method != HF_OPTIMIZE_LM;
    s->derives_seed = c->has_optimize && !has_seed_axis;
    s->seed = c->optimize.seed;
    if (!*s->title) snprintf(s->title, sizeof s->title, "%s", c->title);
    return HF_OK;
}

/* Loads points until one is valid, because some combinations may be impossible. If none of the tried points is valid,
 * the fault is in the base case or in an axis. The faults of the first point are then reported. */
static hf_status learn_from_a_point(hf_study *s, hf_messages *messages)
{
    hf_case *c = calloc(1, sizeof *c);
    if (!c) return out_of_memory(s, messages);
    hf_status status = HF_BAD_CASE;
    hf_messages first = {0};
    for (int k = 0; k < s->n_point && k < TRIED_MOST && status == HF_BAD_CASE; k++) {
        hf_messages found = {0}, *to = k ? &found : &first;
        status = learn_from(s, hf_study_spread(s, k), c, to);
        const char *why = hf_text_first_error(to->text, hf_status_text(status));
        if (status != HF_OK && status != HF_BAD_CASE) /* a fault of the machine, which is no fault of a point */
            hf_error(messages, status, "%.*s", (int)strcspn(why, "\n"), why);
        /* All lines are warnings: of old names in the base case. */
        for (const char *line = to->text; status == HF_OK && line && *line; line = strchr(line, '\n') + 1)
            hf_warning(messages, "%.*s", (int)strcspn(line, "\n") - 9, line + 9);
        hf_messages_free(&found);
        hf_case_free(c);
    }
    free(c);
    if (status == HF_BAD_CASE) hf_study_tell_faults(s, 0, &first, messages);
    hf_messages_free(&first);
    return status;
}

/* Refuses replicates that would all be identical. */
static hf_status check_replicates(const hf_study *s, hf_messages *messages)
{
    const hf_study_axis *replicate = NULL;
    bool has_search = s->has_search;
    for (int a = 0; a < s->n_axis; a++) {
        const hf_study_axis *axis = &s->axis[a];
        if (axis->is_replicate) replicate = axis;
        for (int k = 0; k < axis->n_value && !strcmp(axis->key.path, "optimize.method"); k++)
            has_search |= strcmp(hf_study_axis_value(axis, k), hf_optimize_method_word[HF_OPTIMIZE_LM]) != 0;
    }
    if (!replicate || has_search) return HF_OK;
    return hf_error(messages, HF_BAD_CASE,
                    "%s:%d:%d: sweep.replicates: all replicates would be identical, because %s. Remove the key "
                    "replicates, or %s",
                    s->path, replicate->line, replicate->column,
                    s->has_optimize ? "the method lm uses no random numbers" : "the case has no section optimize",
                    s->has_optimize ? "use the method ga, ga+lm or auto" : "add the section optimize");
}

hf_status hf_study_make_points(hf_study *s, hf_messages *messages)
{
    HF_TRY(name_points(s, messages));
    HF_TRY(learn_from_a_point(s, messages));
    return check_replicates(s, messages);
}

void hf_study_free(hf_study *s)
{
    for (int a = 0; a < s->n_axis; a++) {
        for (int k = 0; s->axis[a].set && s->axis[a].canonical && k < s->axis[a].n_value; k++) {
            free(s->axis[a].canonical[k]);
            free(s->axis[a].set[k]);
        }
        free(s->axis[a].canonical);
        free(s->axis[a].set);
    }
    free(s->value);
    free(s->id);
    free(s->by_id);
    *s = (hf_study){0};
}

/* ---- overrides of a point ---- */

void hf_study_point_overrides(const hf_study *s, int i, hf_study_overrides *o)
{
    const int *value = s->value + (size_t)i * (size_t)s->n_axis;
    o->n_set = 0;
    for (int a = 0; a < s->n_axis; a++)
        if (!s->axis[a].is_replicate) o->set[o->n_set++] = s->axis[a].set[value[a]];
    if (!s->derives_seed) return;
    char text[64], hex[65];
    int n = snprintf(text, sizeof text, "seed %" PRIu64 " of point %s", s->seed, s->id[i]);
    hf_sha256(text, (size_t)n, hex);
    hex[16] = '\0';
    snprintf(o->seed, sizeof o->seed, "optimize.seed=%" PRIu64, (uint64_t)strtoull(hex, NULL, 16));
    o->set[o->n_set++] = o->seed;
}

void hf_study_point_text(const hf_study *s, int i, char *text, size_t size)
{
    size_t used = 0;
    for (int a = 0; a < s->n_axis && used < size; a++)
        used += (size_t)snprintf(text + used, size - used, "%s%s", a ? ", " : "",
                                 s->axis[a].canonical[s->value[(size_t)i * (size_t)s->n_axis + (size_t)a]]);
    if (used < size || size <= 4) return;
    text[size - 4] = '\0';
    hf_text_trim_utf8(text);
    strcat(text, "...");
}

bool hf_study_has_files(const hf_study *s)
{
    return s->files == HF_FILES_ALL || (s->files == HF_FILES_AUTO && s->has_optimize);
}

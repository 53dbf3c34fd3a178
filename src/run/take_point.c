/* Takes a point of the front in an earlier result as the design of a run.
 *
 *     "FILE:N" -> front of the file
 *         | the objectives and variables must be those of this case
 *         v
 *     design of point N
 *         | evaluated by run.c: objectives as stored, design within the bounds
 *         v
 *     result of the run */
#include "run/take_point.h"

#include "base/sha256.h"
#include "base/text.h"
#include <hifdm/objectives.h>
#include <hifdm/store.h>

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Maximum difference of an objective to the stored one, relative to its maximum over the front. Levenberg-Marquardt
 * reproduces its points to the bit. Points of generations come from other solvers and agree within 3.5e-8
 * (configs/chen2022-truss.yaml, 20 generations); machines differ by less. */
#define SAME 1e-6

#define MADE_OF "use the case file and the --set options of that front%s"
#define KEYS_TOLD 8
enum { DIFFERENCES_SIZE = 640 };

/* A front as stored in its file. */
typedef struct {
    hf_summary *summary;
    hf_front front;
    char *variable;
    size_t variable_size;
} stored_front;

/* ---- the point ---- */

static hf_status read_words(const char *point, hf_front_origin *taken, hf_messages *messages)
{
    uint64_t number = 0;
    const char *colon = strrchr(point, ':');
    size_t length = colon ? (size_t)(colon - point) : 0;
    if (length == 0 || !hf_text_uint64(colon + 1, &number) || number < 1 || number > INT_MAX)
        return hf_error(messages, HF_BAD_USAGE,
                        "--point must be FILE:N, such as night.h5:7, not '%s'. FILE is a result with a Pareto front, "
                        "and N is the number of a point",
                        point);
    if (length >= sizeof taken->path) return hf_error(messages, HF_BAD_USAGE, "--point: the path is too long");
    snprintf(taken->path, sizeof taken->path, "%.*s", (int)length, point);
    taken->point = (int)number;
    return HF_OK;
}

/* ---- does it belong to this case? ---- */

/* Returns true if this key of the case has no effect on the points of its front. */
static bool is_beside(const hf_problem *p, const char *key)
{
    static const char *const section[] = {"load_cases", "tolerance", "adjust", "sweep"};
    for (size_t i = 0; i < sizeof section / sizeof *section && !p->objectives.nets; i++)
        if (!strncmp(key, section[i], strlen(section[i]))) return true;
    return false;
}

/* Writes "; different: form.pretension_N", or "" if the differences are unknown. Returns words. */
static const char *tell_keys(const hf_problem *p, char words[DIFFERENCES_SIZE])
{
    char keys[4096], *next = keys;
    size_t used = 0;
    int n = 0;
    *words = '\0';
    if (hf_store_case_differences(p->settings.taken.path, &p->settings, keys, sizeof keys) == 0) return words;
    while (next) {
        char *key = next, *end = strstr(key, ", ");
        next = end ? end + 2 : NULL;
        if (end) *end = '\0';
        if (is_beside(p, key) || n++ >= KEYS_TOLD) continue;
        used +=
            (size_t)snprintf(words + used, DIFFERENCES_SIZE - used, "%s%.64s", n == 1 ? "; different: " : ", ", key);
    }
    if (n > KEYS_TOLD) snprintf(words + used, DIFFERENCES_SIZE - used, " and %d more", n - KEYS_TOLD);
    return words;
}

static bool has_objectives(const hf_problem *p, const hf_summary *s)
{
    char name[HF_OBJECTIVE_NAME_SIZE];
    bool is_same = p->objectives.n_objective == s->objectives.n;
    for (int k = 0; k < s->objectives.n && is_same; k++)
        is_same = !strcmp(hf_objectives_name(&p->objectives, k, name), s->objectives.name[k]);
    return is_same;
}

static bool has_variables(const hf_problem *p, const stored_front *f)
{
    char name[HF_VARIABLE_NAME_SIZE];
    bool is_same = p->model.n_variable == f->front.n_variable;
    for (int k = 0; k < f->front.n_variable && is_same; k++) {
        hf_model_variable_name(&p->model, &p->scene, k, name, sizeof name);
        is_same = !strcmp(name, f->variable + (size_t)k * f->variable_size);
    }
    return is_same;
}

/* Warns about a point whose verdict is worse than that of another one, and about one that has not converged. */
static void doubt_point(const stored_front *f, const hf_front_origin *taken, hf_messages *messages)
{
    const hf_front_point *point = &f->front.point[taken->point - 1];
    const hf_front_table *t = f->summary->front;
    const hf_judgement *of = &point->judgement;
    if (hf_judgement_verdict(of) == HF_VERDICT_FAIL && of->n_failed > t->first.judgement.n_failed)
        hf_warning(messages, "%s: point %d fails %d of %d requirements, but point %d fails %d. Use --point %s:%d",
                   taken->path, taken->point, of->n_failed, of->n_required, hf_front_suggested(t),
                   t->first.judgement.n_failed, taken->path, hf_front_suggested(t));
    if (f->front.minimised >= 0 && !point->is_converged)
        hf_warning(
            messages,
            "%s: point %d of the front has not converged, so better designs exist near it. Choose another point, "
            "or raise optimize.refine_steps and compute the front again",
            taken->path, taken->point);
}

static hf_status check_point(const hf_problem *p, const stored_front *f, const hf_front_origin *taken,
                             hf_messages *messages)
{
    char words[DIFFERENCES_SIZE];
    if (taken->point > f->front.n_point)
        return hf_error(
            messages, HF_BAD_USAGE,
            "%s: the front has points 1 to %d, but no point %d. `hifdm export %s --front FILE` lists these points",
            taken->path, f->front.n_point, taken->point, taken->path);
    const hf_front_point *point = &f->front.point[taken->point - 1];
    if (point->status != HF_OK)
        return hf_error(messages, HF_BAD_USAGE, "%s: point %d of the front failed and has no design: %s", taken->path,
                        taken->point, hf_status_text(point->status));
    if (!has_objectives(p, f->summary) || !has_variables(p, f))
        return hf_error(messages, HF_BAD_CASE, "%s: the front has other %s than %s: " MADE_OF, taken->path,
                        has_objectives(p, f->summary) ? "variables" : "objectives", p->settings.path,
                        tell_keys(p, words));
    if (point->mark == HF_FRONT_DOMINATED)
        hf_warning(
            messages,
            "%s: point %d is dominated, because another point of the front is at least as good in all objectives",
            taken->path, taken->point);
    doubt_point(f, taken, messages);
    return HF_OK;
}

static hf_status take(const hf_front *front, hf_front_origin *origin, hf_taken_point *taken, hf_messages *messages)
{
    size_t i = (size_t)origin->point - 1, n = (size_t)front->n_variable, bytes = n * sizeof(double);
    taken->design = malloc(bytes);
    if (!taken->design)
        return hf_error(messages, HF_NO_MEMORY, "out of memory for a design of %zu design variables", n);
    memcpy(taken->design, front->design + i * n, bytes);
    hf_sha256(taken->design, bytes, origin->sha256);
    for (int k = 0; k < front->n_objective; k++) {
        taken->objective[k] = front->point[i].objective[k];
        taken->largest[k] = fmax(0, fabs(front->initial[k]));
        for (int j = 0; j < front->n_point; j++)
            taken->largest[k] = fmax(taken->largest[k], fabs(front->point[j].objective[k]));
    }
    return HF_OK;
}

hf_status hf_take_point_read(const char *point, hf_problem *p, hf_taken_point *taken, hf_messages *messages)
{
    hf_front_origin *origin = &p->settings.taken;
    HF_TRY(read_words(point, origin, messages));
    stored_front f = {.summary = calloc(1, sizeof *f.summary)};
    if (!f.summary) return hf_error(messages, HF_NO_MEMORY, "%s: out of memory", origin->path);
    hf_status status = hf_store_read_summary(origin->path, f.summary, messages);
    if (status == HF_OK && !f.summary->front)
        status = hf_error(messages, HF_BAD_USAGE,
                          "%s: this result has no Pareto front. Use the result of a case with the list optimize.front",
                          origin->path);
    if (status == HF_OK) status = hf_store_read_front(origin->path, &f.front, &f.variable, &f.variable_size, messages);
    if (status == HF_OK) status = check_point(p, &f, origin, messages);
    if (status == HF_OK) status = take(&f.front, origin, taken, messages);
    hf_front_free(&f.front);
    free(f.variable);
    hf_summary_free(f.summary);
    free(f.summary);
    return status;
}

/* ---- its evaluation ---- */

static hf_status check_bounds(const hf_problem *p, const hf_taken_point *taken, const hf_population *bounds,
                              hf_messages *messages)
{
    const hf_front_origin *origin = &p->settings.taken;
    char name[HF_VARIABLE_NAME_SIZE], words[DIFFERENCES_SIZE];
    for (int k = 0; k < bounds->n_variable; k++) {
        double value = taken->design[k], low = bounds->lower[k], high = bounds->upper[k], room = SAME * (high - low);
        if (!(value < low - room) && !(value > high + room)) continue;
        hf_model_variable_name(&p->model, &p->scene, k, name, sizeof name);
        return hf_error(messages, HF_BAD_CASE,
                        "%s: point %d of the front has %.6g for '%s', but %s allows %.6g to %.6g: " MADE_OF,
                        origin->path, origin->point, value, name, p->settings.path, low, high, tell_keys(p, words));
    }
    return HF_OK;
}

hf_status hf_take_point_check(const hf_problem *p, const hf_taken_point *taken, const hf_population *bounds,
                              const hf_form_result *found, hf_messages *messages)
{
    const hf_front_origin *origin = &p->settings.taken;
    char name[HF_OBJECTIVE_NAME_SIZE], words[DIFFERENCES_SIZE];
    if (found->status == HF_NO_MEMORY) return hf_error(messages, HF_NO_MEMORY, "out of memory for a design");
    if (found->status != HF_OK)
        return hf_error(messages, HF_BAD_CASE,
                        "%s: point %d of the front is not a feasible design of %s (%s): " MADE_OF, origin->path,
                        origin->point, p->settings.path, hf_status_text(found->status), tell_keys(p, words));
    for (int k = 0; k < p->objectives.n_objective; k++)
        if (!(fabs(found->objective[k] - taken->objective[k]) <= SAME * taken->largest[k]))
            return hf_error(messages, HF_BAD_CASE,
                            "%s: point %d of the front has %s %.6g, but in %s it has %.6g: " MADE_OF, origin->path,
                            origin->point, hf_objectives_name(&p->objectives, k, name), taken->objective[k],
                            p->settings.path, found->objective[k], tell_keys(p, words));
    return check_bounds(p, taken, bounds, messages);
}

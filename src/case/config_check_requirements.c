/* Checks the rows of `requirements`: bounds, keys that a figure does not use, load cases, shares, and rows that repeat
 * or contradict another row. Sets of cables and facets are known only with the net; run/requirements_stage.c checks
 * them. */
#include "case/config_check.h"

#include "base/text.h"
#include "net/cable_pick.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char list[] = "requirements";

/* Returns the bounds of a row, also those of `within`; infinite if not given. */
static void bounds_of(const hf_requirement_settings *r, double bound[2])
{
    bound[0] = isnan(r->at_least) ? r->within[0] : r->at_least;
    bound[1] = isnan(r->at_most) ? r->within[1] : r->at_most;
}

static void check_bounds(int i, const hf_requirement_settings *r, hf_config_faults *f)
{
    double bound[2], least = r->figure == HF_REQUIRED_RATIO ? 1 : 0; /* smallest possible value of a figure */
    bool is_in_dB = r->figure == HF_REQUIRED_GAIN || r->figure == HF_REQUIRED_GAIN_LOSS; /* any value is possible */
    bool has_within = isfinite(r->within[0]) || isfinite(r->within[1]);
    bounds_of(r, bound);
    if (has_within && !(isnan(r->at_least) && isnan(r->at_most))) {
        hf_config_fault_in_row(f, list, i, "within", "replaces at_least and at_most; keep one of them");
        return;
    }
    if (isinf(bound[0]) && isinf(bound[1]))
        hf_config_fault_in_row(f, list, i, "figure", "has no bound; give at_most, at_least or within");
    if (bound[0] > bound[1])
        hf_config_fault_in_row(f, list, i, has_within ? "within" : "at_least", "must not be above at_most");
    else if (bound[1] < least && !is_in_dB)
        hf_config_fault_in_row(f, list, i, has_within ? "within" : "at_most",
                               least == 1 ? "is below 1, the ratio of equal tensions"
                                          : "is below 0, which no net can reach");
}

static void check_load_case(const hf_case *c, int i, const hf_requirement_settings *r, hf_config_faults *f)
{
    const hf_built_settings *b = &c->built;
    const char *name[HF_LOAD_CASE_ROWS_MAX + 2] = {"nominal", "all"}, *near;
    char what[2 * HF_KEY_SIZE + 2 * HF_SET_NAME_SIZE];
    bool is_known = !strcmp(r->load_case, name[0]) || (!strcmp(r->load_case, name[1]) && b->n_load_case > 0);
    for (int k = 0; k < b->n_load_case; k++) {
        name[2 + k] = b->load_case[k].name;
        is_known |= !strcmp(name[2 + k], r->load_case);
    }
    if (is_known || !hf_config_is_read(c, "load_cases")) return;
    if (b->n_load_case == 0)
        snprintf(what, sizeof what, "needs load cases; add rows to `load_cases`, or remove this key");
    else if ((near = hf_text_nearest(r->load_case, name, 2 + b->n_load_case)))
        snprintf(what, sizeof what, "is neither nominal, all nor a load case of `load_cases`; did you mean '%s'?",
                 near);
    else
        snprintf(what, sizeof what, "is neither nominal, all nor a load case of `load_cases`, whose first is '%s'",
                 name[2]);
    hf_config_fault_in_row(f, list, i, "load_case", what);
}

/* Reports a share that no outcome of the samples could show with a confidence of 95 %. A row that was converted from an
 * old key has no share of its own; its verdict is then undecided. */
static void check_share(const hf_case *c, int i, const hf_requirement_settings *r, hf_config_faults *f)
{
    const double tail = 0.025;
    char what[160];
    if (isnan(r->share)) return;
    double needed = ceil(log(tail) / log(r->share));
    if (r->share == 1)
        hf_config_fault_in_row(f, list, i, "share", "cannot be 1: no number of samples shows that all nets pass");
    if (!hf_config_is_read(c, "tolerance.samples")) return;
    if (!c->has_tolerance)
        hf_config_fault_in_row(f, list, i, "share", "needs a section tolerance, which defines the as-built samples");
    else if (r->share < 1 && needed > c->tolerance.samples && hf_config_is_given_in_row(f, list, i, "share")) {
        snprintf(what, sizeof what, "cannot be decided by %d samples; set tolerance.samples to at least %.0f",
                 c->tolerance.samples, needed);
        hf_config_fault_in_row(f, list, i, "share", what);
    }
}

/* Returns the frequency of a row; NaN: it has none. The default is the highest frequency of the surface. */
static double frequency_of(const hf_case *c, const hf_requirement_settings *r)
{
    return isnan(r->frequency_Hz) ? hf_config_highest_Hz(c) : r->frequency_Hz;
}

/* Returns whether two rows bound the same figure of the same cables. An empty set stands for all cables. */
static bool is_same_quantity(const hf_case *c, const hf_requirement_settings *a, const hf_requirement_settings *b)
{
    const char *of_a = *a->set ? a->set : "all", *of_b = *b->set ? b->set : "all";
    bool has_frequency = hf_required_is_of(a->figure, HF_REQUIRED_OF_RADIO);
    return a->figure == b->figure && !strcmp(of_a, of_b) && a->feed == b->feed &&
           (!has_frequency || frequency_of(c, a) == frequency_of(c, b));
}

/* Returns whether the names `sets` contain all cables, or this one name. */
static bool has_set(const char *sets, const char *of)
{
    char name[HF_SET_NAME_SIZE];
    bool has = !*sets;
    for (const char *rest = sets; rest && *rest && !has;) {
        rest = hf_cable_pick_name(rest, name);
        has = !strcmp(name, of) || !strcmp(name, "all");
    }
    return has;
}

/* Returns whether both rows bound the tension of a set that both name, or one of them is about all cables. */
static bool shares_cables(const hf_requirement_settings *a, const hf_requirement_settings *b)
{
    char name[HF_SET_NAME_SIZE];
    bool shares = !*a->set;
    for (const char *rest = a->set; rest && *rest && !shares;) {
        rest = hf_cable_pick_name(rest, name);
        shares = !strcmp(name, "all") || has_set(b->set, name);
    }
    return a->figure == HF_REQUIRED_TENSION && a->figure == b->figure && shares;
}

/* Reports a row that repeats an earlier one, or that excludes every value that an earlier one allows. */
static void check_against_earlier(const hf_case *c, int i, hf_config_faults *f)
{
    const hf_requirement_settings *r = &c->requirement[i];
    char what[128];
    double mine[2], other[2];
    bounds_of(r, mine);
    for (int k = 0; k < i; k++) {
        const hf_requirement_settings *q = &c->requirement[k];
        bool is_same_share = r->share == q->share || (isnan(r->share) && isnan(q->share)),
             is_same_case = !strcmp(r->load_case, q->load_case),
             overlaps = is_same_case || !strcmp(r->load_case, "all") || !strcmp(q->load_case, "all");
        bounds_of(q, other);
        if (!hf_config_is_read(c, "%s.%d", list, k) || mine[0] > mine[1] || other[0] > other[1]) continue;
        bool is_same = is_same_quantity(c, r, q);
        if (!overlaps || !(is_same || shares_cables(r, q))) continue;
        if (is_same && is_same_case && is_same_share &&
            ((isfinite(mine[0]) && isfinite(other[0])) || (isfinite(mine[1]) && isfinite(other[1])))) {
            snprintf(what, sizeof what, "is bounded by %s.%d already; keep one of the rows", list, k);
            hf_config_fault_in_row(f, list, i, "figure", what);
        } else if (mine[0] > other[1] || mine[1] < other[0]) {
            snprintf(what, sizeof what, "contradicts %s.%d: no value meets both rows. Change or remove one of them",
                     list, k);
            hf_config_fault_in_row(f, list, i, "figure", what);
        }
    }
}

/* Reports what a figure at a frequency lacks. */
static void check_radio(const hf_case *c, int i, const hf_requirement_settings *r, hf_config_faults *f)
{
    char text[HF_CONFIG_WHAT_SIZE];
    const char *what = hf_config_frequency_fault(r->frequency_Hz, text);
    if (what) hf_config_fault_in_row(f, list, i, "frequency_Hz", what);
    if (!hf_required_is_of(r->figure, HF_REQUIRED_OF_RADIO)) return;
    if (c->has_surface && isnan(frequency_of(c, r)) && hf_config_is_read(c, "surface.frequencies_Hz"))
        hf_config_fault_in_row(f, list, i, "figure",
                               "needs a frequency; add frequency_Hz to this row, or surface.frequencies_Hz");
    if (r->figure == HF_REQUIRED_POINTING && r->feed == HF_REFOCUSED && hf_config_is_given_in_row(f, list, i, "feed"))
        hf_config_fault_in_row(f, list, i, "feed",
                               "cannot be refocused for pointing, because that feed follows the beam; remove this key");
}

static void check_needs(const hf_case *c, int i, const hf_requirement_settings *r, hf_config_faults *f)
{
    if (hf_required_is_of(r->figure, HF_REQUIRED_OF_FEED) && !c->has_surface && hf_config_is_read(c, "surface"))
        hf_config_fault_in_row(f, list, i, "figure", "is not measured; add a section surface");
    check_radio(c, i, r, f);
    if (r->figure == HF_REQUIRED_DEFLECTION && !(c->has_truss || c->has_truss_import || c->has_truss_ring) &&
        hf_config_is_read(c, "truss"))
        hf_config_fault_in_row(f, list, i, "figure", "needs a section truss");
    if (r->figure == HF_REQUIRED_MASS && (strcmp(r->load_case, "nominal") != 0 || !isnan(r->share)))
        hf_config_fault_in_row(f, list, i, isnan(r->share) ? "load_case" : "share",
                               "has no meaning for mass, which neither loads nor errors change; remove this key");
}

void hf_config_check_requirements(const hf_case *c, hf_config_faults *f)
{
    for (int i = 0; i < c->n_requirement; i++) {
        const hf_requirement_settings *r = &c->requirement[i];
        if (!hf_config_is_read(c, "%s.%d", list, i)) continue;
        hf_config_check_use(f, list, i, "set", (int)r->figure, hf_required_figure_word, HF_REQUIRED_OF_SET);
        hf_config_check_use(f, list, i, "feed", (int)r->figure, hf_required_figure_word, HF_REQUIRED_OF_FEED);
        hf_config_check_use(f, list, i, "frequency_Hz", (int)r->figure, hf_required_figure_word, HF_REQUIRED_OF_RADIO);
        hf_config_check_set(f, list, i, r->set);
        check_bounds(i, r, f);
        check_load_case(c, i, r, f);
        check_share(c, i, r, f);
        check_needs(c, i, r, f);
        check_against_earlier(c, i, f);
    }
}

void hf_config_complete_requirements(hf_case *c)
{
    char key[HF_KEY_SIZE], location[HF_LOCATION_SIZE];
    for (int i = 0; i < c->n_requirement; i++) {
        hf_requirement_settings *r = &c->requirement[i];
        if (isfinite(r->within[0])) r->at_least = r->within[0];
        if (isfinite(r->within[1])) r->at_most = r->within[1];
        if (!hf_required_is_of(r->figure, HF_REQUIRED_OF_RADIO)) continue;
        r->frequency_Hz = frequency_of(c, r);
        snprintf(key, sizeof key, "%s.%d.feed", list, i);
        if (r->figure == HF_REQUIRED_POINTING && !hf_config_location(c, key, location, sizeof location))
            r->feed = HF_FIXED;
    }
}

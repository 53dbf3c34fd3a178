/* poison - fills a workspace with garbage, because its content between calls has no meaning. If a call reads stale
 * contents, its result shows this. Header only, like nets.h. */
#pragma once

#include <hifdm/workspace.h>
#include <string.h>

/* Sets every floating-point field to NaN and every byte of the other fields to 0xff. */
static inline void poison_workspace(const hf_model *m, hf_workspace *w)
{
/* In IEEE 754 all bits set are a NaN; in an integer they are an index or a law that no check accepts. */
#define POISON(type, name, count, unit, meaning) memset(w->name, 0xff, (size_t)(count) * sizeof(type));
    HF_WORKSPACE_FIELDS(POISON)
#undef POISON
}

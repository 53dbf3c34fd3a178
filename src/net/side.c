#include "net/side.h"

int hf_side_compare_nodes(const void *a, const void *b)
{
    const hf_side *p = a, *q = b;
    return p->from != q->from ? (p->from > q->from) - (p->from < q->from) : (p->to > q->to) - (p->to < q->to);
}

int hf_side_compare(const void *a, const void *b)
{
    const hf_side *p = a, *q = b;
    int order = hf_side_compare_nodes(a, b);
    return order ? order : (p->of > q->of) - (p->of < q->of);
}

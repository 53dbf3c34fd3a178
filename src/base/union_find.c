#include "base/union_find.h"

int hf_union_find_root(int *parent, int i)
{
    while (parent[i] != i)
        i = parent[i] = parent[parent[i]];
    return i;
}

void hf_union_find_join(int *parent, int a, int b)
{
    int root_a = hf_union_find_root(parent, a), root_b = hf_union_find_root(parent, b);
    parent[root_a > root_b ? root_a : root_b] = root_a < root_b ? root_a : root_b;
}

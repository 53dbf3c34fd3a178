/* union_find - a partition of numbers into classes that are joined pair by pair. */
#pragma once

/* Returns the root of the class of i. Two numbers are in the same class if their roots are equal. parent[n] starts with
 * parent[i] = i. The search makes every second node on its way point to its grandparent (path halving), so that later
 * searches are shorter. */
int hf_union_find_root(int *parent, int i);

/* Joins the classes of a and b. The smaller root remains, so that a root is the smallest member of its class. */
void hf_union_find_join(int *parent, int a, int b);

/* reference - nets of tests/verify/data. Header only, like nets.h. */
#pragma once

#include "nets.h"

/* Opens the net NAME_nodes.csv, NAME_cables.csv. form: keys of the section form. */
static inline void open_reference(struct net *net, const char *name, const char *form)
{
    char path[2][128], text[512], nodes[1024], cables[1024];
    snprintf(path[0], sizeof path[0], "tests/verify/data/%s_nodes.csv", name);
    snprintf(path[1], sizeof path[1], "tests/verify/data/%s_cables.csv", name);
    snprintf(nodes, sizeof nodes, "scene.import.nodes=%s", source_path(path[0]));
    snprintf(cables, sizeof cables, "scene.import.cables=%s", source_path(path[1]));
    snprintf(text, sizeof text, "title: %s\nform: {%s}\n", name, form);
    write_file(temp_path("case.yaml"), text);
    open_case_file(net, temp_path("case.yaml"), (const char *const[]){nodes, cables}, 2);
}

/* path - names of files as text, and whether two names lead to the same file.
 *
 * The name of a path is what follows its last slash. The ending of a name begins at its last dot; a dot at the very
 * beginning starts a hidden file and no ending. */
#ifndef HIFDM_PATH_H
#define HIFDM_PATH_H

#include <stdbool.h>
#include <stddef.h>
#include <sys/stat.h>

/* A path that lost part of itself to a buffer of `size` bytes must not be used: functions that write a path return
 * false then. */

const char *hf_path_name(const char *path);   /* points into `path` */
const char *hf_path_ending(const char *path); /* ".h5"; points at the final NUL when there is none */

/* Bytes of `path` up to and including its last slash, 0 without a slash: "%.*s" of them is the folder as a prefix. */
int hf_path_prefix_length(const char *path);

/* The folder that `path` is in, as a path of its own: "." without a slash, "/" for the root. */
bool hf_path_folder(const char *path, char *folder, size_t size);

/* What a file calls `name`: relative to that file's folder, unless absolute. */
bool hf_path_beside(const char *file, const char *name, char *path, size_t size);

/* `given` when it is not NULL; else the name of `source` with another ending, in the current folder. */
bool hf_path_choose(const char *given, const char *source, const char *ending, char *path, size_t size);

/* `part` between stem and ending: table.csv and "_nodes" make table_nodes.csv. */
bool hf_path_insert(const char *path, const char *part, char *longer, size_t size);

/* Do both names lead to one file that exists? Links are followed. The second also has -1 and errno: the system cannot
 * tell. */
bool hf_path_is_same(const char *a, const char *b);
int hf_path_compare(const char *a, const char *b);
/* Would both names lead to one file, if it existed? Same name in the same folder, however that is spelt. */
bool hf_path_will_be_same(const char *a, const char *b);
/* Looks at what `path` leads to, and at the link itself. 1: it is there. 0: nothing is there. -1 and errno: the system
 * cannot tell, so nothing may be written there. */
int hf_path_look(const char *path, struct stat *info);
int hf_path_look_at_link(const char *path, struct stat *info);

bool hf_path_is_same_inode(const struct stat *a, const struct stat *b);

/* Is the open file still the one that `path` leads to? */
bool hf_path_leads_to(const char *path, int file);

#endif

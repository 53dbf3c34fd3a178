/* path - file names as text, and whether two names lead to the same file.
 *
 * The name of a path is the part after its last slash. The ending of a name begins at its last dot. A dot at the start
 * of a name marks a hidden file and begins no ending. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <sys/stat.h>

/* Functions that write a path return false if the buffer of `size` bytes is too small. The truncated path must
 * not be used. */

const char *hf_path_name(const char *path);   /* points into `path` */
const char *hf_path_ending(const char *path); /* ".h5", for example; points to the final NUL if there is no ending */

/* Returns the number of bytes of `path` up to and including its last slash; 0 without a slash. Printed with "%.*s",
 * these bytes are the folder as a prefix. */
int hf_path_prefix_length(const char *path);

/* Writes the folder of `path` as a path: "." without a slash, "/" for the root. */
bool hf_path_folder(const char *path, char *folder, size_t size);

/* Writes the path of the file that `file` refers to as `name`: relative to the folder of `file`, unless
 * `name` is absolute. */
bool hf_path_beside(const char *file, const char *name, char *path, size_t size);

/* Writes `given` if it is not NULL. Otherwise writes the name of `source` with another ending, in
 * the current folder. */
bool hf_path_choose(const char *given, const char *source, const char *ending, char *path, size_t size);

/* Writes `path` with `part` inserted before the ending: table.csv and "_nodes" become table_nodes.csv. */
bool hf_path_insert(const char *path, const char *part, char *longer, size_t size);

/* Returns 1 if both names lead to the same existing file, following links, and 0 if not. Returns -1 with errno if the
 * system cannot answer. */
int hf_path_compare(const char *a, const char *b);
/* Returns true if both names would lead to the same file once it exists: equal names in the same folder. The folder may
 * be spelt in two ways. */
bool hf_path_will_be_same(const char *a, const char *b);
/* Examine the file that `path` leads to, or the link itself. Return 1 if it exists, 0 if not. Return -1 with errno if
 * the system cannot answer; the caller must not write there. */
int hf_path_look(const char *path, struct stat *info);
int hf_path_look_at_link(const char *path, struct stat *info);

bool hf_path_is_same_inode(const struct stat *a, const struct stat *b);

/* Returns true if the open file is still the file that `path` leads to. */
bool hf_path_leads_to(const char *path, int file);

#include "base/path.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>

const char *hf_path_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

const char *hf_path_ending(const char *path)
{
    const char *name = hf_path_name(path), *dot = strrchr(name, '.');
    return dot && dot != name ? dot : path + strlen(path);
}

int hf_path_prefix_length(const char *path)
{
    return (int)(hf_path_name(path) - path);
}

static bool fits(int n, size_t size)
{
    return n >= 0 && (size_t)n < size;
}

bool hf_path_folder(const char *path, char *folder, size_t size)
{
    int n = hf_path_prefix_length(path);
    if (n > 1) n--; /* the root keeps its slash */
    return fits(snprintf(folder, size, "%.*s", n ? n : 1, n ? path : "."), size);
}

bool hf_path_beside(const char *file, const char *name, char *path, size_t size)
{
    int n = *name == '/' ? 0 : hf_path_prefix_length(file);
    return fits(snprintf(path, size, "%.*s%s", n, file, name), size);
}

bool hf_path_choose(const char *given, const char *source, const char *ending, char *path, size_t size)
{
    const char *name = hf_path_name(source);
    if (given) return fits(snprintf(path, size, "%s", given), size);
    const char *here = *name == '-' ? "./" : ""; /* so that no command takes the name for an option */
    return fits(snprintf(path, size, "%s%.*s%s", here, (int)(hf_path_ending(source) - name), name, ending), size);
}

bool hf_path_insert(const char *path, const char *part, char *longer, size_t size)
{
    const char *ending = hf_path_ending(path);
    return fits(snprintf(longer, size, "%.*s%s%s", (int)(ending - path), path, part, ending), size);
}

static int judge(int failed)
{
    if (!failed) return 1;
    return errno == ENOENT || errno == ENOTDIR || errno == ELOOP || errno == ENAMETOOLONG ? 0 : -1;
}

int hf_path_look(const char *path, struct stat *info)
{
    return judge(stat(path, info));
}

int hf_path_look_at_link(const char *path, struct stat *info)
{
    return judge(lstat(path, info));
}

bool hf_path_is_same_inode(const struct stat *a, const struct stat *b)
{
    return a->st_dev == b->st_dev && a->st_ino == b->st_ino;
}

int hf_path_compare(const char *a, const char *b)
{
    struct stat of_a, of_b;
    int seen = hf_path_look(a, &of_a);
    if (seen > 0) seen = hf_path_look(b, &of_b);
    return seen > 0 ? hf_path_is_same_inode(&of_a, &of_b) : seen;
}

bool hf_path_will_be_same(const char *a, const char *b)
{
    char of_a[PATH_MAX], of_b[PATH_MAX];
    if (!strcmp(a, b)) return true;
    return !strcmp(hf_path_name(a), hf_path_name(b)) && hf_path_folder(a, of_a, sizeof of_a) &&
           hf_path_folder(b, of_b, sizeof of_b) && hf_path_compare(of_a, of_b) > 0;
}

bool hf_path_leads_to(const char *path, int file)
{
    struct stat of_file, of_path;
    return fstat(file, &of_file) == 0 && stat(path, &of_path) == 0 && hf_path_is_same_inode(&of_file, &of_path);
}

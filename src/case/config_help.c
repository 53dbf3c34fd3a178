#include "case/config_key.h"

#include <fnmatch.h>
#include <stdio.h>
#include <string.h>

const char *hf_config_help(const char *path, const char *key)
{
    char whole[HF_KEY_SIZE];
    snprintf(whole, sizeof whole, "%s%s%s", path, key ? "." : "", key ? key : "");
    for (const char *pattern = hf_config_help_text, *help; *pattern; pattern = help + strlen(help) + 1) {
        help = pattern + strlen(pattern) + 1;
        if (fnmatch(pattern, whole, 0) == 0) return help;
    }
    return "";
}

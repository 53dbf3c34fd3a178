/* config_meant - what somebody means by a key that other programs have: by sense, where a guess by spelling would name
 * something else. */
#ifndef HIFDM_CONFIG_MEANT_H
#define HIFDM_CONFIG_MEANT_H

/* The key of ours, and where there are several what each is for, as words behind "did you mean "; NULL for a key that
 * nobody is known to use. section: "" of a key at the top. Capitals and "_" do not count. A row of a list, as
 * "optimize.goals.0", has no key of the section that it is in. */
const char *hf_config_meant(const char *section, const char *key);

#endif

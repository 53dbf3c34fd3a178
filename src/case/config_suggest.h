/* config_suggest - suggests our key for a key that other programs use. It compares meanings, because the key with the
 * nearest spelling would be another one. */
#pragma once

/* Returns the suggestion as words after "did you mean ", or NULL if the key is not known. If there are several keys,
 * the words say what each is for. `section` is "" for a key at the top level. Upper case and "_" make no difference. In
 * a row of a list, such as "optimize.objective.0", the suggestions of its section are not used. */
const char *hf_config_suggestion(const char *section, const char *key);

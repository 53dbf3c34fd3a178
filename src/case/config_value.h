/* config_value - reads one value of a case file and checks it against its row of the table. */
#pragma once

#include "case/config_fault.h"

#include <yaml.h>

/* Sets *to, of the type of `field`, from a node of the document, or reports the fault. field->path is the key in
 * messages. Relative paths of files in the case start from the folder of case_path. */
void hf_config_value(hf_config_faults *faults, yaml_document_t *document, const yaml_node_t *node,
                     const hf_field *field, const char *case_path, void *to);

/* Returns the text of a scalar, and "" for a list or a section. */
static inline const char *hf_config_text(const yaml_node_t *node)
{
    return node->type == YAML_SCALAR_NODE ? (const char *)node->data.scalar.value : "";
}

/* Returns the key of the mapping that is the same as the key of `pair` and before it, or NULL. */
const yaml_node_t *hf_config_earlier_key(yaml_document_t *document, const yaml_node_t *mapping,
                                         const yaml_node_pair_t *pair);

/* Returns true if the text is a number within the range of a key of one number. Also returns false for values that only
 * hf_config_value can check. */
bool hf_config_is_in_range(const hf_field *field, const char *text);

/* Writes the range of a key: "must be above 0, not ", "must be at least 1 and at most 5, not ". */
#define HF_CONFIG_RANGE_SIZE 160
void hf_config_range_words(const hf_field *field, char words[HF_CONFIG_RANGE_SIZE]);

/* Sets *to to the value of a key in a row that is not given and has no default. */
void hf_config_no_value(const hf_field *field, void *to);

/* config_value - one value of a case file, checked against its row of the table. */
#ifndef HIFDM_CONFIG_VALUE_H
#define HIFDM_CONFIG_VALUE_H

#include "case/config_fault.h"

#include <yaml.h>

/* Set *to, of the type of `field`, from a node of the document, or report why not; field->path is the key in messages.
 * Paths of files that the case itself names lead from the folder of case_path. */
void hf_config_value(hf_config_faults *faults, yaml_document_t *document, const yaml_node_t *node,
                     const hf_field *field, const char *case_path, void *to);

/* Is the text a number of a key of one number, within its range? False also for what only hf_config_value can judge. */
bool hf_config_is_in_range(const hf_field *field, const char *text);

/* "must be above 0, not ", "must be at least 1 and at most 5, not " */
#define HF_CONFIG_RANGE_SIZE 160
void hf_config_range_words(const hf_field *field, char words[HF_CONFIG_RANGE_SIZE]);

/* Set *to to what a row has where its key is not given and has no default. */
void hf_config_no_value(const hf_field *field, void *to);

#endif

/* config_value - one value of a case file, checked against its row of the table. */
#ifndef HIFDM_CONFIG_VALUE_H
#define HIFDM_CONFIG_VALUE_H

#include "case/config_fault.h"

#include <yaml.h>

/* Set *to, of the type of `field`, from a node of the document, or report why not; field->path is the key in messages.
 * Paths of files that the case itself names lead from the folder of case_path. */
void hf_config_value(hf_config_faults *faults, yaml_document_t *document, const yaml_node_t *node,
                     const hf_field *field, const char *case_path, void *to);

/* Set *to to what a row has where its key is not given and has no default. */
void hf_config_no_value(const hf_field *field, void *to);

#endif

/* `hifdm version` prints the version of the program. */
#include "app/cmd.h"

#include <hifdm/store.h>

static hf_status command_version(const hf_options *o, FILE *file, hf_messages *messages)
{
    (void)o;
    (void)messages;
    fprintf(file, "hifdm %s\n", hf_store_version());
    return HF_OK;
}

const hf_command hf_cmd_version = {.name = "version", .help = "print the version", .run = command_version};

/* The table of all commands. */
#include "app/cmd.h"

#define ROW(name) &hf_cmd_##name,
const hf_command *const hf_command_table[HF_N_COMMAND] = {HF_COMMANDS(ROW)};
#undef ROW

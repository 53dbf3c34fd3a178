/* The table of all exporters. */
#include "out/export.h"

#define ROW(name) &hf_exporter_##name,
const hf_exporter *const hf_exporter_table[HF_N_EXPORTER] = {HF_EXPORTERS(ROW)};
#undef ROW

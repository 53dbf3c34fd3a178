#include <hifdm/result.h>

const char *hf_stop_reason_word(int reason)
{
    switch (reason) {
#define WORD(name, value, word)                                                                                        \
    case HF_STOPPED_##name:                                                                                            \
        return word;
        HF_STOP_REASON_LIST(WORD)
#undef WORD
    }
    return "unknown";
}

const char *hf_coupling_stop_word(int stop)
{
    switch (stop) {
#define WORD(name, value, word)                                                                                        \
    case HF_COUPLING_##name:                                                                                           \
        return word;
        HF_COUPLING_STOP_LIST(WORD)
#undef WORD
    }
    return "unknown";
}

/* api - macros that mark what the shared library exports.
 * Stability: stable.
 *
 * Each public header declares its functions and variables between HF_API_BEGIN and HF_API_END. The declared functions
 * and variables have C linkage, and libhifdm.so exports them. The library is compiled with -fvisibility=hidden. Symbols
 * without a declaration in a public header are therefore hidden. The command `make abi` compares the symbols that the
 * library exports with the symbols that the headers declare. */
#pragma once

#ifdef __cplusplus
#define HF_API_LINKAGE_BEGIN extern "C" {
#define HF_API_LINKAGE_END }
#else
#define HF_API_LINKAGE_BEGIN
#define HF_API_LINKAGE_END
#endif

#define HF_API_BEGIN HF_API_LINKAGE_BEGIN _Pragma("GCC visibility push(default)")
#define HF_API_END _Pragma("GCC visibility pop") HF_API_LINKAGE_END

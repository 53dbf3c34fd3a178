/* sha256 - the digest (FIPS 180-4) that links a result file to its case. None of the libraries that we use has one. */
#pragma once

#include <stddef.h>

/* Writes the digest of the `length` bytes at `data` as 64 lower-case hexadecimal digits and a NUL. */
void hf_sha256(const void *data, size_t length, char hex[65]);

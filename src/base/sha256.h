/* sha256 - the digest (FIPS 180-4) that ties a result file to its case. None of the libraries we use offers one. */
#ifndef HIFDM_SHA256_H
#define HIFDM_SHA256_H

#include <stddef.h>

/* 64 lower-case hexadecimal digits and a NUL of the `length` bytes at `data`. */
void hf_sha256(const void *data, size_t length, char hex[65]);

#endif

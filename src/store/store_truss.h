/* store_truss - writing and reading of /truss, as <hifdm/store.h> declares it. */
#ifndef HIFDM_STORE_TRUSS_H
#define HIFDM_STORE_TRUSS_H

#include <hifdm/store.h>

#endif

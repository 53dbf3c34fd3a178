/* store_read - the reading half of what <hifdm/store.h> declares. */
#ifndef HIFDM_STORE_READ_H
#define HIFDM_STORE_READ_H

#include <hifdm/store.h>

#endif

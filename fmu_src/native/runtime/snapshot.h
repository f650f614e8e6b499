/* States of the FMU outside of an instance, and as bytes. */
#ifndef JOINTFMU_SNAPSHOT_H
#define JOINTFMU_SNAPSHOT_H

#include "instance.h"

Status state_save(const Instance *m, const char *function, void **saved);
Status state_restore(Instance *m, const char *function, const void *saved);
Status state_free(const Instance *m, const char *function, void **saved);
Status state_size(const Instance *m, const char *function, const void *saved, size_t *size);
Status state_write(const Instance *m, const char *function, const void *saved, void *bytes, size_t size);
Status state_read(const Instance *m, const char *function, const void *bytes, size_t size, void **saved);

#endif

/* Writes members of a struct as attributes, and reads them back. */
#include "store/hdf5.h"

#include <assert.h>
#include <math.h>
#include <string.h>

int hf_hdf5_int_value(const hf_hdf5_member *m, const void *owner)
{
    const char *member = (const char *)owner + m->offset;
    int value;
    if (m->size == sizeof(bool)) return *(const bool *)member;
    assert(m->size == sizeof value);
    memcpy(&value, member, sizeof value);
    return value;
}

void hf_hdf5_set_int_value(const hf_hdf5_member *m, int value, void *owner)
{
    char *member = (char *)owner + m->offset;
    if (m->size == sizeof(bool))
        *(bool *)member = value != 0;
    else
        memcpy(member, &value, sizeof value);
}

void hf_hdf5_put_members(hf_hdf5 *io, const char *object, const hf_hdf5_member *table, int n, const void *owner)
{
    for (const hf_hdf5_member *m = table; m < table + n; m++) {
        const char *member = (const char *)owner + m->offset;
        if (m->kind == HF_KIND_CHARS) {
            hf_hdf5_put_chars(io, io->file, m->object ? m->object : object, m->name, member);
        } else if (m->kind->class == HF_HDF5_ENUM) {
            signed char value = (signed char)hf_hdf5_int_value(m, owner);
            hf_hdf5_put(io, io->file, m->object ? m->object : object, m->name, m->kind, 0, &value);
        } else if (m->kind == HF_KIND_INT) {
            int value = hf_hdf5_int_value(m, owner);
            hf_hdf5_put(io, io->file, m->object ? m->object : object, m->name, m->kind, 0, &value);
        } else {
            assert(m->size == hf_hdf5_kind_bytes(m->kind));
            hf_hdf5_put(io, io->file, m->object ? m->object : object, m->name, m->kind, 0, member);
        }
    }
}

/* Returns true if the file is of another version that did not have this attribute yet. */
static bool is_newer_than_file(hf_hdf5 *io, const char *object, const char *name)
{
    return *io->made_by && hf_hdf5_has(io, io->file, object) && !hf_hdf5_has_attribute(io, io->file, object, name);
}

static void set_unknown(const hf_hdf5_member *m, void *owner)
{
    memset((char *)owner + m->offset, 0, m->size);
    if (m->kind == HF_KIND_REAL) *(double *)(void *)((char *)owner + m->offset) = (double)NAN;
}

void hf_hdf5_get_members(hf_hdf5 *io, const char *object, const hf_hdf5_member *table, int n, void *owner)
{
    for (const hf_hdf5_member *m = table; m < table + n; m++) {
        signed char byte = 0;
        int value = 0;
        if (is_newer_than_file(io, m->object ? m->object : object, m->name)) {
            set_unknown(m, owner);
        } else if (m->kind->class == HF_HDF5_ENUM) {
            hf_hdf5_get(io, io->file, m->object ? m->object : object, m->name, m->kind, &byte, 1);
            hf_hdf5_set_int_value(m, byte, owner);
        } else if (m->kind == HF_KIND_INT) {
            hf_hdf5_get(io, io->file, m->object ? m->object : object, m->name, m->kind, &value, sizeof value);
            hf_hdf5_set_int_value(m, value, owner);
        } else {
            hf_hdf5_get(io, io->file, m->object ? m->object : object, m->name, m->kind, (char *)owner + m->offset,
                        m->size);
        }
    }
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Finds the format of a file from its bytes. The file's name is ignored: `x.OBJ` and a name without
// an ending are read like any other.
#pragma once

#include "mesh/mesh_builder.h"

typedef struct cau_mesh_format {
	cau_status (*read)(cau_mesh_builder *builder);
	const char *name;    // name of a format that is read
	const char *refusal; // otherwise: why the format is not read, and what to do
	bool text;           // a byte order mark may come first
} cau_mesh_format;

// Returns the format, or NULL if none is known. `bytes` must begin after any byte order mark.
const cau_mesh_format *cau_mesh_format_of(const unsigned char *bytes, size_t byte_count);

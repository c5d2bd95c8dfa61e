// SPDX-License-Identifier: GPL-3.0-or-later
// Which format a file's bytes are in. Names are not looked at: `x.OBJ` and a name without an ending
// are read like any other.
#pragma once

#include "mesh/mesh_builder.h"

typedef struct cau_mesh_format {
	cau_status (*read)(cau_mesh_builder *builder);
	const char *name;    // of a format that is read
	const char *refusal; // else why it is not read and what to do
	bool text;           // a byte order mark may come first
} cau_mesh_format;

// NULL: none that is known. The bytes begin behind a byte order mark.
const cau_mesh_format *cau_mesh_format_of(const unsigned char *bytes, size_t byte_count);

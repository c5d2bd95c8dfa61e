// SPDX-License-Identifier: GPL-3.0-or-later
// Any bytes as a surface or a segmentation. What becomes a solid is read back, and cleaning finds
// nothing to mend.
#include <stdlib.h>

#include "cautery/solid.h"
#include "fuzz/fuzz_target.h"
#include "mesh/mesh.h"

enum { VOXELS_BYTES = 1 << 16 }; // larger inputs only take time

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	cau_solid solid;
	cau_error error = {0};
	cau_solid_wish wish = {.file = "fuzz", .bytes = data, .byte_count = bytes};
	if (!bytes || bytes > VOXELS_BYTES)
		return 0;
	cau_status status = cau_solid_make(&wish, &solid, &error);
	if (!status) {
		cau_mesh mesh;
		cau_mesh_report report = {0};
		if (cau_mesh_read("solid", solid.bytes, solid.byte_count, &mesh, &report, &error))
			abort();
		if (mesh.tetrahedron_count < 1)
			abort();
		cau_mesh_finish(&mesh);
	} else if (!error.reason[0]) {
		abort();
	}
	cau_solid_finish(&solid);
	return 0;
}

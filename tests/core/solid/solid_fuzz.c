// SPDX-License-Identifier: GPL-3.0-or-later
// Reads any bytes as a segmentation, or as a surface that is turned outward. One input in 64 is
// made into a solid, which takes long, and the solid is read back.
#include <stdlib.h>

#include "cautery/solid.h"
#include "fuzz/fuzz_target.h"
#include "mesh/mesh.h"
#include "solid/mesher.h"

enum { MOST_BYTES = 1 << 16, ONE_IN = 64, TETRAHEDRA = 500 }; // larger limits only take time

static void demand(int promise)
{
	if (!promise)
		abort();
}

static void read_volume(const uint8_t *data, size_t bytes)
{
	cau_volume volume;
	cau_domain domain;
	cau_error error = {0};
	cau_status status = cau_volume_read(data, bytes, NULL, &volume, &error);
	demand(!status || error.reason[0]);
	if (!status) {
		cau_domain_of_volume(&volume, &domain);
		double middle[3];
		for (int c = 0; c < 3; c++)
			middle[c] = (domain.least[c] + domain.most[c]) / 2;
		int32_t label = domain.label_at(&domain, middle, NULL);
		demand(label >= 0 && label <= volume.label_count);
		for (int32_t k = 1; k <= volume.label_count; k++)
			demand(volume.label[k].voxel_count > 0);
	}
	cau_volume_finish(&volume);
}

static void read_surface(const uint8_t *data, size_t bytes)
{
	cau_mesh mesh;
	cau_domain domain;
	int32_t turned = 0;
	if (cau_mesh_read("fuzz", data, bytes, &mesh, NULL, NULL))
		return;
	if (!cau_mesh_clean(&mesh, NULL, NULL) && mesh.triangle_count &&
	    !cau_domain_of_surface(&mesh, &domain, &turned, NULL)) {
		int32_t label = domain.label_at(&domain, mesh.position, NULL);
		demand(label == 0 || label == 1);
		demand(turned >= 0 && turned <= mesh.triangle_count);
		cau_domain_finish(&domain);
	}
	cau_mesh_finish(&mesh);
}

static void make_solid(const uint8_t *data, size_t bytes)
{
	cau_solid solid;
	cau_mesh mesh;
	cau_error error = {0};
	cau_solid_wish wish = {
		.file = "fuzz", .bytes = data, .byte_count = bytes, .tetrahedra = TETRAHEDRA};
	cau_status status = cau_solid_make(&wish, &solid, &error);
	demand(!status || error.reason[0]);
	if (!status) {
		demand(!cau_mesh_read("solid", solid.bytes, solid.byte_count, &mesh, NULL, NULL));
		demand(mesh.tetrahedron_count > 0);
		cau_mesh_finish(&mesh);
	}
	cau_solid_finish(&solid);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	unsigned sum = 0;
	if (!bytes || bytes > MOST_BYTES)
		return 0;
	for (size_t i = 0; i < bytes; i++)
		sum = 31 * sum + data[i];
	if (cau_solid_is_volume(data, bytes))
		read_volume(data, bytes);
	else
		read_surface(data, bytes);
	if (sum % ONE_IN == 0)
		make_solid(data, bytes);
	return 0;
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Packs uploaded meshes into one block, which the store keeps with the session. For each mesh of
// source bytes, in the scene's order, the block has a u64 length and the bytes.
#include <stdlib.h>
#include <string.h>

#include "scenes/scenes.h"

static bool is_uploaded(const cau_mesh_def *mesh)
{
	return mesh->source == CAU_MESH_BYTES;
}

cau_status cau_meshes_pack(cau_scene_def *scene, void **meshes, size_t *bytes, cau_error *error)
{
	*meshes = NULL;
	*bytes = 0;
	for (int32_t i = 0; i < scene->mesh_count; i++)
		if (is_uploaded(&scene->meshes[i]))
			*bytes += sizeof(uint64_t) + scene->meshes[i].byte_count;
	if (!*bytes)
		return CAU_OK;
	char *block = malloc(*bytes), *at = block;
	if (!block)
		return cau_fail(error, CAU_NO_MEMORY, "", "no memory for the meshes");
	for (int32_t i = 0; i < scene->mesh_count; i++) {
		cau_mesh_def *mesh = &scene->meshes[i];
		if (!is_uploaded(mesh))
			continue;
		uint64_t length = mesh->byte_count;
		memcpy(at, &length, sizeof length);
		memcpy(at + sizeof length, mesh->bytes, mesh->byte_count);
		mesh->bytes = at + sizeof length;
		at += sizeof length + mesh->byte_count;
	}
	*meshes = block;
	return CAU_OK;
}

cau_status cau_meshes_unpack(cau_scene_def *scene, const void *meshes, size_t bytes,
                             cau_error *error)
{
	const char *at = meshes;
	size_t left = bytes;
	for (int32_t i = 0; i < scene->mesh_count; i++) {
		cau_mesh_def *mesh = &scene->meshes[i];
		uint64_t length = 0;
		if (!is_uploaded(mesh))
			continue;
		if (left >= sizeof length)
			memcpy(&length, at, sizeof length);
		if (left < sizeof length || length > left - sizeof length)
			return cau_fail(error, CAU_CORRUPT, "", "the stored meshes are cut short");
		mesh->bytes = at + sizeof length;
		mesh->byte_count = length;
		at += sizeof length + length;
		left -= sizeof length + length;
	}
	return left ? cau_fail(error, CAU_CORRUPT, "", "the stored meshes are too long") : CAU_OK;
}

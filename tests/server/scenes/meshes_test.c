// SPDX-License-Identifier: GPL-3.0-or-later
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "scenes/scenes.h"

static cau_scene_def *scene_with(const char *first, const char *second)
{
	cau_scene_def *scene = calloc(1, sizeof *scene);
	assert_non_null(scene);
	scene->mesh_count = 3;
	scene->meshes[0] = (cau_mesh_def){
		.source = CAU_MESH_BYTES, .bytes = first, .byte_count = first ? strlen(first) : 0};
	scene->meshes[1].source = CAU_MESH_SHEET;
	scene->meshes[2] = (cau_mesh_def){
		.source = CAU_MESH_BYTES, .bytes = second, .byte_count = second ? strlen(second) : 0};
	return scene;
}

static void meshes_travel_in_one_block(void **state)
{
	(void)state;
	void *block;
	size_t bytes;
	cau_scene_def *scene = scene_with("v 0 0 0", "f 1 2 3\n"), *read = scene_with(NULL, NULL);
	assert_int_equal(cau_meshes_pack(scene, &block, &bytes, NULL), CAU_OK);
	assert_int_equal(bytes, 2 * sizeof(uint64_t) + 7 + 8);
	assert_int_equal(cau_meshes_unpack(read, block, bytes, NULL), CAU_OK);
	assert_int_equal(read->meshes[0].byte_count, 7);
	assert_memory_equal(read->meshes[0].bytes, "v 0 0 0", 7);
	assert_memory_equal(read->meshes[2].bytes, "f 1 2 3\n", 8);
	assert_memory_equal(scene->meshes[2].bytes, "f 1 2 3\n", 8); // now it points into the block
	free(block);
	free(scene);
	free(read);
}

static void a_scene_without_uploads_has_no_block(void **state)
{
	(void)state;
	void *block;
	size_t bytes;
	cau_scene_def *scene = scene_with("a", "b");
	scene->meshes[0].source = scene->meshes[2].source = CAU_MESH_SLAB;
	assert_int_equal(cau_meshes_pack(scene, &block, &bytes, NULL), CAU_OK);
	assert_null(block);
	assert_int_equal(cau_meshes_unpack(scene, NULL, 0, NULL), CAU_OK);
	free(scene);
}

static void damaged_blocks_are_refused(void **state)
{
	(void)state;
	void *block;
	size_t bytes;
	uint64_t huge = UINT64_MAX;
	cau_scene_def *scene = scene_with("v 0 0 0", "f 1 2 3\n");
	assert_int_equal(cau_meshes_pack(scene, &block, &bytes, NULL), CAU_OK);
	for (size_t cut = 0; cut < bytes; cut++)
		assert_int_equal(cau_meshes_unpack(scene, block, cut, NULL), CAU_CORRUPT);
	memcpy(block, &huge, sizeof huge);
	assert_int_equal(cau_meshes_unpack(scene, block, bytes, NULL), CAU_CORRUPT);
	free(block);
	free(scene);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(meshes_travel_in_one_block),
		cmocka_unit_test(a_scene_without_uploads_has_no_block),
		cmocka_unit_test(damaged_blocks_are_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

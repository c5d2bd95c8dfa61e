// SPDX-License-Identifier: GPL-3.0-or-later
#include "cautery/topology_codec.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { SIDE = 20, VERTICES = SIDE * SIDE, FACES = 2 * (SIDE - 1) * (SIDE - 1) };

typedef struct fixture {
	cau_stream_def def;
	int32_t face[FACES * 3];
	uint8_t face_layer[FACES];
	float texture[FACES * 6];
	double rest[VERTICES * 3];
	cau_topology topology;
	uint8_t *scratch, *bytes;
	size_t capacity, byte_count;
} fixture;

static void fill_faces(fixture *made)
{
	for (int32_t f = 0; f < FACES; f++) {
		int32_t cell = f / 2, corner = cell / (SIDE - 1) * SIDE + cell % (SIDE - 1);
		const int32_t *turn =
			f % 2 ? (const int32_t[]){SIDE, 1, SIDE + 1} : (const int32_t[]){0, 1, SIDE};
		for (int i = 0; i < 3; i++) {
			made->face[3 * f + i] = corner + turn[i];
			int column = made->face[3 * f + i] % SIDE, row = made->face[3 * f + i] / SIDE;
			made->texture[6 * f + 2 * i] = 0.125f * (float)column;
			made->texture[6 * f + 2 * i + 1] = -0.25f * (float)row;
		}
		made->face_layer[f] = (uint8_t)(f / 300);
	}
}

static fixture *new_fixture(void)
{
	fixture *made = calloc(1, sizeof *made);
	made->def = cau_default_stream_def();
	made->def.session = 9;
	made->def.vertex_count = VERTICES;
	made->def.face_count = FACES;
	fill_faces(made);
	for (int v = 0; v < VERTICES; v++) {
		int column = v % SIDE, row = v / SIDE;
		made->rest[3 * v] = 0.002 * column;
		made->rest[3 * v + 1] = 0.002 * row;
		made->rest[3 * v + 2] = 0.001 * sin(v);
	}
	made->topology = (cau_topology){.face = made->face,
	                                .face_layer = made->face_layer,
	                                .texture = made->texture,
	                                .rest_position = made->rest};
	made->scratch = malloc(cau_topology_scratch_bytes(&made->def));
	made->capacity = cau_topology_bytes_max(&made->def);
	made->bytes = malloc(made->capacity);
	return made;
}

static void free_fixture(fixture *made)
{
	free(made->scratch);
	free(made->bytes);
	free(made);
}

static cau_status encode(fixture *of, cau_error *error)
{
	return cau_topology_encode(&of->def, 1, &of->topology, of->scratch, of->bytes, of->capacity,
	                           &of->byte_count, error);
}

typedef struct decoded {
	int32_t face[FACES * 3];
	uint8_t face_layer[FACES];
	float texture[FACES * 6];
	int32_t rest[VERTICES * 3];
} decoded;

static cau_status decode(fixture *of, size_t byte_count, decoded *to, bool *has_texture)
{
	cau_topology_arrays arrays = {to->face, to->face_layer, to->texture, to->rest, false};
	cau_status status =
		cau_topology_decode(&of->def, of->bytes, byte_count, of->scratch, &arrays, NULL);
	*has_texture = arrays.has_texture;
	return status;
}

static void test_round_trip(void **unused)
{
	(void)unused;
	fixture *of = new_fixture();
	decoded *to = malloc(sizeof *to);
	bool has_texture;
	assert_int_equal(encode(of, NULL), CAU_OK);
	assert_int_equal(decode(of, of->byte_count, to, &has_texture), CAU_OK);
	assert_true(has_texture);
	assert_memory_equal(to->face, of->face, sizeof of->face);
	assert_memory_equal(to->face_layer, of->face_layer, sizeof of->face_layer);
	assert_memory_equal(to->texture, of->texture, sizeof of->texture);
	for (int i = 0; i < 3 * VERTICES; i++)
		assert_int_equal(to->rest[i], lrint(of->rest[i] / of->def.step_m));
	free(to);
	free_fixture(of);
}

static void test_texture_may_be_absent(void **unused)
{
	(void)unused;
	fixture *of = new_fixture();
	decoded *to = malloc(sizeof *to);
	bool has_texture;
	of->topology.texture = NULL;
	assert_int_equal(encode(of, NULL), CAU_OK);
	assert_int_equal(decode(of, of->byte_count, to, &has_texture), CAU_OK);
	assert_false(has_texture);
	assert_true(to->texture[17] == 0.0f);
	free(to);
	free_fixture(of);
}

static void test_bad_faces_and_positions_are_refused(void **unused)
{
	(void)unused;
	fixture *of = new_fixture();
	cau_error error = {0};
	of->face[5] = VERTICES;
	assert_int_equal(encode(of, &error), CAU_BAD_VALUE);
	assert_string_equal(error.path, "face");
	of->face[5] = 0;
	of->rest[7] = NAN;
	assert_int_equal(encode(of, &error), CAU_NUMERICAL);
	free_fixture(of);
}

static void test_hostile_topology_is_refused(void **unused)
{
	(void)unused;
	fixture *of = new_fixture();
	decoded *to = malloc(sizeof *to);
	bool has_texture;
	assert_int_equal(encode(of, NULL), CAU_OK);
	for (size_t bytes = 0; bytes < of->byte_count; bytes += 7)
		assert_int_equal(decode(of, bytes, to, &has_texture), CAU_CORRUPT);
	assert_true(of->byte_count > 72); // larger than a header
	// + 1, because the analyzer does not know that the size is not 0
	uint8_t *whole = malloc(of->byte_count + 1);
	memcpy(whole, of->bytes, of->byte_count);
	srand(3);
	// If a damaged frame is accepted, its indices must be in range.
	for (int round = 0; round < 3000; round++) {
		for (int flips = 0; flips < 3; flips++)
			of->bytes[72 + (size_t)rand() % (of->byte_count - 72)] ^= (uint8_t)(1 << rand() % 8);
		if (decode(of, of->byte_count, to, &has_texture) == CAU_OK) {
			for (int i = 0; i < 3 * FACES; i++)
				assert_in_range(to->face[i], 0, VERTICES - 1);
		}
		memcpy(of->bytes, whole, of->byte_count);
	}
	of->def.session = 10;
	assert_int_equal(decode(of, of->byte_count, to, &has_texture), CAU_BAD_STATE);
	free(whole);
	free(to);
	free_fixture(of);
}

// With a known frame of another profile, epoch and step, the encoder writes the same bytes as
// without a known frame.
static void test_a_known_frame_is_used(void **unused)
{
	(void)unused;
	fixture *of = new_fixture(), *other = new_fixture();
	assert_int_equal(encode(of, NULL), CAU_OK);
	other->def.profile = 3;
	other->def.step_m *= 4;
	assert_int_equal(encode(other, NULL), CAU_OK);
	uint8_t *whole = malloc(other->byte_count);
	size_t whole_bytes = other->byte_count;
	memcpy(whole, other->bytes, whole_bytes);
	other->topology.known = of->bytes;
	other->topology.known_bytes = of->byte_count;
	other->face[0] = VERTICES; // must not be read
	assert_int_equal(encode(other, NULL), CAU_OK);
	assert_int_equal(other->byte_count, whole_bytes);
	assert_memory_equal(other->bytes, whole, whole_bytes);
	free(whole);
	free_fixture(of);
	free_fixture(other);
}

static void test_an_unfit_known_frame_is_refused(void **unused)
{
	(void)unused;
	fixture *of = new_fixture(), *other = new_fixture();
	assert_int_equal(encode(of, NULL), CAU_OK);
	other->topology.known = of->bytes;
	other->topology.known_bytes = of->byte_count - 4;
	assert_int_equal(encode(other, NULL), CAU_CORRUPT);
	other->topology.known_bytes = of->byte_count;
	other->def.face_count = 1;
	assert_int_equal(encode(other, NULL), CAU_LIMIT);
	other->def.face_count = of->def.face_count;
	other->def.session++;
	assert_int_equal(encode(other, NULL), CAU_BAD_STATE);
	free_fixture(of);
	free_fixture(other);
}

static void test_a_session_without_faces(void **unused)
{
	(void)unused;
	fixture *of = new_fixture();
	decoded *to = malloc(sizeof *to);
	bool has_texture;
	of->def.face_count = 0;
	assert_int_equal(encode(of, NULL), CAU_OK);
	assert_int_equal(decode(of, of->byte_count, to, &has_texture), CAU_OK);
	free(to);
	free_fixture(of);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_round_trip),
		cmocka_unit_test(test_texture_may_be_absent),
		cmocka_unit_test(test_bad_faces_and_positions_are_refused),
		cmocka_unit_test(test_hostile_topology_is_refused),
		cmocka_unit_test(test_a_known_frame_is_used),
		cmocka_unit_test(test_an_unfit_known_frame_is_refused),
		cmocka_unit_test(test_a_session_without_faces),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

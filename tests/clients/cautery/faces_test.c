// SPDX-License-Identifier: GPL-3.0-or-later
#include "cautery/progress.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

enum { FACES = 40 }; // number of faces: the mask has two words, of which the second is not full

static void faces_are_counted_against_the_first_state(void **state)
{
	(void)state;
	cli_faces faces = {0};
	uint32_t mask[2] = {0x0000000f, 0};
	cau_stream_state s = {.synced = true, .epoch = 1, .face_mask = mask};
	assert_int_equal(cli_faces_count(&faces, &s, FACES), CAU_OK);
	assert_int_equal(faces.drawn, 36);
	assert_int_equal(faces.gone, 0);
	// Faces 4 to 11 and 39 disappear, and face 3 appears.
	mask[0] = 0x00000ff7;
	mask[1] = 0x00000080;
	assert_int_equal(cli_faces_count(&faces, &s, FACES), CAU_OK);
	assert_int_equal(faces.drawn, 28);
	assert_int_equal(faces.gone, 9);
	assert_int_equal(faces.bared, 1);
	s.epoch = 2; // a new epoch after a rewind: counting starts again
	assert_int_equal(cli_faces_count(&faces, &s, FACES), CAU_OK);
	assert_int_equal(faces.drawn, 28);
	assert_int_equal(faces.gone, 0);
	assert_int_equal(faces.bared, 0);
	cli_faces_finish(&faces);
}

static void nothing_is_counted_before_a_key_frame(void **state)
{
	(void)state;
	cli_faces faces = {0};
	cau_stream_state s = {.synced = false};
	assert_int_equal(cli_faces_count(&faces, &s, FACES), CAU_OK);
	assert_int_equal(faces.drawn, 0);
	assert_null(faces.first);
	cli_faces_finish(&faces);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(faces_are_counted_against_the_first_state),
		cmocka_unit_test(nothing_is_counted_before_a_key_frame),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

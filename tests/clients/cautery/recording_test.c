// SPDX-License-Identifier: GPL-3.0-or-later
#include "cautery/recording.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static char file_name[64];

static int make_name(void **state)
{
	(void)state;
	strcpy(file_name, "/tmp/cautery-recording-XXXXXX");
	int descriptor = mkstemp(file_name);
	return descriptor < 0 || close(descriptor);
}

static int remove_file(void **state)
{
	(void)state;
	return remove(file_name);
}

static const cau_wire_stream_description description = {.session = "t1-square",
                                                        .session_number = 5,
                                                        .epoch = 0xfedcba9876543210u,
                                                        .rate_hz = 60,
                                                        .channels = 3,
                                                        .vertex_count = 4,
                                                        .face_count = 2,
                                                        .origin_m = {0.1, -0.2, 1.0 / 3},
                                                        .step_m = 5e-5,
                                                        .stress_step_pa = 10};

static void write_recording(void)
{
	cli_recording recording;
	cau_error error = {0};
	assert_int_equal(cli_recording_create(&recording, file_name, &error), CAU_OK);
	assert_int_equal(cli_recording_describe(&recording, &description, &error), CAU_OK);
	assert_int_equal(cli_recording_frame(&recording, 1.5, "frame", 5, &error), CAU_OK);
	assert_int_equal(cli_recording_frame(&recording, 2.0, "another one", 11, &error), CAU_OK);
	assert_int_equal(recording.frames, 2);
	assert_int_equal(cli_recording_close(&recording, &error), CAU_OK);
	assert_int_equal(cli_recording_close(&recording, &error), CAU_OK);
}

static void what_was_recorded_comes_back(void **state)
{
	(void)state;
	cli_recording recording;
	cau_error error = {0};
	uint32_t kind, bytes;
	cau_wire_stream_description read = {0};
	write_recording();
	assert_int_equal(cli_recording_open(&recording, file_name, &error), CAU_OK);
	assert_int_equal(cli_recording_next(&recording, &kind, &bytes, &error), CAU_OK);
	assert_int_equal(kind, CLI_RECORD_DESCRIPTION);
	assert_int_equal(cli_recording_read_description(&recording, bytes, &read, &error), CAU_OK);
	assert_string_equal(read.session, description.session);
	assert_true(read.epoch == description.epoch);
	assert_memory_equal(read.origin_m, description.origin_m, sizeof read.origin_m);
	assert_int_equal(read.vertex_count, 4);
	assert_int_equal(cli_recording_next(&recording, &kind, &bytes, &error), CAU_OK);
	assert_int_equal(kind, CLI_RECORD_FRAME);
	assert_int_equal(bytes, 5);
	assert_memory_equal(recording.buffer, "frame", 5);
	assert_int_equal(recording.received_us, 1500000);
	assert_int_equal(cli_recording_next(&recording, &kind, &bytes, &error), CAU_OK);
	assert_memory_equal(recording.buffer, "another one", 11);
	assert_int_equal(cli_recording_next(&recording, &kind, &bytes, &error), CAU_OK);
	assert_int_equal(kind, 0);
	cli_recording_close(&recording, NULL);
}

// Reads the recording to its end or to the first error.
static cau_status read_all(void)
{
	cli_recording recording;
	cau_error error = {0};
	uint32_t kind = 1, bytes;
	cau_wire_stream_description read;
	cau_status status = cli_recording_open(&recording, file_name, &error);
	while (!status && kind) {
		status = cli_recording_next(&recording, &kind, &bytes, &error);
		if (!status && kind == CLI_RECORD_DESCRIPTION)
			status = cli_recording_read_description(&recording, bytes, &read, &error);
	}
	cli_recording_close(&recording, NULL);
	return status;
}

static void a_recording_cut_short_is_told(void **state)
{
	(void)state;
	write_recording();
	FILE *file = fopen(file_name, "rb");
	fseek(file, 0, SEEK_END);
	long whole = ftell(file);
	fclose(file);
	// positions where a record ends: after the magic, the description and each frame
	const long ends[] = {8, whole - 16 - 11 - 16 - 5, whole - 16 - 11, whole};
	for (long bytes = whole; bytes >= 0; bytes--) {
		bool at_end = false;
		for (size_t i = 0; i < sizeof ends / sizeof *ends; i++)
			at_end = at_end || bytes == ends[i];
		assert_int_equal(truncate(file_name, bytes), 0);
		cau_status status = read_all();
		if (status != (at_end ? CAU_OK : CAU_CORRUPT))
			fail_msg("cut to %ld bytes: %s", bytes, cau_status_name(status));
	}
}

static void damage_is_told(void **state)
{
	(void)state;
	const struct {
		long at;
		unsigned char byte;
	} cases[] = {
		{0, 'c'},   // the magic
		{8, 3},     // the kind of the first record
		{15, 0x7f}, // the length of the first record
		{24, '['},  // the text of the first record
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		write_recording();
		FILE *file = fopen(file_name, "r+b");
		fseek(file, cases[i].at, SEEK_SET);
		fputc(cases[i].byte, file);
		fclose(file);
		if (read_all() != CAU_CORRUPT)
			fail_msg("byte %ld: the damage is not noticed", cases[i].at);
	}
}

static void files_that_are_not_there(void **state)
{
	(void)state;
	cli_recording recording;
	cau_error error = {0};
	assert_int_equal(cli_recording_open(&recording, "/nowhere/at/all", &error), CAU_IO);
	assert_string_equal(error.file, "/nowhere/at/all");
	assert_int_equal(cli_recording_create(&recording, "/nowhere/at/all", &error), CAU_IO);
	assert_int_equal(cli_recording_close(&recording, &error), CAU_OK);
}

// A full disk is reported when the file is closed, at the latest.
static void a_full_disk_is_told(void **state)
{
	(void)state;
	cli_recording recording;
	cau_error error = {0};
	if (access("/dev/full", W_OK))
		skip();
	cau_status status = cli_recording_create(&recording, "/dev/full", &error);
	if (!status)
		status = cli_recording_frame(&recording, 0, "frame", 5, &error);
	cau_status closed = cli_recording_close(&recording, &error);
	assert_int_equal(status ? status : closed, CAU_IO);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(what_was_recorded_comes_back, make_name, remove_file),
		cmocka_unit_test_setup_teardown(a_recording_cut_short_is_told, make_name, remove_file),
		cmocka_unit_test_setup_teardown(damage_is_told, make_name, remove_file),
		cmocka_unit_test(files_that_are_not_there),
		cmocka_unit_test(a_full_disk_is_told),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Writes MCAP files and checks their records. tests/browser/page/mcap.test.ts reads such files with
// the format's own library.
#include "cautery/recording.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

enum { FILE_BYTES_MAX = 1 << 16, MESSAGES = 100 };

static char file_name[64];

static int make_name(void **state)
{
	(void)state;
	strcpy(file_name, "/tmp/cautery-mcap-XXXXXX");
	int descriptor = mkstemp(file_name);
	return descriptor < 0 || close(descriptor);
}

static int remove_file(void **state)
{
	(void)state;
	return remove(file_name);
}

static uint64_t get(const unsigned char *at, int bytes)
{
	uint64_t value = 0;
	for (int i = 0; i < bytes; i++)
		value |= (uint64_t)at[i] << 8 * i;
	return value;
}

static size_t read_file(unsigned char *bytes)
{
	FILE *file = fopen(file_name, "rb");
	assert_non_null(file);
	size_t count = fread(bytes, 1, FILE_BYTES_MAX, file);
	assert_int_equal(fclose(file), 0);
	return count;
}

// Counts records by opcode from `at` to the magic at the end. Each record must end where the next
// begins.
static void count_records(const unsigned char *bytes, size_t at, size_t end, int count[256])
{
	memset(count, 0, 256 * sizeof *count);
	while (at < end) {
		count[bytes[at]]++;
		at += 9 + get(bytes + at + 1, 8);
	}
	assert_int_equal(at, end);
}

static void every_message_is_found_through_the_summary(void **state)
{
	(void)state;
	static unsigned char bytes[FILE_BYTES_MAX];
	cli_mcap mcap;
	cau_error error = {0};
	int count[256];
	assert_int_equal(cli_mcap_create(&mcap, file_name, &error), CAU_OK);
	for (uint64_t i = 0; i < MESSAGES; i++)
		assert_int_equal(cli_mcap_message(&mcap, 1000 + i, "{\"n\":1}", 7, &error), CAU_OK);
	assert_int_equal(mcap.messages, MESSAGES);
	assert_int_equal(cli_mcap_close(&mcap, &error), CAU_OK);
	assert_int_equal(cli_mcap_close(&mcap, &error), CAU_OK);

	size_t size = read_file(bytes);
	assert_int_equal(size, mcap.bytes);
	assert_memory_equal(bytes, "\x89MCAP0\r\n", 8);
	assert_memory_equal(bytes + size - 8, "\x89MCAP0\r\n", 8);
	count_records(bytes, 8, size - 8, count);
	assert_int_equal(count[0x06], MESSAGES); // chunks
	assert_int_equal(count[0x07], MESSAGES); // message indices of the chunks
	assert_int_equal(count[0x08], MESSAGES); // chunk indices in the summary
	// the schema, before the messages and again in the summary
	assert_int_equal(count[0x03], 2);
	// the channel, before the messages and again in the summary
	assert_int_equal(count[0x04], 2);
	size_t summary = get(bytes + size - 8 - 20, 8);
	count_records(bytes, summary, size - 8, count);
	assert_int_equal(count[0x08], MESSAGES);
	assert_int_equal(count[0x0b], 1); // statistics
	assert_int_equal(count[0x02], 1); // the footer
}

static void an_empty_file_is_whole(void **state)
{
	(void)state;
	static unsigned char bytes[FILE_BYTES_MAX];
	cli_mcap mcap;
	cau_error error = {0};
	int count[256];
	assert_int_equal(cli_mcap_create(&mcap, file_name, &error), CAU_OK);
	assert_int_equal(cli_mcap_close(&mcap, &error), CAU_OK);
	count_records(bytes, 8, read_file(bytes) - 8, count);
	assert_int_equal(count[0x06], 0);
	assert_int_equal(count[0x02], 1);
}

static void a_full_disk_is_told(void **state)
{
	(void)state;
	cli_mcap mcap;
	cau_error error = {0};
	assert_int_equal(cli_mcap_create(&mcap, "/no/such/folder/file", &error), CAU_IO);
	assert_string_equal(error.file, "/no/such/folder/file");
	assert_int_equal(cli_mcap_close(&mcap, &error), CAU_OK);
	// Bytes that fit into the stream's buffer can fail only when the file is closed.
	cau_status status = cli_mcap_create(&mcap, "/dev/full", &error);
	for (int i = 0; i < MESSAGES && !status; i++)
		status = cli_mcap_message(&mcap, 1, "{}", 2, &error);
	assert_int_equal(status, CAU_IO);
	assert_int_equal(cli_mcap_close(&mcap, &error), CAU_IO);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(every_message_is_found_through_the_summary, make_name,
	                                    remove_file),
		cmocka_unit_test_setup_teardown(an_empty_file_is_whole, make_name, remove_file),
		cmocka_unit_test(a_full_disk_is_told),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

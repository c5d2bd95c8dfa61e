// SPDX-License-Identifier: GPL-3.0-or-later
#include "http/static_files.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

static void put(const char *folder, const char *name, const char *text, int repeat)
{
	char path[512];
	snprintf(path, sizeof path, "%s/%s", folder, name);
	FILE *stream = fopen(path, "w");
	assert_non_null(stream);
	for (int i = 0; i < repeat; i++)
		fputs(text, stream);
	fclose(stream);
}

static void without_a_folder_there_is_a_page(void **state)
{
	(void)state;
	cau_static_files *files;
	assert_int_equal(cau_static_files_load(&files, "viewer", "", NULL), CAU_OK);
	assert_non_null(cau_static_files_find(files, "/"));
	assert_ptr_equal(cau_static_files_find(files, "/"),
	                 cau_static_files_find(files, "/index.html"));
	assert_null(cau_static_files_find(files, "/other"));
	cau_static_files_destroy(files);
}

static void a_folder_is_read_whole(void **state)
{
	(void)state;
	char folder[] = "/tmp/cautery-files-XXXXXX", sub[64], link[64], command[128];
	cau_static_files *files;
	assert_non_null(mkdtemp(folder));
	snprintf(sub, sizeof sub, "%s/assets", folder);
	snprintf(link, sizeof link, "%s/link.txt", folder);
	assert_int_equal(mkdir(sub, 0700), 0);
	put(folder, "index.html", "<p>hello</p>", 1);
	put(folder, ".secret", "no", 1);
	put(sub, "a-1.js", "let a = 1;\n", 100);
	put(sub, "a-1.png", "a picture ", 100);
	assert_int_equal(symlink("/etc/passwd", link), 0);
	assert_int_equal(cau_static_files_load(&files, "viewer", folder, NULL), CAU_OK);
	const cau_static_file *page = cau_static_files_find(files, "/");
	assert_string_equal(page->content_type, "text/html; charset=utf-8");
	assert_null(page->gzip); // too small for compression to help
	assert_false(page->hashed);
	const cau_static_file *script = cau_static_files_find(files, "/assets/a-1.js");
	assert_true(script->hashed);
	assert_int_equal(script->plain_bytes, 1100);
	assert_true(script->gzip_bytes > 0 && script->gzip_bytes < 200);
	// the format is compressed already
	assert_null(cau_static_files_find(files, "/assets/a-1.png")->gzip);
	assert_null(cau_static_files_find(files, "/.secret"));
	assert_null(cau_static_files_find(files, "/link.txt"));
	assert_null(cau_static_files_find(files, "/assets"));
	cau_static_files_destroy(files);
	snprintf(command, sizeof command, "rm -r %s", folder);
	assert_int_equal(system(command), 0);
	assert_int_equal(cau_static_files_load(&files, "viewer", folder, NULL), CAU_IO);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(without_a_folder_there_is_a_page),
		cmocka_unit_test(a_folder_is_read_whole),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

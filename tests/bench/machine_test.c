// SPDX-License-Identifier: GPL-3.0-or-later
// Reads machines of several kinds from a folder with the files that their kernels provide.
#include "bench/machine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static char root[64];
static bench_machine machine;

static void put(const char *path, const char *text)
{
	char command[512], whole[256];
	snprintf(whole, sizeof whole, "%s%s", root, path);
	snprintf(command, sizeof command, "mkdir -p $(dirname %s)", whole);
	assert_int_equal(system(command), 0);
	FILE *file = fopen(whole, "w");
	assert_non_null(file);
	fputs(text, file);
	assert_int_equal(fclose(file), 0);
}

static void put_cache(int index, const char *level, const char *type, const char *size)
{
	char path[128];
	const char *const names[] = {"level", "type", "size"}, *const texts[] = {level, type, size};
	for (int i = 0; i < 3; i++) {
		snprintf(path, sizeof path, "/sys/devices/system/cpu/cpu0/cache/index%d/%s", index,
		         names[i]);
		put(path, texts[i]);
	}
}

static int set_up(void **state)
{
	(void)state;
	strcpy(root, "/tmp/cautery-machine-XXXXXX");
	return mkdtemp(root) ? 0 : -1;
}

static int tear_down(void **state)
{
	(void)state;
	char command[128];
	snprintf(command, sizeof command, "rm -r %s", root);
	return system(command);
}

static void x86_has_family_and_model(void **state)
{
	(void)state;
	put("/proc/cpuinfo",
	    "processor\t: 0\nvendor_id\t: AuthenticAMD\ncpu family\t: 25\nmodel\t\t: 17\n"
	    "model name\t: AMD EPYC\nstepping\t: 1\ncpu MHz\t\t: 2596.132\n\n"
	    "processor\t: 1\nvendor_id\t: Other\nmodel\t\t: 18\ncpu MHz\t\t: 800.0\n");
	put_cache(0, "1\n", "Data\n", "32K\n");
	put_cache(1, "1\n", "Instruction\n", "32K\n");
	put_cache(2, "2\n", "Unified\n", "1024K\n");
	put_cache(3, "3\n", "Unified\n", "32M\n");
	put("/sys/devices/system/cpu/cpu0/cpufreq/cpuinfo_max_freq", "3700000\n");
	bench_machine_read(root, &machine);
	assert_string_equal(machine.vendor, "AuthenticAMD");
	assert_string_equal(machine.name, "AMD EPYC");
	assert_int_equal(machine.family, 25);
	assert_int_equal(machine.model, 17);
	assert_int_equal(machine.stepping, 1);
	assert_true(machine.mhz_present == 2596.132 && machine.mhz_most == 3700);
	assert_int_equal(machine.cache_count, 4);
	assert_string_equal(machine.caches[0].name, "L1d");
	assert_string_equal(machine.caches[1].name, "L1i");
	assert_string_equal(machine.caches[3].name, "L3");
	assert_true(machine.caches[2].bytes == 1048576 && machine.caches[3].bytes == 33554432);
}

static void arm_has_implementer_and_part(void **state)
{
	(void)state;
	put("/proc/cpuinfo",
	    "processor\t: 0\nBogoMIPS\t: 243.75\nFeatures\t: fp asimd\nCPU implementer\t: 0x41\n"
	    "CPU architecture: 8\nCPU variant\t: 0x3\nCPU part\t: 0xd0c\nCPU revision\t: 1\n");
	bench_machine_read(root, &machine);
	assert_string_equal(machine.vendor, "0x41");
	assert_string_equal(machine.name, "");
	assert_int_equal(machine.family, 8);
	assert_int_equal(machine.model, 0xd0c);
	assert_int_equal(machine.stepping, 0x31);
	assert_true(machine.mhz_present == 0 && machine.mhz_most == 0);
	put("/proc/device-tree/model", "Some Board 4"); // without a line end
	bench_machine_read(root, &machine);
	assert_string_equal(machine.name, "Some Board 4");
}

static void what_is_not_told_is_unknown(void **state)
{
	(void)state;
	put("/proc/cpuinfo", ":\n::\nmodel\nmodel\t: unknown\ncpu family : -3\nstepping\t:\n");
	put_cache(0, "1\n", "Data\n", "\n");
	bench_machine_read(root, &machine);
	assert_int_equal(machine.family, -1);
	assert_int_equal(machine.model, -1);
	assert_int_equal(machine.stepping, -1);
	assert_int_equal(machine.cache_count, 0);
	assert_true(machine.cores >= 1);
	bench_cpu_time time;
	bench_cpu_time_read(root, &time);
	assert_true(time.total == 0 && time.steal == -1 && time.load == -1);
	bench_disturbance none = bench_disturbance_between(&time, &time, 100);
	assert_true(none.load_before == -1 && none.others == -1 && none.steal == -1);
}

static void a_folder_that_is_not_there_is_no_trouble(void **state)
{
	(void)state;
	bench_machine_read("/nowhere", &machine);
	assert_string_equal(machine.vendor, "");
	char *text = NULL;
	size_t bytes = 0;
	FILE *out = open_memstream(&text, &bytes);
	bench_disturbance none = {-1, -1, -1};
	machine.cores = 2;
	bench_machine_write_json(out, &machine, "baseline", &none);
	fclose(out);
	assert_string_equal(text, "\"machine\":{\"vendor\":null,\"name\":null,\"family\":null,"
	                          "\"model\":null,\"stepping\":null,\"mhz_most\":null,"
	                          "\"mhz_present\":null,\"cores\":2,\"caches\":{},"
	                          "\"load_before\":null,\"others\":null,\"steal\":null,"
	                          "\"instruction_set\":\"baseline\"}");
	free(text);
}

static void text_in_json_is_escaped(void **state)
{
	(void)state;
	put("/proc/cpuinfo", "model name\t: A \"B\" \\ C\tD\n");
	bench_machine_read(root, &machine);
	char *text = NULL;
	size_t bytes = 0;
	FILE *out = open_memstream(&text, &bytes);
	bench_machine_write_json(out, &machine, "avx2", &(bench_disturbance){0.5, 0.25, 0});
	fclose(out);
	assert_non_null(strstr(text, "\"name\":\"A \\\"B\\\" \\\\ C D\","));
	assert_non_null(strstr(text, "\"load_before\":0.5,\"others\":0.25,\"steal\":0,"));
	free(text);
}

static void others_and_steal_are_shares_of_all_cores(void **state)
{
	(void)state;
	bench_cpu_time before, after;
	put("/proc/loadavg", "0.75 0.50 0.25 1/100 1234\n");
	put("/proc/stat", "cpu  100 0 100 800 0 0 0 10 0 0\ncpu0 1 2 3\n");
	bench_cpu_time_read(root, &before);
	put("/proc/stat", "cpu  160 10 120 880 10 5 5 20 0 0\ncpu0 1 2 3\n");
	bench_cpu_time_read(root, &after);
	after.own_s = before.own_s + 0.5; // 0.5 s are half of the 100 busy ticks, at 100 ticks a second
	bench_disturbance d = bench_disturbance_between(&before, &after, 100);
	assert_true(d.load_before == 0.75);
	assert_float_equal(d.others, 50. / 200, 1e-12); // the tolerance is for rounding
	assert_float_equal(d.steal, 10. / 200, 1e-12);
	after.own_s = before.own_s + 1.01; // ticks are whole numbers, but the share is never below 0
	assert_true(bench_disturbance_between(&before, &after, 100).others == 0);
}

static void a_kernel_without_steal_says_nothing_of_it(void **state)
{
	(void)state;
	bench_cpu_time before, after;
	put("/proc/stat", "cpu 100 0 100 800\n");
	bench_cpu_time_read(root, &before);
	put("/proc/stat", "cpu 200 0 100 900\n");
	bench_cpu_time_read(root, &after);
	after.own_s = before.own_s;
	bench_disturbance d = bench_disturbance_between(&before, &after, 100);
	assert_true(d.steal == -1);
	assert_float_equal(d.others, 0.5, 1e-12); // the tolerance is for rounding
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(x86_has_family_and_model, set_up, tear_down),
		cmocka_unit_test_setup_teardown(arm_has_implementer_and_part, set_up, tear_down),
		cmocka_unit_test_setup_teardown(what_is_not_told_is_unknown, set_up, tear_down),
		cmocka_unit_test(a_folder_that_is_not_there_is_no_trouble),
		cmocka_unit_test_setup_teardown(text_in_json_is_escaped, set_up, tear_down),
		cmocka_unit_test_setup_teardown(others_and_steal_are_shares_of_all_cores, set_up,
	                                    tear_down),
		cmocka_unit_test_setup_teardown(a_kernel_without_steal_says_nothing_of_it, set_up,
	                                    tear_down),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

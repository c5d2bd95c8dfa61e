// SPDX-License-Identifier: GPL-3.0-or-later
// The content of /proc/cpuinfo depends on the processor: x86 has families and models, ARM has
// implementers and parts, and others have less. A missing line leaves its field unknown.
#include "bench/machine.h"

#include <ctype.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

// LINE_BYTES is large, because x86 lists its features in one line.
enum { PATH_BYTES = 512, LINE_BYTES = 8192 };

static FILE *open_under(const char *root, const char *path)
{
	char whole[PATH_BYTES];
	snprintf(whole, sizeof whole, "%s%s", root, path);
	return fopen(whole, "r");
}

// Reads the first line of a file without its line end. Returns false if there is none.
static bool read_first_line(const char *root, const char *path, char *line, size_t bytes)
{
	FILE *file = open_under(root, path);
	bool got = file && fgets(line, (int)bytes, file);
	if (file)
		fclose(file);
	if (got)
		line[strcspn(line, "\r\n")] = 0;
	return got && *line;
}

// ---- the processor

// Copies a text unless it is known already. So the first processor's line counts.
static void take_text(char *to, size_t bytes, const char *value)
{
	if (!*to)
		snprintf(to, bytes, "%.*s", (int)bytes - 1, value); // a longer text is cut
}

static void take_number(int *to, const char *value)
{
	char *end;
	long number = strtol(value, &end, 0); // ARM writes hexadecimal numbers like 0x41
	if (*to < 0 && end != value && number >= 0)
		*to = (int)number;
}

// ARM numbers that are combined into the stepping.
typedef struct arm_revision {
	int variant, revision;
} arm_revision;

static void take_line(bench_machine *m, arm_revision *arm, const char *key, const char *value)
{
	const struct {
		const char *key;
		char *text;
		size_t bytes;
		int *number;
	} known[] = {
		{"vendor_id", m->vendor, sizeof m->vendor, NULL},
		{"CPU implementer", m->vendor, sizeof m->vendor, NULL},
		{"cpu family", NULL, 0, &m->family},
		{"CPU architecture", NULL, 0, &m->family},
		{"model", NULL, 0, &m->model},
		{"CPU part", NULL, 0, &m->model},
		{"stepping", NULL, 0, &m->stepping},
		{"CPU variant", NULL, 0, &arm->variant},
		{"CPU revision", NULL, 0, &arm->revision},
		{"model name", m->name, sizeof m->name, NULL},
		{"Model", m->name, sizeof m->name, NULL},    // the name on boards
		{"Hardware", m->name, sizeof m->name, NULL}, // the name on older ARM kernels
		{"uarch", m->name, sizeof m->name, NULL},    // the name on RISC-V
		{"cpu", m->name, sizeof m->name, NULL},      // the name on POWER
	};
	for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
		if (strcmp(known[i].key, key) != 0)
			continue;
		else if (known[i].text)
			take_text(known[i].text, known[i].bytes, value);
		else
			take_number(known[i].number, value);
	bool clock = strcmp(key, "cpu MHz") == 0 || strcmp(key, "clock") == 0;
	if (clock && m->mhz_present == 0)
		m->mhz_present = strtod(value, NULL);
}

// Splits "key \t: value" in place. Returns false if the line has no colon.
static bool split(char *line, char **key, char **value)
{
	char *colon = strchr(line, ':');
	if (!colon)
		return false;
	*colon = 0;
	*key = line;
	*value = colon + 1 + strspn(colon + 1, " \t");
	(*value)[strcspn(*value, "\r\n")] = 0;
	while (colon > line && isspace((unsigned char)colon[-1]))
		*--colon = 0;
	return true;
}

static void read_processor(const char *root, bench_machine *m)
{
	char line[LINE_BYTES], *key, *value;
	arm_revision arm = {-1, -1};
	FILE *file = open_under(root, "/proc/cpuinfo");
	while (file && fgets(line, sizeof line, file))
		if (split(line, &key, &value))
			take_line(m, &arm, key, value);
	if (file)
		fclose(file);
	if (m->stepping < 0 && arm.variant >= 0 && arm.revision >= 0)
		m->stepping = 16 * arm.variant + arm.revision;
	if (!*m->name && read_first_line(root, "/proc/device-tree/model", line, sizeof line))
		take_text(m->name, sizeof m->name, line);
	// the file's number is in kHz
	const char most[] = "/sys/devices/system/cpu/cpu0/cpufreq/cpuinfo_max_freq";
	if (read_first_line(root, most, line, sizeof line))
		m->mhz_most = strtod(line, NULL) / 1e3;
}

static double read_bytes(const char *text)
{
	char *unit;
	double number = strtod(text, &unit);
	return *unit == 'K' ? number * 1024 : *unit == 'M' ? number * 1048576 : number;
}

static void read_caches(const char *root, bench_machine *m)
{
	char path[PATH_BYTES], level[16], type[32], size[32];
	for (int i = 0; i < BENCH_CACHES_MOST; i++) {
		const char folder[] = "/sys/devices/system/cpu/cpu0/cache/index";
		snprintf(path, sizeof path, "%s%d/level", folder, i);
		bool told = read_first_line(root, path, level, sizeof level);
		snprintf(path, sizeof path, "%s%d/type", folder, i);
		told = told && read_first_line(root, path, type, sizeof type);
		snprintf(path, sizeof path, "%s%d/size", folder, i);
		told = told && read_first_line(root, path, size, sizeof size);
		if (!told || read_bytes(size) <= 0)
			continue;
		const char *kind = *type == 'D' ? "d" : *type == 'I' ? "i" : ""; // "Data" or "Instruction"
		snprintf(m->caches[m->cache_count].name, sizeof m->caches[0].name, "L%.3s%s", level, kind);
		m->caches[m->cache_count++].bytes = read_bytes(size);
	}
}

void bench_machine_read(const char *root, bench_machine *machine)
{
	long cores = sysconf(_SC_NPROCESSORS_ONLN);
	*machine = (bench_machine){.family = -1, .model = -1, .stepping = -1};
	machine->cores = cores > 0 ? (int)cores : 1;
	read_processor(root, machine);
	read_caches(root, machine);
}

// ---- other load

void bench_cpu_time_read(const char *root, bench_cpu_time *time)
{
	char line[LINE_BYTES];
	double f[8] = {0}; // user nice system idle iowait irq softirq steal
	struct rusage usage;
	*time = (bench_cpu_time){.steal = -1, .load = -1};
	getrusage(RUSAGE_SELF, &usage);
	time->own_s = (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
	              1e-6 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
	if (read_first_line(root, "/proc/loadavg", line, sizeof line))
		time->load = strtod(line, NULL);
	int got = 0;
	if (read_first_line(root, "/proc/stat", line, sizeof line))
		got = sscanf(line, "cpu %lf %lf %lf %lf %lf %lf %lf %lf", &f[0], &f[1], &f[2], &f[3], &f[4],
		             &f[5], &f[6], &f[7]);
	if (got < 4) // the busy and idle numbers are needed at least
		return;
	time->busy = f[0] + f[1] + f[2] + f[5] + f[6];
	time->steal = got == 8 ? f[7] : -1;
	time->total = time->busy + f[3] + f[4] + f[7];
}

bench_disturbance bench_disturbance_between(const bench_cpu_time *before,
                                            const bench_cpu_time *after, double ticks_per_s)
{
	bench_disturbance d = {before->load, -1, -1};
	double total = after->total - before->total;
	if (before->total <= 0 || total <= 0)
		return d; // the time between the readings is unknown, or shorter than a tick
	double own = (after->own_s - before->own_s) * ticks_per_s;
	// The kernel counts whole ticks, so the difference may be slightly negative.
	d.others = fmin(fmax((after->busy - before->busy - own) / total, 0), 1);
	if (before->steal >= 0 && after->steal >= before->steal)
		d.steal = (after->steal - before->steal) / total;
	return d;
}

// ---- output

static void write_json_text(FILE *out, const char *name, const char *text)
{
	fprintf(out, "\"%s\":%s", name, *text ? "\"" : "null");
	for (const char *c = text; *c; c++)
		if (*c == '"' || *c == '\\')
			fprintf(out, "\\%c", *c);
		else
			fputc((unsigned char)*c < 0x20 ? ' ' : *c, out);
	fputs(*text ? "\"," : ",", out);
}

static void write_json_number(FILE *out, const char *name, double value, bool known)
{
	if (known)
		fprintf(out, "\"%s\":%.6g,", name, value);
	else
		fprintf(out, "\"%s\":null,", name);
}

void bench_machine_write_json(FILE *out, const bench_machine *m, const char *instruction_set,
                              const bench_disturbance *d)
{
	fputs("\"machine\":{", out);
	write_json_text(out, "vendor", m->vendor);
	write_json_text(out, "name", m->name);
	write_json_number(out, "family", m->family, m->family >= 0);
	write_json_number(out, "model", m->model, m->model >= 0);
	write_json_number(out, "stepping", m->stepping, m->stepping >= 0);
	write_json_number(out, "mhz_most", m->mhz_most, m->mhz_most > 0);
	write_json_number(out, "mhz_present", m->mhz_present, m->mhz_present > 0);
	write_json_number(out, "cores", m->cores, true);
	fputs("\"caches\":{", out);
	for (int i = 0; i < m->cache_count; i++)
		fprintf(out, "%s\"%s\":%.0f", i ? "," : "", m->caches[i].name, m->caches[i].bytes);
	fputs("},", out);
	write_json_number(out, "load_before", d->load_before, d->load_before >= 0);
	write_json_number(out, "others", d->others, d->others >= 0);
	write_json_number(out, "steal", d->steal, d->steal >= 0);
	fprintf(out, "\"instruction_set\":\"%s\"}", instruction_set);
}

void bench_machine_write(FILE *out, const bench_machine *m, const char *instruction_set,
                         const bench_disturbance *d)
{
	fprintf(out, "on %s (%s family %d model %d stepping %d), ", *m->name ? m->name : "?",
	        *m->vendor ? m->vendor : "?", m->family, m->model, m->stepping);
	if (m->mhz_most > 0 || m->mhz_present > 0)
		fprintf(out, "%.0f MHz, ", m->mhz_most > 0 ? m->mhz_most : m->mhz_present);
	fprintf(out, "%d cores", m->cores);
	for (int i = 0; i < m->cache_count; i++)
		fprintf(out, ", %s %.0f KiB", m->caches[i].name, m->caches[i].bytes / 1024);
	fprintf(out, ", %s; load before %.2f", instruction_set, d->load_before);
	if (d->others >= 0)
		fprintf(out, ", others %.1f %%", 100 * d->others);
	if (d->steal >= 0)
		fprintf(out, ", steal %.1f %%", 100 * d->steal);
	fputc('\n', out);
}

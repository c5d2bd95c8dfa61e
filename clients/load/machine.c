// SPDX-License-Identifier: GPL-3.0-or-later
#include "load/load.h"

#include <errno.h>
#include <netdb.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include "library/url.h"

enum { PAGE_BYTES_MAX = 1 << 22, WAIT_S = 10 };

static const char metric[] = "\ncautery_resident_bytes ";

enum { CPU_FIELDS = 8 }; // number of fields: user nice system idle iowait irq softirq steal

// Reads the first line of /proc/stat: `cpu` and at least CPU_FIELDS numbers.
static bool read_fields(const char *line, double field[CPU_FIELDS])
{
	const char *at = line + 3;
	if (strncmp(line, "cpu ", 4) != 0)
		return false;
	for (int i = 0; i < CPU_FIELDS; i++) {
		char *end;
		field[i] = strtod(at, &end);
		if (end == at)
			return false;
		at = end;
	}
	return true;
}

load_cpu load_cpu_read(void)
{
	load_cpu cpu = {0};
	double field[CPU_FIELDS];
	char line[512];
	FILE *file = fopen("/proc/stat", "r");
	if (!file)
		return cpu;
	if (fgets(line, sizeof line, file) && read_fields(line, field)) {
		for (int i = 0; i < CPU_FIELDS; i++)
			cpu.total += field[i];
		cpu.steal = field[CPU_FIELDS - 1];
	}
	fclose(file);
	return cpu;
}

double load_own_cpu_s(void)
{
	struct rusage usage;
	getrusage(RUSAGE_SELF, &usage);
	return (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
	       1e-6 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

static int open_socket(const cau_url *url)
{
	char port[8];
	struct addrinfo hints = {.ai_socktype = SOCK_STREAM}, *all = NULL;
	struct timeval wait = {.tv_sec = WAIT_S};
	int descriptor = -1;
	snprintf(port, sizeof port, "%d", url->port);
	if (getaddrinfo(url->host, port, &hints, &all))
		return -1;
	for (struct addrinfo *a = all; a && descriptor < 0; a = a->ai_next) {
		descriptor = socket(a->ai_family, a->ai_socktype | SOCK_CLOEXEC, a->ai_protocol);
		if (descriptor < 0)
			continue;
		setsockopt(descriptor, SOL_SOCKET, SO_RCVTIMEO, &wait, sizeof wait);
		if (connect(descriptor, a->ai_addr, a->ai_addrlen)) {
			close(descriptor);
			descriptor = -1;
		}
	}
	freeaddrinfo(all);
	return descriptor;
}

// Reads all data until the peer closes, and appends a zero byte. The caller frees the result.
static char *read_all(int descriptor)
{
	char *text = malloc(PAGE_BYTES_MAX + 1);
	size_t used = 0;
	ssize_t got = 1;
	while (text && used < PAGE_BYTES_MAX && got > 0) {
		got = recv(descriptor, text + used, PAGE_BYTES_MAX - used, 0);
		used += got > 0 ? (size_t)got : 0;
	}
	if (text)
		text[used] = 0;
	return text;
}

cau_status load_daemon_memory(const char *url, const char *token, double *bytes, cau_error *error)
{
	cau_url at;
	char request[1024];
	cau_status status = cau_url_read(url, &at, error);
	if (status)
		return status;
	if (at.tls)
		return cau_fail(error, CAU_UNSUPPORTED, NULL, "/metrics is read over plain HTTP only");
	int descriptor = open_socket(&at);
	if (descriptor < 0)
		return cau_fail(error, CAU_IO, NULL, "/metrics: %s", strerror(errno));
	snprintf(request, sizeof request,
	         "GET /metrics HTTP/1.1\r\nHost: %s:%d\r\nConnection: close\r\n%s%.512s%s\r\n", at.host,
	         at.port, token ? "Authorization: Bearer " : "", token ? token : "",
	         token ? "\r\n" : "");
	send(descriptor, request, strlen(request), MSG_NOSIGNAL);
	char *text = read_all(descriptor);
	close(descriptor);
	const char *found = text ? strstr(text, metric) : NULL;
	if (found)
		*bytes = strtod(found + sizeof metric - 1, NULL);
	free(text);
	return found ? CAU_OK
	             : cau_fail(error, CAU_NOT_FOUND, NULL, "/metrics does not report resident memory");
}

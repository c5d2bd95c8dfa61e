// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport_dds/local.h"

#include <arpa/inet.h>
#include <dirent.h>
#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>

static bool is_loopback(const struct sockaddr_storage *address)
{
	if (address->ss_family == AF_INET)
		return ntohl(((const struct sockaddr_in *)address)->sin_addr.s_addr) >> 24 == 127;
	return IN6_IS_ADDR_LOOPBACK(&((const struct sockaddr_in6 *)address)->sin6_addr);
}

// True if the descriptor is a UDP socket that can receive from other machines.
static bool is_open(int descriptor)
{
	struct sockaddr_storage address = {0};
	socklen_t bytes = sizeof address, type_bytes = sizeof(int);
	int type = 0;
	return getsockopt(descriptor, SOL_SOCKET, SO_TYPE, &type, &type_bytes) == 0 &&
	       type == SOCK_DGRAM &&
	       getsockname(descriptor, (struct sockaddr *)&address, &bytes) == 0 &&
	       (address.ss_family == AF_INET || address.ss_family == AF_INET6) &&
	       !is_loopback(&address);
}

cau_status cau_dds_stay_local(cau_error *error)
{
	static const char device[] = "lo";
	DIR *descriptors = opendir("/proc/self/fd");
	int problem = descriptors ? 0 : errno;
	for (const struct dirent *entry; descriptors && !problem && (entry = readdir(descriptors));) {
		char *end;
		long descriptor = strtol(entry->d_name, &end, 10);
		if (end != entry->d_name && is_open((int)descriptor) &&
		    setsockopt((int)descriptor, SOL_SOCKET, SO_BINDTODEVICE, device, sizeof device) != 0)
			problem = errno;
	}
	if (descriptors)
		closedir(descriptors);
	return problem ? cau_fail(error, CAU_IO, "dds", "cannot keep DDS on this machine: %s",
	                          strerror(problem))
	               : CAU_OK;
}

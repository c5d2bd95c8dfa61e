// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport_dds/indices.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <stdbool.h>
#include <stdint.h>
#include <sys/socket.h>
#include <unistd.h>

// Cyclone DDS takes its ports from DDSI 2.2, 9.6.1.1: 7400 + 250 domain + 10 + 2 index, and the
// port after it.
enum { FIRST_PORT = 7410, DOMAIN_GAIN = 250, INDEX_GAIN = 2, INDICES = 120 };

static bool is_free(int port)
{
	struct sockaddr_in at = {.sin_family = AF_INET,
	                         .sin_port = htons((uint16_t)port),
	                         .sin_addr.s_addr = htonl(INADDR_ANY)};
	int descriptor = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
	if (descriptor < 0)
		return true; // without a socket, a taken port cannot be detected
	bool bound = bind(descriptor, (struct sockaddr *)&at, sizeof at) == 0;
	close(descriptor);
	return bound;
}

static bool are_taken(int domain)
{
	for (int i = 0; i < INDICES; i++) {
		int port = FIRST_PORT + DOMAIN_GAIN * domain + INDEX_GAIN * i;
		if (port + 1 > UINT16_MAX || (is_free(port) && is_free(port + 1)))
			return false;
	}
	return true;
}

cau_status cau_dds_explain_domain(const cau_config *config, const char *word, cau_error *error)
{
	int domain = (int)config->dds_domain;
	if (*config->dds_config)
		return cau_fail(
			error, CAU_IO, "dds",
			"Cyclone DDS cannot open domain %d with %.120s (%s): is its interface up, and a "
			"participant index free (MaxAutoParticipantIndex)?",
			domain, config->dds_config, word);
	if (are_taken(domain))
		return cau_fail(error, CAU_LIMIT, "dds",
		                "%d DDS programs run in domain %d on this machine, the most that can: end "
		                "some, take another dds_domain, or set dds_optional to go without DDS",
		                INDICES, domain);
	return cau_fail(error, CAU_IO, "dds", "Cyclone DDS cannot open domain %d on loopback: %s",
	                domain, word);
}

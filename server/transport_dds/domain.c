// SPDX-License-Identifier: GPL-3.0-or-later
// Opens and leaves the DDS domain: participant indices, the restriction to this machine.
#include <arpa/inet.h>
#include <dirent.h>
#include <errno.h>
#include <netinet/in.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "clock/clock.h"
#include "config/config.h"
#include "log/log.h"
#include "transport_dds/internal.h"
#include "transport_dds/loopback.h"

// ---- participant indices
// Each DDS program on a machine has one index in its domain, and two ports that follow from the
// index.

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

// Explains in *error why Cyclone DDS opened no domain; `word` is Cyclone's own short reason.
// Returns CAU_LIMIT if programs of this machine hold all participant indices, else CAU_IO.
static cau_status explain_domain(const cau_config *config, const char *word, cau_error *error)
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

// ---- this machine only
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

// Ties each UDP socket of the process that is not on a loopback address to the loopback device.
// Cyclone binds its receiving ports to every address, even if its settings name only some
// interfaces. So packets of other machines would arrive without this. Call it when the domain has
// its sockets and no participant yet. Returns CAU_IO if the kernel refuses (before 5.7 it requires
// CAP_NET_RAW).
static cau_status stay_local(cau_error *error)
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

// ---- opening the domain
enum { CONFIG_BYTES = 4096 };

// Cyclone's setting for the time that a closing writer waits for acknowledgements. It is 0, because
// a reader may be dead.
static const char no_linger[] =
	"<CycloneDDS><Domain Id=\"any\"><Internal>"
	"<WriterLingerDuration>0 s</WriterLingerDuration></Internal></Domain></CycloneDDS>";

cau_status cau_dds_open_domain(cau_dds_entities *entities, const cau_config *config,
                               cau_error *error)
{
	char given[CONFIG_BYTES], reason[CAU_NAMED_FILE_REASON_BYTES];
	FILE *settings = *config->dds_config ? cau_named_file_open(config->dds_config,
	                                                           CAU_NAMED_FILE_BYTES, NULL, reason)
	                                     : NULL;
	if (*config->dds_config && !settings)
		return cau_fail(error, CAU_IO, "dds_config", "cannot open %.160s: %s", config->dds_config,
		                reason);
	if (settings)
		// The file is opened only as a check. Cyclone opens it again and would wait for the writer
		// of a FIFO.
		fclose(settings);
	if (*config->dds_config)
		snprintf(given, sizeof given, "file://%s,%s", config->dds_config, no_linger);
	else
		snprintf(given, sizeof given, "%s,%s", cau_dds_loopback, no_linger);
	entities->domain = dds_create_domain((dds_domainid_t)config->dds_domain, given);
	if (entities->domain < 0)
		return explain_domain(config, dds_strretcode(entities->domain), error);
	dds_qos_t *qos = dds_create_qos();
	cau_status status = *config->dds_config ? CAU_OK : stay_local(error);
	if (!status)
		status = cau_dds_secure(qos, config, error);
	if (!status)
		entities->participant =
			dds_create_participant((dds_domainid_t)config->dds_domain, qos, NULL);
	dds_delete_qos(qos);
	if (!status && entities->participant < 0 && *config->dds_security)
		return cau_fail(
			error, CAU_IO, "dds_security",
			"Cyclone DDS made no participant with the identity in %.100s (%s): check that "
			"cert.pem fits key.pem, that identity_ca.cert.pem signed it, that "
			"permissions_ca.cert.pem signed the .p7s files, and that none has expired",
			config->dds_security, dds_strretcode(entities->participant));
	if (!status && entities->participant < 0)
		return cau_fail(error, CAU_IO, "dds", "cannot create a DDS participant: %s",
		                dds_strretcode(entities->participant));
	return status;
}

// ---- leaving the domain
#define LEAVE_S 2

static void *leave(void *domain)
{
	dds_delete((dds_entity_t)(intptr_t)domain);
	return NULL;
}

// Ends the process before OpenSSL's exit handler, which frees memory that Cyclone's running threads
// use. Exit handlers run in the reverse order of their registration.
static void end_at_once(int status, void *unused)
{
	(void)unused;
	fflush(NULL);
	_exit(status);
}

void cau_dds_leave(dds_entity_t domain)
{
	pthread_t thread;
	struct timespec until = cau_timespec(cau_monotonic_s() + LEAVE_S);
	if (pthread_create(&thread, NULL, leave, (void *)(intptr_t)domain) != 0) {
		dds_delete(domain);
	} else if (pthread_clockjoin_np(thread, NULL, CLOCK_MONOTONIC, &until) != 0) {
		pthread_detach(thread);
		on_exit(end_at_once, NULL);
		cau_log(CAU_LOG_WARNING, NULL, "dds_not_left",
		        "reason=\"the network interface of DDS is gone\"");
	}
}

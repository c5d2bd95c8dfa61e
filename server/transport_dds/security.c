// SPDX-License-Identifier: GPL-3.0-or-later
// DDS Security: sets the daemon's identity as properties of its participant. The files are in one
// folder, named as in a ROS 2 keystore's enclave. Cyclone makes no participant with a broken
// identity, so a given identity is always in force.
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "config/config.h"
#include "dds_identity/identity.h"
#include "transport_dds/internal.h"

enum { FILE_BYTES = CAU_CONFIG_TEXT_BYTES + 64, PATH_KEPT = 100 };

static const struct {
	const char *property, *file;
} identity[] = {
	{"dds.sec.auth.identity_ca", "identity_ca.cert.pem"},
	{"dds.sec.auth.identity_certificate", "cert.pem"},
	{"dds.sec.auth.private_key", "key.pem"},
	{"dds.sec.access.permissions_ca", "permissions_ca.cert.pem"},
	{"dds.sec.access.governance", "governance.p7s"},
	{"dds.sec.access.permissions", "permissions.p7s"},
};

// Property and file name of the list of certificates that the authority has revoked. The list is
// optional.
static const char revoked_property[] = "org.eclipse.cyclonedds.sec.auth.crl", revoked[] = "crl.pem";

// Cyclone's security plugins. Debian keeps them outside the linker's folders; the build has found
// their folder.
static const struct {
	const char *name, *path, *function;
} plugins[] = {
	{"access", CAU_DDS_PLUGINS "libdds_security_ac.so", "access_control"},
	{"crypto", CAU_DDS_PLUGINS "libdds_security_crypto.so", "crypto"},
};

static void set_plugin(dds_qos_t *qos, const char *name, const char *member, const char *value)
{
	char property[64];
	snprintf(property, sizeof property, "dds.sec.%s.library.%s", name, member);
	dds_qset_prop(qos, property, value);
}

// Sets our authentication plugin, which wraps Cyclone's own and notes who was authenticated.
static void set_authentication(dds_qos_t *qos, const char *library)
{
	set_plugin(qos, "auth", "path", library);
	set_plugin(qos, "auth", "init", "cau_dds_identity_init");
	set_plugin(qos, "auth", "finalize", "cau_dds_identity_finalize");
}

static void set_plugins(dds_qos_t *qos)
{
	char function[64];
	for (size_t i = 0; i < sizeof plugins / sizeof plugins[0]; i++) {
		set_plugin(qos, plugins[i].name, "path", plugins[i].path);
		snprintf(function, sizeof function, "init_%s", plugins[i].function);
		set_plugin(qos, plugins[i].name, "init", function);
		snprintf(function, sizeof function, "finalize_%s", plugins[i].function);
		set_plugin(qos, plugins[i].name, "finalize", function);
	}
}

// Checks that a file can be read. Cyclone opens the file by itself, and would wait for the writer
// of a FIFO.
static cau_status check_file(const char *folder, const char *name, cau_error *error)
{
	char reason[CAU_NAMED_FILE_REASON_BYTES];
	char path[FILE_BYTES];
	snprintf(path, sizeof path, "%s/%s", folder, name);
	FILE *stream = cau_named_file_open(path, CAU_NAMED_FILE_BYTES, NULL, reason);
	if (!stream)
		return cau_fail(error, CAU_NOT_FOUND, "dds_security", "cannot read %s in %.*s: %s", name,
		                PATH_KEPT, folder, reason);
	fclose(stream);
	return CAU_OK;
}

static cau_status set_identity(dds_qos_t *qos, const char *folder, cau_error *error)
{
	for (size_t i = 0; i < sizeof identity / sizeof identity[0]; i++) {
		char uri[FILE_BYTES];
		snprintf(uri, sizeof uri, "file:%s/%s", folder, identity[i].file);
		cau_status status = check_file(folder, identity[i].file, error);
		if (status)
			return status;
		dds_qset_prop(qos, identity[i].property, uri);
	}
	char uri[FILE_BYTES];
	snprintf(uri, sizeof uri, "file:%s/%s", folder, revoked);
	if (access(uri + strlen("file:"), F_OK) != 0)
		return CAU_OK;
	// If the revocation list cannot be read, the daemon does not start.
	dds_qset_prop(qos, revoked_property, uri);
	return check_file(folder, revoked, error);
}

cau_status cau_dds_secure(dds_qos_t *qos, const cau_config *config, cau_error *error)
{
	if (!*config->dds_security)
		return CAU_OK;
	const char *library = cau_dds_identity_library();
	if (!library)
		return cau_fail(error, CAU_NOT_FOUND, "dds_security",
		                "the daemon cannot find the file of its own library "
		                "libcautery_dds_identity.so, which DDS Security needs: install the daemon "
		                "again");
	set_authentication(qos, library);
	set_plugins(qos);
	return set_identity(qos, config->dds_security, error);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// The plugin that Cyclone loads. It passes all calls to Cyclone's own authentication, and notes
// what some of them report.
#include <dds/security/dds_security_api.h>
#include <dlfcn.h>
#include <stddef.h>
#include <string.h>

#include "dds_identity/identity.h"

static void *library; // handle of Cyclone's plugin; stays open
// functions of Cyclone's plugin; the same for every domain
static dds_security_authentication own;
// the property of a credential token that has the certificate
static const char certificate[] = "c.id";

static DDS_Security_ValidationResult_t
meet(dds_security_authentication *instance, DDS_Security_IdentityHandle *identity,
     DDS_Security_AuthRequestMessageToken *local_request,
     const DDS_Security_AuthRequestMessageToken *request, const DDS_Security_IdentityHandle local,
     const DDS_Security_IdentityToken *token, const DDS_Security_GUID_t *guid,
     DDS_Security_SecurityException *exception)
{
	DDS_Security_ValidationResult_t result = own.validate_remote_identity(
		instance, identity, local_request, request, local, token, guid, exception);
	uint8_t bytes[16];
	memcpy(bytes, guid->prefix, sizeof guid->prefix);
	memcpy(bytes + sizeof guid->prefix, &guid->entityId, sizeof guid->entityId);
	if (result != DDS_SECURITY_VALIDATION_FAILED)
		cau_dds_proofs_meet(bytes, *identity);
	return result;
}

static DDS_Security_ValidationResult_t begin_request(dds_security_authentication *instance,
                                                     DDS_Security_HandshakeHandle *handshake,
                                                     DDS_Security_HandshakeMessageToken *message,
                                                     const DDS_Security_IdentityHandle initiator,
                                                     const DDS_Security_IdentityHandle replier,
                                                     const DDS_Security_OctetSeq *local,
                                                     DDS_Security_SecurityException *exception)
{
	DDS_Security_ValidationResult_t result = own.begin_handshake_request(
		instance, handshake, message, initiator, replier, local, exception);
	if (result != DDS_SECURITY_VALIDATION_FAILED)
		cau_dds_proofs_begin(replier, *handshake);
	return result;
}

static DDS_Security_ValidationResult_t
begin_reply(dds_security_authentication *instance, DDS_Security_HandshakeHandle *handshake,
            DDS_Security_HandshakeMessageToken *out, const DDS_Security_HandshakeMessageToken *in,
            const DDS_Security_IdentityHandle initiator, const DDS_Security_IdentityHandle replier,
            const DDS_Security_OctetSeq *local, DDS_Security_SecurityException *exception)
{
	DDS_Security_ValidationResult_t result = own.begin_handshake_reply(
		instance, handshake, out, in, initiator, replier, local, exception);
	if (result != DDS_SECURITY_VALIDATION_FAILED)
		cau_dds_proofs_begin(initiator, *handshake);
	return result;
}

// Passes the credential on and notes the certificate. Cyclone calls this after a successful
// handshake, to check the peer's permissions.
static DDS_Security_boolean tell_credential(dds_security_authentication *instance,
                                            DDS_Security_AuthenticatedPeerCredentialToken *token,
                                            const DDS_Security_HandshakeHandle handshake,
                                            DDS_Security_SecurityException *exception)
{
	DDS_Security_boolean told =
		own.get_authenticated_peer_credential_token(instance, token, handshake, exception);
	for (uint32_t i = 0; told && i < token->properties._length; i++) {
		const DDS_Security_Property_t *property = &token->properties._buffer[i];
		if (property->name && property->value && strcmp(property->name, certificate) == 0)
			cau_dds_proofs_prove(handshake, property->value);
	}
	return told;
}

static DDS_Security_boolean return_identity(dds_security_authentication *instance,
                                            const DDS_Security_IdentityHandle identity,
                                            DDS_Security_SecurityException *exception)
{
	cau_dds_proofs_forget(identity);
	return own.return_identity_handle(instance, identity, exception);
}

static void *find(const char *name)
{
	if (!library)
		library = dlopen(CAU_DDS_PLUGINS "libdds_security_auth.so", RTLD_NOW | RTLD_LOCAL);
	return library ? dlsym(library, name) : NULL;
}

int cau_dds_identity_init(const char *argument, void **context, struct ddsi_domaingv *domain)
{
	plugin_init init;
	*(void **)&init = find("init_authentication");
	int failed = init ? init(argument, context, domain) : -1;
	if (failed)
		return failed;
	dds_security_authentication *authentication = *context;
	own = *authentication;
	authentication->validate_remote_identity = meet;
	authentication->begin_handshake_request = begin_request;
	authentication->begin_handshake_reply = begin_reply;
	authentication->get_authenticated_peer_credential_token = tell_credential;
	authentication->return_identity_handle = return_identity;
	return 0;
}

int cau_dds_identity_finalize(void *context)
{
	plugin_finalize finalize;
	*(void **)&finalize = find("finalize_authentication");
	return finalize ? finalize(context) : -1;
}

const char *cau_dds_identity_library(void)
{
	Dl_info info;
	static const char here;
	return dladdr(&here, &info) ? info.dli_fname : NULL;
}

bool cau_dds_identity_find(const uint8_t guid[16], char subject[CAU_DDS_SUBJECT_BYTES])
{
	return cau_dds_proofs_find(guid, subject);
}

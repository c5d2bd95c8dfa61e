// SPDX-License-Identifier: GPL-3.0-or-later
// Changes the roles of identities while the daemon runs. The thread that calls cau_dds_reload reads
// the file; the DDS thread, which alone uses the roles, takes them over.
#include <stdio.h>
#include <stdlib.h>

#include "config/role.h"
#include "transport_dds/internal.h"

cau_status cau_dds_reload(cau_dds *dds, cau_error *error)
{
	cau_dds_roles *read = malloc(sizeof *read);
	if (!read)
		return cau_fail(error, CAU_NO_MEMORY, "dds_roles", "no memory for roles");
	cau_status status = cau_dds_roles_read(read, dds->config, error);
	if (status) {
		if (error)
			snprintf(error->file, sizeof error->file, "%.255s", dds->config->dds_roles);
		free(read);
		return status;
	}
	pthread_mutex_lock(&dds->mailbox.mutex);
	free(dds->mailbox.roles); // roles of an earlier reload that were not taken yet
	dds->mailbox.roles = read;
	pthread_mutex_unlock(&dds->mailbox.mutex);
	cau_dds_wake(&dds->wakeup, &dds->wakeup.roles_changed);
	return CAU_OK;
}

static cau_role role_of(const cau_dds_roles *roles, const char *subject)
{
	return cau_dds_roles_find(roles, *subject ? subject : NULL);
}

// Applies a changed role to a client. If the role is smaller, the client ends with energy off; its
// writers become clients with the new role by their next samples. If the role is larger, the client
// continues.
static void follow_role(cau_dds *dds, cau_dds_client *client)
{
	cau_role role = role_of(&dds->roles, client->subject), before = client->asker.role;
	if (role == before)
		return;
	cau_log(CAU_LOG_NOTICE, NULL, "dds_role_changed", "client=%u subject=\"%s\" before=%s role=%s",
	        client->asker.client, client->subject, cau_role_word(before), cau_role_word(role));
	client->asker.role = role;
	if (role < before)
		cau_dds_end_place(dds, client);
}

void cau_dds_take_roles(cau_dds *dds)
{
	pthread_mutex_lock(&dds->mailbox.mutex);
	cau_dds_roles *read = dds->mailbox.roles;
	dds->mailbox.roles = NULL;
	pthread_mutex_unlock(&dds->mailbox.mutex);
	if (!read)
		return;
	dds->roles = *read;
	free(read);
	for (int i = 0; i < WRITER_BUCKETS; i++)
		for (cau_dds_writer *writer = dds->writers.buckets[i]; writer; writer = writer->next)
			writer->asker.role = role_of(&dds->roles, writer->subject);
	for (cau_dds_client *client = dds->places.clients, *next; client; client = next) {
		next = client->next;
		follow_role(dds, client);
	}
}

// SPDX-License-Identifier: GPL-3.0-or-later
// A client as a stranger would write it against the installed library: connects and says to whom.
#include <stdio.h>

#include <cautery/client.h>

int main(int argument_count, char **arguments)
{
	cau_loop *loop = NULL;
	cau_client *client = NULL;
	cau_error error = {0};
	cau_client_def def = cau_default_client_def();
	def.url = argument_count > 1 ? arguments[1] : CAU_CLIENT_DEFAULT_URL;
	cau_status status = cau_loop_create(&loop, &error);
	if (!status)
		status = cau_client_create(loop, &def, &client, &error);
	if (!status)
		status = cau_client_connect(client, &error);
	if (status)
		fprintf(stderr, "%s\n", error.reason);
	else
		printf("%s\n", cau_client_server(client)->server);
	cau_client_destroy(client);
	cau_loop_destroy(loop);
	return status ? 1 : 0;
}

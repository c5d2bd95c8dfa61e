// SPDX-License-Identifier: GPL-3.0-or-later
// mesh.read: an upload is read on the hub's builder.
#include "hub/internal.h"

cau_status cau_hub_read_mesh(cau_hub *hub, const cau_mesh_asked *asked, const cau_reply *reply,
                             cau_error *error)
{
	return cau_mesh_ask(hub->def.builder, asked, reply, error);
}

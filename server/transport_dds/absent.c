// SPDX-License-Identifier: GPL-3.0-or-later
// The DDS transport in a build without DDS: creating one fails.
#include <stddef.h>

#include "transport_dds/dds_transport.h"

cau_status cau_dds_create(cau_dds **dds, const cau_config *config, cau_hub *hub, cau_error *error)
{
	(void)config, (void)hub;
	*dds = NULL;
	return cau_fail(error, CAU_UNSUPPORTED, "dds", "this cauteryd was built without DDS");
}

cau_status cau_dds_start(cau_dds *dds, cau_error *error)
{
	(void)dds;
	return cau_fail(error, CAU_UNSUPPORTED, "dds", "this cauteryd was built without DDS");
}

cau_status cau_dds_reload(cau_dds *dds, cau_error *error)
{
	(void)dds;
	return cau_fail(error, CAU_UNSUPPORTED, "dds", "this cauteryd was built without DDS");
}

void cau_dds_stop(cau_dds *dds)
{
	(void)dds;
}

void cau_dds_destroy(cau_dds *dds)
{
	(void)dds;
}

void cau_dds_write_metrics(void *dds, FILE *out, cau_metrics_format format)
{
	(void)dds, (void)out, (void)format;
}

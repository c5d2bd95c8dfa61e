// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport_dds/compatible.h"

#include <string.h>

typedef struct policies {
	dds_durability_kind_t durability;
	dds_duration_t deadline, latency, lease, blocking;
	dds_ownership_kind_t ownership;
	dds_liveliness_kind_t liveliness;
	dds_destination_order_kind_t order;
	dds_reliability_kind_t reliability;
} policies;

static policies read_policies(const dds_qos_t *qos, dds_reliability_kind_t reliability)
{
	policies p = {.deadline = DDS_INFINITY, .lease = DDS_INFINITY, .reliability = reliability};
	dds_qget_durability(qos, &p.durability);
	dds_qget_deadline(qos, &p.deadline);
	dds_qget_latency_budget(qos, &p.latency);
	dds_qget_ownership(qos, &p.ownership);
	dds_qget_liveliness(qos, &p.liveliness, &p.lease);
	dds_qget_destination_order(qos, &p.order);
	dds_qget_reliability(qos, &p.reliability, &p.blocking);
	return p;
}

const char *cau_dds_mismatch(const dds_qos_t *offered, const dds_qos_t *requested)
{
	policies o = read_policies(offered, DDS_RELIABILITY_RELIABLE);
	policies r = read_policies(requested, DDS_RELIABILITY_BEST_EFFORT);
	if (o.durability < r.durability)
		return "durability";
	if (o.deadline > r.deadline)
		return "deadline";
	if (o.latency > r.latency)
		return "latency_budget";
	if (o.ownership != r.ownership)
		return "ownership";
	if (o.liveliness < r.liveliness || o.lease > r.lease)
		return "liveliness";
	if (o.order < r.order)
		return "destination_order";
	if (o.reliability < r.reliability)
		return "reliability";
	return NULL;
}

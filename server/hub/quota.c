// SPDX-License-Identifier: GPL-3.0-or-later
#include "hub/quota.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "config/role.h"

// Addresses remembered at once. Beyond them the one that has taken least is forgotten: what that
// gives away is bounded by the role's and the daemon's allowance.
enum { ADDRESSES = 256 };

#define MINUTE_S 60.0

typedef struct address {
	char text[CAU_QUOTA_ADDRESS_BYTES];
	cau_allowance allowance;
} address;

struct cau_quota {
	const cau_config *config;
	pthread_mutex_t mutex; // guards what follows
	address addresses[ADDRESSES];
	int address_count;
	cau_allowance roles[CAU_ROLE_COUNT], all;
};

// One allowance and what bounds it.
typedef struct bound {
	cau_allowance *allowance;
	int64_t most; // a minute
	const char *setting, *whose;
} bound;

cau_quota *cau_quota_create(const cau_config *config)
{
	cau_quota *quota = calloc(1, sizeof *quota);
	if (!quota)
		return NULL;
	quota->config = config;
	pthread_mutex_init(&quota->mutex, NULL);
	return quota;
}

void cau_quota_destroy(cau_quota *quota)
{
	if (quota)
		pthread_mutex_destroy(&quota->mutex);
	free(quota);
}

// What is left of what was taken, after the time that has gone by.
static void refill(cau_allowance *allowance, int64_t most, double now_s)
{
	double back = (now_s - allowance->seen_s) * (double)most / MINUTE_S;
	allowance->taken = fmax(0, allowance->taken - fmax(0, back));
	allowance->seen_s = now_s;
}

static cau_allowance *find_address(cau_quota *quota, const char *text, double now_s)
{
	address *least = NULL;
	for (int i = 0; i < quota->address_count; i++) {
		address *known = &quota->addresses[i];
		if (strcmp(known->text, text) == 0)
			return &known->allowance;
		refill(&known->allowance, quota->config->quota_address, now_s);
		if (!least || known->allowance.taken < least->allowance.taken)
			least = known;
	}
	address *made =
		quota->address_count < ADDRESSES ? &quota->addresses[quota->address_count++] : least;
	*made = (address){.allowance.seen_s = now_s};
	snprintf(made->text, sizeof made->text, "%s", text);
	return &made->allowance;
}

static cau_status refuse(const bound *over, cau_error *error)
{
	double wait_s =
		(over->allowance->taken + 1 - (double)over->most) * MINUTE_S / (double)over->most;
	return cau_fail(error, CAU_LIMIT, "",
	                "%s made %lld expensive requests within a minute, as many as it may (setting "
	                "%s): try again in %.1f s",
	                over->whose, (long long)over->most, over->setting, wait_s + 0.05);
}

static cau_status take_all(const bound *bounds, int count, double now_s, cau_error *error)
{
	for (int i = 0; i < count; i++) {
		refill(bounds[i].allowance, bounds[i].most, now_s);
		if (bounds[i].allowance->taken + 1 > (double)bounds[i].most)
			return refuse(&bounds[i], error);
	}
	for (int i = 0; i < count; i++)
		bounds[i].allowance->taken++;
	return CAU_OK;
}

cau_status cau_quota_take(cau_quota *quota, cau_allowance *connection, const char *address_text,
                          cau_role role, double now_s, cau_error *error)
{
	const cau_config *config = quota->config;
	const bound by_role[CAU_ROLE_COUNT] = {
		[CAU_ROLE_VIEW] = {NULL, config->quota_view, "quota_view", "viewers"},
		[CAU_ROLE_OPERATE] = {NULL, config->quota_operate, "quota_operate", "operators"},
		[CAU_ROLE_ADMIN] = {NULL, config->quota_admin, "quota_admin", "admins"},
	};
	pthread_mutex_lock(&quota->mutex);
	bound bounds[] = {
		{connection, config->quota_connection, "quota_connection", "this connection"},
		{find_address(quota, address_text, now_s), config->quota_address, "quota_address",
	     "this address"},
		by_role[role],
		{&quota->all, config->quota_all, "quota_all", "all clients together"},
	};
	bounds[2].allowance = &quota->roles[role];
	cau_status status = take_all(bounds, sizeof bounds / sizeof bounds[0], now_s, error);
	pthread_mutex_unlock(&quota->mutex);
	return status;
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "quota/quota.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "config/config.h"

// Number of remembered addresses. If there are more, the address that has taken least is forgotten,
// and so gets a full allowance again. The allowances of the role and of the daemon limit these
// gifts.
enum { ADDRESSES = 256 };

#define MINUTE_S 60.0

typedef struct address {
	char text[CAU_QUOTA_ADDRESS_BYTES];
	cau_allowance allowance;
} address;

// Number of remembered tokens: as many as a file of tokens may have. If there are more, the token
// that has taken least is forgotten.
enum { TOKENS = 256 };

typedef struct token {
	uint64_t grant;
	int64_t most;
	cau_allowance allowance;
} token;

struct cau_quota {
	const cau_config *config;
	pthread_mutex_t mutex; // guards the members below
	address addresses[ADDRESSES];
	int address_count;
	token tokens[TOKENS];
	int token_count;
	cau_allowance roles[CAU_ROLE_COUNT], all;
};

// One allowance and its limit.
typedef struct bound {
	cau_allowance *allowance;
	int64_t most;              // requests a minute
	const char *where, *whose; // where: the setting of the limit; whose: to what it applies
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

// Refills the allowance for the time since the last call.
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

static cau_allowance *find_token(cau_quota *quota, const cau_quota_token *wanted, double now_s)
{
	token *least = NULL;
	for (int i = 0; i < quota->token_count; i++) {
		token *known = &quota->tokens[i];
		if (known->grant == wanted->grant)
			return &known->allowance;
		refill(&known->allowance, known->most, now_s);
		if (!least || known->allowance.taken < least->allowance.taken)
			least = known;
	}
	token *made = quota->token_count < TOKENS ? &quota->tokens[quota->token_count++] : least;
	*made = (token){wanted->grant, wanted->most, {.seen_s = now_s}};
	return &made->allowance;
}

static cau_status refuse(const bound *over, cau_error *error)
{
	double wait_s =
		(over->allowance->taken + 1 - (double)over->most) * MINUTE_S / (double)over->most;
	return cau_fail(error, CAU_LIMIT, "",
	                "%s: %lld expensive requests within a minute, which is the limit (%s): "
	                "try again in %.1f s",
	                over->whose, (long long)over->most, over->where, wait_s + 0.05);
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

cau_status cau_quota_take(cau_quota *quota, cau_allowance *connection,
                          const cau_quota_token *of_token, const char *address_text, cau_role role,
                          double now_s, cau_error *error)
{
	const cau_config *config = quota->config;
	const bound by_role[CAU_ROLE_COUNT] = {
		[CAU_ROLE_VIEW] = {NULL, config->quota_view, "setting quota_view", "viewers"},
		[CAU_ROLE_OPERATE] = {NULL, config->quota_operate, "setting quota_operate", "operators"},
		[CAU_ROLE_ADMIN] = {NULL, config->quota_admin, "setting quota_admin", "admins"},
	};
	pthread_mutex_lock(&quota->mutex);
	bound bounds[] = {
		{connection, config->quota_connection, "setting quota_connection", "this connection"},
		{find_address(quota, address_text, now_s), config->quota_address, "setting quota_address",
	     "this address"},
		by_role[role],
		{&quota->all, config->quota_all, "setting quota_all", "all clients together"},
		{NULL, 0, "quota= in the file of tokens", "this token"},
	};
	int count = sizeof bounds / sizeof bounds[0] - 1;
	bounds[2].allowance = &quota->roles[role];
	if (of_token && of_token->most) {
		bounds[count].allowance = find_token(quota, of_token, now_s);
		bounds[count++].most = of_token->most;
	}
	cau_status status = take_all(bounds, count, now_s, error);
	pthread_mutex_unlock(&quota->mutex);
	return status;
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport_ws/shares.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define BURST_S 0.2

// Shares of one core. All viewers together leave most of the core to drivers and to the sessions'
// workers.
static const struct {
	double connection, address, all;
} rates[CAU_STANDING_COUNT] = {
	[CAU_STANDING_UNKNOWN] = {0.02, 0.05, 0.1},
	[CAU_STANDING_VIEWER] = {0.05, 0.1, 0.15},
	[CAU_STANDING_DRIVER] = {0.3, 0.7, 0.9},
};

cau_standing cau_standing_of_role(cau_role role)
{
	return role > CAU_ROLE_VIEW ? CAU_STANDING_DRIVER : CAU_STANDING_VIEWER;
}

static void give_back(cau_time_used *used, double rate, double now_s)
{
	used->used_s = fmax(0, used->used_s - rate * fmax(0, now_s - used->seen_s));
	used->seen_s = now_s;
}

static double wait_s(cau_time_used *used, double rate, double now_s)
{
	give_back(used, rate, now_s);
	return fmax(0, used->used_s / rate - BURST_S);
}

static void free_address(cau_address_share *address)
{
	free(address->address);
	free(address);
}

// ---- addresses
static void forget_idle(cau_shares *shares, double now_s)
{
	for (cau_address_share **place = &shares->addresses, *a; (a = *place);) {
		give_back(&a->used, rates[a->standing].address, now_s);
		if (a->connections || a->used.used_s > 0) {
			place = &a->next;
			continue;
		}
		*place = a->next;
		free_address(a);
	}
}

static cau_address_share *make_address(cau_shares *shares, const char *address,
                                       cau_standing standing)
{
	cau_address_share *made = calloc(1, sizeof *made);
	if (!made)
		return NULL;
	made->address = strdup(address);
	if (!made->address) {
		free(made);
		return NULL;
	}
	made->standing = standing;
	made->next = shares->addresses;
	return shares->addresses = made;
}

static cau_address_share *find_address(cau_shares *shares, const char *address,
                                       cau_standing standing)
{
	cau_address_share *a = shares->addresses;
	while (a && (a->standing != standing || strcmp(a->address, address) != 0))
		a = a->next;
	return a ? a : make_address(shares, address, standing);
}

void cau_shares_finish(cau_shares *shares)
{
	for (cau_address_share *a = shares->addresses, *next; a; a = next) {
		next = a->next;
		free_address(a);
	}
	shares->addresses = NULL;
}

// ---- connections
bool cau_share_open(cau_shares *shares, cau_share *share, const char *address,
                    cau_standing standing, double now_s)
{
	forget_idle(shares, now_s);
	cau_address_share *found = find_address(shares, address, standing);
	if (!found)
		return false;
	found->connections++;
	*share = (cau_share){.shares = shares, .address = found, .standing = standing};
	return true;
}

void cau_share_close(cau_share *share)
{
	if (share->shares)
		share->address->connections--;
	share->shares = NULL;
}

void cau_share_promote(cau_share *share, cau_standing standing, double now_s)
{
	cau_share old = *share;
	if (!cau_share_open(old.shares, share, old.address->address, standing, now_s))
		return;
	share->used = old.used;
	cau_share_close(&old);
}

void cau_share_charge(cau_share *share, double cpu_s, double now_s)
{
	cau_share_wait_s(share, now_s);
	share->used.used_s += cpu_s;
	share->address->used.used_s += cpu_s;
	share->shares->standings[share->standing].used_s += cpu_s;
}

double cau_share_wait_s(cau_share *share, double now_s)
{
	cau_time_used *all = &share->shares->standings[share->standing];
	double own_s = wait_s(&share->used, rates[share->standing].connection, now_s);
	double address_s = wait_s(&share->address->used, rates[share->standing].address, now_s);
	return fmax(own_s, fmax(address_s, wait_s(all, rates[share->standing].all, now_s)));
}

bool cau_share_precedes(const cau_share *share, const cau_share *other)
{
	if (share->standing != other->standing)
		return share->standing > other->standing;
	return share->used.used_s < other->used.used_s;
}

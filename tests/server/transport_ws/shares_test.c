// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the shares of the network thread's time: how much each client may use, and which client
// goes first.
#include "transport_ws/shares.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

typedef struct world {
	cau_shares shares;
	cau_share viewers[3], driver;
	double now_s;
} world;

// Opens two viewers and a driver behind one address, and one viewer behind another.
static void open_world(world *w)
{
	*w = (world){.now_s = 100};
	const char *addresses[] = {"192.0.2.1", "192.0.2.1", "198.51.100.2"};
	for (int i = 0; i < 3; i++)
		assert_true(cau_share_open(&w->shares, &w->viewers[i], addresses[i], CAU_STANDING_VIEWER,
		                           w->now_s));
	assert_true(cau_share_open(&w->shares, &w->driver, "192.0.2.1", CAU_STANDING_DRIVER, w->now_s));
}

static void close_world(world *w)
{
	for (int i = 0; i < 3; i++)
		cau_share_close(&w->viewers[i]);
	cau_share_close(&w->driver);
	cau_shares_finish(&w->shares);
}

// The clients use all the time that they get, a millisecond at a time. Returns the part of a core
// that they used.
static double flood(world *w, cau_share *const *shares, int count, int seconds)
{
	double used_s = 0;
	for (int ms = 0; ms < 1000 * seconds; ms++) {
		for (int i = 0; i < count; i++)
			if (cau_share_wait_s(shares[i], w->now_s) <= 0) {
				cau_share_charge(shares[i], 1e-3, w->now_s);
				used_s += 1e-3;
			}
		w->now_s += 1e-3;
	}
	return used_s / seconds;
}

static void quiet_clients_do_not_wait(void **state)
{
	(void)state;
	world w;
	open_world(&w);
	for (int second = 0; second < 100; second++) {
		w.now_s += 1;
		assert_true(cau_share_wait_s(&w.viewers[0], w.now_s) <= 0);
		cau_share_charge(&w.viewers[0], 5e-3, w.now_s);
	}
	close_world(&w);
}

static void a_flood_gets_its_share_and_no_more(void **state)
{
	(void)state;
	world w;
	open_world(&w);
	cau_share *both[] = {&w.viewers[0], &w.viewers[1]}, *all[] = {both[0], both[1], &w.viewers[2]};
	double connection = flood(&w, both, 1, 100);
	assert_true(connection > 0.049 && connection < 0.052);
	double address = flood(&w, both, 2, 100);
	assert_true(address > 0.098 && address < 0.102);
	double viewers = flood(&w, all, 3, 100);
	assert_true(viewers > 0.148 && viewers < 0.152);
	close_world(&w);
}

static void viewers_take_nothing_from_a_driver_behind_their_address(void **state)
{
	(void)state;
	world w;
	open_world(&w);
	cau_share *both[] = {&w.viewers[0], &w.viewers[1]};
	flood(&w, both, 2, 10);
	cau_share_charge(both[0], 1, w.now_s);
	assert_true(cau_share_wait_s(both[0], w.now_s) > 5);
	assert_true(cau_share_wait_s(both[1], w.now_s) > 5);
	assert_true(cau_share_wait_s(&w.driver, w.now_s) <= 0);
	close_world(&w);
}

static void drivers_go_first_then_who_used_less(void **state)
{
	(void)state;
	world w;
	open_world(&w);
	cau_share_charge(&w.driver, 5e-3, w.now_s);
	cau_share_charge(&w.viewers[0], 1e-3, w.now_s);
	assert_true(cau_share_precedes(&w.driver, &w.viewers[1]));
	assert_false(cau_share_precedes(&w.viewers[1], &w.driver));
	assert_true(cau_share_precedes(&w.viewers[1], &w.viewers[0]));
	close_world(&w);
}

static void a_new_connection_does_not_renew_the_share(void **state)
{
	(void)state;
	world w;
	open_world(&w);
	cau_share_charge(&w.viewers[0], 0.1, w.now_s);
	cau_share_close(&w.viewers[0]);
	cau_share_close(&w.viewers[1]);
	assert_true(
		cau_share_open(&w.shares, &w.viewers[0], "192.0.2.1", CAU_STANDING_UNKNOWN, w.now_s));
	// the client still has time to say hello
	assert_true(cau_share_wait_s(&w.viewers[0], w.now_s) <= 0);
	cau_share_promote(&w.viewers[0], CAU_STANDING_VIEWER, w.now_s);
	assert_true(cau_share_wait_s(&w.viewers[0], w.now_s) > 0.5);
	w.now_s += 2; // used time is given back and forgotten
	assert_true(
		cau_share_open(&w.shares, &w.viewers[1], "192.0.2.1", CAU_STANDING_VIEWER, w.now_s));
	assert_true(cau_share_wait_s(&w.viewers[1], w.now_s) <= 0);
	close_world(&w);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(quiet_clients_do_not_wait),
		cmocka_unit_test(a_flood_gets_its_share_and_no_more),
		cmocka_unit_test(viewers_take_nothing_from_a_driver_behind_their_address),
		cmocka_unit_test(drivers_go_first_then_who_used_less),
		cmocka_unit_test(a_new_connection_does_not_renew_the_share),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport_ws/network.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

#include "clock/clock.h"
#include "log/log.h"
#include "transport_ws/internal.h"
#include "worker/pool.h"

enum { TICK_MS = 100 };

// libwebsockets' log function has no context argument. So each thread serves one network.
static _Thread_local cau_network *own;

static void log_library(int level, const char *line)
{
	if (own)
		cau_unread_complaint(own, line);
	cau_log(level == LLL_ERR ? CAU_LOG_ERROR : CAU_LOG_WARNING, NULL, "libwebsockets",
	        "text=\"%.*s\"", (int)strcspn(line, "\n"), line);
}

static void set_protocols(cau_network *network)
{
	network->protocols[0] = (struct lws_protocols){.name = "http",
	                                               .callback = cau_http_callback,
	                                               .per_session_data_size = sizeof(cau_http_body)};
	network->protocols[1] =
		(struct lws_protocols){.name = CAU_SUBPROTOCOL,
	                           .callback = cau_ws_callback,
	                           .per_session_data_size = sizeof(cau_connection *)};
	network->protocols[2] = (struct lws_protocols){.name = "input", .callback = cau_input_callback};
}

// Sets the files of certificate and key. libwebsockets reads them first and makes the TLS context;
// afterwards cau_http_callback sets our own pair. The only protocol is HTTP/1.1: with
// libwebsockets' own list browsers would choose HTTP/2, over which libwebsockets offers no
// WebSocket that browsers support.
static void add_tls(const cau_network *network, struct lws_context_creation_info *info)
{
	info->options |= LWS_SERVER_OPTION_DO_SSL_GLOBAL_INIT;
	info->ssl_cert_filepath = network->def.config->tls_certificate;
	info->ssl_private_key_filepath = network->def.config->tls_key;
	info->ssl_cipher_list = cau_tls_ciphers;
	info->alpn = "http/1.1";
}

static cau_status open_context(cau_network *network, cau_error *error)
{
	cau_config *config = network->def.config;
	network->validity.secs_since_valid_ping = (uint16_t)fmax(1, config->ping_s);
	// Time after which libwebsockets ends a connection that sends, but answers no ping. A silent
	// connection is closed earlier, with a code (closing.c).
	network->validity.secs_since_valid_hangup = (uint16_t)fmax(6, 3 * config->ping_s + 3);
	struct lws_context_creation_info info = {
		.port = config->port ? (int)config->port : 0,
		.iface = config->listen,
		.protocols = network->protocols,
		.gid = -1,
		.uid = -1,
		.user = network,
		.retry_and_idle_policy = &network->validity,
		.options = LWS_SERVER_OPTION_FAIL_UPON_UNABLE_TO_BIND | LWS_SERVER_OPTION_EXPLICIT_VHOSTS,
	};
	if (network->tls)
		add_tls(network, &info);
	lws_set_log_level(LLL_ERR | LLL_WARN, log_library);
	network->context = lws_create_context(&info);
	if (!network->context)
		return cau_fail(error, CAU_IO, NULL, "libwebsockets did not start");
	info.vhost_name = "default";
	network->vhost = lws_create_vhost(network->context, &info);
	if (!network->vhost)
		return cau_fail(error, CAU_IO, "port", "cannot listen on %.60s port %lld", config->listen,
		                (long long)config->port);
	config->port = lws_get_vhost_listen_port(network->vhost);
	if (!cau_input_open(network))
		return network->input < 0
		           ? cau_fail(error, CAU_IO, NULL,
		                      "cannot create the epoll descriptor of the connections: %s",
		                      strerrordesc_np(errno))
		           : cau_fail(error, CAU_IO, NULL,
		                      "libwebsockets refuses the epoll descriptor of the connections");
	return CAU_OK;
}

cau_status cau_network_create(cau_network **made, const cau_network_def *def, cau_error *error)
{
	*made = NULL;
	cau_network *network = calloc(1, sizeof *network);
	if (!network)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for the network");
	network->def = *def;
	network->input = -1;
	set_protocols(network);
	cau_status status = cau_tls_create(&network->tls, def->config, error);
	if (!status)
		status = open_context(network, error);
	if (status)
		cau_network_destroy(network);
	else
		*made = network;
	return status;
}

static void tick(lws_sorted_usec_list_t *sul)
{
	cau_network *network = lws_container_of(sul, cau_network, sul);
	cau_network_comes_round(network);
	double now_s = cau_monotonic_s();
	cau_outsiders_tick(network, now_s);
	network->def.handler.tick(network->def.handler.user);
	for (cau_connection *c = network->connections; c; c = c->next)
		cau_connection_watch(c, now_s);
	lws_sul_schedule(network->context, 0, &network->sul, tick, TICK_MS * LWS_US_PER_MS);
}

static void *serve(void *argument)
{
	cau_network *network = argument;
	pthread_setname_np(pthread_self(), "cautery-net");
	cau_thread_set_nice(CAU_NICE_FIRST);
	lws_sul_schedule(network->context, 0, &network->sul, tick, TICK_MS * LWS_US_PER_MS);
	own = network;
	while (!network->ending || ((network->connections || network->lingering) &&
	                            cau_monotonic_s() < network->ending_until_s))
		if (lws_service(network->context, 0) < 0)
			break;
	lws_sul_schedule(network->context, 0, &network->sul, NULL, LWS_SET_TIMER_USEC_CANCEL);
	lws_sul_schedule(network->context, 0, &network->turns, NULL, LWS_SET_TIMER_USEC_CANCEL);
	return NULL;
}

cau_status cau_network_start(cau_network *network, cau_error *error)
{
	int code = pthread_create(&network->thread, NULL, serve, network);
	network->started = code == 0;
	return code ? cau_fail(error, CAU_NO_MEMORY, NULL,
	                       "cannot start the network thread: %s (its limit: ulimit -u)",
	                       strerrordesc_np(code))
	            : CAU_OK;
}

void cau_network_wake(cau_network *network)
{
	if (!atomic_exchange(&network->woken, true))
		lws_cancel_service(network->context);
}

void cau_network_stop(cau_network *network, cau_close_code code, double seconds)
{
	if (!network->started)
		return;
	network->ending_code = code;
	network->ending_until_s = cau_monotonic_s() + seconds;
	network->ending = true;
	lws_cancel_service(network->context);
	pthread_join(network->thread, NULL);
	network->started = false;
}

void cau_network_destroy(cau_network *network)
{
	if (!network)
		return;
	if (network->context)
		lws_context_destroy(network->context);
	if (network->input >= 0)
		close(network->input);
	cau_tls_destroy(network->tls);
	free(network->unread);
	cau_shares_finish(&network->shares);
	free(network);
}

cau_status cau_network_reload_tls(cau_network *network, cau_error *error)
{
	return network->tls ? cau_tls_reload(network->tls, network->def.config, error) : CAU_OK;
}

cau_connection *cau_network_first(cau_network *network)
{
	return network->connections;
}

cau_connection *cau_network_find(cau_network *network, uint64_t id)
{
	cau_connection *c = network->connections;
	while (c && c->id != id)
		c = c->next;
	return c;
}

cau_network_counts cau_network_count(cau_network *network)
{
	return network->counts;
}

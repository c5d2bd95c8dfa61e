// SPDX-License-Identifier: GPL-3.0-or-later
// The bytes of a connection that transport_ws reads and ends by itself, past libwebsockets. These
// are the bytes of its socket or, with TLS, the contents of its records. The library writes and
// transport_ws reads, both on one thread. So the TLS state has one user at a time.
#include <errno.h>
#include <openssl/err.h>
#include <openssl/ssl.h>
#include <sys/socket.h>

#include "transport_ws/internal.h"

static SSL *tls_of_wsi(struct lws *wsi)
{
	return cau_network_of(wsi)->tls ? lws_get_ssl(wsi) : NULL;
}

static SSL *tls_of(const cau_connection *c)
{
	return tls_of_wsi(c->wsi);
}

static ssize_t receive_tls(SSL *tls, void *bytes, size_t most)
{
	ERR_clear_error();
	int got = SSL_read(tls, bytes, (int)most);
	if (got > 0)
		return got;
	switch (SSL_get_error(tls, got)) {
	case SSL_ERROR_ZERO_RETURN:
		return 0;
	case SSL_ERROR_WANT_READ:
	// OpenSSL wants to write an answer to a key update. It is sent with the next bytes.
	case SSL_ERROR_WANT_WRITE:
		errno = EAGAIN;
		return -1;
	default: // the peer is gone, or sent something that is not TLS
		ERR_clear_error();
		errno = EIO;
		return -1;
	}
}

ssize_t cau_connection_receive(cau_connection *c, void *bytes, size_t most)
{
	SSL *tls = tls_of(c);
	return tls ? receive_tls(tls, bytes, most) : recv(c->descriptor, bytes, most, MSG_DONTWAIT);
}

bool cau_connection_has_more(const cau_connection *c)
{
	SSL *tls = tls_of(c);
	return tls && SSL_pending(tls) > 0;
}

static void put(SSL *tls, int descriptor, const void *bytes, size_t count)
{
	ERR_clear_error();
	if (tls ? SSL_write(tls, bytes, (int)count) <= 0
	        : send(descriptor, bytes, count, MSG_DONTWAIT | MSG_NOSIGNAL) < 0)
		ERR_clear_error(); // the peer is gone
}

void cau_connection_put(cau_connection *c, const void *bytes, size_t count)
{
	put(tls_of(c), c->descriptor, bytes, count);
}

// Sends the last bytes, then reads and drops the bytes that have arrived. Closing a socket with
// unread bytes resets it, and the reset may overtake the sent bytes.
void cau_wsi_last_words(struct lws *wsi, const void *bytes, size_t count)
{
	enum { DROPPED_MOST = 256, PIECE_BYTES = 4096 };
	char dropped[PIECE_BYTES];
	int descriptor = lws_get_socket_fd(wsi);
	put(tls_of_wsi(wsi), descriptor, bytes, count);
	shutdown(descriptor, SHUT_WR);
	for (int i = 0; i < DROPPED_MOST; i++)
		if (recv(descriptor, dropped, sizeof dropped, MSG_DONTWAIT) <= 0)
			return;
}

void cau_connection_shut(cau_connection *c)
{
	SSL *tls = tls_of(c);
	ERR_clear_error();
	if (tls && SSL_shutdown(tls) < 0)
		ERR_clear_error(); // an error here has no effect: the socket is shut anyway
	shutdown(c->descriptor, SHUT_WR);
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh/mesh_file.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cautery/assert.h"
#include "mesh/mesh_memory.h"

static const long long most_bytes = 1LL << 30;

// Reads until `wanted` bytes are there. Returns how many came, or -1 with errno set.
static ssize_t read_all(int file, char *bytes, size_t wanted)
{
	size_t done = 0;
	while (done < wanted) {
		ssize_t got = read(file, bytes + done, wanted - done);
		if (got < 0 && errno != EINTR)
			return -1;
		if (got == 0)
			break;
		done += got > 0 ? (size_t)got : 0;
	}
	return (ssize_t)done;
}

static cau_status load(int file, const char *path, void **bytes, size_t *byte_count,
                       cau_error *error)
{
	struct stat about;
	if (fstat(file, &about))
		return cau_fail(error, CAU_IO, NULL, "cannot read '%.180s': %s", path, strerror(errno));
	if (!S_ISREG(about.st_mode))
		return cau_fail(error, CAU_IO, NULL, "'%.180s' is not a regular file", path);
	if (about.st_size > most_bytes)
		return cau_fail(error, CAU_LIMIT, NULL, "'%.180s' has %lld bytes, at most %lld are read",
		                path, (long long)about.st_size, most_bytes);

	size_t wanted = (size_t)about.st_size;
	char *loaded = cau_mesh_array(wanted, 1);
	if (!loaded)
		return cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for %zu bytes", wanted);
	ssize_t got = read_all(file, loaded, wanted);
	if (got < 0) {
		free(loaded);
		return cau_fail(error, CAU_IO, NULL, "cannot read '%.180s': %s", path, strerror(errno));
	}
	*bytes = loaded;
	*byte_count = (size_t)got;
	return CAU_OK;
}

cau_status cau_mesh_file_load(const char *path, void **bytes, size_t *byte_count, cau_error *error)
{
	CAU_ASSERT(path[0] != 0, "a file without a name, for %p", (void *)bytes);
	int file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK); // a pipe would wait for its writer
	if (file < 0)
		return cau_fail(error, CAU_IO, NULL, "cannot open '%.180s': %s", path, strerror(errno));
	cau_status status = load(file, path, bytes, byte_count, error);
	close(file);
	return status;
}

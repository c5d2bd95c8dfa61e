// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh/mesh_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cautery/assert.h"
#include "mesh/mesh_memory.h"

enum { PATH_BYTES = 600 };
static const long long most_bytes = 1LL << 30;

// Reads until `wanted` bytes are read or the file ends. Returns the number of bytes, or -1 with
// errno set.
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

static cau_status load_one(const char *path, void **bytes, size_t *byte_count, cau_error *error)
{
	// Without O_NONBLOCK, open would wait for the writer of a pipe.
	int file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
	if (file < 0)
		return cau_fail(error, CAU_IO, NULL, "cannot open '%.180s': %s", path, strerror(errno));
	cau_status status = load(file, path, bytes, byte_count, error);
	close(file);
	return status;
}

// Finds the second file of a TetGen mesh, which has points and elements in two files of one name.
// Returns false if `path` is no TetGen file, or if there is no second file.
static bool find_partner(const char *path, char partner[static PATH_BYTES], bool *points)
{
	static const char *const pairs[][2] = {
		{".node", ".ele"}, {".node", ".face"}, {".ele", ".node"}, {".face", ".node"}};
	size_t length = strlen(path);
	for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
		size_t ending = strlen(pairs[i][0]);
		if (length < ending || strcasecmp(path + length - ending, pairs[i][0]) != 0)
			continue;
		int written =
			snprintf(partner, PATH_BYTES, "%.*s%s", (int)(length - ending), path, pairs[i][1]);
		*points = strcasecmp(pairs[i][0], ".node") == 0;
		if (written > 0 && written < PATH_BYTES && access(partner, R_OK) == 0)
			return true;
	}
	return false;
}

// Joins the two byte arrays with a line feed between them. Frees both.
static cau_status join(char *first, size_t first_count, char *second, size_t second_count,
                       void **bytes, size_t *byte_count, cau_error *error)
{
	char *joined = cau_mesh_array(first_count + 1 + second_count, 1);
	if (joined) {
		memcpy(joined, first, first_count);
		joined[first_count] = '\n';
		memcpy(joined + first_count + 1, second, second_count);
		*bytes = joined;
		*byte_count = first_count + 1 + second_count;
	}
	free(first);
	free(second);
	return joined ? CAU_OK : cau_fail(error, CAU_NO_MEMORY, NULL, "no memory for two files");
}

cau_status cau_mesh_file_load(const char *path, void **bytes, size_t *byte_count, cau_error *error)
{
	CAU_ASSERT(path[0] != 0, "a file without a name, for %p", (void *)bytes);
	char partner[PATH_BYTES];
	bool points = false;
	cau_status status = load_one(path, bytes, byte_count, error);
	if (status || !find_partner(path, partner, &points))
		return status;
	void *other = NULL;
	size_t other_count = 0;
	status = load_one(partner, &other, &other_count, error);
	if (status) {
		free(*bytes);
		*bytes = NULL;
		return status;
	}
	if (points)
		return join(*bytes, *byte_count, other, other_count, bytes, byte_count, error);
	return join(other, other_count, *bytes, *byte_count, bytes, byte_count, error);
}

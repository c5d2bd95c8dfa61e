// SPDX-License-Identifier: GPL-3.0-or-later
#include "http/static_files.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <zlib.h>

enum { MAX_FILES = 1024, MAX_BYTES = 64 << 20, MAX_DEPTH = 8 };

struct cau_static_files {
	const char *setting; // setting that names the folder, for errors
	cau_static_file files[MAX_FILES];
	size_t count;
	size_t bytes;
};

static const char plain_page[] =
	"<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>cauteryd</title>\n"
	"<h1>cauteryd is running</h1>\n"
	"<p>No viewer is installed here (setting <code>viewer</code>). "
	"<a href=\"/manual/\">Manual</a>, <a href=\"/api/sessions\">sessions</a>, <a "
	"href=\"/metrics\">metrics</a>.</p></html>\n";

static const char *content_type(const char *path)
{
	static const struct {
		const char *ending, *type;
	} types[] = {
		{".html", "text/html; charset=utf-8"},
		{".js", "text/javascript; charset=utf-8"},
		{".css", "text/css; charset=utf-8"},
		{".json", "application/json"},
		{".map", "application/json"},
		{".wasm", "application/wasm"},
		{".svg", "image/svg+xml"},
		{".png", "image/png"},
		{".jpg", "image/jpeg"},
		{".webp", "image/webp"},
		{".ico", "image/x-icon"},
		{".woff2", "font/woff2"},
		{".txt", "text/plain; charset=utf-8"},
		{".glb", "model/gltf-binary"},
	};
	const char *ending = strrchr(path, '.');
	for (size_t i = 0; ending && i < sizeof types / sizeof types[0]; i++)
		if (strcmp(ending, types[i].ending) == 0)
			return types[i].type;
	return "application/octet-stream";
}

// True for types of pictures and fonts that are compressed already. Compressing them again would
// only delay the start.
static bool is_packed(const char *type)
{
	return strcmp(type, "image/png") == 0 || strcmp(type, "image/jpeg") == 0 ||
	       strcmp(type, "image/webp") == 0 || strcmp(type, "font/woff2") == 0;
}

// Fills file->gzip if that saves at least a tenth.
static void compress_file(cau_static_file *file)
{
	z_stream z = {0};
	if (file->plain_bytes < 256 || is_packed(file->content_type) ||
	    deflateInit2(&z, 9, Z_DEFLATED, 15 + 16, 9, Z_DEFAULT_STRATEGY))
		return;
	uLong bound = deflateBound(&z, (uLong)file->plain_bytes);
	void *packed = malloc(bound);
	if (packed) {
		z.next_in = file->plain;
		z.avail_in = (uInt)file->plain_bytes;
		z.next_out = packed;
		z.avail_out = (uInt)bound;
		if (deflate(&z, Z_FINISH) == Z_STREAM_END &&
		    z.total_out < file->plain_bytes - file->plain_bytes / 10) {
			file->gzip = packed;
			file->gzip_bytes = z.total_out;
			packed = NULL;
		}
	}
	free(packed);
	deflateEnd(&z);
}

static cau_status add_file(cau_static_files *files, const char *url, void *bytes, size_t count)
{
	cau_static_file *file = &files->files[files->count++];
	snprintf(file->path, sizeof file->path, "%s", url);
	file->content_type = content_type(url);
	file->hashed = strncmp(url, "/assets/", 8) == 0;
	file->plain = bytes;
	file->plain_bytes = count;
	files->bytes += count;
	compress_file(file);
	return CAU_OK;
}

static cau_status read_file(cau_static_files *files, const char *path, const char *url, size_t size,
                            cau_error *error)
{
	if (files->count == MAX_FILES || files->bytes + size > MAX_BYTES || strlen(url) >= 256)
		return cau_fail(error, CAU_LIMIT, files->setting, "more than %d files or %d bytes",
		                MAX_FILES, MAX_BYTES);
	FILE *stream = fopen(path, "rb");
	void *bytes = malloc(size ? size : 1);
	size_t got = stream && bytes ? fread(bytes, 1, size, stream) : 0;
	if (stream)
		fclose(stream);
	if (!stream || !bytes || got != size) {
		free(bytes);
		return cau_fail(error, CAU_IO, files->setting, "cannot read %.200s", path);
	}
	return add_file(files, url, bytes, size);
}

static cau_status read_folder(cau_static_files *files, const char *folder, const char *url,
                              int depth, cau_error *error)
{
	DIR *directory = opendir(folder);
	if (!directory)
		return cau_fail(error, CAU_IO, files->setting, "cannot open the folder %.200s", folder);
	cau_status status = CAU_OK;
	for (struct dirent *entry; !status && (entry = readdir(directory));) {
		char path[1024], entry_url[512];
		struct stat info;
		snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
		snprintf(entry_url, sizeof entry_url, "%s/%s", url, entry->d_name);
		if (entry->d_name[0] == '.' || lstat(path, &info))
			continue;
		if (S_ISREG(info.st_mode))
			status = read_file(files, path, entry_url, (size_t)info.st_size, error);
		else if (S_ISDIR(info.st_mode) && depth < MAX_DEPTH)
			status = read_folder(files, path, entry_url, depth + 1, error);
	}
	closedir(directory);
	return status;
}

cau_status cau_static_files_load(cau_static_files **made, const char *setting, const char *folder,
                                 cau_error *error)
{
	*made = NULL;
	cau_static_files *files = calloc(1, sizeof *files);
	if (!files)
		return cau_fail(error, CAU_NO_MEMORY, setting, "no memory");
	files->setting = setting;
	cau_status status = CAU_OK;
	if (*folder) {
		status = read_folder(files, folder, "", 0, error);
	} else {
		void *page = strdup(plain_page);
		status = page ? add_file(files, "/index.html", page, sizeof plain_page - 1)
		              : cau_fail(error, CAU_NO_MEMORY, setting, "no memory");
	}
	if (status)
		cau_static_files_destroy(files);
	else
		*made = files;
	return status;
}

void cau_static_files_destroy(cau_static_files *files)
{
	for (size_t i = 0; files && i < files->count; i++) {
		free(files->files[i].plain);
		free(files->files[i].gzip);
	}
	free(files);
}

const cau_static_file *cau_static_files_find(const cau_static_files *files, const char *path)
{
	if (strcmp(path, "/") == 0)
		path = "/index.html";
	for (size_t i = 0; i < files->count; i++)
		if (strcmp(files->files[i].path, path) == 0)
			return &files->files[i];
	return NULL;
}

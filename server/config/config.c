// SPDX-License-Identifier: GPL-3.0-or-later
// The settings as a whole: set, read from all sources and checked.
#include "config/config.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "config/setting.h"

// ---- words for roles
static const char *const words[CAU_ROLE_COUNT] = {
#define X(code, name) [CAU_ROLE_##code] = (name),
	CAU_ROLE_TABLE(X)
#undef X
};

const char *cau_role_word(cau_role role)
{
	return words[role];
}

bool cau_role_read(const char *word, cau_role *role)
{
	for (int i = 0; i < CAU_ROLE_COUNT; i++)
		if (strcmp(word, words[i]) == 0) {
			*role = (cau_role)i;
			return true;
		}
	return false;
}

// ---- settings
void cau_config_default(cau_config *config)
{
	*config = (cau_config){0};
	for (size_t i = 0; i < cau_setting_count; i++)
		cau_setting_store(&cau_settings[i], config, cau_settings[i].default_text, NULL);
}

cau_status cau_config_set(cau_config *config, const char *name, const char *text, cau_error *error)
{
	const setting *found = cau_setting_find(name);
	if (!found)
		return cau_fail(error, CAU_NOT_FOUND, name, "there is no such setting");
	return cau_setting_store(found, config, text, error);
}

// True for the names of CAUTERY_* variables that are not settings. Programs read these variables
// elsewhere.
static bool no_setting(const char *name)
{
	static const char *const names[] = {"config", "meshes", "jobs"};
	for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
		if (strcmp(name, names[i]) == 0)
			return true;
	return false;
}

cau_status cau_config_read_environment(cau_config *config, char *const *environment,
                                       cau_error *error)
{
	static const char prefix[] = "CAUTERY_";
	for (; *environment; environment++) {
		const char *text = strchr(*environment, '=');
		if (!text || strncmp(*environment, prefix, sizeof prefix - 1) != 0)
			continue;
		char name[64] = "";
		const char *tail = *environment + sizeof prefix - 1;
		for (size_t i = 0; i < sizeof name - 1 && tail + i < text; i++)
			name[i] = (char)tolower((unsigned char)tail[i]);
		if (no_setting(name))
			continue;
		cau_status status = cau_config_set(config, name, text + 1, error);
		if (status) {
			if (error)
				snprintf(error->file, sizeof error->file, "environment");
			return status;
		}
	}
	return CAU_OK;
}

// Reads a flag that is not a setting. Returns false if the flag is a setting.
static bool read_request(cau_config_request *request, const char *flag)
{
	const struct {
		const char *name;
		bool *wanted;
	} requests[] = {{"--help", &request->help},
	                {"--version", &request->version},
	                {"--json", &request->json},
	                {"--print-config", &request->print_config},
	                {"--settings-schema", &request->settings_schema}};
	for (size_t i = 0; i < sizeof requests / sizeof requests[0]; i++)
		if (strcmp(flag, requests[i].name) == 0)
			return *requests[i].wanted = true;
	return false;
}

// True if the text is a switch's value. Without a value, `--dds` means `--dds true`.
static bool is_switch_value(const char *text)
{
	return strcmp(text, "true") == 0 || strcmp(text, "false") == 0;
}

// Reads the flags once. If `file` is given, reads only --config; otherwise all flags but --config.
static cau_status read_flags(cau_config *config, cau_config_request *request, const char **file,
                             int count, char *const *arguments, cau_error *error)
{
	for (int i = 1; i < count; i++) {
		const char *flag = arguments[i];
		if (strncmp(flag, "--", 2) != 0)
			return cau_fail(
				error, CAU_BAD_SYNTAX, flag,
				"is not a flag: a flag begins with --, with at most one value after it");
		if (read_request(request, flag))
			continue;
		char name[64];
		const char *equals = strchr(flag, '=');
		snprintf(name, sizeof name, "%.*s", equals ? (int)(equals - flag - 2) : 60, flag + 2);
		bool is_config = strcmp(name, "config") == 0, is_backup = strcmp(name, "backup") == 0;
		const setting *found = cau_setting_find(name);
		if (!is_config && !is_backup && !found)
			return cau_fail(error, CAU_NOT_FOUND, flag, "there is no such flag; see --help");
		const char *text = equals ? equals + 1 : NULL;
		if (!text && found && found->kind == SETTING_SWITCH)
			text = i + 1 < count && is_switch_value(arguments[i + 1]) ? arguments[++i] : "true";
		else if (!text && i + 1 < count)
			text = arguments[++i];
		if (!text)
			return cau_fail(error, CAU_BAD_SYNTAX, flag, "needs a value");
		if (is_config && file)
			*file = text;
		if (is_backup)
			request->backup = text;
		cau_status status = CAU_OK;
		if (found && !file)
			status = cau_config_set(config, name, text, error);
		if (status)
			return status;
	}
	return CAU_OK;
}

static const char *environment_value(char *const *environment, const char *name)
{
	size_t length = strlen(name);
	for (; *environment; environment++)
		if (strncmp(*environment, name, length) == 0 && (*environment)[length] == '=')
			return *environment + length + 1;
	return NULL;
}

static bool is_loopback(const char *address)
{
	return strncmp(address, "127.", 4) == 0 || strcmp(address, "::1") == 0 ||
	       strcmp(address, "localhost") == 0;
}

static cau_status check_together(const cau_config *config, cau_error *error)
{
	if (!is_loopback(config->listen) && !*config->tokens)
		return cau_fail(
			error, CAU_BAD_VALUE, "listen",
			"%.60s is not a loopback address: other addresses need a file of tokens (--tokens)",
			config->listen);
	if (!*config->tls_certificate != !*config->tls_key)
		return cau_fail(error, CAU_BAD_VALUE, *config->tls_key ? "tls_certificate" : "tls_key",
		                "TLS needs both a certificate and its key");
	if (!is_loopback(config->listen) && !*config->tls_certificate && !config->tls_by_proxy)
		return cau_fail(
			error, CAU_BAD_VALUE, "listen",
			"%.60s is not a loopback address: other addresses need TLS (--tls-certificate and "
			"--tls-key), or --tls-by-proxy if a proxy terminates TLS",
			config->listen);
	if (*config->dds_config && !*config->dds_security && !config->dds_network)
		return cau_fail(
			error, CAU_BAD_VALUE, "dds_config",
			"lets DDS leave this machine: set dds_security, or dds_network to allow it without");
	if (!cau_role_read(config->dds_role, &(cau_role){0}))
		return cau_fail(error, CAU_BAD_VALUE, "dds_role", "%.60s is not view, operate or admin",
		                config->dds_role);
	if (*config->dds_roles && !*config->dds_security)
		return cau_fail(error, CAU_BAD_VALUE, "dds_roles",
		                "has roles of DDS identities, which exist only with dds_security");
	return CAU_OK;
}

cau_status cau_config_load(cau_config *config, cau_config_request *request, int argument_count,
                           char *const *arguments, char *const *environment, cau_error *error)
{
	cau_config_default(config);
	*request = (cau_config_request){0};
	const char *file = environment_value(environment, "CAUTERY_CONFIG");
	cau_status status = read_flags(config, request, &file, argument_count, arguments, error);
	if (!status && file)
		status = cau_config_read_file(config, file, error);
	if (!status)
		status = cau_config_read_environment(config, environment, error);
	if (!status)
		status = read_flags(config, request, NULL, argument_count, arguments, error);
	return status ? status : check_together(config, error);
}

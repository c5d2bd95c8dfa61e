#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes a domain's authority and the identities of its participants, for DDS Security. See --help.
set -euo pipefail

usage() {
	cat <<'END'
Usage: deploy/dds/security/make.sh [options] FOLDER [ROLE NAME]...
       deploy/dds/security/make.sh --revoke NAME FOLDER

Makes the identities NAME, each with the permissions of its ROLE: daemon, controller or viewer. With
none named it makes three: `daemon daemon`, `controller controller` and `viewer viewer`. In a FOLDER
that has none yet it first makes the authority: two self-signed certificates, one that vouches for
identities and one that signs governance and permissions.

  --revoke NAME  takes the identity NAME back: puts it on the list of revoked certificates, crl.pem,
                 that lies in FOLDER/public, and copies the list into every folder of enclaves. Who
                 starts with the new list lets the identity in no more
  --session ID   controllers and viewers made now may reach this session alone, and controllers may
                 not ask for sessions
  --days N       how long certificates and permissions hold (default 365)
  --plugins DIR  where Cyclone's security plugins are (default: searched for)
  --help         this text

FOLDER/enclaves/NAME/ then holds, named as in a keystore of ROS 2 (SROS2):
  identity_ca.cert.pem permissions_ca.cert.pem cert.pem key.pem governance.p7s permissions.p7s
  crl.pem
  cyclonedds.xml   for Cyclone programs, beside the configuration of the network:
                   CYCLONEDDS_URI=file://.../network.xml,file://FOLDER/enclaves/NAME/cyclonedds.xml
  loopback-fastdds.xml   for Fast DDS programs on one machine: FASTRTPS_DEFAULT_PROFILES_FILE names it
cauteryd takes the folder: --dds-security FOLDER/enclaves/daemon --dds-config .../network.xml

FOLDER/private/ holds the authority's keys: keep it off the machines that only take part. The
permissions are made from permissions-ROLE.xml, and the governance from governance.xml, beside this
script.
END
}

fail() {
	echo "make.sh: $*" >&2
	exit 2
}

session='*' days=365 plugins='' revoke='' words=()
while [ $# -gt 0 ]; do
	case $1 in
	--session | --days | --plugins | --revoke)
		[ $# -gt 1 ] || fail "$1 needs a value"
		declare "${1#--}=$2"
		shift
		;;
	--help | -h)
		usage
		exit 0
		;;
	-*) fail "unknown option '$1'; see --help" ;;
	*) words+=("$1") ;;
	esac
	shift
done
[ ${#words[@]} -ge 1 ] || fail "needs FOLDER; see --help"
[[ $session =~ ^(\*|[a-z][a-z0-9]*([_-][a-z0-9]+)*)$ ]] || fail "'$session' is no session's id"
[[ $days =~ ^[1-9][0-9]{0,4}$ ]] || fail "'$days' is no number of days"

# Requests are in the partition `cautery`, and name any session.
control=cautery
[ "$session" = '*' ] || control=$session

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
folder=${words[0]}
identities=("${words[@]:1}")
if [ -n "$revoke" ]; then
	[ ${#identities[@]} -eq 0 ] || fail "--revoke takes FOLDER alone"
	[ -e "$folder/enclaves/$revoke/cert.pem" ] || fail "$folder has no identity '$revoke'"
elif [ ${#identities[@]} -eq 0 ]; then
	identities=(daemon daemon controller controller viewer viewer)
fi
[ $((${#identities[@]} % 2)) -eq 0 ] || fail "each identity needs a role and a name"

find_plugins() {
	local candidate
	for candidate in /usr/lib/*/libddsc0debian /usr/local/lib /usr/lib /usr/lib/*; do
		if [ -e "$candidate/libdds_security_auth.so" ]; then
			echo "$candidate"
			return
		fi
	done
	fail "Cyclone's security plugins (libdds_security_auth.so) are not found; see --plugins"
}
plugins=${plugins:-$(find_plugins)}

umask 077
mkdir -p "$folder/private" "$folder/public" "$folder/enclaves"
folder=$(cd "$folder" && pwd)
not_before=$(date -u -d '1 day ago' +%Y-%m-%dT%H:%M:%S)
not_after=$(date -u -d "$days days" +%Y-%m-%dT%H:%M:%S)

make_key() {
	openssl genpkey -algorithm EC -pkeyopt ec_paramgen_curve:P-256 -out "$1" 2>/dev/null
}

# authority NAME COMMON_NAME
authority() {
	[ -e "$folder/private/$1.key.pem" ] && return
	make_key "$folder/private/$1.key.pem"
	openssl req -new -x509 -sha256 -days "$days" -subj "/O=Cautery/CN=$2" \
		-key "$folder/private/$1.key.pem" -out "$folder/public/$1.cert.pem"
}

# sign FROM TO: as the permissions' authority.
sign() {
	openssl smime -sign -text -in "$1" -out "$2" \
		-signer "$folder/public/permissions_ca.cert.pem" \
		-inkey "$folder/private/permissions_ca.key.pem"
}

# list_revoked [CERTIFICATE]: writes the list anew, with this one added, and copies it to everybody. It
# holds longer than any certificate: who has an expired list lets nobody in.
list_revoked() {
	local private=$folder/private enclave
	local as_authority=(openssl ca -config "$private/revoked.cnf"
		-keyfile "$private/identity_ca.key.pem" -cert "$folder/public/identity_ca.cert.pem")
	touch "$private/revoked.txt"
	printf '[ca]\ndefault_ca = list\n[list]\ndatabase = %s\ndefault_md = sha256\n' \
		"$private/revoked.txt" >"$private/revoked.cnf"
	if [ $# -gt 0 ]; then
		"${as_authority[@]}" -revoke "$1" 2>"$private/revoked.log" || fail "$(<"$private/revoked.log")"
	fi
	"${as_authority[@]}" -gencrl -crldays 36500 -out "$folder/public/crl.pem" 2>/dev/null
	for enclave in "$folder"/enclaves/*/; do
		[ ! -e "$enclave/cert.pem" ] || cp "$folder/public/crl.pem" "$enclave/"
	done
}

# fill TEMPLATE NAME TO
fill() {
	sed -e "s|@NAME@|$2|g" -e "s|@SUBJECT@|CN=$2,O=Cautery|g" \
		-e "s|@NOT_BEFORE@|$not_before|g" -e "s|@NOT_AFTER@|$not_after|g" \
		-e "s|@CONTROL@|$control|g" -e "s|@SESSION@|$session|g" -e "s|@ROS_SESSION@|${session//-/_}|g" \
		-e "s|@PLUGINS@|$plugins|g" -e "s|@ENCLAVE@|$folder/enclaves/$2|g" "$1" >"$3"
}

# identity ROLE NAME
identity() {
	local role=$1 name=$2 enclave=$folder/enclaves/$2 work
	[[ $name =~ ^[a-z][a-z0-9]*([_-][a-z0-9]+)*$ ]] || fail "'$name' is no name"
	[ -e "$here/permissions-$role.xml" ] || fail "'$role' is no role"
	[ ! -e "$enclave" ] || fail "$enclave is there already"
	mkdir "$enclave"
	work=$(mktemp -d)
	make_key "$enclave/key.pem"
	openssl req -new -sha256 -subj "/O=Cautery/CN=$name" -key "$enclave/key.pem" -out "$work/request"
	openssl x509 -req -sha256 -days "$days" -in "$work/request" -set_serial "0x$(openssl rand -hex 8)" \
		-CA "$folder/public/identity_ca.cert.pem" -CAkey "$folder/private/identity_ca.key.pem" \
		-out "$enclave/cert.pem" 2>/dev/null
	fill "$here/permissions-$role.xml" "$name" "$work/permissions"
	sign "$work/permissions" "$enclave/permissions.p7s"
	cp "$folder/public/governance.p7s" "$folder/public/identity_ca.cert.pem" \
		"$folder/public/permissions_ca.cert.pem" "$folder/public/crl.pem" "$enclave/"
	fill "$here/cyclonedds.xml" "$name" "$enclave/cyclonedds.xml"
	fill "$here/fastdds-properties.xml" "$name" "$work/properties"
	awk -v properties="$work/properties" \
		'/<\/rtps>/ { while ((getline line <properties) > 0) print line } { print }' \
		"$here/../loopback-fastdds.xml" >"$enclave/loopback-fastdds.xml"
	rm -r "$work"
	echo "$enclave: $role CN=$name,O=Cautery"
}

authority identity_ca 'identities'
authority permissions_ca 'permissions'
if [ ! -e "$folder/public/governance.p7s" ]; then
	sign "$here/governance.xml" "$folder/public/governance.p7s"
fi
if [ -n "$revoke" ]; then
	list_revoked "$folder/enclaves/$revoke/cert.pem"
	echo "$folder/public/crl.pem: CN=$revoke,O=Cautery is taken back"
	exit 0
fi
[ -e "$folder/public/crl.pem" ] || list_revoked
for ((i = 0; i < ${#identities[@]}; i += 2)); do
	identity "${identities[i]}" "${identities[i + 1]}"
done

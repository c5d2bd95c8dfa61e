// SPDX-License-Identifier: Apache-2.0
// Reads and writes little-endian numbers in byte arrays, on any machine and at any alignment.
#pragma once

#include <stdint.h>
#include <string.h>

static inline uint16_t load_u16(const uint8_t *at)
{
	return (uint16_t)(at[0] | at[1] << 8);
}

static inline uint32_t load_u32(const uint8_t *at)
{
	return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

static inline uint64_t load_u64(const uint8_t *at)
{
	return load_u32(at) | (uint64_t)load_u32(at + 4) << 32;
}

static inline float load_f32(const uint8_t *at)
{
	uint32_t bits = load_u32(at);
	float value;
	memcpy(&value, &bits, sizeof value);
	return value;
}

static inline double load_f64(const uint8_t *at)
{
	uint64_t bits = load_u64(at);
	double value;
	memcpy(&value, &bits, sizeof value);
	return value;
}

static inline void store_u16(uint8_t *at, uint16_t value)
{
	at[0] = (uint8_t)value;
	at[1] = (uint8_t)(value >> 8);
}

static inline void store_u32(uint8_t *at, uint32_t value)
{
	store_u16(at, (uint16_t)value);
	store_u16(at + 2, (uint16_t)(value >> 16));
}

static inline void store_u64(uint8_t *at, uint64_t value)
{
	store_u32(at, (uint32_t)value);
	store_u32(at + 4, (uint32_t)(value >> 32));
}

static inline void store_f32(uint8_t *at, float value)
{
	uint32_t bits;
	memcpy(&bits, &value, sizeof bits);
	store_u32(at, bits);
}

static inline void store_f64(uint8_t *at, double value)
{
	uint64_t bits;
	memcpy(&bits, &value, sizeof bits);
	store_u64(at, bits);
}

static inline size_t round_up_4(size_t bytes)
{
	return (bytes + 3) & ~(size_t)3;
}

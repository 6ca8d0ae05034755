// What is fuzzed: everything that is read from outside. A target takes any bytes and ends the program when a promise does not
// hold.
#pragma once

#include <cstdint>
#include <span>

namespace brume::fuzz {

using Bytes = std::span<const uint8_t>;

void message(Bytes input); // wire::parse, and every field that either side reads of what it lets through
void session(Bytes input); // SessionRules through records of messages, texts, ticks and waits: session.cpp has their form
void query(Bytes input);   // lines: a request's target (page, picture query), its Origin, its Host
void scene(Bytes input);   // a scene file; a first line "--set KEY=VALUE" is an override
void ply(Bytes input);     // a point cloud
void costs(Bytes input);   // what calibration wrote
void token(Bytes input);   // a token, and a request that may hold one

struct Target {
    const char* name;
    void (*run)(Bytes input);
};
inline constexpr Target kTargets[] = {{"message", message}, {"session", session}, {"query", query}, {"scene", scene},
                                      {"ply", ply},         {"costs", costs},     {"token", token}};

} // namespace brume::fuzz

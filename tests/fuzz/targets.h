// Fuzz targets: one for everything that the programs read from outside. A target takes any bytes, and ends the
// program if a promise does not hold.
#pragma once

#include <cstdint>
#include <span>

namespace brume::fuzz {

using Bytes = std::span<const uint8_t>;

void message(Bytes input);   // wire::parse(), then every field that server and client read of a valid message
void session(Bytes input);   // SessionRules; the bytes are messages, texts, ticks and waits, see session.cpp
void query(Bytes input);     // lines of an HTTP request: target (page, picture query), Origin, Host
void scene(Bytes input);     // a scene file; a first line "--set KEY=VALUE" is an override
void ply(Bytes input);       // a point cloud
void volume(Bytes input);    // a volume of the format NRRD
void gltf(Bytes input);      // a mesh
void costs(Bytes input);     // a cost file of `brume-bench calibrate`
void token(Bytes input);     // a token, and a request that may carry one
void cluster(Bytes input);   // a message of the log of several servers, and its state
void forwarded(Bytes input); // lines of X-Forwarded-For, and networks of trusted proxies
void proxy(Bytes input);     // the PROXY protocol header of a gateway, and what follows it

struct Target {
    const char* name;
    void (*run)(Bytes input);
};
inline constexpr Target kTargets[] = {
    {"message", message}, {"session", session}, {"query", query},         {"scene", scene},
    {"ply", ply},         {"volume", volume},   {"gltf", gltf},           {"costs", costs},
    {"token", token},     {"proxy", proxy},     {"forwarded", forwarded}, {"cluster", cluster}};

} // namespace brume::fuzz

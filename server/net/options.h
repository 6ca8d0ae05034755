// What an operator may set of the network, and the limits that keep one viewer from harming the others.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "server/net/address.h"

namespace brume::net {

struct NetOptions {
    std::string listen = "127.0.0.1"; // this machine only; 0.0.0.0 or :: for everyone
    uint16_t port = 8080;             // 0 takes a free one
    uint16_t agent_port = 0;          // answers HAProxy's agent-check (agent.h); 0: none does
    // True: every connection to `port` begins with the header of a gateway (proxy_header.h), which says whose it is.
    bool proxy_protocol = false;
    // Proxies whose header X-Forwarded-For says whose a request is (address.h). Empty: nobody's is read.
    std::vector<Network> trusted_proxies;
    std::filesystem::path web_root; // the built page
    // Origins ("https://clouds.example") whose pages may open the WebSocket besides our own; "*" for any.
    std::vector<std::string> allowed_origins;
    // Names, without port, that requests may have in their Host header, besides those that hostAllowed() takes by
    // itself (origin.h). For a server without a token key: with one the Host header is not looked at.
    std::vector<std::string> hosts;
    uint32_t threads = 1; // threads that serve connections; one is enough for the default number of viewers

    // Trust.
    std::string token_key;                          // of good tokens (token.h); empty: everyone is operator
    std::filesystem::path tls_certificate, tls_key; // PEM; empty: no TLS

    // Counts. The Audience limits viewers and their unacknowledged frames.
    uint32_t max_connections = 1280, max_connections_per_address = 128;
    // At one time, each is also a viewer; one owner has three quarters (places.h).
    uint32_t max_streams = 8; // MJPEG
    uint32_t max_snapshots = 4;

    // Bytes.
    uint32_t max_message_bytes = 64 << 10; // of a viewer's message; those of the own clients are below 1 KiB
    uint32_t max_header_bytes = 8 << 10;   // of an HTTP request, with its first line
    uint32_t max_target_bytes = 2 << 10;   // path and query
    uint64_t max_upload = 64 << 20;        // one uploaded point cloud; 0: none can be uploaded

    // Time.
    // Connected -> the gateway's header read; that -> request's header read; its first byte -> all of it; upgraded ->
    // hello; hello -> pose.
    std::chrono::milliseconds handshake{5000};
    std::chrono::milliseconds keep_alive{10000};  // an HTTP connection waits for another request
    std::chrono::milliseconds idle{60000};        // of a WebSocket: nothing received; half of it, and a ping is sent
    std::chrono::milliseconds write_stall{10000}; // a write does not finish, or the peer does not take its bytes
    std::chrono::milliseconds frame_wait{20000};  // a snapshot or stream waits for its first frame
    std::chrono::milliseconds silence{15000};     // frames were sent, and the viewer acknowledged none

    // Rates, 1/s; a burst may be as long as `burst_s` seconds of it.
    double accept_rate = 100; // connections of one address; more are turned away
    // Per viewer.
    double pose_rate = 250;     // newer poses replace older ones, the newest is never lost
    double input_rate = 120;    // more are refused
    double message_rate = 2000; // more are read later
    double burst_s = 2;

    // Pictures, of one eye. A larger size is scaled down with its aspect kept.
    uint16_t default_width = 640, default_height = 360;
    uint16_t max_side = 3840;
    uint32_t max_pixels = 1920 * 1080;
    uint8_t default_quality = 80; // JPEG, 1...100
    float max_stream_fps = 60;
};

inline constexpr uint16_t kMinSide = 16;

} // namespace brume::net

#include "server/options/groups.h"

namespace brume {

void addLimitOptions(OptionTable& table, ServerOptions& o) {
    OptionGroup g(table, "Limits");
    g.option("--max-viewers", o.max_viewers, "who get pictures; MJPEG streams and snapshots count")
        .range(1, 1000)
        .live();
    g.option("--max-drawing-viewers", o.max_drawing_viewers,
             "besides them: who draws by himself; three quarters for one address or token name")
        .range(0, 10'000)
        .live();
    g.option("--max-viewers-per-address", o.max_viewers_per_owner, "and with tokens of each name in them")
        .range(1, 1000)
        .live();
    g.option("--max-in-flight", o.max_in_flight, "frames a viewer may leave unacknowledged").range(1, 16);
    g.mebibytes("--memory", o.frame.memory,
                "that particles may take on the CPU and on the device; a scene with more is refused")
        .range(1u, 65536u);
    g.mebibytes("--picture-memory", o.frame.picture_memory,
                "that picture buffers may take; viewers whose pictures need more are refused")
        .range(16u, 65536u);
    g.option("--max-connections", o.net.max_connections, "open sockets; a few more answer health checks")
        .range(1, 65535)
        .live();
    g.option("--max-connections-per-address", o.net.max_connections_per_address, "open sockets of one address")
        .range(1, 65535)
        .live();
    g.option("--max-streams", o.net.max_streams,
             "MJPEG streams at a time; three quarters for one address or token name")
        .range(0, 1000)
        .live();
    g.option("--max-snapshots", o.net.max_snapshots,
             "snapshots at a time; three quarters for one address or token name")
        .range(0, 1000)
        .live();
    g.option("--lit-rate", o.frame.lit_rate,
             "kB/s of lit particles for a viewer who draws by himself; an eighth of all messages comes in any case")
        .range(10.0, 100'000.0);
    g.option("--max-pixels", o.net.max_pixels, "of one picture; a larger wish is scaled down")
        .range(256, 8192 * 8192)
        .live();
    g.option("--max-message-bytes", o.net.max_message_bytes, "of one message from a viewer")
        .range(1024, 1 << 20)
        .live();
    g.mebibytes("--max-upload", o.net.max_upload, "of one uploaded point cloud; 0: none can be uploaded")
        .range(0u, 512u)
        .live();
    g.option("--quality", o.net.default_quality, "JPEG quality unless a viewer wishes another")
        .standing(std::to_string(o.net.default_quality))
        .range(1, 100)
        .live();
    g.perSecond("--accept-rate", o.net.accept_rate, "connections of one address; more are turned away").live();
    g.milliseconds("--handshake", o.net.handshake, "for a request's header, for Hello, and then for the first pose")
        .live();
    g.milliseconds("--idle", o.net.idle, "a viewer that is silent for this long is closed").live();
    g.perSecond("--pose-rate", o.net.pose_rate, "poses of a viewer; of more the newest is shown later").live();
    g.perSecond("--input-rate", o.net.input_rate, "commands of a viewer; more are refused").live();
    g.perSecond("--message-rate", o.net.message_rate, "messages of a viewer; of more we read more slowly").live();
}

} // namespace brume

// Every viewer as it is now, for operators. Prometheus does not get this: labels of viewers, who come and go, would
// never end.
#pragma once

#include <string>

#include "server/viewer/audience.h"

namespace brume::net {

// {"viewers": [{"id", "size", "eyes", "window_frames", "frames_in_flight", "bytes_in_flight", "round_trip_ms",
// "queue_ms", "quality": {"jpeg", "half", "every", "link_step", "device_step"}, "frames_per_second", "frames":
// {"rendered", "sent", "superseded"}, "stages_ms": {"wait": {"p50", "p95", "p99"}, ...}, "error": {METHOD:
// {"relative_rmse", "low", "high", "predicted", "bias", "pixels"}, ...}}]}, at most --max-viewers of them. "error" is
// measured, and empty until that is known.
std::string viewersJson(const Audience& audience);

} // namespace brume::net

#include "server/cluster/log.h"

#include "server/sim/state_bytes.h"
#include "tests/fuzz/promise.h"

namespace brume::fuzz {

// A message of the log that servers of a cluster share, and the same bytes as the log's state in a snapshot.
void cluster(Bytes input) {
    using namespace brume::cluster;
    const std::string_view text = textOf(input);
    if (const auto message = unpack(text)) {
        const std::string packed = pack(*message);
        const auto again = unpack(packed);
        promise(again.has_value(), "what is packed can be read", packed);
        promise(pack(*again) == packed, "it says the same", packed);
        Log log;
        const auto step = log.take(*message);
        promise(!step || (step->first <= step->last && step->last <= kMostAdvance), "ticks are bounded", packed);
        promise(Log::load(log.save()).save() == log.save(), "the state can be saved", log.save());
    }
    try {
        promise(!Log::load(text).save().empty(), "what was loaded can be saved");
    } catch (const StateError& error) {
        promise(std::string_view(error.what()).size() > 0, "a refusal says why");
    }
}

} // namespace brume::fuzz

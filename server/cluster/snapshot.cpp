#include "server/cluster/snapshot.h"

#include <algorithm>
#include <cstring>
#include <exception>
#include <functional>
#include <limits>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/whole_number.h"
#include "server/sim/state_hash.h"

namespace brume::cluster {
namespace {

constexpr uint64_t kMostBytes = 1ull << 30; // of a snapshot
constexpr uint32_t kSlots = 2;              // kept in turn, so that one is always whole

std::string manifestKey(uint32_t slot) { return fmt::format("{}.manifest", slot); }
std::string partKey(uint32_t slot, size_t part) { return fmt::format("{}.{}", slot, part); }

std::span<const std::byte> bytesOf(std::string_view text) {
    return {reinterpret_cast<const std::byte*>(text.data()), text.size()};
}

uint64_t checksum(std::span<const std::byte> bytes) { return XXH3_64bits(bytes.data(), bytes.size()); }

} // namespace

uint64_t hashOf(std::string_view text) { return XXH3_64bits(text.data(), text.size()); }

std::optional<Manifest> Snapshots::manifest(uint32_t slot) {
    const auto bytes = engine_.get(manifestKey(slot));
    if (!bytes) return {};
    try {
        const auto in = nlohmann::json::parse(reinterpret_cast<const char*>(bytes->data()),
                                              reinterpret_cast<const char*>(bytes->data() + bytes->size()));
        const auto number = [&](const char* key) { return wholeNumber(in.at(key)); };
        const uint64_t created = number("created");
        if (created > uint64_t(std::numeric_limits<int64_t>::max())) return {};
        return Manifest{number("tick"),   number("hash"),  number("sequence"), number("message"),
                        int64_t(created), number("bytes"), number("checksum")};
    } catch (const std::exception&) {
        return {};
    }
}

// Its manifest comes last. While the parts are written their checksum tells that they are not whole.
uint64_t Snapshots::write(const SavedState& state, int64_t created) {
    std::vector<std::byte> all;
    StateBytes out(all);
    std::string log = state.at.log;
    out.value(log, log.size());
    all.insert(all.end(), state.simulation.begin(), state.simulation.end());
    const auto age = [&](uint32_t slot) {
        const auto there = manifest(slot);
        // One of a message that comes only now is of a log that has lost its end.
        const bool good = there && there->created == created && there->sequence < state.at.sequence;
        return good ? there->tick : 0;
    };
    const uint32_t slot = age(0) <= age(1) ? 0 : 1;
    for (size_t at = 0, part = 0; at < all.size(); at += Engine::kMostBytes, ++part)
        engine_.put(partKey(slot, part), std::span(all).subspan(at, std::min(Engine::kMostBytes, all.size() - at)));
    const std::string text =
        nlohmann::json{{"tick", state.tick},          {"hash", state.hash}, {"sequence", state.at.sequence},
                       {"message", state.at.message}, {"created", created}, {"bytes", all.size()},
                       {"checksum", checksum(all)}}
            .dump();
    engine_.put(manifestKey(slot), bytesOf(text));
    return all.size();
}

// Its message may be dropped by the log's limit, as long as the next one is there.
bool Snapshots::isOf(const Engine::LogInfo& log, const Manifest& snapshot) const {
    const uint64_t at = snapshot.sequence;
    if (snapshot.created != log.created || snapshot.bytes > kMostBytes || at > log.last || at + 1 < log.first)
        return false;
    const auto message = engine_.message(at);
    return message ? hashOf(*message) == snapshot.message : at < log.first;
}

std::optional<SavedState> Snapshots::read(const Engine::LogInfo& log, uint64_t last_tick, bool& changing) {
    std::vector<std::pair<Manifest, uint32_t>> good;
    for (uint32_t slot = 0; slot < kSlots; ++slot)
        if (const auto there = manifest(slot); there && there->tick <= last_tick && isOf(log, *there))
            good.emplace_back(*there, slot);
    std::ranges::sort(good, std::greater(), [](const auto& one) { return one.first.tick; });
    for (const auto& [newest, slot] : good)
        if (auto whole = state(slot, newest)) {
            changing = false;
            return whole;
        }
    changing = !good.empty();
    return {};
}

// Nothing: its parts are being replaced.
std::optional<SavedState> Snapshots::state(uint32_t slot, const Manifest& of) {
    std::vector<std::byte> all;
    all.reserve(of.bytes);
    for (size_t part = 0; all.size() < of.bytes; ++part) {
        const auto bytes = engine_.get(partKey(slot, part));
        if (!bytes || bytes->empty()) return {};
        all.insert(all.end(), bytes->begin(), bytes->end());
    }
    if (all.size() != of.bytes || checksum(all) != of.checksum) return {};
    SavedState state{of.tick, of.hash, {of.sequence, of.message, {}}, {}};
    StateBytes in{std::span<const std::byte>(all)};
    in.value(state.at.log, all.size());
    state.simulation.assign(in.left().begin(), in.left().end());
    return state;
}

} // namespace brume::cluster

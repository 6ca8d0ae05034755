#include "server/cluster/handover.h"

#include <utility>

namespace brume::cluster {

void Handover::give(uint64_t last, std::vector<Command> commands, std::optional<LogPoint> save) {
    const std::scoped_lock lock(mutex_);
    runs_.push_back({last, std::move(commands), std::move(save)});
    given_ = last;
}

void Handover::begin(std::vector<std::byte> state, uint64_t tick) {
    const std::scoped_lock lock(mutex_);
    runs_.clear();
    save_.reset();
    hashes_.fill({});
    given_ = taken_ = tick;
    present_ = {tick, 0};
    beginning_ = std::move(state);
}

void Handover::fail(std::exception_ptr failure) {
    const std::scoped_lock lock(mutex_);
    failure_ = std::move(failure);
}

void Handover::stand(const char* why) {
    const std::scoped_lock lock(mutex_);
    standstill_ = why;
}

uint64_t Handover::behind() const {
    const std::scoped_lock lock(mutex_);
    return given_ - taken_;
}

std::optional<uint64_t> Handover::hashOf(uint64_t tick) const {
    const std::scoped_lock lock(mutex_);
    const Known& known = hashes_[tick % kHashes];
    return known.tick == tick && known.hash != 0 ? std::optional(known.hash) : std::nullopt;
}

std::pair<uint64_t, uint64_t> Handover::present() const {
    const std::scoped_lock lock(mutex_);
    return {present_.tick, present_.hash};
}

// Nothing while a beginning waits: what was given belongs to it.
bool Handover::take(std::vector<Command>& commands) {
    const std::scoped_lock lock(mutex_);
    if (failure_) std::rethrow_exception(failure_);
    if (beginning_ || runs_.empty()) return false;
    Run& run = runs_.front();
    commands = std::exchange(run.commands, {});
    ++taken_;
    if (taken_ == run.last) {
        save_ = std::move(run.save);
        runs_.pop_front();
    }
    return true;
}

std::optional<std::vector<std::byte>> Handover::beginning() {
    const std::scoped_lock lock(mutex_);
    return std::exchange(beginning_, std::nullopt);
}

const char* Handover::standstill() const {
    const std::scoped_lock lock(mutex_);
    return standstill_;
}

void Handover::ticked(const Simulation& simulation) {
    std::optional<LogPoint> save;
    const Known now{simulation.tick(), simulation.stateHash()};
    {
        const std::scoped_lock lock(mutex_);
        if (beginning_) return; // of a state that is left
        hashes_[now.tick % kHashes] = present_ = now;
        save = std::exchange(save_, std::nullopt);
    }
    passed_(now.tick);
    if (!save) return;
    SavedState saved{now.tick, now.hash, *std::move(save), {}};
    simulation.save(saved.simulation);
    saved_(std::move(saved));
}

} // namespace brume::cluster

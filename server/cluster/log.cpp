#include "server/cluster/log.h"

#include <algorithm>
#include <utility>

#include <nlohmann/json.hpp>

#include "common/whole_number.h"
#include "server/sim/state_bytes.h"

namespace brume::cluster {
namespace {

using nlohmann::json;

size_t rowBytes(const Command& command) {
    const auto* particles = std::get_if<SetParticles>(&command.body);
    return particles ? particles->rows->bytes() : 0;
}

} // namespace

// Null: there are too many servers. Then it is as if it had said nothing.
Log::Node* Log::node(const std::string& name) {
    if (!nodes_.contains(name) && nodes_.size() >= kMostNodes) return nullptr;
    Node& found = nodes_[name];
    found.heard = tick_;
    return &found;
}

std::optional<Log::Step> Log::take(LogMessage message) {
    if (const auto* to = std::get_if<Advance>(&message)) return advance(*to);
    if (auto* here = std::get_if<Here>(&message)) {
        if (Node* const from = node(here->node)) {
            from->here_at = tick_;
            from->here = std::move(*here);
        }
    } else if (auto& command = std::get<NodeCommand>(message); Node* const from = node(command.node)) {
        if (command.number != from->number + 1) return {};
        from->number = command.number;
        waiting_.push_back(std::move(command));
    }
    return {};
}

// A tick takes as many pushes and rows as a simulation allows in one; the others wait for the next.
std::optional<Log::Step> Log::advance(const Advance& to) {
    if (to.tick <= tick_ || to.tick - tick_ > kMostAdvance) return {};
    Step step{tick_ + 1, to.tick, {}};
    uint32_t pushes = 0;
    size_t bytes = 0;
    for (; !waiting_.empty(); waiting_.pop_front()) {
        const Command& next = waiting_.front().command;
        pushes += std::holds_alternative<Impulse>(next.body);
        bytes += rowBytes(next);
        if (pushes > kMostImpulses || (bytes > kMostRowBytes && !step.commands.empty())) break;
        step.commands.push_back(std::move(waiting_.front()));
    }
    tick_ = to.tick;
    ticker_ = to.node;
    forget();
    return step;
}

void Log::forget() {
    std::erase_if(nodes_, [&](const auto& one) { return tick_ - one.second.heard > kRemembered; });
}

uint64_t Log::lastNumber(const std::string& node) const {
    const auto found = nodes_.find(node);
    return found == nodes_.end() ? 0 : found->second.number;
}

std::vector<Here> Log::present() const {
    std::vector<Here> all;
    for (const auto& [name, one] : nodes_)
        if (one.here && tick_ - one.here_at <= kHereFor) all.push_back(*one.here);
    return all;
}

size_t Log::rank(const std::string& node) const {
    size_t before = 0;
    for (const Here& one : present()) {
        if (one.node == node) return before;
        before += one.node != ticker_;
    }
    return before;
}

std::string Log::save() const {
    json nodes = json::object(), waiting = json::array();
    for (const auto& [name, one] : nodes_) {
        json& to = nodes[name] = {{"number", one.number}, {"heard", one.heard}, {"here_at", one.here_at}};
        if (one.here) to["here"] = pack(*one.here);
    }
    for (const NodeCommand& command : waiting_) waiting.push_back(pack(command));
    return json{{"tick", tick_}, {"ticker", ticker_}, {"nodes", std::move(nodes)}, {"waiting", std::move(waiting)}}
        .dump();
}

Log Log::load(std::string_view text) {
    const auto messageIn = [](const json& from) {
        auto message = unpack(from.get<std::string>());
        if (!message) throw StateError("a state of the log with a message that is none");
        return *std::move(message);
    };
    try {
        const json in = json::parse(text);
        Log log;
        log.tick_ = wholeNumber(in.at("tick"));
        in.at("ticker").get_to(log.ticker_);
        for (const auto& [name, from] : in.at("nodes").items()) {
            Node& one = log.nodes_[name];
            one.number = wholeNumber(from.at("number"));
            one.heard = wholeNumber(from.at("heard"));
            one.here_at = wholeNumber(from.at("here_at"));
            if (from.contains("here")) one.here = std::get<Here>(messageIn(from.at("here")));
        }
        for (const json& from : in.at("waiting")) log.waiting_.push_back(std::get<NodeCommand>(messageIn(from)));
        return log;
    } catch (const StateError&) {
        throw;
    } catch (const std::exception& error) {
        throw StateError(std::string("a state of the log that cannot be read: ") + error.what());
    }
}

} // namespace brume::cluster

#include "server/cluster/message.h"

#include <exception>

#include <nlohmann/json.hpp>

#include "common/whole_number.h"
#include "server/net/command_message.h"

namespace brume::cluster {
namespace {

using nlohmann::json;

constexpr size_t kLongestNode = 32, kLongestUrl = 1024 + 64; // an option's URL and a room's path

json fieldsOf(const NodeCommand& m) { return {{"number", m.number}, {"input", net::textOf(m.command)}}; }
json fieldsOf(const Advance& m) { return {{"tick", m.tick}}; }
json fieldsOf(const Here& m) {
    return {{"tick", m.tick}, {"hash", m.hash}, {"url", m.url}, {"load", m.load}, {"takes", m.takes}};
}

LogMessage messageOf(const std::string& kind, const json& in) {
    auto node = in.at("node").get<std::string>();
    if (node.empty() || node.size() > kLongestNode) throw std::runtime_error("no name of a server");
    if (kind == "command")
        return NodeCommand{std::move(node), wholeNumber(in.at("number")),
                           net::commandOf(in.at("input").get<std::string>())};
    if (kind == "advance") return Advance{std::move(node), wholeNumber(in.at("tick"))};
    if (kind != "here") throw std::runtime_error("no such message");
    Here here{std::move(node),
              wholeNumber(in.at("tick")),
              wholeNumber(in.at("hash")),
              in.at("url").get<std::string>(),
              in.at("load").get<double>(),
              in.at("takes").get<bool>()};
    if (here.url.size() > kLongestUrl) throw std::runtime_error("a URL that is too long");
    return here;
}

constexpr const char* kKinds[] = {"command", "advance", "here"}; // in the order of LogMessage

} // namespace

std::string pack(const LogMessage& message) {
    json out = std::visit([](const auto& m) { return fieldsOf(m); }, message);
    out["is"] = kKinds[message.index()];
    out["node"] = std::visit([](const auto& m) { return m.node; }, message);
    return out.dump(-1, ' ', false, json::error_handler_t::replace);
}

std::optional<LogMessage> unpack(std::string_view text) {
    try {
        const json in = json::parse(text);
        return messageOf(in.at("is").get<std::string>(), in);
    } catch (const std::exception&) {
        return {};
    }
}

} // namespace brume::cluster

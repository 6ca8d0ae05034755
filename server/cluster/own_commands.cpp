#include "server/cluster/own_commands.h"

#include <random>
#include <utility>

#include <fmt/format.h>

namespace brume::cluster {
namespace {

std::string newName() {
    std::random_device random;
    return fmt::format("{:08x}{:08x}", random(), random());
}

} // namespace

OwnCommands::OwnCommands() : name_(newName()) {}

const std::string& OwnCommands::add(Command command, Time now) {
    if (unseen_.empty()) sent_at_ = now;
    Own own{++number_, std::move(command), {}};
    own.message = pack(NodeCommand{name_, own.number, own.command});
    return unseen_.emplace_back(std::move(own)).message;
}

void OwnCommands::came(uint64_t number, uint64_t taken, Time now) {
    if (!unseen_.empty() && number == unseen_.front().number && taken != number) {
        if (number == 1) return; // the log knows too many servers: under another name it would take this as little
        if (rejoined_ && number - 1 > taken) lost_ += number - 1 - taken;
        return renew();
    }
    for (; !unseen_.empty() && unseen_.front().number <= taken; unseen_.pop_front()) {
        waiting_.push_back(std::move(unseen_.front()));
        sent_at_ = now;
    }
}

// No message under the old name is taken any more: the log waits for a number that will not come.
void OwnCommands::renew() {
    name_ = newName();
    number_ = 0;
    rejoined_ = false;
    waiting_.clear();
    for (Own& own : unseen_) {
        own.number = ++number_;
        own.message = pack(NodeCommand{name_, own.number, own.command});
    }
    all_again_ = true;
}

std::vector<std::string> OwnCommands::overdue(Time now) {
    if (unseen_.empty() || (!all_again_ && now - sent_at_ <= kOverdue)) return {};
    all_again_ = false;
    sent_at_ = now;
    std::vector<std::string> all;
    for (const Own& own : unseen_) all.push_back(own.message);
    resent_ += all.size();
    return all;
}

void OwnCommands::rejoined(uint64_t taken, Time now) {
    rejoined_ = true;
    waiting_.clear();
    while (!unseen_.empty() && unseen_.front().number <= taken) unseen_.pop_front();
    sent_at_ = now;
}

Command OwnCommands::take(NodeCommand&& command) {
    if (command.node == name_) {
        while (!waiting_.empty() && waiting_.front().number < command.number) waiting_.pop_front();
        if (!waiting_.empty() && waiting_.front().number == command.number) {
            Command known = std::move(waiting_.front().command);
            waiting_.pop_front();
            return known;
        }
    }
    command.command.viewer = 0;
    return std::move(command.command);
}

} // namespace brume::cluster

#include "client/native/link.h"

#include <algorithm>
#include <iostream>
#include <random>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace brume::client {
namespace {

constexpr double kPatienceS = 60;
constexpr double kLongestAskedS = 300; // the longest wait that a server may ask for

double secondsBetween(uint64_t begin_us, uint64_t end_us) {
    return static_cast<double>(end_us - std::min(begin_us, end_us)) * 1e-6;
}

double randomPart() {
    std::random_device random;
    return std::generate_canonical<double, 32>(random);
}

} // namespace

double Backoff::next(double asked_s, double part) {
    const double step = step_s_ * (0.5 + 0.5 * part);
    step_s_ = std::min(2 * step_s_, kLongestS);
    return asked_s > 0 ? std::min(asked_s, kLongestAskedS) + 0.2 * step : step;
}

Session* Link::session(const Wishes& wishes) {
    if (session_) return &*session_;
    const uint64_t now = nowUs();
    if (now < next_try_us_) return nullptr;
    session_.emplace(servers_[at_], wishes, std::chrono::milliseconds(static_cast<int64_t>(options_.timeout * 1000)),
                     key_);
    connected_us_ = now;
    return &*session_;
}

void Link::heard(uint64_t now_us) {
    heard_us_ = now_us;
    failed_ = refused_ = 0;
    asked_s_ = 0;
    trouble_.clear();
    backoff_.reset();
}

void Link::check(const std::string& last_error) {
    if (session_->closed()) return lose(session_->closedBecause());
    if (secondsBetween(std::max(heard_us_, connected_us_), nowUs()) <= options_.timeout) return;
    lose(fmt::format("no frame from {} in {:g} s{}", servers_[at_].url(), options_.timeout,
                     last_error.empty() ? "" : "; the server said: " + last_error));
}

// The next try is where the goodbye says. The token goes along, since who sends us has it already, but nothing goes
// from TLS to none.
bool Link::goWhereSent() {
    const Endpoint from = servers_[at_];
    auto to = parseGoTo(session_->goTo());
    if (!to || (from.tls && !to->tls)) return false;
    to->token = from.token, to->ca = from.ca;
    const auto known = std::find_if(servers_.begin(), servers_.end(),
                                    [&](const Endpoint& server) { return server.url() == to->url(); });
    at_ = size_t(known - servers_.begin());
    if (known == servers_.end()) {
        at_ = options_.servers.size();
        servers_.resize(at_);
        servers_.push_back(std::move(*to));
    }
    return true;
}

// The next try is at the next server that there is. A server that a goodbye named is left only when it does not let us
// in.
bool Link::goToNext() {
    if (servers_.size() < 2 || (options_.servers.size() < 2 && session_->welcomed())) return false;
    at_ = (at_ + 1) % servers_.size();
    return true;
}

void Link::lose(const std::string& why) {
    const uint64_t now = nowUs();
    if (session_->welcomed()) {
        welcomed_ = true;
        key_ = session_->granted().resume;
    }
    ++failed_;
    refused_ = session_->refused() ? refused_ + 1 : 0;
    asked_s_ = std::max(asked_s_, double(session_->retryAfterSeconds()));
    const bool sent = options_.reconnect && goWhereSent();
    const bool moves = sent || (options_.reconnect && goToNext());
    const bool round = failed_ % servers_.size() == 0; // true: each server has failed since the last frame
    const bool at_once = moves && !sent && !round;
    const double asked_s = at_once ? 0 : std::exchange(asked_s_, 0);
    const double wait_s = at_once ? 0 : backoff_.next(asked_s, randomPart());
    if (moves) key_.clear(); // nobody knows it there
    const bool hopeful = welcomed_ && refused_ < servers_.size();
    const bool worth_it = asked_s > 0 || sent || at_once || hopeful;
    const bool patient = (for_ever_ && welcomed_) || secondsBetween(heard_us_, now) + wait_s < kPatienceS;
    if (!options_.reconnect || !worth_it || !patient)
        throw std::runtime_error(asked_s > 0 ? fmt::format("{} (try again in {:g} s)", why, asked_s) : why);
    if (trouble_.empty())
        std::cerr << fmt::format("brume-client: {}; trying {} in {:.1f} s\n", why,
                                 moves ? servers_[at_].url() : "again", wait_s)
                  << std::flush;
    trouble_ = why;
    session_.reset();
    next_try_us_ = now + static_cast<uint64_t>(wait_s * 1e6);
}

void Link::leave(const std::string& reason) {
    if (session_) session_->leave(reason);
}

} // namespace brume::client

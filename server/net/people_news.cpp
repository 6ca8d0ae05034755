#include "server/net/people_news.h"

namespace brume::net {
namespace {

constexpr auto kPeriod = std::chrono::milliseconds(100); // as often as a connection looks for news by itself

} // namespace

bool PeopleNews::due(Clock::time_point now) const {
    return asked_ && (!told_ || (now - told_at_ >= kPeriod && people_.version(cameras_) != *told_));
}

wire::Packed PeopleNews::take(Clock::time_point now) {
    told_ = people_.version(cameras_); // read before: a change in between is told again
    told_at_ = now;
    return packPeople(people_.now(), cameras_);
}

} // namespace brume::net

// PeopleNews: what one viewer was told of the others, and when there is more to tell.
#pragma once

#include <optional>
#include <utility>

#include "server/net/outgoing.h"
#include "server/viewer/people.h"

namespace brume::net {

class PeopleNews {
public:
    explicit PeopleNews(const People& people) : people_(people) {}

    // It has said who it is, and wants to know of the others from now on. `cameras`: also where they look from.
    void ask(bool cameras) {
        asked_ = true;
        if (std::exchange(cameras_, cameras) != cameras) told_.reset();
    }
    // True: something is new that was not told within the last tenth of a second.
    bool due(Clock::time_point now) const;
    // A People message. It counts as told.
    wire::Packed take(Clock::time_point now);

private:
    const People& people_;
    bool asked_ = false, cameras_ = false;
    std::optional<uint64_t> told_; // People::version(); nothing: none yet
    Clock::time_point told_at_{};
};

} // namespace brume::net

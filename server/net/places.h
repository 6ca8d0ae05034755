// Places of one kind, at most three quarters of them for one owner.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>

namespace brume::net {

// Thread-safe.
class Places {
public:
    // Given back when it dies. It does not outlive its Places.
    class Place {
    public:
        Place(Places& places, std::string owner) : places_(places), owner_(std::move(owner)) {}
        ~Place();
        Place(const Place&) = delete;
        Place& operator=(const Place&) = delete;

    private:
        Places& places_;
        const std::string owner_;
    };
    struct Taken {
        std::unique_ptr<Place> place; // null: refused
        std::string refusal;          // one line
    };

    // `taken`: of places that are, for refusals: "streams are open".
    explicit Places(const char* taken) : taken_(taken) {}

    // One of `most` places. An owner (ownerOf(), access.h) has at most three quarters of them, and one at least.
    Taken take(const std::string& owner, uint32_t most);

private:
    const char* const taken_;
    std::mutex mutex_;
    uint32_t all_ = 0;
    std::map<std::string, uint32_t> per_owner_;
};

} // namespace brume::net

// People: who is here under which name, what each points at, and whose camera each one has.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

#include "server/viewer/frame.h"

namespace brume {

class Viewer;

inline constexpr size_t kMostPeople = 64;         // that viewers are told of
inline constexpr size_t kMostNameCharacters = 32; // code points

// A name as others see it: UTF-8 of at most kMostNameCharacters, with single spaces. What is no UTF-8, what controls
// a terminal or the direction of text, and what is over the length is left out.
std::string personName(std::string_view wished);

// A ray of a pointer, in metres.
struct PointingRay {
    glm::vec3 origin{0}, direction{0, 0, -1}; // direction: unit
};

// What a viewer says of itself; the last one counts.
struct Presence {
    std::string name; // personName()'s; empty: it has chosen none
    std::optional<PointingRay> pointer;
    uint32_t follow = 0;  // id of the person whose camera it wants; 0: its own
    bool cameras = false; // True: it wants to know where others look from
};

struct Person {
    uint32_t id = 0;
    std::string name;                 // never empty
    bool known = false;               // True: its token says the name
    uint32_t colour = 0;              // red, green and blue, a byte each, sRGB
    uint8_t role = 0;                 // wire::Role's value
    uint32_t follows = 0;             // whose camera it has; 0: its own
    std::optional<PoseRequest> look;  // nothing: it has asked for no picture, or its window is hidden
    std::optional<glm::vec3> pointer; // m, what it points at
};

// Thread-safe.
class People {
public:
    // Those who are told of, the presenter among them.
    struct Now {
        std::vector<Person> people; // in the order in which they came, kMostPeople at most
        uint32_t count = 0;         // of all
        uint32_t presenter = 0;     // all who have one eye take this person's camera; 0: nobody presents
    };

    // `token`: the name in its token; empty: it has none.
    void join(const std::shared_ptr<Viewer>& viewer, const std::string& token, uint8_t role);
    // Who followed it has its own camera again. Presenting ends with the presenter.
    void leave(uint32_t id);
    void say(uint32_t id, const Presence& presence);
    // All take this person's camera from now on; 0: nobody's. False: there is no such person.
    bool lead(uint32_t id);
    // A viewer's own pose. It and its followers are given it, or it is kept until the viewer follows nobody.
    void look(uint32_t id, const PoseRequest& request);

    Now now() const;
    // Numbers that grow when there is something new to tell: with `cameras` also when a camera has moved.
    uint64_t version(bool cameras) const;

    // Rays of pointers that have moved since the last call, at most `most`; the longest waiting first.
    struct Moved {
        uint32_t id;
        PointingRay ray;
    };
    std::vector<Moved> takeMoved(size_t most);
    // What such a ray meets; nothing: nothing.
    void meets(const Moved& moved, const std::optional<glm::vec3>& point);

private:
    struct Entry {
        std::weak_ptr<Viewer> viewer;
        Person person;
        std::string token;
        std::optional<PointingRay> ray;
        uint64_t ray_waits = 0;         // its place among rays that wait; 0: it was taken
        uint32_t wanted = 0;            // Presence::follow
        std::optional<PoseRequest> own; // the last pose of its own
        bool any_pose = true;           // True: the next pose counts, however old its number is
    };

    // Precondition of all: mutex_ is held.
    uint32_t leaderOf(uint32_t id) const; // whose own pose it has; 0: its own
    void settle();                        // gives each whose leader is another the camera of that one
    uint32_t freeColour() const;
    std::string shownName(const Entry& entry) const;

    mutable std::mutex mutex_;
    std::map<uint32_t, Entry> entries_; // ids count up in the order of coming, but of those who come back
    std::vector<uint32_t> order_;       // ids in the order of coming
    uint32_t presenter_ = 0;
    size_t followers_ = 0; // who have another's camera
    uint64_t people_version_ = 0, camera_version_ = 0, ray_count_ = 0;
};

} // namespace brume

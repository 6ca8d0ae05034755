// People: who else is here, and where a picture shows what they point at and where they look from. The page does the
// same (client/web/src/people-drawing.ts).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include "common/camera.h"
#include "protocol/message.h"

namespace brume::client {

struct Look { // where somebody looks from
    glm::vec3 position{0};
    glm::quat orientation{1, 0, 0, 0}; // world from view, unit length
    float right = 0, up = 0;           // tangents of the angles from the view axis to the picture's sides
};

struct Person {
    uint32_t id = 0;
    std::string name;                 // one line
    uint32_t colour = 0;              // red, green and blue, a byte each, sRGB
    std::optional<Look> look;         // nothing: it was not asked for, or there is no picture
    std::optional<glm::vec3> pointer; // m; nothing: it points at nothing
};

std::vector<Person> peopleOf(const wire::People& message);

// All but `me`, for a title: a name, the colour in a word, and who points. Of more than four the number of the rest.
// Empty if nobody else is here.
std::string namesOf(const std::vector<Person>& people, uint32_t me);

struct Area { // the rectangle that a picture covers, in pixels
    float x = 0, y = 0, width = 1, height = 1;
};

// Where a place is seen, in pixels. Nothing: behind the eye. Uses Pose::fov_y, not its frustum.
std::optional<glm::vec2> seenAt(glm::vec3 place, const Pose& eye, const Area& area);

struct Line {
    glm::vec2 from{0}, to{0};
};

// What of a line lies in the area, if anything does.
std::optional<Line> inside(const Line& line, const Area& area);

// The eight edges of a small cone before a person's eye, in pixels. Its length is a fixed part of its distance. Empty
// if one of its corners is behind the eye.
std::vector<Line> coneSeen(const Look& look, const Pose& eye, const Area& area);

// What is drawn over a picture.
struct Marks {
    struct Dot {
        glm::vec2 at{0}; // its middle, in pixels
        uint32_t colour = 0;
    };
    struct Edge {
        Line line;
        uint32_t colour = 0;
    };
    std::vector<Dot> dots;
    std::vector<Edge> edges; // below the dots
};

// Dots of all who point, and with `cones` the cones of all but `me`. Lines end at the area's sides.
Marks marksOf(const std::vector<Person>& people, uint32_t me, const Pose& eye, const Area& area, bool cones);

} // namespace brume::client

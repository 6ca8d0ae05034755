// The numbered PLY files of the layout `sequence`, loaded and checked as a whole.
#pragma once

#include <cstdint>
#include <filesystem>
#include <utility>
#include <vector>

#include "server/sim/layout.h"

namespace brume {

// The points of one file. The optional lists are empty, or as long as `position`.
struct SequenceFile {
    uint64_t number = 0;             // of the file's name: its time
    std::vector<glm::vec3> position; // m, without the volume's offset
    std::vector<float> scale;        // m
    std::vector<float> weight;       // as Column::weight
    std::vector<glm::vec3> albedo;
    std::vector<int64_t> id;         // ascending
    std::vector<glm::vec3> velocity; // m/s
};

struct SequenceFiles {
    std::vector<SequenceFile> files; // by number; at least one
    uint32_t most = 0;               // points that are shown at once
    bool own_extinction = false;     // True: weights are extinctions (1/m) that came with the points
    bool has_ids = false;            // True: the points of every file have ids, and no velocities
    bool has_velocities = false;     // True: the points of every file have velocities
    uint64_t hash = 0;               // of the points, their times and how they are played
    uint64_t bytes = 0;              // of the points
    PointCloudFacts facts;           // of the first file, with points that are left out of all files
};

// Reads all files of the medium. `most_bytes`: of their points. Throws SceneError for a bad file, for files that have
// not the same properties, and if there are more bytes. Precondition: the layout is `sequence`.
SequenceFiles loadSequence(const Medium& medium, glm::dvec3 origin, uint64_t most_bytes);

// A scene that is drawn by the same shaders, for what needs no more: of a sequence the first file; for a live scene,
// which is empty, a small cube; for a medium without extinction one with some; any other scene as it is.
Scene standIn(Scene scene);

} // namespace brume

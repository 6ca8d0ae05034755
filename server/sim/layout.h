// Initial particles of the layouts cube, tubes, cumulus and file, and those of a sequence's file.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/scene.h"
#include "shaders/shared/types.h"

namespace brume {

// What is known about a point cloud besides its particles.
struct PointCloudFacts {
    std::string sizes_from, extinctions_from; // for people: "the file's scale"
    bool by_depth = false;                    // True: extinctions are chosen for a mean optical depth
    bool coloured = false;                    // True: every point came with its albedo
    std::vector<std::string> ignored;         // names of properties that are not read
    std::vector<std::string> notes;           // one line each: what was guessed, merged or passed over
    size_t kept = 0, dropped = 0;             // points that are read, and those that are left out
    std::string first_dropped;                // why the first of them is
    std::string volume;                       // a volume in words
    std::string sequence, gaps;               // a sequence in words; a warning of missing files, or empty
};

// One entry per particle. sigma_t and albedo come from files only and are empty otherwise.
struct Placement {
    std::vector<glm::vec3> position;      // m, world
    std::vector<float> scale;             // m
    std::vector<float> multiplier;        // times the medium's extinction
    std::vector<float> sigma_t;           // 1/m, replaces multiplier * extinction
    std::vector<glm::vec3> albedo;        // replaces the medium's
    std::vector<gpu::EllipsoidAxes> axes; // of ellipsoids; empty with another model
    std::vector<int64_t> id;              // each point's id, where a sequence's file has them
    std::vector<glm::vec3> velocity;      // m/s, where a sequence's file has it
    bool own_scale = false;               // True: sizes came with the points
    bool still = false;                   // True: they stand for something that does not move
    std::optional<PointCloudFacts> cloud; // facts about points of a file; nothing for other layouts
};

// Places the particles of a medium. The result depends on the medium only, not on compiler or machine. Throws
// SceneError if the medium's file is bad. `origin`: the scene's; it is subtracted from a file's positions.
// Precondition: the layout is not `emitter`, `sequence` or `live`.
// `volume`: the scene's.
Placement place(const Medium& medium, glm::dvec3 origin = glm::dvec3(0), const Volume* volume = nullptr);

// Particles that stand for a volume: one for each cube of voxels that holds something, with the same mass. Pictures are
// of the voxels; maps' bounds, cameras and laws of errors go by these.
Placement placeVolume(const Medium& medium, const Volume& volume);

// medium.count positions and scales that fill a cumulus, medium.extent wide, that stands on y = 0 over the origin.
Placement cumulus(const Medium& medium);

} // namespace brume

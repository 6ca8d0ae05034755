// What the tests of PLY files ask of the reader.
#pragma once

#include <string>

#include <gtest/gtest.h>

#include "common/ply/ply.h"
#include "common/scene.h"
#include "tests/unit/ply_file.h"

namespace brume::test {

inline PointCloud readPly(const std::string& bytes, PlyWanted wanted = {}, const PlyFrame& frame = {}) {
    return parsePly(bytes, "a.ply", frame, wanted);
}

// The one line with which a file is refused.
inline std::string plyRefusal(const std::string& bytes, PlyWanted wanted = {}) {
    try {
        readPly(bytes, wanted);
    } catch (const SceneError& error) {
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
        return error.what();
    }
    return "no error";
}

inline void expectPlyRefused(const std::string& bytes, const std::string& says, PlyWanted wanted = {}) {
    const std::string message = plyRefusal(bytes, wanted);
    EXPECT_NE(message.find(says), std::string::npos) << message << "\nnot: " << says;
}

// The four points of kFour and nothing else.
inline void expectFour(const PointCloud& cloud, const std::string& of = "") {
    EXPECT_EQ(cloud.position, (std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}})) << of;
    EXPECT_EQ(cloud.dropped, 0u) << of;
}

inline bool tells(const PointCloud& cloud, const std::string& what) {
    for (const std::string& note : cloud.notes)
        if (note.find(what) != note.npos) return true;
    return false;
}

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
    for (size_t at = 0; (at = text.find(from, at)) != text.npos; at += to.size()) text.replace(at, from.size(), to);
    return text;
}

} // namespace brume::test

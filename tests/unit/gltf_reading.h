// What the tests of glTF files ask of the reader.
#pragma once

#include <algorithm>
#include <functional>
#include <string>

#include <gtest/gtest.h>

#include "common/gltf/gltf.h"
#include "common/scene.h"
#include "tests/unit/gltf_file.h"

namespace brume::test {

inline constexpr size_t kMostTriangles = 100;

inline Gltf read(const std::string& bytes) { return parseGltf(bytes, "mesh.glb", testing::TempDir(), kMostTriangles); }

inline std::string refusal(const std::string& bytes) {
    try {
        read(bytes);
    } catch (const SceneError& error) {
        return error.what();
    }
    return "no error";
}

inline void expectRefused(const std::string& bytes, const char* what) {
    const std::string message = refusal(bytes);
    EXPECT_EQ(message.rfind("mesh.glb: glTF: ", 0), 0u) << message;
    EXPECT_NE(message.find(what), std::string::npos) << message << ", not: " << what;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_LT(message.size(), 400u);
}

inline std::string changed(const std::function<void(nlohmann::json&)>& change) {
    GltfFile file;
    change(file.json);
    return file.glb();
}

// Exactly these lines, each as the beginning of what is told.
inline void expectTold(const Gltf& gltf, const std::vector<std::string>& lines) {
    ASSERT_EQ(gltf.told.size(), lines.size()) << testing::PrintToString(gltf.told);
    for (size_t i = 0; i < lines.size(); ++i) EXPECT_EQ(gltf.told[i].rfind(lines[i], 0), 0u) << gltf.told[i];
}

// So many triangles, with this box around them.
inline void expectBox(const Gltf& gltf, size_t count, glm::dvec3 lo, glm::dvec3 hi) {
    EXPECT_EQ(gltf.triangles.size(), count);
    glm::dvec3 least(1e300), most(-1e300);
    for (const GltfTriangle& triangle : gltf.triangles)
        for (const glm::dvec3& corner : triangle.corners)
            least = glm::min(least, corner), most = glm::max(most, corner);
    EXPECT_LT(glm::distance(least, lo), 1e-6) << least.x << ' ' << least.y << ' ' << least.z;
    EXPECT_LT(glm::distance(most, hi), 1e-6) << most.x << ' ' << most.y << ' ' << most.z;
}

// The two triangles of GltfFile::square(), as they are.
inline void expectSquare(const Gltf& gltf) { expectBox(gltf, 2, glm::dvec3(0), glm::dvec3(1)); }

inline void expectAlbedo(const Gltf& gltf, size_t triangle, glm::vec3 albedo, float most = 1e-6f) {
    ASSERT_LT(triangle, gltf.triangles.size());
    const glm::vec3 got = gltf.triangles[triangle].albedo;
    EXPECT_LT(glm::distance(got, albedo), most) << got.r << ' ' << got.g << ' ' << got.b;
}

} // namespace brume::test

// Meshes from glTF files: what is read, and one clear line for every file that cannot be.
#include "common/gltf.h"

#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "common/scene.h"
#include "tests/unit/gltf_file.h"

namespace brume {
namespace {

using nlohmann::json, test::GltfFile;

constexpr size_t kMost = 100;

Gltf read(const std::string& bytes) { return parseGltf(bytes, "mesh.glb", testing::TempDir(), kMost); }

std::string refusal(const std::string& bytes) {
    try {
        read(bytes);
    } catch (const SceneError& error) {
        return error.what();
    }
    return "no error";
}

void expectRefused(const std::string& bytes, const char* what) {
    const std::string message = refusal(bytes);
    EXPECT_EQ(message.rfind("mesh.glb: glTF: ", 0), 0u) << message;
    EXPECT_NE(message.find(what), std::string::npos) << message << ", not: " << what;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_LT(message.size(), 400u);
}

std::string changed(const std::function<void(json&)>& change) {
    GltfFile file;
    change(file.json);
    return file.glb();
}

TEST(Gltf, ATriangle) {
    const Gltf gltf = read(GltfFile().glb());
    ASSERT_EQ(gltf.triangles.size(), 1u);
    EXPECT_EQ(gltf.triangles[0].corners[1], glm::dvec3(1, 0, 0));
    EXPECT_EQ(gltf.triangles[0].corners[2], glm::dvec3(0, 1, 0));
    EXPECT_EQ(gltf.triangles[0].albedo, glm::vec3(0.5f, 0.25f, 0.125f));
    EXPECT_FALSE(gltf.textured);
}

TEST(Gltf, WithoutIndicesAndMaterial) {
    const Gltf gltf = read(changed([](json& j) {
        j["meshes"][0]["primitives"][0].erase("indices");
        j["meshes"][0]["primitives"][0].erase("material");
    }));
    ASSERT_EQ(gltf.triangles.size(), 1u);
    EXPECT_EQ(gltf.triangles[0].albedo, glm::vec3(1));
}

// Translation, rotation and scale of a node apply in the order scale, rotation, translation; a parent's come after.
TEST(Gltf, NodesPlaceWhatIsInThem) {
    const double half = std::sqrt(0.5);
    const Gltf gltf = read(changed([&](json& j) {
        j["nodes"] = json::array({{{"children", {1, 2}}, {"translation", {0, 10, 0}}},
                                  {{"mesh", 0}, {"rotation", {0, 0, half, half}}, {"scale", {2, 3, 1}}},
                                  {{"mesh", 0}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1}}}});
    }));
    ASSERT_EQ(gltf.triangles.size(), 2u);
    const auto expectAt = [](glm::dvec3 got, glm::dvec3 expected) {
        EXPECT_LT(glm::distance(got, expected), 1e-12) << got.x << ' ' << got.y << ' ' << got.z;
    };
    expectAt(gltf.triangles[0].corners[0], {5, 16, 7});
    expectAt(gltf.triangles[1].corners[1], {0, 12, 0}); // (1, 0, 0) doubled, turned to +y, raised
    expectAt(gltf.triangles[1].corners[2], {-3, 10, 0});
}

TEST(Gltf, BuffersInTextAndBeside) {
    GltfFile file;
    const std::filesystem::path beside = std::filesystem::path(testing::TempDir()) / "gltf test.bin";
    std::ofstream(beside, std::ios::binary) << file.buffer();
    file.json["buffers"][0]["uri"] = "gltf%20test.bin";
    EXPECT_EQ(read(file.json.dump()).triangles.size(), 1u);
    for (const char* uri : {"../gltf%20test.bin", "/etc/passwd", "no.bin", "a/../../b", "x%00.bin", ".", ""}) {
        file.json["buffers"][0]["uri"] = uri;
        expectRefused(file.json.dump(), *uri ? "not found" : "uri");
    }
    file.json["buffers"][0]["uri"] = "data:application/octet-stream;base64,"
                                     "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIAAAA=";
    EXPECT_EQ(read(file.json.dump()).triangles[0].corners[2], glm::dvec3(0, 1, 0));
}

TEST(Gltf, TexturesAreSeenAndNotRead) {
    const std::string textured = changed([](json& j) {
        j["images"] = json::array({{{"uri", "no.png"}}, {{"bufferView", 0}, {"mimeType", "image/png"}}});
        j["textures"] = json::array({{{"source", 0}}});
        j["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}};
    });
    EXPECT_TRUE(read(textured).textured);
}

TEST(Gltf, RefusesWhatIsNoGltf) {
    const std::string good = GltfFile().glb();
    for (size_t length = 0; length < good.size(); length += 3)
        ASSERT_NE(refusal(good.substr(0, length)), "no error") << length;
    expectRefused("", "short");
    expectRefused("ply\nformat ascii 1.0\n", "syntax error");
    expectRefused(std::string(200, '['), "deeper than 64");
    expectRefused(R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[)" +
                      [] {
                          std::string zeros;
                          for (int i = 0; i < 250'000; ++i) zeros += "0,";
                          return zeros;
                      }() +
                      "0]}]}",
                  "more than 200000 values");
    expectRefused(changed([](json& j) { j.erase("asset"); }), "asset");
    expectRefused(changed([](json& j) { j["extensionsRequired"] = {"KHR_draco_mesh_compression"}; }), "draco");
}

TEST(Gltf, RefusesWrongNumbers) {
    const auto primitive = [](json& j) -> json& { return j["meshes"][0]["primitives"][0]; };
    expectRefused(changed([](json& j) { j["scene"] = 3; }), "no scene 3");
    expectRefused(changed([](json& j) { j["scenes"] = json::array(); }), "no scene 0");
    expectRefused(changed([](json& j) { j["scenes"][0]["nodes"] = {7}; }), "no node 7");
    expectRefused(changed([](json& j) { j["scenes"][0]["nodes"] = {-1}; }), "no node -1");
    expectRefused(changed([](json& j) { j["scenes"][0]["nodes"] = {0, 0}; }), "node 0 is there twice");
    expectRefused(changed([](json& j) { j["nodes"][0]["children"] = {0}; }), "node 0 is there twice, or in itself");
    expectRefused(changed([](json& j) { j["nodes"][0]["mesh"] = 1; }), "no mesh 1");
    expectRefused(changed([](json& j) { j["nodes"][0]["skin"] = 0; }), "has a skin");
    expectRefused(changed([](json& j) { j["nodes"][0].erase("mesh"); }), "no triangles");
    expectRefused(changed([](json& j) {
                      j["nodes"][0]["scale"] = {1e300, 1e300, 1e300}, j["nodes"][0]["children"] = {1};
                      j["nodes"].push_back({{"mesh", 0}, {"scale", {1e300, 1, 1}}});
                  }),
                  "no finite place");
    expectRefused(changed([&](json& j) { primitive(j)["indices"] = 9; }), "indices");
    expectRefused(changed([&](json& j) { primitive(j)["attributes"]["POSITION"] = 9; }), "no accessor 9");
    expectRefused(changed([&](json& j) { primitive(j)["attributes"] = {{"NORMAL", 0}}; }), "without POSITION");
    expectRefused(changed([&](json& j) { primitive(j)["attributes"]["POSITION"] = 1; }), "no list of places");
    expectRefused(changed([&](json& j) { primitive(j)["mode"] = 1; }), "mode 1");
    expectRefused(changed([&](json& j) { primitive(j)["material"] = 4; }), "no material 4");
    expectRefused(changed([](json& j) { j["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"][1] = -2; }),
                  "base colour factor of -2");
    expectRefused(changed([](json& j) { j["accessors"][0]["count"] = 4; }), "larger than its buffer");
    expectRefused(changed([](json& j) { j["accessors"][0]["count"] = 1ull << 62; }), "larger than its buffer");
    expectRefused(changed([](json& j) { j["accessors"][0]["byteOffset"] = 1ull << 63; }), "larger than its buffer");
    expectRefused(changed([](json& j) { j["accessors"][1]["count"] = 2; }), "no whole number of triangles");
    expectRefused(changed([](json& j) { j["accessors"][1]["componentType"] = 5126; }), "larger than its buffer");
    expectRefused(changed([](json& j) { j["accessors"][0]["componentType"] = 5123; }), "no floats");
    expectRefused(changed([](json& j) {
                      j["accessors"][0]["sparse"] = {{"count", 1},
                                                     {"indices", {{"bufferView", 1}, {"componentType", 5123}}},
                                                     {"values", {{"bufferView", 0}}}};
                  }),
                  "sparse");
    expectRefused(changed([](json& j) { j["accessors"][0].erase("bufferView"); }), "no buffer view -1");
    expectRefused(changed([](json& j) { j["bufferViews"][0]["buffer"] = 2; }), "no buffer 2");
    expectRefused(changed([](json& j) { j["bufferViews"][0]["byteLength"] = 4000; }), "larger than its buffer");
    expectRefused(changed([](json& j) { j["buffers"][0]["byteLength"] = 4000; }), "byteLength");
    expectRefused(changed([](json& j) { j["buffers"][0]["byteLength"] = 0; }), "");
}

TEST(Gltf, RefusesWrongVertices) {
    GltfFile file;
    file.indices[2] = 3;
    expectRefused(file.glb(), "index 3 of a primitive with 3 vertices");
    for (const float wrong : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        file = {};
        file.places[4] = wrong;
        expectRefused(file.glb(), "vertex 1 is at no finite place");
    }
}

TEST(Gltf, RefusesMoreTrianglesThanAreAllowed) {
    const std::string many = changed([](json& j) {
        j["scenes"][0]["nodes"] = json::array();
        for (size_t i = 0; i <= kMost; ++i) {
            j["nodes"][i] = {{"mesh", 0}};
            j["scenes"][0]["nodes"].push_back(i);
        }
    });
    expectRefused(many, "more than 100 triangles");
}

TEST(Gltf, AFileThatIsNotThere) {
    EXPECT_THROW(
        {
            try {
                loadGltf("nowhere/mesh.glb", kMost);
            } catch (const SceneError& error) {
                EXPECT_NE(std::string(error.what()).find("no such file"), std::string::npos) << error.what();
                throw;
            }
        },
        SceneError);
    EXPECT_THROW(loadGltf(testing::TempDir(), kMost), SceneError);
    EXPECT_THROW(loadGltf("/dev/zero", kMost), SceneError);
}

} // namespace
} // namespace brume

// Meshes from glTF files: what is read, and one clear line for every file that cannot be.
#include "common/gltf/gltf.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include "tests/unit/gltf_reading.h"

namespace brume {
namespace {

using nlohmann::json, test::changed, test::expectBox, test::expectRefused, test::expectTold, test::GltfFile,
    test::kMostTriangles, test::read, test::refusal;

TEST(Gltf, ATriangle) {
    const Gltf gltf = read(GltfFile().glb());
    ASSERT_EQ(gltf.triangles.size(), 1u);
    EXPECT_EQ(gltf.triangles[0].corners[1], glm::dvec3(1, 0, 0));
    EXPECT_EQ(gltf.triangles[0].corners[2], glm::dvec3(0, 1, 0));
    EXPECT_EQ(gltf.triangles[0].albedo, glm::vec3(0.5f, 0.25f, 0.125f));
    expectTold(gltf, {});
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
        expectRefused(file.json.dump(), *uri ? "not found" : "no uri");
    }
    file.json["buffers"][0]["uri"] = "data:application/octet-stream;base64,"
                                     "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIAAAA=";
    EXPECT_EQ(read(file.json.dump()).triangles[0].corners[2], glm::dvec3(0, 1, 0));
}

// Data URIs as RFC 2397 has them; what is wrong with one is said without its data.
TEST(Gltf, DataUris) {
    const std::string data = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIAAAA=";
    GltfFile file;
    for (const char* head : {"data:;base64,", "data:application/octet-stream;charset=US-ASCII;base64,",
                             "DATA:image/png;a=b;c=\"d\";BASE64,", "data:application/gltf-buffer;base64,"}) {
        file.json["buffers"][0]["uri"] = head + data;
        expectBox(read(file.json.dump()), 1, {0, 0, 0}, {1, 1, 0});
    }
    file.json["buffers"][0]["uri"] = "data:;base64," + data.substr(0, data.size() - 1); // the padding is left out
    expectBox(read(file.json.dump()), 1, {0, 0, 0}, {1, 1, 0});
    std::string escaped = "data:,";
    for (const unsigned char byte : file.buffer()) {
        constexpr char kHex[] = "0123456789abcdef";
        escaped += {'%', kHex[byte / 16], kHex[byte % 16]};
    }
    file.json["buffers"][0]["uri"] = escaped;
    expectBox(read(file.json.dump()), 1, {0, 0, 0}, {1, 1, 0});
    for (const auto& [uri, why] : {std::pair("data:;base64,AAAA?AAA", "no base64"),
                                   {"data:AAAAAAAA", "comma"},
                                   {"data:;base64,AAAA", "has 3 bytes; its byteLength is 44"}}) {
        file.json["buffers"][0]["uri"] = uri;
        expectRefused(file.json.dump(), why);
        EXPECT_EQ(refusal(file.json.dump()).find("AAAA"), std::string::npos);
    }
}

TEST(Gltf, Versions) {
    const auto withAsset = [](const json& asset) { return changed([&](json& j) { j["asset"] = asset; }); };
    for (const json& asset : {json{{"version", "2.0"}, {"minVersion", "2.0"}},
                              {{"version", "2.1"}},
                              {{"version", "2.7"}, {"minVersion", "2.0"}}})
        EXPECT_EQ(read(withAsset(asset)).triangles.size(), 1u) << asset;
    expectRefused(withAsset({{"version", "2.0"}, {"minVersion", "2.1"}}), "asset.minVersion is \"2.1\"");
    expectRefused(withAsset({{"version", "3.0"}, {"minVersion", "3.0"}}), "asset.version is \"3.0\"");
    for (const char* version : {"1.0", "1.1", "1", "3.0", "two"})
        expectRefused(withAsset({{"version", version}}), "another format; export it as glTF 2.0");
    expectRefused(withAsset({{"version", 2}}), "version is no text");
    expectRefused(withAsset(json::object()), "no version");
    std::string first = GltfFile().glb();
    first[4] = 1;
    expectRefused(first, "of version 1; export it as glTF 2.0");
}

// A bound of memory, not of values: files of many values are good.
TEST(Gltf, JsonIsBoundedByItsMemory) {
    GltfFile file;
    file.json["extras"] = std::vector<int>(1'000'000);
    EXPECT_EQ(read(file.glb()).triangles.size(), 1u);
    file.json["extras"] = std::vector<int>(3'000'000);
    expectRefused(file.glb(), "MiB of memory; allowed: 256 MiB");
    file.json["extras"] = std::string(3'000'000, ','); // text is what it is
    EXPECT_EQ(read(file.glb()).triangles.size(), 1u);
}

// A file without a scene has its nodes in view, one without nodes its meshes.
TEST(Gltf, WithoutAScene) {
    const Gltf nodes = read(changed([](json& j) {
        j.erase("scene"), j.erase("scenes");
        j["nodes"] = json::array({{{"mesh", 0}}, {{"children", {0}}, {"translation", {0, 0, 5}}}});
    }));
    expectBox(nodes, 1, {0, 0, 5}, {1, 1, 5});
    expectBox(read(changed([](json& j) { j.erase("scene"), j.erase("scenes"), j.erase("nodes"); })), 1, {0, 0, 0},
              {1, 1, 0});
}

TEST(Gltf, RefusesWhatIsNoGltf) {
    const std::string good = GltfFile().glb();
    for (size_t length = 0; length < good.size(); length += 3)
        ASSERT_NE(refusal(good.substr(0, length)), "no error") << length;
    expectRefused("", "an empty file");
    expectRefused("ply\nformat ascii 1.0\n", "syntax error");
    expectRefused(std::string(200, '['), "deeper than 64");
    expectRefused(changed([](json& j) { j.erase("asset"); }), "asset");
    expectRefused("[]", "no object");
    expectRefused("{\"asset\": \"" + std::string(100'000, 'x'), "parse error at line 1"); // without the text there
}

TEST(Gltf, RefusesWrongNumbers) {
    const auto primitive = [](json& j) -> json& { return j["meshes"][0]["primitives"][0]; };
    expectRefused(changed([](json& j) { j["scene"] = 3; }), "no scenes[3]; the file has 1");
    expectRefused(changed([](json& j) { j["scenes"] = json::array(); }), "no scenes[0]; the file has 0");
    expectRefused(changed([](json& j) { j["scenes"][0]["nodes"] = {7}; }), "no nodes[7]");
    expectRefused(changed([](json& j) { j["scenes"][0]["nodes"] = {-1}; }), "a node of the scene is no whole number");
    expectRefused(changed([](json& j) { j["scenes"][0]["nodes"] = {1e300}; }),
                  "a node of the scene is no whole number");
    expectRefused(changed([](json& j) { j["scenes"][0]["nodes"] = 0; }), "nodes is no list");
    expectRefused(changed([](json& j) { j["scenes"][0]["nodes"] = {0, 0}; }), "nodes[0] is there twice");
    expectRefused(changed([](json& j) { j["nodes"][0]["children"] = {0}; }), "nodes[0] is there twice, or in itself");
    expectRefused(changed([](json& j) { j["nodes"][0]["mesh"] = 1; }), "no meshes[1]");
    expectRefused(changed([](json& j) { j["nodes"][0]["skin"] = 0; }), "no skins[0]");
    expectRefused(changed([](json& j) { j["nodes"][0]["matrix"] = {1, 2, 3}; }), "matrix has 3 numbers; allowed: 16");
    expectRefused(changed([](json& j) { j["nodes"][0]["scale"] = {1, "x", 3}; }), "scale holds something");
    expectRefused(changed([](json& j) { j["nodes"][0].erase("mesh"); }), "no triangles");
    expectRefused(changed([](json& j) {
                      j["nodes"][0]["scale"] = {1e300, 1e300, 1e300}, j["nodes"][0]["children"] = {1};
                      j["nodes"].push_back({{"mesh", 0}, {"scale", {1e300, 1, 1}}});
                  }),
                  "no finite place");
    expectRefused(changed([&](json& j) { primitive(j)["indices"] = 9; }), "no accessors[9]");
    expectRefused(changed([&](json& j) { primitive(j)["attributes"]["POSITION"] = 9; }), "no accessors[9]");
    expectRefused(changed([&](json& j) { primitive(j)["attributes"] = {{"NORMAL", 0}}; }), "no POSITION");
    expectRefused(changed([&](json& j) { primitive(j)["attributes"]["POSITION"] = 1; }), "is SCALAR; expected VEC3");
    expectRefused(changed([&](json& j) { primitive(j)["mode"] = 7; }), "mode 7");
    expectRefused(changed([&](json& j) { primitive(j)["material"] = 4; }), "no materials[4]");
    expectRefused(changed([](json& j) { j["accessors"][0]["count"] = 4; }), "larger than its buffer");
    expectRefused(changed([](json& j) { j["accessors"][0]["count"] = 1ull << 52; }), "larger than its buffer");
    expectRefused(changed([](json& j) { j["accessors"][0]["count"] = 1ull << 62; }), "no whole number");
    expectRefused(changed([](json& j) { j["accessors"][0]["byteOffset"] = 1ull << 53; }), "larger than its buffer");
    expectRefused(changed([](json& j) { j["bufferViews"][0]["byteStride"] = 1ull << 52; }), "larger than its buffer");
    expectRefused(changed([](json& j) { j["accessors"][1]["componentType"] = 5126; }), "larger than its buffer");
    expectRefused(changed([](json& j) { j["accessors"][1]["componentType"] = 5122; }), "no unsigned whole numbers");
    expectRefused(changed([](json& j) { j["accessors"][0]["componentType"] = 5130; }), "componentType 5130");
    expectRefused(changed([](json& j) { j["accessors"][0]["bufferView"] = 5; }), "no bufferViews[5]");
    expectRefused(changed([](json& j) { j["bufferViews"][0]["buffer"] = 2; }), "no buffers[2]");
    expectRefused(changed([](json& j) { j["bufferViews"][0]["byteLength"] = 4000; }), "larger than its buffer");
    expectRefused(changed([](json& j) { j["bufferViews"][0]["byteOffset"] = 4000; }), "larger than its buffer");
    expectRefused(changed([](json& j) { j["buffers"][0]["byteLength"] = 4000; }), "byteLength is 4000");
    expectRefused(changed([](json& j) { j["buffers"][0]["byteLength"] = 0; }), "larger than its buffer");
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
        for (size_t i = 0; i <= kMostTriangles; ++i) {
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
                loadGltf("nowhere/mesh.glb", kMostTriangles);
            } catch (const SceneError& error) {
                EXPECT_NE(std::string(error.what()).find("no such file"), std::string::npos) << error.what();
                throw;
            }
        },
        SceneError);
    EXPECT_THROW(loadGltf(testing::TempDir(), kMostTriangles), SceneError);
    EXPECT_THROW(loadGltf("/dev/zero", kMostTriangles), SceneError);
}

} // namespace
} // namespace brume

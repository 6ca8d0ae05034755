// Meshes from glTF files: where triangles are, however the file has them.
#include <cmath>

#include "tests/unit/gltf_reading.h"

namespace brume::test::gltf_geometry_test {
namespace {

using nlohmann::json;

using Triangles = std::vector<std::vector<glm::dvec3>>;

void expectTriangles(const Gltf& gltf, const Triangles& expected) {
    ASSERT_EQ(gltf.triangles.size(), expected.size());
    for (size_t i = 0; i < expected.size(); ++i)
        for (size_t c = 0; c < 3; ++c)
            EXPECT_LT(glm::distance(gltf.triangles[i].corners[c], expected[i][c]), 1e-6) << i << ", corner " << c;
}

// The four places of GltfFile::square().
const glm::dvec3 kA(0, 0, 0), kB(1, 0, 0), kC(0, 1, 0), kD(0, 0, 1);

TEST(GltfGeometry, ListsStripsAndFans) {
    GltfFile file = GltfFile::square();
    expectTriangles(read(file.glb()), {{kA, kB, kC}, {kA, kC, kD}});
    file.primitive().erase("indices");
    file.primitive()["mode"] = 5;
    expectTriangles(read(file.glb()), {{kA, kB, kC}, {kC, kB, kD}});
    file.primitive()["mode"] = 6;
    expectTriangles(read(file.glb()), {{kA, kB, kC}, {kA, kC, kD}});
    file.primitive()["indices"] = file.add(std::vector<uint8_t>{3, 2, 1, 0, 3}, "SCALAR", 5);
    expectTriangles(read(file.glb()), {{kD, kC, kB}, {kD, kB, kA}, {kD, kA, kD}});
    file.primitive()["mode"] = 5;
    expectTriangles(read(file.glb()), {{kD, kC, kB}, {kB, kC, kA}, {kB, kA, kD}});
    file.primitive()["indices"] = file.add(std::vector<uint32_t>{0, 1, 2, 3}, "SCALAR", 4);
    expectTriangles(read(file.glb()), {{kA, kB, kC}, {kC, kB, kD}});
}

TEST(GltfGeometry, WhatIsNoTriangleIsLeftOutWithAWord) {
    for (const int mode : {0, 1, 2, 3}) {
        GltfFile file = GltfFile::square();
        json lines = file.primitive();
        lines["mode"] = mode;
        file.json["meshes"][0]["primitives"].push_back(lines);
        const Gltf gltf = read(file.glb());
        expectSquare(gltf);
        expectTold(gltf, {"points and lines are left out (1 primitive)"});
        file.json["meshes"][0]["primitives"] = {lines, lines};
        expectRefused(file.glb(), "no triangles in its scene: points and lines are left out (2 primitives)");
    }
    // Without POSITION, without vertices, without indices, with too few.
    for (const int what : {0, 1, 2, 3}) {
        GltfFile file = GltfFile::square();
        json other = file.primitive();
        if (what == 0) other["attributes"] = {{"NORMAL", 0}};
        if (what == 1) other["attributes"]["POSITION"] = file.add(std::vector<float>{}, "VEC3", 0);
        if (what == 2) other["indices"] = file.add(std::vector<uint16_t>{}, "SCALAR", 0);
        if (what == 3) other["indices"] = file.add(std::vector<uint16_t>{0, 1}, "SCALAR", 2);
        file.json["meshes"][0]["primitives"].push_back(other);
        const Gltf gltf = read(file.glb());
        expectSquare(gltf);
        expectTold(gltf, {what == 0   ? "what has no POSITION is left out (1 primitive)"
                          : what == 3 ? "what has fewer than three corners is left out (1 primitive)"
                                      : "what has no vertices is left out (1 primitive)"});
    }
    // A count of 0 that names a view of something else.
    GltfFile file = GltfFile::square();
    file.json["accessors"].push_back({{"bufferView", 0}, {"componentType", 5126}, {"count", 0}, {"type", "VEC3"}});
    file.json["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", file.json["accessors"].size() - 1}}}});
    expectSquare(read(file.glb()));
}

TEST(GltfGeometry, CornersThatAreNoWholeTriangleAreLeftOut) {
    for (const size_t extra : {1u, 2u}) {
        GltfFile file = GltfFile::square();
        std::vector<uint16_t> indices{0, 1, 2, 0, 2, 3, 1, 2};
        file.primitive()["indices"] = file.add(indices, "SCALAR", 6 + extra);
        const Gltf gltf = read(file.glb());
        expectSquare(gltf);
        expectTold(gltf, {"corners behind the last whole triangle are left out (1 primitive)"});
    }
}

// KHR_mesh_quantization, with and without the node that scales it back.
TEST(GltfGeometry, QuantizedPlaces) {
    const auto readAs = [](auto one, bool normalized, double scale, size_t stride) {
        using T = decltype(one);
        GltfFile file = GltfFile::square();
        std::vector<T> places(4 * stride);
        places[stride] = places[2 * stride + 1] = places[3 * stride + 2] = one;
        const size_t index = file.add(places, "VEC3", 4, normalized);
        file.json["bufferViews"].back()["byteStride"] = stride * sizeof(T);
        file.primitive()["attributes"]["POSITION"] = index;
        file.json["nodes"][0]["scale"] = {scale, scale, scale};
        file.json["extensionsUsed"] = file.json["extensionsRequired"] = {"KHR_mesh_quantization"};
        const Gltf gltf = read(file.glb());
        expectSquare(gltf);
        expectTold(gltf, {});
    };
    readAs(int16_t(32767), true, 1, 4);
    readAs(uint16_t(65535), true, 1, 4);
    readAs(int8_t(127), true, 1, 4);
    readAs(uint8_t(255), true, 1, 4);
    readAs(int16_t(-32768), true, -1, 3); // a normalised -32768 is -1, too
    readAs(int16_t(2000), false, 1 / 2000.0, 4);
    readAs(uint16_t(50000), false, 1 / 50000.0, 3);
    readAs(int8_t(-100), false, -1 / 100.0, 4);
    readAs(uint8_t(200), false, 1 / 200.0, 3);
}

TEST(GltfGeometry, SparseAccessorsAndThoseWithoutAView) {
    GltfFile file = GltfFile::square();
    const size_t places = file.primitive()["attributes"]["POSITION"];
    const size_t indices = file.addView(std::string("\1\0\3\0", 4));
    const float values[6]{2, 0, 0, 0, 0, 4};
    const size_t view = file.addView({reinterpret_cast<const char*>(values), sizeof(values)});
    json& accessor = file.json["accessors"][places];
    accessor["sparse"] = {{"count", 2},
                          {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
                          {"values", {{"bufferView", view}}}};
    expectTriangles(read(file.glb()), {{kA, 2.0 * kB, kC}, {kA, kC, 4.0 * kD}});
    accessor.erase("bufferView"); // what is not replaced is zero
    expectTriangles(read(file.glb()), {{kA, 2.0 * kB, kA}, {kA, kA, 4.0 * kD}});
    accessor.erase("sparse");
    expectTriangles(read(file.glb()), {{kA, kA, kA}, {kA, kA, kA}});
    accessor["sparse"] = {
        {"count", 2}, {"indices", {{"bufferView", view}, {"componentType", 5126}}}, {"values", {{"bufferView", view}}}};
    expectRefused(file.glb(), "sparse indices that are no unsigned whole numbers");
    accessor["sparse"]["indices"] = {{"bufferView", file.addView(std::string("\3\1", 2))}, {"componentType", 5121}};
    expectRefused(file.glb(), "sparse indices that do not grow");
    accessor["sparse"]["count"] = 3000;
    expectRefused(file.glb(), "larger than its buffer");
    // Zeros take no memory, however many they are: the triangles are bounded.
    GltfFile zeros;
    zeros.json["accessors"][0].erase("bufferView");
    zeros.json["accessors"][0]["count"] = 3'000'000'000'000;
    zeros.primitive().erase("indices");
    expectRefused(zeros.glb(), "more than 100 triangles");
}

// Copies of a node by translation, rotation and scale, in this order from the outside.
TEST(GltfGeometry, Instances) {
    GltfFile file = GltfFile::square();
    const auto copies = [&]() -> json& {
        return file.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
    };
    copies()["TRANSLATION"] = file.add(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, "VEC3", 4);
    file.json["extensionsUsed"] = file.json["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
    expectBox(read(file.glb()), 8, {0, 0, 0}, {2, 2, 2});
    expectTold(read(file.glb()), {});
    copies()["SCALE"] = file.add(std::vector<float>{1, 1, 1, 2, 3, 4, 1, 1, 1, 1, 1, 1}, "VEC3", 4);
    expectBox(read(file.glb()), 8, {0, 0, 0}, {3, 3, 4});
    const auto half = int16_t(std::lround(std::sqrt(0.5) * 32767));
    copies() = {{"ROTATION", file.add(std::vector<int16_t>{0, 0, half, half}, "VEC4", 1, true)}};
    expectBox(read(file.glb()), 2, {-1, 0, 0}, {0, 1, 1}); // x turned to y, y to -x
    const float turn = std::sqrt(0.5f);
    copies() = {{"ROTATION", file.add(std::vector<float>{0, 0, turn, turn}, "VEC4", 1)},
                {"TRANSLATION", file.add(std::vector<float>{10, 0, 0}, "VEC3", 1)},
                {"SCALE", file.add(std::vector<float>{5, 1, 1}, "VEC3", 1)}};
    file.json["nodes"][0]["translation"] = {0, 0, 100};
    expectBox(read(file.glb()), 2, {9, 0, 100}, {10, 5, 101});
    copies()["SCALE"] = file.add(std::vector<float>{1, 1, 1, 1, 1, 1}, "VEC3", 2);
    expectRefused(file.glb(), "lists of 1 and 2 copies");
    file.json["accessors"].push_back({{"componentType", 5126}, {"count", 1ull << 40}, {"type", "VEC3"}});
    copies() = {{"TRANSLATION", file.json["accessors"].size() - 1}};
    expectRefused(file.glb(), "more than 100 copies");
    copies() = {{"TRANSLATION", file.add(std::vector<float>(153), "VEC3", 51)}};
    expectRefused(file.glb(), "more than 100 triangles");
}

// A vertex stands where its joints take it; the node of the mesh does not count.
TEST(GltfGeometry, SkinsStandInTheirPose) {
    GltfFile file = GltfFile::square();
    file.json["nodes"] = json::parse(R"([
        {"mesh": 0, "skin": 0, "translation": [50, 0, 0]},
        {"translation": [0, 10, 0], "children": [2]},
        {"translation": [0, 0, 5], "scale": [2, 2, 2]}])");
    file.json["scenes"][0]["nodes"] = {0, 1};
    // The second joint was bound 1 m up.
    std::vector<float> inverse(32);
    for (const size_t i : {0u, 5u, 10u, 15u}) inverse[i] = inverse[16 + i] = 1;
    inverse[16 + 13] = -1;
    file.json["skins"] = json::array({{{"joints", {1, 2}}, {"inverseBindMatrices", file.add(inverse, "MAT4", 2)}}});
    json& attributes = file.primitive()["attributes"];
    attributes["JOINTS_0"] = file.add(std::vector<uint8_t>{0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0}, "VEC4", 4);
    attributes["WEIGHTS_0"] =
        file.add(std::vector<float>{1, 0, 0, 0, 0.5, 0.5, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0}, "VEC4", 4);
    // kA: (0, 10, 0). kB: the mean of (1, 10, 0) and 2 (1, -1, 0) + (0, 10, 5). kC: 2 (0, 0, 0) + (0, 10, 5).
    const glm::dvec3 a(0, 10, 0), b(1.5, 9, 2.5), c(0, 10, 5), d(0, 10, 1);
    const Gltf gltf = read(file.glb());
    expectTriangles(gltf, {{a, b, c}, {a, c, d}});
    expectTold(gltf, {});
    attributes["JOINTS_0"] = file.add(std::vector<uint16_t>{0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0}, "VEC4", 4);
    attributes["WEIGHTS_0"] =
        file.add(std::vector<uint8_t>{255, 0, 0, 0, 127, 127, 0, 0, 255, 0, 0, 0, 255, 0, 0, 0}, "VEC4", 4, true);
    expectTriangles(read(file.glb()), {{a, b, c}, {a, c, d}});
    json broken = attributes;
    attributes["JOINTS_0"] = file.add(std::vector<uint8_t>{0, 0, 0, 0, 0, 9, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0}, "VEC4", 4);
    expectRefused(file.glb(), "vertex 1 has joint 9; its skin has 2");
    attributes = broken;
    file.json["skins"][0]["inverseBindMatrices"] = file.add(std::vector<float>(16), "MAT4", 1);
    expectRefused(file.glb(), "2 joints, and 1 matrices");
}

// Without weights, or with joints that are not in the scene, a mesh is there as it was bound, and it is said.
TEST(GltfGeometry, SkinsThatCannotBeApplied) {
    GltfFile file = GltfFile::square();
    file.json["skins"] = json::array({{{"joints", {1}}}});
    file.json["nodes"] = json::parse(R"([{"mesh": 0, "skin": 0}, {"name": "joint"}])");
    for (const json& roots : {json{0}, json{0, 1}}) {
        file.json["scenes"][0]["nodes"] = roots;
        const Gltf gltf = read(file.glb());
        expectSquare(gltf);
        expectTold(gltf, {"a skin that cannot be applied is ignored: the mesh is in its bind pose (1 primitive)"});
    }
    file.json["nodes"].push_back({{"mesh", 0}});
    file.json["scenes"][0]["nodes"] = {0, 2};
    expectSquare(read(file.glb())); // the other node has the same mesh at the same place
}

TEST(GltfGeometry, MorphTargetsByTheirWeights) {
    GltfFile file = GltfFile::square();
    const std::vector<float> up{0, 0, 0, 0, 4, 0, 0, 0, 0, 0, 0, 0}, right{8, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    file.primitive()["targets"] = {{{"POSITION", file.add(up, "VEC3", 4)}}, {{"POSITION", file.add(right, "VEC3", 4)}}};
    expectTriangles(read(file.glb()), {{kA, kB, kC}, {kA, kC, kD}});
    file.json["meshes"][0]["weights"] = {0.5, 0.25};
    const glm::dvec3 a(2, 0, 0), b(1, 2, 0);
    expectTriangles(read(file.glb()), {{a, b, kC}, {a, kC, kD}});
    file.json["nodes"][0]["weights"] = {1, 0};
    expectTriangles(read(file.glb()), {{kA, {1, 4, 0}, kC}, {kA, kC, kD}});
    file.primitive()["targets"][0] = {{"POSITION", file.add(up, "VEC3", 3)}};
    expectRefused(file.glb(), "3 places of 4 vertices");
    file.json["nodes"][0]["weights"] = {"x"};
    expectRefused(file.glb(), "weights holds something that is no number");
}

TEST(GltfGeometry, HiddenNodesAreLeftOut) {
    const auto withNodes = [](const char* nodes) {
        GltfFile file = GltfFile::square();
        file.json["nodes"] = json::parse(nodes);
        file.json["extensionsUsed"] = file.json["extensionsRequired"] = {"KHR_node_visibility"};
        return file.glb();
    };
    expectSquare(read(withNodes(R"([{"mesh": 0, "extensions": {"KHR_node_visibility": {"visible": true}}}])")));
    const Gltf gltf = read(withNodes(R"([{"mesh": 0, "children": [1]},
        {"extensions": {"KHR_node_visibility": {"visible": false}}, "children": [2]}, {"mesh": 0}])"));
    expectSquare(gltf);
    expectTold(gltf, {"hidden nodes are left out (1 mesh)"});
}

// A scale of 0 along an axis is no mistake: what has no area is dropped later (meshes_test).
TEST(GltfGeometry, AScaleOfZero) {
    const Gltf gltf = read(changed([](json& j) {
        j["nodes"] = json::array({{{"mesh", 0}}, {{"mesh", 0}, {"scale", {0, 0, 0}}}});
        j["scenes"][0]["nodes"] = {1, 0};
    }));
    expectTriangles(gltf, {{kA, kB, kC}, {kA, kA, kA}});
}

} // namespace
} // namespace brume::test::gltf_geometry_test

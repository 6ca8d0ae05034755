// Meshes from glTF files that write the same thing in ways of their own, up to the limits of the format.
#include <cmath>

#include "tests/unit/gltf_reading.h"

namespace brume::test::gltf_variants_test {
namespace {

using nlohmann::json;

std::string base64(const std::string& bytes) {
    const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    for (size_t i = 0; i < bytes.size(); i += 3) {
        uint32_t word = 0;
        for (size_t k = 0; k < 3; ++k) word = word << 8 | (i + k < bytes.size() ? uint8_t(bytes[i + k]) : 0u);
        for (size_t k = 0; k < 4; ++k) out += i + k <= bytes.size() ? digits[word >> (18 - 6 * k) & 63] : '=';
    }
    return out;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    for (size_t at = 0; (at = text.find(from, at)) != text.npos; at += to.size()) text.replace(at, from.size(), to);
    return text;
}

TEST(GltfVariants, DataUrisWithEscapesAndLines) {
    GltfFile file = GltfFile::square();
    const std::string data = base64(file.buffer());
    ASSERT_NE(data.find('/'), std::string::npos);
    std::string lines;
    for (size_t i = 0; i < data.size(); i += 76) lines += data.substr(i, 76) + "\r\n";
    for (const std::string& text : {data, lines, " " + data, replaced(data, "A", "%41"), replaced(data, "/", "%2f"),
                                    data + "%3D%3D", data + "===\n", lines.substr(0, 40) + "%0D%0A" + lines.substr(40)})
        for (const char* head :
             {"data:;base64,", "data:;charset=utf-8;BASE64,", "dAtA:application/gltf-buffer;x=y;base64,"}) {
            file.json["buffers"][0]["uri"] = head + text;
            const Gltf gltf = read(file.json.dump());
            expectSquare(gltf);
            expectTold(gltf, {});
        }
    for (const char* wrong : {"data:;base64,AA=A", "data:;base64,%", "data:;base64,AAAA-_", "data:;base64,%2"}) {
        file.json["buffers"][0]["uri"] = wrong;
        expectRefused(file.json.dump(), "a data URI holds what is no base64");
    }
    for (const char* none : {"data:,", "data:;base64,", "data:;base64,==", "data:base64,AAAA"}) {
        file.json["buffers"][0]["uri"] = none;
        expectRefused(file.json.dump(), "bytes; its byteLength is ");
    }
}

TEST(GltfVariants, VersionsAtTheirLimits) {
    const auto withAsset = [](const json& asset) { return changed([&](json& j) { j["asset"] = asset; }); };
    for (const json& asset : {json{{"version", "2"}},
                              {{"version", "2.0"}, {"minVersion", "2"}},
                              {{"version", "2.0"}, {"minVersion", "1.0"}},
                              {{"version", "2.99"}, {"minVersion", "2.00"}}})
        EXPECT_EQ(read(withAsset(asset)).triangles.size(), 1u) << asset;
    for (const char* least : {"2.01", "2.10", "3", "3.0", "10.0"})
        expectRefused(withAsset({{"version", "2.0"}, {"minVersion", least}}),
                      ("asset.minVersion is \"" + std::string(least) + "\"; allowed: 2.0").c_str());
    for (const char* version : {"1.0.1", "0.2", "20.0", "-2.0", "v2.0", ".2"})
        expectRefused(withAsset({{"version", version}}), "another format; export it as glTF 2.0");
    expectRefused(withAsset({{"version", "2.0"}, {"minVersion", 2.1}}), "minVersion is no text");
    expectRefused(withAsset({{"version", "1.0"}, {"minVersion", "2.1"}}), "another format");
    expectRefused(withAsset({{"version", std::string(900, '9')}}), "\"99999999999999999999...\", another format");
}

TEST(GltfVariants, RequiredExtensionsWhereverTheyStand) {
    const auto with = [](const json& required, const json& used) {
        GltfFile file = GltfFile::square();
        file.json["extensionsRequired"] = required;
        file.json["extensionsUsed"] = used;
        return file.glb();
    };
    const json none = json::array();
    for (const char* name : {"KHR_materials_iridescence", "VRMC_vrm", "EXT_lights_ies", "MSFT_lod", "KHR_audio_emitter",
                             "ADOBE_materials_thin_transparency", "EXT_structural_metadata"})
        for (const json& used : {none, json{name}}) {
            const Gltf gltf = read(with({name}, used));
            expectSquare(gltf);
            expectTold(gltf, {std::string("ignored extensions: ") + name});
        }
    expectTold(read(with({"KHR_texture_transform", "KHR_materials_unlit"}, {"KHR_mesh_quantization"})),
               {"ignored extensions: KHR_materials_unlit"});
    // One that moves vertices is named, whatever is before it.
    for (const char* name : {"KHR_meshopt_compression", "KHR_gaussian_splatting", "GODOT_single_root",
                             "khr_materials_unlit", "KHR_mesh_quantization_2", ""})
        expectRefused(with({"KHR_materials_unlit", "KHR_texture_transform", name}, none),
                      (std::string("requires extension ") + name + "; export it without that extension").c_str());
    expectRefused(with({std::string(500, 'x')}, none), (std::string(60, 'x') + "...; export it").c_str());
    expectRefused(with({"a\nb"}, none), "requires extension a?b;");
}

// Triangles as three letters of their corners, which are at (i, i * i, 0).
std::string lettersOf(const Gltf& gltf) {
    std::string out;
    for (const GltfTriangle& triangle : gltf.triangles) {
        for (const glm::dvec3& corner : triangle.corners) {
            EXPECT_EQ(corner.y, corner.x * corner.x);
            out += char('a' + int(corner.x));
        }
        out += ' ';
    }
    return out;
}

TEST(GltfVariants, StripsAndFansOfAnyLength) {
    const auto withMode = [](int mode, const std::vector<uint32_t>& indices) {
        GltfFile file;
        std::vector<float> places;
        for (int i = 0; i < 8; ++i) places.insert(places.end(), {float(i), float(i * i), 0});
        file.primitive()["attributes"]["POSITION"] = file.add(places, "VEC3", 8);
        file.primitive()["indices"] = file.add(indices, "SCALAR", indices.size());
        if (indices.empty()) file.primitive().erase("indices");
        file.primitive()["mode"] = mode;
        return file.glb();
    };
    EXPECT_EQ(lettersOf(read(withMode(5, {}))), "abc cbd cde edf efg gfh ");
    EXPECT_EQ(lettersOf(read(withMode(6, {}))), "abc acd ade aef afg agh ");
    EXPECT_EQ(lettersOf(read(withMode(5, {7, 0, 3}))), "had ");
    EXPECT_EQ(lettersOf(read(withMode(6, {7, 0, 3}))), "had ");
    // A strip that a doubled corner turns, and one of two parts: flat ones are dropped later.
    EXPECT_EQ(lettersOf(read(withMode(5, {0, 1, 2, 2, 3}))), "abc cbc ccd ");
    EXPECT_EQ(lettersOf(read(withMode(5, {0, 1, 2, 2, 3, 3, 4, 5}))), "abc cbc ccd dcd dde edf ");
    EXPECT_EQ(lettersOf(read(withMode(6, {3, 3, 4, 5}))), "dde def ");
    for (const int mode : {5, 6}) {
        expectRefused(withMode(mode, {0, 1}), "fewer than three corners");
        expectRefused(withMode(mode, {0, 1, 2, 8}), "index 8 of a primitive with 8 vertices");
        expectRefused(withMode(mode, {0, 1, 2, 0xffffffffu}), "index 4294967295 of a primitive with 8 vertices");
    }
    for (const int mode : {7, 100})
        expectRefused(withMode(mode, {}),
                      ("a primitive of mode " + std::to_string(mode) + "; allowed: 0 to 6").c_str());
}

// Places between other numbers, wherever they begin.
TEST(GltfVariants, StridesAndOffsetsOfAnySize) {
    for (const size_t stride : {12u, 13u, 16u, 28u, 252u, 255u})
        for (const size_t of_view : {0u, 1u, 4u})
            for (const size_t of_accessor : {0u, 3u, 16u}) {
                GltfFile file = GltfFile::square();
                const float places[4][3]{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
                std::string bytes(of_view + of_accessor + 3 * stride + 12, '\x7f'); // the last ends with its numbers
                for (size_t i = 0; i < 4; ++i)
                    std::memcpy(&bytes[of_view + of_accessor + i * stride], places[i], sizeof(places[i]));
                json& view = file.json["bufferViews"][file.addView(bytes)];
                view["byteOffset"] = size_t(view["byteOffset"]) + of_view;
                view["byteLength"] = bytes.size() - of_view;
                view["byteStride"] = stride;
                json& accessor = file.json["accessors"][size_t(file.primitive()["attributes"]["POSITION"])];
                accessor["bufferView"] = file.json["bufferViews"].size() - 1;
                accessor["byteOffset"] = of_accessor;
                expectSquare(read(file.glb()));
                view["byteStride"] = stride + 1;
                expectRefused(file.glb(), "is larger than its buffer");
                view["byteStride"] = stride;
                view["byteLength"] = bytes.size() - of_view - 1;
                expectRefused(file.glb(), "is larger than its buffer");
            }
    // Indices between other bytes; a word that they are normalised means nothing.
    GltfFile file = GltfFile::square();
    file.primitive()["indices"] =
        file.add(std::vector<uint8_t>{0, 9, 9, 1, 9, 9, 2, 9, 9, 0, 9, 9, 2, 9, 9, 3}, "SCALAR", 6, true);
    file.json["bufferViews"].back()["byteStride"] = 3;
    expectSquare(read(file.glb()));
    EXPECT_EQ(read(file.glb()).triangles[1].corners[2], glm::dvec3(0, 0, 1));
}

TEST(GltfVariants, QuantizedNumbersOfAnyValue) {
    const auto placeOf = [](auto value, bool normalized) {
        using T = decltype(value);
        GltfFile file = GltfFile::square();
        std::vector<T> places(16);
        places[4] = value;
        file.primitive()["attributes"]["POSITION"] = file.add(places, "VEC3", 4, normalized);
        file.json["bufferViews"].back()["byteStride"] = 4 * sizeof(T);
        file.json["extensionsRequired"] = file.json["extensionsUsed"] = {"KHR_mesh_quantization"};
        return read(file.glb()).triangles[0].corners[1].x;
    };
    EXPECT_DOUBLE_EQ(placeOf(int16_t(16384), true), 16384 / 32767.0);
    EXPECT_DOUBLE_EQ(placeOf(int16_t(-32767), true), -1);
    EXPECT_DOUBLE_EQ(placeOf(int16_t(-32768), false), -32768);
    EXPECT_DOUBLE_EQ(placeOf(int8_t(-128), true), -1);
    EXPECT_DOUBLE_EQ(placeOf(int8_t(64), true), 64 / 127.0);
    EXPECT_DOUBLE_EQ(placeOf(uint8_t(51), true), 0.2);
    EXPECT_DOUBLE_EQ(placeOf(uint16_t(13107), true), 0.2);
    EXPECT_DOUBLE_EQ(placeOf(uint16_t(65535), false), 65535);
    EXPECT_DOUBLE_EQ(placeOf(1.5f, true), 1.5); // floats are not normalised
}

TEST(GltfVariants, EmptyPrimitivesInAnyPlace) {
    for (const char* what : {"places", "indices", "both"})
        for (const size_t before : {0u, 1u, 2u}) {
            GltfFile file = GltfFile::square();
            json empty = file.primitive();
            if (*what != 'i') empty["attributes"]["POSITION"] = file.add(std::vector<float>{}, "VEC3", 0);
            if (*what != 'p') empty["indices"] = file.add(std::vector<uint16_t>{}, "SCALAR", 0);
            const json good = file.primitive();
            json& all = file.json["meshes"][0]["primitives"] = json::array();
            for (size_t i = 0; i < 3; ++i) all.push_back(i == before ? good : empty);
            expectSquare(read(file.glb()));
            expectTold(read(file.glb()), {"what has no vertices is left out (2 primitives)"});
            all = {empty};
            expectRefused(file.glb(), "no triangles in its scene: what has no vertices is left out (1 primitive)");
        }
    // Modes apart, with the view of an empty accessor beyond the buffer, or without any.
    for (const json& view : {json{99}, json{}}) {
        GltfFile file = GltfFile::square();
        file.json["accessors"].push_back({{"componentType", 5126}, {"count", 0}, {"type", "VEC3"}});
        if (!view.is_null()) file.json["accessors"].back()["bufferView"] = view[0];
        for (const int mode : {0, 1, 2, 3, 4, 5, 6})
            file.json["meshes"][0]["primitives"].push_back(
                {{"attributes", {{"POSITION", file.json["accessors"].size() - 1}}}, {"mode", mode}});
        expectSquare(read(file.glb()));
        expectTold(read(file.glb()),
                   {"points and lines are left out (4 primitives)", "what has no vertices is left out (3 primitives)"});
    }
}

TEST(GltfVariants, MasksAtTheirCutOff) {
    const auto withAlpha = [](const json& alpha, const json& cutoff, const char* mode = "MASK") {
        GltfFile file = GltfFile::square();
        file.json["materials"][0] = {{"alphaMode", mode},
                                     {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, alpha}}}}};
        if (!cutoff.is_null()) file.json["materials"][0]["alphaCutoff"] = cutoff;
        return file.glb();
    };
    const char* const hidden =
        "no triangles in its scene: what is below its alpha cut-off, or has no alpha, is left out";
    for (const auto& [alpha, cutoff] : {std::pair(json(0.5), json()), {0.1, 0.1}, {1, 1}, {0, 0}, {0.3, 0.29}, {-1, 0}})
        expectSquare(read(withAlpha(alpha, cutoff)));
    for (const auto& [alpha, cutoff] : {std::pair(json(0.4999), json()), {0.1, 0.1001}, {1, 1.01}, {0, 1e-6}, {1, 5}})
        expectRefused(withAlpha(alpha, cutoff), hidden);
    expectSquare(read(withAlpha(0, 1, "OPAQUE")));
    expectSquare(read(withAlpha(0.002, 1, "BLEND"))); // a cut-off is for masks alone
    expectRefused(withAlpha(0.0019, json(), "BLEND"), hidden);
}

TEST(GltfVariants, TransmissionIsToldOnceAMaterial) {
    const auto told = [](const std::vector<json>& factors, bool listed) {
        GltfFile file = GltfFile::square();
        file.json["materials"] = json::array();
        const json part = file.primitive();
        file.json["meshes"][0]["primitives"] = json::array();
        for (size_t i = 0; i < factors.size(); ++i) {
            json material = json::object();
            if (!factors[i].is_null()) material["extensions"]["KHR_materials_transmission"] = factors[i];
            file.json["materials"].push_back(material);
            for (int twice = 0; twice < 2; ++twice) {
                file.json["meshes"][0]["primitives"].push_back(part);
                file.json["meshes"][0]["primitives"].back()["material"] = i;
            }
        }
        if (listed) file.json["extensionsUsed"] = {"KHR_materials_transmission", "KHR_materials_volume"};
        return read(file.glb()).told;
    };
    const auto line = [](const char* of) {
        return std::vector<std::string>{std::string("transmission is ignored: what transmits light is opaque (") + of +
                                        ")"};
    };
    for (const bool listed : {false, true}) {
        EXPECT_EQ(told({{{"transmissionFactor", 0.01}}}, listed), line("1 material"));
        EXPECT_EQ(told({{{"transmissionFactor", 1}}, nullptr, {{"transmissionFactor", 0.5}}}, listed),
                  line("2 materials"));
        EXPECT_TRUE(
            told({{{"transmissionFactor", 0}}, json::object(), {{"transmissionTexture", {{"index", 0}}}}}, listed)
                .empty());
    }
}

TEST(GltfVariants, InstancesUnderOtherNodesAndOfAnyNumber) {
    GltfFile file = GltfFile::square();
    const double half = std::sqrt(0.5);
    const auto copies = [&](size_t node) -> json& {
        return file.json["nodes"][node]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
    };
    // Copies at 0 and 3 along x, which the parent turns to y and doubles. A child of their node stands there once.
    file.json["nodes"] = {{{"children", {1}}, {"rotation", {0, 0, half, half}}, {"scale", {2, 2, 2}}},
                          {{"mesh", 0}, {"children", {2}}},
                          {{"mesh", 0}, {"translation", {0, 0, 10}}}};
    copies(1)["TRANSLATION"] = file.add(std::vector<float>{0, 0, 0, 3, 0, 0}, "VEC3", 2);
    expectBox(read(file.glb()), 6, {-2, 0, 0}, {0, 8, 22});
    // Mirrored, by a negative scale; with a property that is none of ours.
    copies(1)["SCALE"] = file.add(std::vector<float>{-1, 1, 1, 1, 1, -1}, "VEC3", 2);
    copies(1)["_ID"] = file.add(std::vector<float>{7, 8}, "SCALAR", 2);
    expectBox(read(file.glb()), 6, {-2, -2, -2}, {0, 8, 22});
    copies(1) = {{"_ID", file.json["accessors"].size() - 1}};
    expectBox(read(file.glb()), 4, {-2, 0, 0}, {0, 2, 22}); // no places: the node's own
    // Two nodes with copies, and one with none of them.
    copies(1) = {{"TRANSLATION", file.add(std::vector<float>(60), "VEC3", 20)}};
    copies(2) = copies(1);
    expectBox(read(file.glb()), 80, {-2, 0, 0}, {0, 2, 22});
    copies(2) = {{"TRANSLATION", file.add(std::vector<float>{}, "VEC3", 0)}};
    expectBox(read(file.glb()), 40, {-2, 0, 0}, {0, 2, 2});
    expectTold(read(file.glb()), {"nodes of no copies are left out (1 mesh)"});
    copies(1) = copies(2);
    expectRefused(file.glb(), "no triangles in its scene: nodes of no copies are left out (2 meshes)");
}

// A mesh whose skin cannot be applied is there as it was bound, and not a second time where it is already.
TEST(GltfVariants, ASkinThatCannotBeAppliedAddsNoSecondMesh) {
    const std::string told = "a skin that cannot be applied is ignored: the mesh is in its bind pose (1 primitive)";
    const auto withNodes = [](const char* nodes, const json& roots) {
        GltfFile file = GltfFile::square();
        file.json["skins"] = json::array({{{"joints", {2}}}});
        file.json["nodes"] = json::parse(nodes);
        file.json["scenes"][0]["nodes"] = roots;
        return file;
    };
    // Without weights, in any order; the joint is in the scene or not; the same place by other numbers.
    for (const char* nodes :
         {R"([{"mesh": 0, "skin": 0}, {"mesh": 0}, {}])", R"([{"mesh": 0}, {"mesh": 0, "skin": 0}, {}])",
          R"([{"mesh": 0, "skin": 0}, {"mesh": 0, "scale": [1, 1, 1], "translation": [0, -0.0, 0]}, {}])"})
        for (const json& roots : {json{0, 1}, json{1, 0}, json{0, 1, 2}}) {
            const Gltf gltf = read(withNodes(nodes, roots).glb());
            expectSquare(gltf);
            expectTold(gltf, {told});
        }
    // Elsewhere, or another mesh, or morphed, it is there.
    for (const char* nodes : {R"([{"mesh": 0, "skin": 0}, {"mesh": 0, "translation": [0, 0, 0.0001]}, {}])",
                              R"([{"mesh": 0, "skin": 0, "scale": [1, 1, 2]}, {"mesh": 0}, {}])",
                              R"([{"mesh": 0, "skin": 0, "weights": [1]}, {"mesh": 0}, {}])",
                              R"([{"mesh": 0, "skin": 0}, {"mesh": 0, "weights": [1]}, {}])",
                              R"([{"mesh": 0, "skin": 0}, {"mesh": 1}, {}])"}) {
        GltfFile file = withNodes(nodes, {0, 1});
        file.json["meshes"].push_back(file.json["meshes"][0]);
        EXPECT_EQ(read(file.glb()).triangles.size(), 4u) << nodes;
    }
    // One that is applied moves away from its neighbour, and both are there.
    GltfFile file = withNodes(R"([{"mesh": 0, "skin": 0}, {"mesh": 0}, {"translation": [0, 0, 5]}])", {0, 1, 2});
    file.primitive()["attributes"]["JOINTS_0"] = file.add(std::vector<uint8_t>(16), "VEC4", 4);
    file.primitive()["attributes"]["WEIGHTS_0"] = file.add(std::vector<float>(16, 0.25f), "VEC4", 4);
    expectBox(read(file.glb()), 4, {0, 0, 0}, {1, 1, 6});
    expectTold(read(file.glb()), {});
    file.json["scenes"][0]["nodes"] = {0, 1}; // its joint is not in the scene
    expectSquare(read(file.glb()));
    expectTold(read(file.glb()), {told});
}

} // namespace
} // namespace brume::test::gltf_variants_test

// Meshes from glTF files: colours, what is told of materials and extensions, and what is refused for them.
#include <cmath>
#include <filesystem>
#include <fstream>

#include <png.h>
#include <turbojpeg.h>

#include "tests/unit/gltf_reading.h"

namespace brume::test::gltf_materials_test {
namespace {

using nlohmann::json;

using Texels = std::vector<glm::u8vec4>;

constexpr glm::u8vec4 kRed(255, 0, 0, 255), kGreen(0, 255, 0, 255), kBlue(0, 0, 255, 255), kWhite(255),
    kNothing(0, 0, 0, 0);

std::string png(unsigned width, const Texels& texels) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = width, image.height = unsigned(texels.size()) / width;
    image.format = PNG_FORMAT_RGBA;
    size_t size = 0;
    EXPECT_TRUE(png_image_write_to_memory(&image, nullptr, &size, 0, texels.data(), 0, nullptr));
    std::string out(size, '\0');
    EXPECT_TRUE(png_image_write_to_memory(&image, out.data(), &size, 0, texels.data(), 0, nullptr));
    return out;
}

std::string jpeg(int width, const Texels& texels) {
    const tjhandle writer = tjInitCompress();
    unsigned char* data = nullptr;
    unsigned long size = 0;
    EXPECT_EQ(tjCompress2(writer, reinterpret_cast<const unsigned char*>(texels.data()), width, 0,
                          int(texels.size()) / width, TJPF_RGBA, &data, &size, TJSAMP_444, 100, 0),
              0);
    std::string out(reinterpret_cast<char*>(data), size);
    tjFree(data);
    tjDestroy(writer);
    return out;
}

// A square whose material, white, has this image as its base colour texture; (u, v) at its four corners.
GltfFile textured(const std::string& image, const std::vector<float>& uv) {
    GltfFile file = GltfFile::square();
    file.json["images"] = json::array({{{"bufferView", file.addView(image)}, {"mimeType", "image/png"}}});
    file.json["textures"] = json::array({{{"source", 0}}});
    file.json["materials"][0]["pbrMetallicRoughness"] = {{"baseColorTexture", {{"index", 0}}}};
    if (!uv.empty()) file.primitive()["attributes"]["TEXCOORD_0"] = file.add(uv, "VEC2", 4);
    return file;
}

// All corners at one place of the image.
std::vector<float> allAt(float u, float v) { return {u, v, u, v, u, v, u, v}; }

const char* const kTexturesTold = "textures are one colour a triangle (1 material)";

TEST(GltfExtensions, ThoseThatMoveNoVertexAreIgnoredWithAWord) {
    for (const char* name : {"KHR_materials_unlit", "KHR_materials_ior", "KHR_materials_specular", "KHR_xmp_json_ld",
                             "KHR_materials_clearcoat", "KHR_lights_punctual", "KHR_texture_basisu", "EXT_texture_webp",
                             "KHR_materials_variants", "KHR_animation_pointer"}) {
        GltfFile file = GltfFile::square();
        file.json["extensionsUsed"] = file.json["extensionsRequired"] = {name};
        const Gltf gltf = read(file.glb());
        expectSquare(gltf);
        expectAlbedo(gltf, 0, {0.5f, 0.25f, 0.125f});
        expectTold(gltf, {std::string("ignored extensions: ") + name});
    }
    // Those that are read.
    for (const char* name : {"KHR_texture_transform", "KHR_mesh_quantization", "EXT_mesh_gpu_instancing"}) {
        GltfFile file = GltfFile::square();
        file.json["extensionsUsed"] = file.json["extensionsRequired"] = {name};
        const Gltf gltf = read(file.glb());
        expectSquare(gltf);
        expectTold(gltf, {});
    }
    // One line for all, also for unknown ones that are not required.
    GltfFile file = GltfFile::square();
    file.json["extensionsUsed"] = {"KHR_materials_unlit", "VENDOR_any", "KHR_materials_unlit"};
    expectTold(read(file.glb()), {"ignored extensions: KHR_materials_unlit, VENDOR_any"});
    file.json["extensionsUsed"] = json::array();
    for (int i = 0; i < 100; ++i) file.json["extensionsUsed"].push_back(std::string(100, char('a' + i % 26)) + "\n");
    const Gltf many = read(file.glb());
    ASSERT_EQ(many.told.size(), 1u);
    EXPECT_LT(many.told[0].size(), 210u);
    EXPECT_EQ(many.told[0].find('\n'), std::string::npos);
}

// Before anything else of the file is looked at.
TEST(GltfExtensions, OthersThatAreRequiredAreRefusedByName) {
    for (const char* name : {"KHR_draco_mesh_compression", "EXT_meshopt_compression", "VENDOR_any"}) {
        GltfFile file = GltfFile::square();
        file.json["extensionsUsed"] = file.json["extensionsRequired"] = {name};
        for (json& accessor : file.json["accessors"]) accessor.erase("bufferView");
        file.json["buffers"].push_back({{"byteLength", 48}});
        file.json["bufferViews"][0]["buffer"] = 1;
        expectRefused(file.glb(), (std::string("requires extension ") + name + ";").c_str());
        file.json["buffers"][0]["uri"] = "data:;base64,AAAA";
        expectRefused(file.json.dump(), (std::string("requires extension ") + name + ";").c_str());
    }
    expectRefused(changed([](json& j) { j["extensionsRequired"] = {7}; }), "extensionsRequired holds something");
    expectRefused(changed([](json& j) { j["extensionsRequired"] = "KHR_any"; }), "extensionsRequired is no list");
}

// Used, but not required: what is there without the extension is read, and where there is nothing it is named.
TEST(GltfExtensions, CompressionThatIsNotRequired) {
    GltfFile file = GltfFile::square();
    file.json["extensionsUsed"] = {"KHR_draco_mesh_compression"};
    file.primitive()["extensions"]["KHR_draco_mesh_compression"] = {{"bufferView", 0}};
    expectSquare(read(file.glb()));
    file.json["accessors"][size_t(file.primitive()["attributes"]["POSITION"])].erase("bufferView");
    expectRefused(file.glb(), "KHR_draco_mesh_compression");
    file = GltfFile::square();
    file.json["buffers"].push_back({{"byteLength", 48}});
    json& view = file.json["bufferViews"][2];
    view["extensions"]["EXT_meshopt_compression"] = {{"buffer", 0}};
    view["buffer"] = 1, view["byteOffset"] = 0;
    expectRefused(file.glb(), "EXT_meshopt_compression");
}

TEST(GltfMaterials, VertexColours) {
    GltfFile file = GltfFile::square();
    json& attributes = file.primitive()["attributes"];
    const auto expectColours = [&](glm::vec3 first, glm::vec3 second, float most = 1e-6f) {
        const Gltf gltf = read(file.glb());
        const glm::vec3 factor(0.5f, 0.25f, 0.125f);
        expectAlbedo(gltf, 0, factor * first, most);
        expectAlbedo(gltf, 1, factor * second, most);
        expectTold(gltf, {});
    };
    attributes["COLOR_0"] = attributes["POSITION"]; // 0, red, green, blue
    expectColours({1 / 3.f, 1 / 3.f, 0}, {0, 1 / 3.f, 1 / 3.f});
    attributes["COLOR_0"] =
        file.add(std::vector<uint8_t>{0, 0, 0, 9, 255, 0, 0, 9, 0, 255, 0, 9, 0, 0, 255, 9}, "VEC4", 4, true);
    expectColours({1 / 3.f, 1 / 3.f, 0}, {0, 1 / 3.f, 1 / 3.f});
    attributes["COLOR_0"] =
        file.add(std::vector<uint16_t>{0, 0, 0, 65535, 0, 0, 0, 65535, 0, 0, 0, 32768}, "VEC3", 4, true);
    expectColours({1 / 3.f, 1 / 3.f, 0}, {0, 1 / 3.f, 32768 / 65535.f / 3});
    attributes["COLOR_0"] = file.add(std::vector<float>{9, 9, 9, 9, 9, 9, 9, 9, 9, -1, -1, -1}, "VEC3", 4);
    const Gltf bright = read(file.glb());
    expectAlbedo(bright, 0, glm::vec3(1));
    // What is no colour costs no triangle.
    for (const auto& [index, why] : {std::pair(size_t(1), "COLOR_0 is ignored: accessors[1] is SCALAR"),
                                     {size_t(0), "COLOR_0 is ignored: it has too few elements"},
                                     {size_t(99), "COLOR_0 is ignored: there is no accessors[99]"}}) {
        attributes["COLOR_0"] = index;
        const Gltf gltf = read(file.glb());
        expectSquare(gltf);
        expectAlbedo(gltf, 0, {0.5f, 0.25f, 0.125f});
        expectTold(gltf, {why});
    }
}

TEST(GltfMaterials, FactorsBeyondOneAreCut) {
    const Gltf gltf = read(changed([](json& j) {
        j["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {1.5, -2, 0.25, 1};
    }));
    expectAlbedo(gltf, 0, {1, 0, 0.25f});
    expectTold(gltf, {"materials[0] has a base colour factor beyond 0 to 1"});
}

TEST(GltfMaterials, SpecularGlossinessHasADiffuseColour) {
    const Gltf gltf = read(changed([](json& j) {
        j["materials"][0]["extensions"]["KHR_materials_pbrSpecularGlossiness"] = {{"diffuseFactor", {0.75, 1, 0, 1}}};
        j["extensionsUsed"] = {"KHR_materials_pbrSpecularGlossiness"};
    }));
    expectAlbedo(gltf, 0, {0.75f, 1, 0});
    expectTold(gltf, {});
}

TEST(GltfMaterials, Alpha) {
    const auto withMaterial = [](const char* mode, double alpha, const json& cutoff = nullptr) {
        GltfFile file = GltfFile::square();
        file.json["materials"][0] = {{"alphaMode", mode},
                                     {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, alpha}}}}};
        if (!cutoff.is_null()) file.json["materials"][0]["alphaCutoff"] = cutoff;
        return file;
    };
    const std::string hidden = "what is below its alpha cut-off, or has no alpha, is left out (2 triangles)";
    const std::string blended = "blending is ignored: what has any alpha is opaque (1 material)";
    expectRefused(withMaterial("MASK", 0.1).glb(), ("no triangles in its scene: " + hidden).c_str());
    expectRefused(withMaterial("MASK", 0.49).glb(), hidden.c_str());
    expectRefused(withMaterial("MASK", 0.7, 0.8).glb(), hidden.c_str());
    expectRefused(withMaterial("BLEND", 0).glb(), hidden.c_str());
    expectSquare(read(withMaterial("MASK", 0.51).glb()));
    expectTold(read(withMaterial("MASK", 0.1, 0.05).glb()), {});
    expectTold(read(withMaterial("OPAQUE", 0).glb()), {});
    expectSquare(read(withMaterial("BLEND", 0.1).glb()));
    expectTold(read(withMaterial("BLEND", 0.1).glb()), {blended});
    expectTold(read(withMaterial("BLEND", 1).glb()), {});
    // Beside others it is a word. Alpha of vertices counts, too.
    GltfFile file = withMaterial("MASK", 0.1);
    file.json["materials"].push_back(json::object());
    json visible = file.primitive();
    visible["material"] = 1;
    file.json["meshes"][0]["primitives"].push_back(visible);
    expectSquare(read(file.glb()));
    expectTold(read(file.glb()), {hidden});
    file = withMaterial("MASK", 1);
    file.primitive()["attributes"]["COLOR_0"] =
        file.add(std::vector<float>{1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 0.5, 1, 1, 1, -9}, "VEC4", 4);
    EXPECT_EQ(read(file.glb()).triangles.size(), 1u);
    expectTold(read(file.glb()), {"what is below its alpha cut-off, or has no alpha, is left out (1 triangle)"});
}

TEST(GltfMaterials, WhatIsNotSeenIsSaid) {
    GltfFile file = GltfFile::square();
    file.json["extensionsUsed"] = {"KHR_materials_transmission"};
    json& transmission = file.json["materials"][0]["extensions"]["KHR_materials_transmission"];
    transmission["transmissionFactor"] = 1;
    expectSquare(read(file.glb()));
    expectTold(read(file.glb()), {"transmission is ignored: what transmits light is opaque (1 material)"});
    transmission["transmissionFactor"] = 0;
    expectTold(read(file.glb()), {});
    file.json["materials"][0]["emissiveFactor"] = {0, 1, 0};
    file.json["animations"] = json::array({json::object(), json::object()});
    expectTold(read(file.glb()), {"emission is ignored (1 material)", "animations are ignored (2 animations)"});
}

TEST(GltfTextures, ATexelWhereTheTriangleIs) {
    const Texels four{kRed, kGreen, kBlue, kWhite};
    const auto expectAt = [&](float u, float v, glm::vec3 albedo) {
        const Gltf gltf = read(textured(png(2, four), allAt(u, v)).glb());
        expectAlbedo(gltf, 0, albedo);
        expectAlbedo(gltf, 1, albedo);
        expectTold(gltf, {kTexturesTold});
    };
    expectAt(0.25f, 0.25f, {1, 0, 0}); // (0, 0) is the first texel's corner
    expectAt(0.75f, 0.25f, {0, 1, 0});
    expectAt(0.25f, 0.75f, {0, 0, 1});
    expectAt(0.75f, 0.75f, {1, 1, 1});
    expectAt(1.25f, -0.75f, {1, 0, 0}); // repeated
    expectAt(-0.25f, 2.25f, {0, 1, 0});
}

// sRGB is not linear: half of black and white is 0.5, and 128 is 0.2159.
TEST(GltfTextures, MeansAreOfLinearLight) {
    const Texels black_and_white{glm::u8vec4(0, 0, 0, 255), kWhite, kWhite, glm::u8vec4(0, 0, 0, 255)};
    for (const std::vector<float>& uv : {std::vector<float>{}, {0, 0, 8, 0, 0, 8, 8, 8}}) { // none; many repeats
        GltfFile file = textured(png(2, black_and_white), uv);
        file.json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {1, 0.5, 0.25, 1};
        expectAlbedo(read(file.glb()), 0, 0.5f * glm::vec3(1, 0.5f, 0.25f));
    }
    expectAlbedo(read(textured(png(1, {glm::u8vec4(128, 128, 128, 255)}), {}).glb()), 0, glm::vec3(0.215861f), 1e-5f);
    // A large one keeps no texel of 1, and the mean is that of all.
    Texels many(1500 * 1100, kWhite);
    std::fill(many.begin(), many.begin() + 1500 * 275, kRed);
    const GltfFile large = textured(png(1500, many), {});
    expectAlbedo(read(large.glb()), 0, {1, 0.75f, 0.75f}, 1e-4f);
    expectAlbedo(read(textured(png(1500, many), allAt(0.5f, 0.1f)).glb()), 0, {1, 0, 0});
    expectAlbedo(read(textured(png(1500, many), allAt(0.5f, 0.9f)).glb()), 0, {1, 1, 1});
}

TEST(GltfTextures, Jpeg) {
    Texels two(16 * 16, kRed);
    for (size_t i = 8 * 16; i < two.size(); ++i) two[i] = kWhite;
    const GltfFile file = textured(jpeg(16, two), allAt(0.5f, 0.2f));
    expectAlbedo(read(file.glb()), 0, {1, 0, 0}, 0.02f);
    expectAlbedo(read(textured(jpeg(16, two), allAt(0.5f, 0.8f)).glb()), 0, {1, 1, 1}, 0.02f);
    expectAlbedo(read(textured(jpeg(16, two), {}).glb()), 0, {1, 0.5f, 0.5f}, 0.02f);
}

TEST(GltfTextures, TransformsSetsAndWraps) {
    const Texels four{kRed, kGreen, kBlue, kWhite};
    const auto withInfo = [&](const json& info, float u, float v, const json& sampler = json::object()) {
        GltfFile file = textured(png(2, four), allAt(u, v));
        file.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"].update(info);
        file.json["samplers"] = json::array({sampler});
        file.json["textures"][0]["sampler"] = 0;
        file.primitive()["attributes"]["TEXCOORD_1"] = file.add(allAt(0.75f, 0.75f), "VEC2", 4);
        return read(file.glb());
    };
    const auto moved = [](const json& how) { return json{{"extensions", {{"KHR_texture_transform", how}}}}; };
    expectAlbedo(withInfo(moved({{"offset", {0.5, 0}}}), 0.25f, 0.25f), 0, {0, 1, 0});
    expectAlbedo(withInfo(moved({{"scale", {1, 3}}}), 0.25f, 0.25f), 0, {0, 0, 1});
    // A quarter turn takes (u, v) to (v, -u): (0.25, 0.75) to (0.75, -0.25), which repeats at 0.75.
    expectAlbedo(withInfo(moved({{"rotation", std::acos(0.0)}}), 0.25f, 0.75f), 0, {1, 1, 1});
    expectAlbedo(withInfo(moved({{"rotation", std::acos(0.0)}, {"offset", {0, 1}}, {"scale", {1, 1}}}), 0.75f, 0.25f),
                 0, {1, 0, 0});
    expectAlbedo(withInfo(moved({{"texCoord", 1}}), 0.25f, 0.25f), 0, {1, 1, 1});
    expectAlbedo(withInfo({{"texCoord", 1}}, 0.25f, 0.25f), 0, {1, 1, 1});
    expectAlbedo(withInfo({{"texCoord", 7}}, 0.25f, 0.25f), 0, {0.5f, 0.5f, 0.5f}); // no such set: the mean
    expectAlbedo(withInfo(json::object(), 1.25f, 0.25f), 0, {1, 0, 0});
    expectAlbedo(withInfo(json::object(), 1.25f, 0.25f, {{"wrapS", 33071}}), 0, {0, 1, 0}); // clamped
    expectAlbedo(withInfo(json::object(), 1.25f, 0.25f, {{"wrapS", 33648}}), 0, {0, 1, 0}); // mirrored
    expectAlbedo(withInfo(json::object(), 0.25f, -0.25f, {{"wrapT", 33648}}), 0, {1, 0, 0});
}

// What is transparent lends a cut-out no colour; an opaque material has no alpha.
TEST(GltfTextures, AlphaOfTexels) {
    GltfFile file = textured(png(2, {kRed, kRed, kRed, kNothing}), {});
    json& material = file.json["materials"][0];
    expectAlbedo(read(file.glb()), 0, {0.75f, 0, 0});
    material["alphaMode"] = "MASK";
    expectAlbedo(read(file.glb()), 0, {1, 0, 0});
    expectTold(read(file.glb()), {kTexturesTold, "alpha masks are one value a triangle (1 material)"});
    material["alphaCutoff"] = 0.8;
    expectRefused(file.glb(), "below its alpha cut-off");
    file = textured(png(2, {kRed, kRed, kRed, kNothing}), {0.9f, 0.9f, 0.9f, 0.9f, 0.9f, 0.9f, -0.6f, -0.6f});
    file.json["materials"][0]["alphaMode"] = "BLEND"; // a triangle has nothing, the other some
    EXPECT_EQ(read(file.glb()).triangles.size(), 1u);
}

// Triangles are there in any case.
TEST(GltfTextures, ImagesThatCannotBeReadAreAWord) {
    const std::string good = png(2, {kRed, kGreen, kBlue, kWhite});
    const auto expectIgnored = [](const GltfFile& file, const char* why) {
        const Gltf gltf = read(file.glb());
        expectSquare(gltf);
        expectAlbedo(gltf, 0, glm::vec3(1));
        ASSERT_EQ(gltf.told.size(), 1u) << testing::PrintToString(gltf.told);
        EXPECT_NE(gltf.told[0].find(why), std::string::npos) << gltf.told[0];
    };
    expectIgnored(textured(good.substr(0, good.size() / 2), {}), "images[0] is ignored: a broken PNG image");
    expectIgnored(textured("\xff\xd8\xff", {}), "images[0] is ignored: a broken JPEG image");
    expectIgnored(textured("RIFF????WEBP", {}), "neither PNG nor JPEG");
    expectIgnored(textured("", {}), "neither PNG nor JPEG");
    expectIgnored(textured(png(4097, Texels(4097)), {}), "4097 x 1 pixels; allowed: 1 to 4096 a side");
    GltfFile file = textured(good, {});
    const auto withImage = [&](const json& image) {
        file.json["images"][0] = image;
        return file;
    };
    expectIgnored(withImage({{"uri", "no.png"}}), "uri \"no.png\" is not found in the file's folder");
    expectIgnored(withImage({{"uri", "../no.png"}}), "is not found in the file's folder");
    expectIgnored(withImage({{"bufferView", 99}}), "no bufferViews[99]");
    expectIgnored(withImage(json::object()), "neither uri nor bufferView");
    expectIgnored(withImage({{"uri", "data:image/png;base64,####"}}), "no base64");
    file.json["textures"][0] = {{"extensions", {{"KHR_texture_basisu", {{"source", 0}}}}}};
    expectIgnored(file, "textures without a PNG or JPEG image are ignored");
    file.json["textures"] = json::array();
    expectRefused(file.glb(), "no textures[0]");
}

TEST(GltfTextures, BesideTheFile) {
    const std::string name = "gltf_texture test.png";
    std::ofstream(std::filesystem::path(testing::TempDir()) / name, std::ios::binary) << png(1, {kBlue});
    GltfFile file = textured(png(1, {kRed}), {});
    file.json["images"][0] = {{"uri", "gltf_texture%20test.png"}};
    expectAlbedo(read(file.glb()), 0, {0, 0, 1});
}

// However many there are, a file's lines are few.
TEST(GltfTold, FewAndShort) {
    GltfFile file = GltfFile::square();
    for (int i = 0; i < 50; ++i) {
        file.json["materials"].push_back({{"pbrMetallicRoughness", {{"baseColorFactor", {2, 0, 0, 1}}}}});
        json part = file.primitive();
        part["material"] = i + 1;
        file.json["meshes"][0]["primitives"].push_back(part);
    }
    file.json["nodes"][0]["mesh"] = 0;
    const Gltf gltf = parseGltf(file.glb(), "mesh.glb", testing::TempDir(), 200);
    EXPECT_EQ(gltf.triangles.size(), 102u);
    EXPECT_EQ(gltf.told.size(), 16u);
    EXPECT_EQ(gltf.told.back(), "more than these lines say is left out");
}

} // namespace
} // namespace brume::test::gltf_materials_test

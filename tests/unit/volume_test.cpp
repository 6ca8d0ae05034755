// Volumes: files of the format NRRD, and the particles that stand for them.
#include <algorithm>
#include <cmath>
#include <cstring>

#include <gtest/gtest.h>
#include <zlib.h>

#include "common/scene.h"
#include "common/volume/volume.h"
#include "server/sim/layout.h"
#include "server/sim/simulation.h"
#include "tests/unit/ply_file.h"
#include "tests/unit/scene_file.h"

namespace brume::volume_test {
namespace {

using test::raw, test::swapped;

constexpr uint64_t kMany = 1 << 20;

// 2 x 3 x 4 voxels; the value is 1 + its number. `more`: lines of the header.
template <class T>
std::string file(const std::string& type, const std::string& more, bool big = false) {
    std::string out = "NRRD0005\n# made by hand\ntype: " + type +
                      "\ndimension: 3\nsizes: 2 3 4\nencoding: raw\nendian: " + (big ? "big" : "little") + "\n" + more +
                      "\n";
    for (int i = 0; i < 24; ++i) out += big ? swapped(T(1 + i)) : raw(T(1 + i));
    return out;
}

std::string packed(const std::string& bytes) {
    std::string out(bytes.size() + 100, '\0');
    z_stream stream{};
    deflateInit2(&stream, 9, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY); // as gzip does
    std::string in = bytes;
    stream.next_in = reinterpret_cast<Bytef*>(in.data()), stream.avail_in = uInt(in.size());
    stream.next_out = reinterpret_cast<Bytef*>(out.data()), stream.avail_out = uInt(out.size());
    EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
    out.resize(stream.total_out);
    deflateEnd(&stream);
    return out;
}

std::string whyNot(const std::string& bytes) {
    try {
        parseVolume(bytes, "v.nrrd", {}, kMany);
    } catch (const SceneError& error) {
        std::string what = error.what();
        EXPECT_EQ(what.find('\n'), what.npos) << what;
        return what;
    }
    return {};
}

std::string replaced(std::string text, const std::string& what, const std::string& with) {
    return text.replace(text.find(what), what.size(), with);
}

TEST(VolumeFile, IsReadAsItLies) {
    for (const bool big : {false, true}) {
        const Volume volume = parseVolume(file<float>("float", "spacings: 0.5 0.5 0.5\nspace origin: (1,2,3)\n", big),
                                          "v.nrrd", {}, kMany);
        EXPECT_EQ(volume.size, glm::uvec3(2, 3, 4));
        EXPECT_EQ(volume.origin, glm::dvec3(1, 2, 3));
        EXPECT_EQ(volume.spacing, 0.5);
        EXPECT_EQ(volume.at({0, 0, 0}), 1);
        EXPECT_EQ(volume.at({1, 0, 0}), 2);
        EXPECT_EQ(volume.at({0, 1, 0}), 3);
        EXPECT_EQ(volume.at({0, 0, 1}), 7);
        EXPECT_EQ(volume.at({-1, 0, 0}), 0);
        EXPECT_EQ(volume.at({0, 0, 4}), 0);
        EXPECT_TRUE(volume.notes.empty());
    }
}

TEST(VolumeFile, NumbersOfAllTypesAreRead) {
    EXPECT_EQ(parseVolume(file<double>("double", ""), "v", {}, kMany).at({1, 2, 3}), 24);
    EXPECT_FLOAT_EQ(parseVolume(file<uint8_t>("uchar", ""), "v", {}, kMany).at({1, 2, 3}), 24 / 255.0f);
    EXPECT_FLOAT_EQ(parseVolume(file<int8_t>("int8", ""), "v", {}, kMany).at({1, 2, 3}), 24 / 127.0f);
    EXPECT_FLOAT_EQ(parseVolume(file<uint16_t>("unsigned short", "", true), "v", {}, kMany).at({1, 2, 3}),
                    24 / 65535.0f);
    EXPECT_FLOAT_EQ(parseVolume(file<int16_t>("short", ""), "v", {}, kMany).at({1, 2, 3}), 24 / 32767.0f);
    EXPECT_FLOAT_EQ(parseVolume(file<uint32_t>("uint", ""), "v", {}, kMany).at({1, 2, 3}), 24 / 4294967295.0f);
    EXPECT_FLOAT_EQ(parseVolume(file<int32_t>("int32_t", "", true), "v", {}, kMany).at({1, 2, 3}), 24 / 2147483647.0f);
}

// What the file has at a place is there in the scene, whichever axis points up and which way the file's axes go.
TEST(VolumeFile, AxesAreTurned) {
    const std::string mirrored =
        file<float>("float", "space directions: (2,0,0) (0,-2,0) (0,0,2)\nspace origin: (1,2,3)\n");
    for (const auto& [up, turn] :
         {std::pair<std::string, glm::dvec3 (*)(glm::dvec3)>("y", [](glm::dvec3 v) { return v; }),
          {"z", [](glm::dvec3 v) { return glm::dvec3(v.x, v.z, -v.y); }},
          {"x", [](glm::dvec3 v) { return glm::dvec3(-v.y, v.x, v.z); }},
          {"-y", [](glm::dvec3 v) { return glm::dvec3(v.x, -v.y, -v.z); }}}) {
        const Volume volume = parseVolume(mirrored, "v", {.origin = {10, 20, 30}, .unit = 0.1, .up = up}, kMany);
        EXPECT_NEAR(volume.spacing, 0.2, 1e-12);
        for (int k = 0; k < 4; ++k)
            for (int j = 0; j < 3; ++j)
                for (int i = 0; i < 2; ++i) {
                    const glm::dvec3 place =
                        0.1 * turn(glm::dvec3(1 + 2 * i, 2 - 2 * j, 3 + 2 * k)) - glm::dvec3(10, 20, 30);
                    const glm::dvec3 at = (place - volume.origin) / volume.spacing;
                    EXPECT_LT(glm::length(at - glm::round(at)), 1e-9);
                    EXPECT_FLOAT_EQ(volume.at(glm::ivec3(glm::round(at))), float(10 * (1 + (k * 3 + j) * 2 + i))) << up;
                }
    }
}

TEST(VolumeFile, WhatCannotBeReadIsSaidInOneLine) {
    const std::string good = file<float>("float", "");
    EXPECT_EQ(whyNot(good), "");
    EXPECT_NE(whyNot("ply\n").find("expected a file of the format NRRD"), std::string::npos);
    EXPECT_NE(whyNot(replaced(good, "encoding: raw", "encoding: bzip2"))
                  .find("encoding is \"bzip2\"; allowed: raw, gzip, gz (of pynrrd"),
              std::string::npos);
    EXPECT_NE(whyNot(replaced(good, "dimension: 3", "dimension: 4")).find("one number for each voxel"),
              std::string::npos);
    EXPECT_NE(whyNot(replaced(good, "sizes: 2 3 4", "sizes: 2 -3 4")).find("sizes are"), std::string::npos);
    EXPECT_NE(whyNot(replaced(good, "sizes: 2 3 4", "sizes: 99999 99999 99999")).find("sizes are"), std::string::npos);
    EXPECT_NE(whyNot(replaced(good, "sizes: 2 3 4", "sizes: 2 3 5")).find("ends after 96 of 120 bytes"),
              std::string::npos);
    EXPECT_NE(whyNot(replaced(good, "type: float", "type: block")).find("type is \"block\""), std::string::npos);
    EXPECT_NE(whyNot(replaced(good, "endian: little\n", "")).find("endian is not given"), std::string::npos);
    EXPECT_NE(whyNot(file<float>("float", "spacings: 1 1 2\n")).find("no cubes"), std::string::npos);
    EXPECT_NE(whyNot(file<float>("float", "space directions: (1,1,0) (0,1,0) (0,0,1)\n")).find("no cubes"),
              std::string::npos);
    EXPECT_NE(whyNot(file<float>("float", "space origin: (1e9,0,0)\n")).find("beyond 50 km"), std::string::npos);
    EXPECT_NE(whyNot(file<float>("float", "data file: v.raw\n")).find("in another file"), std::string::npos);
    EXPECT_NE(whyNot(good.substr(0, 40)).find("no end"), std::string::npos);
    std::string empty = good;
    std::fill(empty.end() - 96, empty.end(), '\0');
    EXPECT_NE(whyNot(empty).find("no voxel is above 0"), std::string::npos);
}

TEST(VolumeFile, PackedVoxelsAreUnpacked) {
    for (const char* encoding : {"encoding: gzip", "encoding: gz"}) {
        const std::string plain =
            replaced(file<float>("float", "spacings: 0.5 0.5 0.5\n", true), "encoding: raw", encoding);
        const std::string header = plain.substr(0, plain.size() - 96), voxels = plain.substr(header.size());
        const std::string gzip = packed(voxels);
        // Two after each other are one.
        for (const std::string& good : {gzip, packed(voxels.substr(0, 7)) + packed(voxels.substr(7))}) {
            const Volume volume = parseVolume(header + good, "v.nrrd", {}, kMany);
            for (int i = 0; i < 24; ++i) EXPECT_EQ(volume.at({i % 2, i / 2 % 3, i / 6}), 1 + i);
        }
        const auto why = [&](const std::string& bytes) {
            const std::string what = whyNot(header + bytes);
            EXPECT_EQ(what.find("v.nrrd: NRRD: its packed voxels "), 0u) << what;
            return what.substr(std::min(what.size(), size_t(32)));
        };
        EXPECT_EQ(why(""), "end early: 0 of 96 bytes are there");
        EXPECT_EQ(why(gzip.substr(0, gzip.size() - 1)), "end early: 96 of 96 bytes are there");
        EXPECT_EQ(why(gzip.substr(0, gzip.size() / 2)).find("end early: "), 0u);
        EXPECT_EQ(why(voxels), "are corrupt: incorrect header check");
        EXPECT_EQ(why(gzip + "more"), "are corrupt: incorrect header check");
        std::string flipped = gzip;
        flipped[gzip.size() - 6] ^= 1;
        EXPECT_EQ(why(flipped), "are corrupt: incorrect data check");
        EXPECT_EQ(why(packed(voxels.substr(1))), "are 95 bytes, fewer than 96");
        EXPECT_EQ(why(packed(voxels + '\0')), "are more than 96 bytes");
        EXPECT_EQ(why(packed(voxels) + packed(voxels)), "are more than 96 bytes");
        EXPECT_EQ(why(packed(std::string(10 << 20, 'a'))), "are more than 96 bytes");
    }
    std::string large = replaced(file<double>("double", ""), "encoding: raw", "encoding: gzip");
    large = replaced(large, "sizes: 2 3 4", "sizes: 600 600 600");
    EXPECT_NE(whyNot(large).find("its voxels take 1728000000 bytes; allowed: 1 GiB"), std::string::npos);
}

TEST(VolumeFile, BadVoxelsCountAsNothingAndAreTold) {
    std::string bytes = file<float>("float", "");
    for (const auto& [voxel, value] : {std::pair(0, -1.0f), {1, NAN}, {2, INFINITY}, {3, 1e30f}})
        std::memcpy(&bytes[bytes.size() - 96 + size_t(4 * voxel)], &value, 4);
    const Volume volume = parseVolume(bytes, "v", {}, kMany);
    EXPECT_EQ(volume.at({0, 0, 0}), 0);
    EXPECT_EQ(volume.at({1, 0, 0}), 0);
    EXPECT_EQ(volume.at({0, 1, 0}), 0);
    EXPECT_EQ(volume.at({1, 1, 0}), 1e4f);
    ASSERT_EQ(volume.notes.size(), 1u);
    EXPECT_EQ(volume.notes[0].find("4 voxels are below 0"), 0u) << volume.notes[0];
}

TEST(VolumeFile, TooManyVoxelsAreMerged) {
    const Volume volume = parseVolume(file<float>("float", ""), "v", {}, 600);
    EXPECT_EQ(volume.size, glm::uvec3(1, 2, 2));
    EXPECT_EQ(volume.spacing, 2);
    EXPECT_EQ(volume.origin, glm::dvec3(0.5));
    EXPECT_FLOAT_EQ(volume.at({0, 0, 0}), (1 + 2 + 3 + 4 + 7 + 8 + 9 + 10) / 8.0f);
    EXPECT_FLOAT_EQ(volume.at({0, 1, 0}), (5 + 6 + 11 + 12) / 8.0f) << "beyond the end is nothing";
    ASSERT_EQ(volume.notes.size(), 1u);
    EXPECT_NE(volume.notes[0].find("2 x 3 x 4 voxels are merged to 1 x 2 x 2"), std::string::npos);
}

TEST(VolumeFile, IsASceneThatNobodyPushes) {
    test::written(file<float>("float", "spacings: 1 1 1\n"), "v.nrrd");
    const Scene scene = loadScene(
        test::written("[medium]\nlayout = \"volume\"\nfile = \"v.nrrd\"\ncentre = [5, 0, 0]\n", "volume.toml"));
    ASSERT_TRUE(scene.volume);
    EXPECT_EQ(scene.medium.model, kVolumeMedium);
    Simulation simulation(scene);
    std::vector<gpu::Particle> particles(simulation.liveCount());
    simulation.write(particles);
    double mass = 0;
    glm::dvec3 moment(0);
    for (const gpu::Particle& p : particles) {
        const double one = double(p.sigma_t) * std::pow(0.1 * double(p.scale) * 1.6 * 2.5066282746, 3);
        mass += one, moment += one * glm::dvec3(p.centre);
    }
    EXPECT_NEAR(mass, 300, 0.01) << "the sum of 1 ... 24 times a cubic metre";
    EXPECT_NEAR(moment.x / mass, 5 + 156 / 300.0, 1e-4);
    const glm::vec3 before = particles[0].centre;
    Command push{.body = Impulse{.origin = before, .direction = {1, 0, 0}, .strength = 1}};
    simulation.step({&push, 1});
    simulation.write(particles);
    EXPECT_EQ(particles[0].centre, before);
}

} // namespace
} // namespace brume::volume_test

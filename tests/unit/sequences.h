// Sequences: a folder of numbered files, and scenes that play them.
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "server/sim/point_cloud.h"
#include "tests/unit/simulation_scenes.h"

namespace brume::sequences_test {

class Sequences : public testing::Test {
protected:
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("brume-sequence-" + std::to_string(getpid()));

    void SetUp() override { std::filesystem::create_directories(folder); }
    void TearDown() override { std::filesystem::remove_all(folder); }

    // `properties`: "float x", one a line; `body`: the points, one a line.
    void put(const std::string& name, const std::string& properties, const std::string& body) const {
        std::ofstream out(folder / name);
        out << "ply\nformat ascii 1.0\nelement vertex " << std::count(body.begin(), body.end(), '\n') << '\n';
        for (size_t at = 0, end; at < properties.size(); at = end + 1) {
            end = properties.find('\n', at);
            out << "property " << properties.substr(at, end - at) << '\n';
        }
        out << "end_header\n" << body;
    }
    Scene scene(const std::string& medium = "rate = 10\n") const {
        std::ofstream(folder / "scene.toml") << "[medium]\nlayout = 'sequence'\nfile = 'smoke-###.ply'\n" << medium;
        return loadScene(folder / "scene.toml");
    }
    std::string errorOf(const std::string& medium = "") const {
        try {
            Simulation simulation(scene(medium), 1 << 20);
        } catch (const SceneError& error) {
            EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
            return error.what();
        }
        return "no error";
    }
    static std::string lines(const Scene& scene) {
        const Simulation simulation(scene);
        std::string all = pointCloudLine(scene, simulation) + '\n';
        for (const std::string& warning : pointCloudWarnings(scene, simulation)) all += warning + '\n';
        return all;
    }
};

inline const std::string kXyz = "float x\nfloat y\nfloat z\n", kIds = kXyz + "int id\n",
                         kOwn = kIds + "float scale\nfloat sigma_t\nfloat red\nfloat green\nfloat blue\n";

inline std::vector<float> xs(const Simulation& simulation) {
    std::vector<float> out;
    for (const gpu::Particle& p : particlesOf(simulation)) out.push_back(p.centre.x);
    return out;
}
inline void run(Simulation& simulation, int steps) {
    for (int i = 0; i < steps; ++i) simulation.step({});
}
using Floats = std::vector<float>;

} // namespace brume::sequences_test

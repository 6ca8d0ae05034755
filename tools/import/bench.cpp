// brume-import-bench: volumes made here, written as VDB, imported, and compared with plain lattices. Prints a table.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <fstream>
#include <numbers>
#include <optional>

#include <CLI/CLI.hpp>

#include "common/scene.h"
#include "server/sim/simulation.h"
#include "tools/import/import.h"
#include "tools/import/rasterise.h"
#include "tools/import/samples.h"

namespace {

constexpr double kRate = 1; // frames a second

using namespace brume;
using volumes::Volume;

Volume volumeOf(volumes::Voxels voxels, double width) {
    Volume out;
    out.voxels = std::move(voxels);
    out.width = width;
    out.turn = glm::dmat3(width);
    return out;
}

// A scene of ours after some seconds.
Volume sceneVolume(const char* name, int ticks, double width) {
    Simulation simulation(loadScene(findScene(name, BRUME_SCENES)));
    for (int i = 0; i < ticks; ++i) simulation.step({});
    std::vector<gpu::Particle> particles(simulation.liveCount());
    simulation.write(particles);
    std::vector<volumes::Ball> balls;
    const double falloff = double(simulation.now().medium.falloff);
    for (const gpu::Particle& p : particles)
        balls.push_back({glm::dvec3(p.centre) / width, double(p.scale) * falloff / 10 / width, double(p.sigma_t)});
    return volumeOf(volumes::rasterised(balls, 1e-4f).voxels, width);
}

// An ellipsoid of noise with details down to three voxels.
float noiseAt(glm::ivec3 voxel) {
    const glm::dvec3 half(80, 64, 80), at = glm::dvec3(voxel) / half;
    const double edge = 1 - glm::dot(at, at);
    return edge > 0 ? std::max(2 * volumes::fractalNoise(glm::dvec3(voxel) / 48.0, 5, 7) - 1 + 0.8f * float(edge), 0.0f)
                    : 0;
}

// A ball with an edge of three voxels, as a level set becomes.
float ballAt(glm::ivec3 voxel) { return std::clamp((60 - float(glm::length(glm::dvec3(voxel)))) / 3, 0.0f, 1.0f); }

// A waved sheet, five voxels thick.
float sheetAt(glm::ivec3 voxel) {
    const double middle = 12 * std::sin(voxel.x / 30.0) * std::cos(voxel.z / 40.0);
    return std::max(float(1 - std::abs(voxel.y - middle) / 2.5), 0.0f);
}

// A puff that rises by `step` voxels a frame and widens. `frame` may lie between two of them.
Volume puff(double frame, double step) {
    const double deviation = 9 + 0.5 * frame;
    const glm::dvec3 centre(0, step * frame, 0);
    Volume out = volumeOf(volumes::sampled({-48, -48, -48}, {48, 96, 48}, 1e-3f,
                                           [&](glm::ivec3 v) {
                                               const double r = glm::length(glm::dvec3(v) - centre) / deviation;
                                               return float(std::exp(-r * r / 2)) *
                                                      volumes::fractalNoise((glm::dvec3(v) - centre) / 16.0, 3, 5);
                                           }),
                          0.1);
    out.velocity.assign(out.voxels.values().size(), glm::vec3(0, step * out.width * kRate, 0));
    return out;
}

// What layout `sequence` shows half-way between two files.
std::vector<volumes::Kernel> halfWay(const std::filesystem::path& folder, const std::string& name, int frame,
                                     const volumes::ImportSettings& settings, double width) {
    std::ofstream(folder / "half.toml") << "[medium]\nlayout = 'sequence'\nfile = '" << name << "-##.ply'\nrate = 1\n";
    for (int i = 0; i < 2; ++i)
        std::filesystem::copy_file(settings.out.parent_path() / fmt::format("{}_{:04}.ply", name, frame + i),
                                   folder / fmt::format("{}-{:02}.ply", name, i),
                                   std::filesystem::copy_options::overwrite_existing);
    Simulation simulation(loadScene(folder / "half.toml"));
    for (int i = 0; i < 30; ++i) simulation.step({});
    std::vector<gpu::Particle> particles(simulation.liveCount());
    simulation.write(particles);
    std::vector<volumes::Kernel> out;
    for (const gpu::Particle& p : particles) {
        const double deviation = double(p.scale) * settings.placing.falloff / 10 / width;
        volumes::Kernel& kernel = out.emplace_back();
        kernel.at = glm::dvec3(p.centre) / width;
        kernel.spread = volumes::ballSpread(deviation) - glm::dmat3(volumes::kInterpolation); // which errorOf() adds
        kernel.mass = float(double(p.sigma_t) / settings.placing.density *
                            std::pow(std::sqrt(2 * std::numbers::pi) * deviation, 3));
    }
    return out;
}

double seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

class Bench {
public:
    Bench(std::filesystem::path folder, double error, bool lattice, bool ellipsoids)
        : folder_(std::move(folder)), error_(error), lattice_(lattice), ellipsoids_(ellipsoids) {
        std::filesystem::create_directories(folder_);
        std::printf(
            "| volume | active voxels | error asked | measured: depth, stopped, picture | particles | voxels a particle | "
            "s | lattice: spacing, particles, error, s |\n|---|---|---|---|---|---|---|---|\n");
    }

    void volume(const std::string& name, const Volume& volume, double density) {
        const std::filesystem::path in = folder_ / (name + ".vdb");
        volumes::writeVolume(in, volume);
        volumes::ImportSettings settings = settingsOf(in, folder_ / (name + ".ply"), density);
        const double begun = seconds();
        const volumes::Imported got = volumes::importFiles(settings, [](const std::string&) {});
        row(name, got, seconds() - begun);
        std::string lattice = "";
        if (lattice_) {
            settings.fit.per_value = volumes::depthPerValue(volume, settings.placing);
            const double from = seconds();
            double spacing = 1;
            const volumes::Fit fit = volumes::fitLattice(volume.voxels, settings.fit, spacing);
            lattice = fmt::format("{:.2f}, {}, {:.4f}, {:.0f}", spacing, fit.kernels.size(), fit.error.worst(),
                                  seconds() - from);
        }
        std::printf(" %s |\n", lattice.c_str());
        std::fflush(stdout);
    }

    // With the voxels' velocities and without them.
    void sequence(const std::string& name, int frames, double step) {
        for (int frame = 1; frame <= frames; ++frame)
            volumes::writeVolume(folder_ / fmt::format("{}_{:04}.vdb", name, frame), puff(frame, step));
        for (const char* const velocity : {"none", ""}) {
            const double begun = seconds();
            volumes::ImportSettings settings =
                settingsOf(folder_ / (name + "_####.vdb"), folder_ / (name + "_####.ply"), 2);
            settings.wanted.velocity = velocity;
            const volumes::Imported got = volumes::importFiles(settings, [](const std::string&) {});
            row(fmt::format("{}, the last of {} frames", name, frames), got, (seconds() - begun) / frames);
            std::printf(" half-way between frames, by %s: %.4f |\n", *velocity ? "ids" : "velocities",
                        worstBetween(name, frames, step, settings));
        }
    }

private:
    volumes::ImportSettings settingsOf(const std::filesystem::path& in, const std::filesystem::path& out,
                                       double density) const {
        volumes::ImportSettings settings;
        settings.in = in;
        settings.out = out;
        settings.placing.density = density;
        settings.fit.error = error_;
        settings.fit.ellipsoids = ellipsoids_;
        return settings;
    }

    // The largest error half-way between two frames.
    double worstBetween(const std::string& name, int frames, double step,
                        const volumes::ImportSettings& settings) const {
        double worst = 0;
        for (int frame = 1; frame < frames; ++frame) {
            const Volume between = puff(frame + 0.5, step);
            const volumes::Rays rays(between.voxels, volumes::depthPerValue(between, settings.placing));
            worst = std::max(worst, rays.errorOf(halfWay(folder_, name, frame, settings, between.width)).worst());
        }
        return worst;
    }

    void row(const std::string& name, const volumes::Imported& got, double took) const {
        std::printf("| %s | %llu | %g | %.4f, %.4f, %.4f%s | %llu | %.1f | %.1f |", name.c_str(),
                    static_cast<unsigned long long>(got.voxels), error_, got.error.depth, got.error.opacity,
                    got.error.picture, got.kept ? "" : ", missed", static_cast<unsigned long long>(got.points),
                    double(got.voxels) / double(got.points), took);
    }

    std::filesystem::path folder_;
    double error_;
    bool lattice_, ellipsoids_;
};

} // namespace

int main(int argc, char** argv) {
    std::filesystem::path folder = "build/import";
    double error = 0.01;
    bool without_lattice = false, ellipsoids = false;
    std::vector<std::string> only;
    CLI::App app{"brume-import-bench: imports six volumes that it makes, and prints a table (Markdown)."};
    app.add_option("--folder", folder, "for the volumes and the clouds")->capture_default_str();
    app.add_option("--error", error)->capture_default_str();
    app.add_option("--only", only, "names of volumes");
    app.add_flag("--without-lattice", without_lattice);
    app.add_flag("--ellipsoids", ellipsoids, "in place of balls; not of the sequence");
    CLI11_PARSE(app, argc, argv);
    try {
        Bench bench(folder, error, !without_lattice, ellipsoids);
        const auto wanted = [&](const char* name) {
            return only.empty() || std::ranges::find(only, name) != only.end();
        };
        if (wanted("cumulus")) bench.volume("cumulus", sceneVolume("cumulus", 1, 0.35), 1);
        if (wanted("plume")) bench.volume("plume", sceneVolume("plume", 600, 0.08), 1);
        if (wanted("noise"))
            bench.volume("noise", volumeOf(volumes::sampled({-80, -64, -80}, {80, 64, 80}, 0, noiseAt), 1), 0.05);
        if (wanted("ball"))
            bench.volume("ball", volumeOf(volumes::sampled(glm::ivec3(-62), glm::ivec3(62), 0, ballAt), 1), 0.1);
        if (wanted("sheet"))
            bench.volume("sheet", volumeOf(volumes::sampled({-90, -20, -90}, {90, 20, 90}, 0, sheetAt), 1), 0.5);
        if (wanted("puff") && !ellipsoids) {
            bench.sequence("puff", 6, 2);
            bench.sequence("fast", 6, 8);
        }
        return 0;
    } catch (const std::exception& e) {
        std::fprintf(stderr, "brume-import-bench: %s\n", e.what());
        return 1;
    }
}

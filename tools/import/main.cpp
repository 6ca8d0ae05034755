// brume-import: a VDB volume as a point cloud of Gaussians, within a bound of what is seen.
#include <cstdio>
#include <exception>

#include <CLI/CLI.hpp>

#include "common/option_range.h"
#include "common/scene_limits.h"
#include "tools/import/import.h"

int main(int argc, char** argv) {
    using namespace brume;
    volumes::ImportSettings settings;
    CLI::App app{
        "brume-import: a VDB volume as a PLY file of particles, for medium.layout = \"file\", or as the voxels\n"
        "themselves (out.nrrd), for medium.layout = \"volume\".\n"
        "With a # for each digit of a number all frames (smoke_####.vdb out_####.ply), for medium.layout =\n"
        "\"sequence\".\n"
        "The error is the relative RMSE of many rays' optical depths, of 1 - exp(-depth), and of the pixels of pictures\n"
        "lit by a sun: the largest of the three.\n"
        "Exit status: 0, 1 for what cannot be done, 2 if the error is above the bound; the file is written then, too."};
    std::string up = "y";
    app.set_version_flag("--version", BRUME_VERSION);
    app.add_option("in", settings.in, "a VDB file")->required();
    app.add_option("out", settings.out, "a PLY file, or a NRRD file")->required();
    allow(app.add_option("--error", settings.fit.error, "allowed error")->capture_default_str(), 1e-4, 1.0);
    allow(app.add_option("--most", settings.fit.most, "particles at most")->capture_default_str(), uint64_t(1),
          uint64_t(limits::kCount.hi));
    app.add_flag("--ellipsoids", settings.fit.ellipsoids,
                 "particles of three axes, for medium.model = \"ellipsoids\": fewer for the same error");
    app.add_option("--grid", settings.wanted.grid, "the grid of extinctions")->capture_default_str();
    app.add_option("--albedo", settings.wanted.albedo,
                   "the grid of albedos, or none; otherwise albedo, color or Cd, if there is one");
    app.add_option("--velocity", settings.wanted.velocity,
                   "of a sequence the grid of velocities, per second, or none; otherwise velocity, vel or v");
    app.add_option("--up", up, "the file's upward axis: y as Houdini has it, z as Blender")
        ->check(CLI::IsMember({"y", "z"}))
        ->capture_default_str();
    allow(app.add_option("--scale", settings.placing.scale, "metres per unit of the file")->capture_default_str(), 1e-6,
          1e6);
    allow(app.add_option("--density", settings.placing.density, "extinction (1/m) of a value of 1")
              ->capture_default_str(),
          1e-6, 1e6);
    allow(app.add_option("--falloff", settings.placing.falloff, "medium.falloff of the scene")->capture_default_str(),
          limits::kFalloff.lo, limits::kFalloff.hi);
    CLI11_PARSE(app, argc, argv);
    settings.placing.z_up = up == "z";
    try {
        const volumes::Imported done =
            volumes::importFiles(settings, [](const std::string& line) { std::printf("%s\n", line.c_str()); });
        return done.kept ? 0 : 2;
    } catch (const std::exception& e) {
        std::fprintf(stderr, "brume-import: %s\n", e.what());
        return 1;
    }
}

// brume-export: a cloud of particles as a VDB volume.
#include <cstdio>
#include <exception>

#include <CLI/CLI.hpp>

#include "common/option_range.h"
#include "common/scene_limits.h"
#include "tools/import/export.h"

int main(int argc, char** argv) {
    using namespace brume;
    volumes::ExportSettings settings;
    std::string up = "y";
    CLI::App app{
        "brume-export: a PLY file of particles as a VDB volume: grid density (1/m), and albedo if there is one.\n"
        "Particles with axes are ellipsoids."};
    app.set_version_flag("--version", BRUME_VERSION);
    app.add_option("in", settings.in, "a PLY file")->required();
    app.add_option("out", settings.out, "a VDB file")->required();
    allow(app.add_option("--voxel", settings.voxel, "width of a voxel, m")->capture_default_str(), 1e-4, 1e3);
    allow(app.add_option("--least", settings.least, "extinction (1/m) of a voxel that is left out")
              ->capture_default_str(),
          0.0, 1e3);
    allow(app.add_option("--falloff", settings.falloff, "medium.falloff of the scene")->capture_default_str(),
          limits::kFalloff.lo, limits::kFalloff.hi);
    app.add_option("--up", up, "the file's upward axis")->check(CLI::IsMember({"y", "z"}))->capture_default_str();
    CLI11_PARSE(app, argc, argv);
    settings.z_up = up == "z";
    try {
        volumes::exportFile(settings, [](const std::string& line) { std::printf("%s\n", line.c_str()); });
        return 0;
    } catch (const std::exception& e) {
        std::fprintf(stderr, "brume-export: %s\n", e.what());
        return 1;
    }
}
